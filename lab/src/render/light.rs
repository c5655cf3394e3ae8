//! Rectangular area lights.

use nalgebra::{Point3, Vector3};

use super::shape::{Ray, Rectangle};

/// A rectangle that emits evenly to the side of its normal, is invisible from the other, and casts no shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it is; it emits along `edge_u × edge_v`.
    pub rectangle: Rectangle,
    /// Emitted radiance.
    pub radiance: f64,
    /// Displacement a frame, in scene units.
    pub velocity: Vector3<f64>,
}

impl Light {
    /// A light that stands still.
    pub fn at_rest(rectangle: Rectangle, radiance: f64) -> Self {
        Self { rectangle, radiance, velocity: Vector3::zeros() }
    }

    /// Whether an unblocked surface element there can receive any of its light: the element lies before the
    /// light and some corner rises above the element's plane.
    pub fn reaches(&self, point: Point3<f64>, normal: &Vector3<f64>) -> bool {
        let along = self.rectangle.edge_u.cross(&self.rectangle.edge_v);
        let before = (point - self.rectangle.corner).dot(&along) > 0.0;
        before && self.rectangle.corners().iter().any(|corner| (corner - point).dot(normal) > 0.0)
    }

    /// Ray parameter at which the ray meets the emitting side.
    pub fn hit(&self, ray: &Ray) -> Option<f64> {
        let facing = ray.direction.dot(&self.rectangle.normal()) < 0.0;
        facing.then(|| self.rectangle.hit(ray)).flatten()
    }

    /// Irradiance of an unblocked surface element: Lambert's formula for a polygon, clipped at the horizon.
    ///
    /// `E = L/2 Σ θᵢ n·γᵢ` over the edges, with θ the angle that the edge subtends and γ the unit normal of
    /// the plane through edge and element (Lambert 1760; Baum, Rushmeier and Winget 1989).
    pub fn irradiance(&self, point: Point3<f64>, normal: &Vector3<f64>) -> f64 {
        if !self.reaches(point, normal) {
            return 0.0;
        }
        let corners = self.rectangle.corners().map(|corner| corner - point);
        let mut above = Vec::with_capacity(8);
        for (i, corner) in corners.iter().enumerate() {
            let next = corners[(i + 1) % 4];
            let (here, there) = (corner.dot(normal), next.dot(normal));
            if here >= 0.0 {
                above.push(*corner);
            }
            if (here > 0.0) != (there > 0.0) && here != there {
                above.push(corner + (next - corner) * (here / (here - there)));
            }
        }
        let edges = above.iter().zip(above.iter().cycle().skip(1));
        let sum: f64 = edges
            .map(|(a, b)| {
                let across = a.cross(b);
                let angle = across.norm().atan2(a.dot(b));
                across.try_normalize(0.0).map_or(0.0, |gamma| angle * gamma.dot(normal))
            })
            .sum();
        self.radiance / 2.0 * sum.abs()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;

    fn ceiling(half: f64) -> Light {
        let edge = 2.0 * half;
        Light::at_rest(
            Rectangle {
                corner: [-half, 1.0, -half].into(),
                edge_u: [edge, 0.0, 0.0].into(),
                edge_v: [0.0, 0.0, edge].into(),
            },
            1.0,
        )
    }

    #[test]
    fn irradiance_has_its_textbook_values() {
        // An endless ceiling gives π L; a square of half-side a at height 1 above the point, by symmetry of
        // the form factor of a rectangle above its corner: 4 L a/√(1+a²) atan(a/√(1+a²)).
        let up = Vector3::y();
        assert_relative_eq!(ceiling(1e6).irradiance(Point3::origin(), &up), PI, epsilon = 1e-5);
        for a in [0.1_f64, 1.0, 3.0] {
            let side = a / (1.0 + a * a).sqrt();
            let expected = 4.0 * side * side.atan();
            assert_relative_eq!(ceiling(a).irradiance(Point3::origin(), &up), expected, max_relative = 1e-12);
        }
    }

    #[test]
    fn irradiance_is_clipped_at_the_horizon() {
        // A wall element below the middle of an endless ceiling sees half of it: π/2.
        let light = ceiling(1e6);
        assert_relative_eq!(light.irradiance(Point3::origin(), &Vector3::x()), PI / 2.0, epsilon = 1e-5);
        assert_eq!(light.irradiance(Point3::origin(), &-Vector3::y()), 0.0);
        assert_eq!(light.irradiance([0.0, 2.0, 0.0].into(), &Vector3::y()), 0.0); // behind the light
    }
}
