//! Pinhole and thin-lens cameras.

use fsot::targets::VectorMap;
use nalgebra::{Point3, Vector3};

use super::shape::Ray;

/// A camera with square pixels; image row 0 is at the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Centre of projection, and of the lens.
    pub eye: Point3<f64>,
    /// The point in the middle of the image.
    pub target: Point3<f64>,
    /// Vertical field of view in degrees, in `(0, 180)`; up is `+y`.
    pub vertical_fov_deg: f64,
    /// `None`: a pinhole, every pixel has one ray through its centre.
    pub lens: Option<Lens>,
}

/// A thin lens: rays of a pixel start on a disc and meet in the plane of focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the disc in scene units.
    pub radius: f64,
    /// Distance of the plane of focus along the view direction.
    pub focus_distance: f64,
}

impl Camera {
    /// The ray through the centre of pixel `(y, x)`. With a lens, `lens_uv` (in `[0, 1)²`, mapped to the disc
    /// by the area-preserving concentric map) says where it starts; a pinhole ignores it.
    pub fn ray(&self, [y, x]: [usize; 2], [height, width]: [usize; 2], lens_uv: [f64; 2]) -> Ray {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(&Vector3::y()).normalize();
        let up = right.cross(&forward);
        let half = (self.vertical_fov_deg.to_radians() / 2.0).tan();
        let scale = 2.0 * half / height as f64;
        let across = (x as f64 + 0.5 - width as f64 / 2.0) * scale;
        let above = (height as f64 / 2.0 - y as f64 - 0.5) * scale;
        let direction = forward + right * across + up * above;
        match self.lens {
            None => Ray { origin: self.eye, direction: direction.normalize() },
            Some(lens) => {
                let [a, b, _] = VectorMap::Disc.vector(lens_uv).map(|c| c * lens.radius);
                let origin = self.eye + right * a + up * b;
                // `direction` has depth 1, so the focused point lies `focus_distance` of it away.
                let focused = self.eye + direction * lens.focus_distance;
                Ray { origin, direction: (focused - origin).normalize() }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_is_upright_and_rays_of_a_pixel_meet_in_focus() {
        let mut camera = Camera {
            eye: [0.0, 0.0, 5.0].into(),
            target: Point3::origin(),
            vertical_fov_deg: 90.0,
            lens: None,
        };
        let corner = camera.ray([0, 0], [2, 2], [0.0; 2]).direction;
        // 90° over two rows: pixel centres lie half a unit from the axis at depth 1.
        assert!((corner - Vector3::new(-0.5, 0.5, -1.0).normalize()).norm() < 1e-15);
        camera.lens = Some(Lens { radius: 0.3, focus_distance: 4.0 });
        for uv in [[0.0, 0.0], [0.9, 0.1], [0.5, 0.5], [0.3, 0.99]] {
            let ray = camera.ray([0, 0], [2, 2], uv);
            assert!((ray.origin - camera.eye).norm() <= 0.3 + 1e-12);
            let focused = ray.at(-4.0 / ray.direction.z);
            assert!((focused - Point3::new(-2.0, 2.0, 1.0)).norm() < 1e-12);
        }
    }
}
