//! A scene as a plain value: objects, lights, a camera, and which numbers it consumes.

use nalgebra::{Point3, Vector3};

use super::bsdf::Material;
use super::camera::Camera;
use super::light::Light;
use super::shape::{Ray, Shape};

/// What is integrated over in a pixel, and with which dimensions.
///
/// A thin lens puts its two dimensions before those named here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// Direct light by one point on the lights: `[light u, light v]`. Several lights share `u` in equal
    /// strips. The environment lights nothing.
    Light,
    /// Direct light by one point on the lights and one reflected ray, combined by the balance
    /// heuristic[^veach]: `[light u, light v, bsdf u, bsdf v]`. Rays that escape see the environment.
    ///
    /// [^veach]: Veach and Guibas 1995, "Optimally combining sampling techniques".
    LightAndBsdf,
    /// Direct light as in [`Integrator::Light`], and light reflected once on the way:
    /// `[light u, light v, bsdf u, bsdf v, light u', light v']`. Rays that escape see the environment.
    OneBounce,
    /// Share of the cosine-weighted hemisphere that is free up to a distance, whatever the material:
    /// `[u, v]`.
    AmbientOcclusion {
        /// Reach of the rays in scene units.
        distance: f64,
    },
}

/// A shape with a material; it may move from frame to frame, and stands still within each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// Its place in frame 0.
    pub shape: Shape,
    /// Its surface.
    pub material: Material,
    /// Displacement a frame, in scene units.
    pub velocity: Vector3<f64>,
}

impl Object {
    /// An object that stands still.
    pub fn at_rest(shape: Shape, material: Material) -> Self {
        Self { shape, material, velocity: Vector3::zeros() }
    }
}

/// Everything that is rendered. Lengths are in scene units, `+y` is up, radiance is linear luminance.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Name, also of cached references; letters, digits and underscores.
    pub name: &'static str,
    /// Frames of the animation, at least 1.
    pub frames: usize,
    /// The camera; it stands still.
    pub camera: Camera,
    /// What blocks and reflects.
    pub objects: Vec<Object>,
    /// What emits.
    pub lights: Vec<Light>,
    /// Radiance from every direction in which there is nothing.
    pub environment: f64,
    /// What is computed.
    pub integrator: Integrator,
}

/// A point of a surface that a ray has reached, lifted off it by a rounding margin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub point: Point3<f64>,
    /// On the side that the ray came from.
    pub normal: Vector3<f64>,
    /// Direction back along the ray, of unit length.
    pub outgoing: Vector3<f64>,
    pub material: Material,
}

/// Distance that a hit is lifted off its surface: far above rounding, far below any feature of a scene.
const LIFT: f64 = 1e-7;

impl Scene {
    /// The groups of dimensions that a sample consumes, in order: lens, light, reflection.
    pub fn dimension_groups(&self) -> Vec<Vec<usize>> {
        let pairs = match self.integrator {
            Integrator::Light | Integrator::AmbientOcclusion { .. } => 1,
            Integrator::LightAndBsdf => 2,
            Integrator::OneBounce => 3,
        };
        let lens = usize::from(self.camera.lens.is_some());
        (0..pairs + lens).map(|pair| vec![2 * pair, 2 * pair + 1]).collect()
    }

    /// Dimensions that a sample consumes.
    pub fn dims(&self) -> usize {
        2 * self.dimension_groups().len()
    }

    /// The scene as it stands in this frame.
    pub(super) fn at_frame(&self, frame: usize) -> Self {
        let mut scene = self.clone();
        for object in &mut scene.objects {
            object.shape = object.shape.moved(object.velocity * frame as f64);
        }
        for light in &mut scene.lights {
            light.rectangle.corner += light.velocity * frame as f64;
        }
        scene
    }

    /// Nearest object along the ray, whose direction has unit length, and its distance.
    pub(super) fn nearest(&self, ray: &Ray) -> Option<(f64, Hit)> {
        let mut nearest: Option<(f64, Vector3<f64>, Material)> = None;
        for object in &self.objects {
            if let Some((t, normal)) = object.shape.hit(ray)
                && nearest.is_none_or(|(least, ..)| t < least)
            {
                nearest = Some((t, normal, object.material));
            }
        }
        nearest.map(|(t, normal, material)| {
            let normal = if normal.dot(&ray.direction) < 0.0 { normal } else { -normal };
            let point = ray.at(t) + normal * LIFT;
            (t, Hit { point, normal, outgoing: -ray.direction, material })
        })
    }

    /// Whether anything stands on the open segment from the origin to `t = 1`.
    pub(super) fn blocked(&self, segment: &Ray) -> bool {
        self.objects.iter().any(|object| object.shape.blocks(segment))
    }

    /// The lights that reach the hit if nothing stands in between.
    pub(super) fn facing_lights(&self, hit: &Hit) -> impl Iterator<Item = &Light> {
        self.lights.iter().filter(move |light| light.reaches(hit.point, &hit.normal))
    }
}
