//! Estimators: how random numbers become a pixel's radiance.
//!
//! Every pixel is prepared once a frame. What is constant there is found by geometry, not by sampling, and
//! then no number is drawn: background, lights, black surfaces, surfaces that face away from every light, and
//! full shadow. The last rests on convexity: seen from a point outside a convex blocker, the region behind it
//! is convex, so a light whose four corners all lie behind the *same* blocker is hidden as a whole.

use fsot::Site;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::bsdf::{Material, cosine_hemisphere, frame};
use super::error::RenderError;
use super::film::Film;
use super::scene::{Hit, Integrator, Scene};
use super::shape::Ray;
use crate::samplers::Sampler;

/// What is known of a pixel before any number is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pixel {
    /// The same radiance whatever the numbers.
    Constant(f64),
    /// A pinhole's pixel shows this point.
    Surface(Hit),
    /// The point shown depends on where the ray crosses the lens.
    Lens([usize; 2]),
}

/// A uniform pair of numbers for the group with this position.
pub(super) trait Draw: FnMut(u32) -> [f64; 2] {}
impl<F: FnMut(u32) -> [f64; 2]> Draw for F {}

/// Renders every frame with `spp` samples a pixel, in parallel over rows.
///
/// The result does not depend on the number of threads. Of sample `s` the dimensions `2g` and `2g + 1` of
/// group `g` of [`Scene::dimension_groups`] are drawn, and only where the group is used.
///
/// # Errors
/// A resolution or a number of samples or frames of 0.
pub fn render(
    scene: &Scene,
    sampler: &dyn Sampler,
    resolution: [usize; 2],
    spp: u32,
) -> Result<Film, RenderError> {
    let shape = [scene.frames, resolution[0], resolution[1]];
    shoot(scene, sampler, resolution, spp, 0, Film::black(shape)?)
}

/// Renders one frame alone, as a film of one frame: the picture that [`render`] puts there.
///
/// # Errors
/// A resolution or a number of samples of 0; a frame that the scene does not have.
pub fn render_frame(
    scene: &Scene,
    frame: usize,
    sampler: &dyn Sampler,
    resolution: [usize; 2],
    spp: u32,
) -> Result<Film, RenderError> {
    super::error::not_empty("frames", scene.frames)?;
    if frame >= scene.frames {
        return Err(RenderError::NoSuchFrame { frame, frames: scene.frames });
    }
    shoot(scene, sampler, resolution, spp, frame, Film::black([1, resolution[0], resolution[1]])?)
}

/// Fills a film with the frames from `first` on.
fn shoot(
    scene: &Scene,
    sampler: &dyn Sampler,
    resolution: [usize; 2],
    spp: u32,
    first: usize,
    mut film: Film,
) -> Result<Film, RenderError> {
    super::error::not_empty("spp", spp as usize)?;
    for_each_pixel_from(scene, first, resolution, film.values_mut(), |still, pixel, site, value| {
        let mut sum = 0.0;
        for sample in 0..spp {
            sum += still.estimate(pixel, resolution, &mut |group| {
                sampler.sample_2d(site, sample, 2 * group).map(f64::from)
            });
        }
        *value = sum / f64::from(spp);
    });
    Ok(film)
}

/// Calls `shade(scene at the frame, pixel, site, value)` on every pixel, in parallel over rows.
pub(super) fn for_each_pixel<V: Send>(
    scene: &Scene,
    resolution: [usize; 2],
    values: &mut [V],
    shade: impl Fn(&Scene, &Pixel, Site, &mut V) + Sync,
) {
    for_each_pixel_from(scene, 0, resolution, values, shade);
}

/// The same for the frames from `first` on.
fn for_each_pixel_from<V: Send>(
    scene: &Scene,
    first: usize,
    resolution: [usize; 2],
    values: &mut [V],
    shade: impl Fn(&Scene, &Pixel, Site, &mut V) + Sync,
) {
    let [height, width] = resolution;
    for (frame, image) in (first..).zip(values.chunks_exact_mut(height * width)) {
        let still = scene.at_frame(frame);
        image.par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| {
            for (x, value) in row.iter_mut().enumerate() {
                let pixel = still.prepare([y, x], resolution);
                shade(&still, &pixel, Site { frame, y, x }, value);
            }
        });
    }
}

impl Scene {
    /// What is known of pixel `(y, x)` of this frame.
    pub(super) fn prepare(&self, at: [usize; 2], resolution: [usize; 2]) -> Pixel {
        if self.camera.lens.is_some() {
            return Pixel::Lens(at);
        }
        match self.first_hit(&self.camera.ray(at, resolution, [0.5; 2])) {
            Ok(hit) => Pixel::Surface(hit),
            Err(radiance) => Pixel::Constant(radiance),
        }
    }

    /// One sample of the pixel's radiance.
    pub(super) fn estimate(&self, pixel: &Pixel, resolution: [usize; 2], draw: &mut impl Draw) -> f64 {
        match pixel {
            Pixel::Constant(radiance) => *radiance,
            Pixel::Surface(hit) => self.shade(hit, draw, 0),
            Pixel::Lens(at) => match self.first_hit(&self.camera.ray(*at, resolution, draw(0))) {
                Ok(hit) => self.shade(&hit, draw, 1),
                Err(radiance) => radiance,
            },
        }
    }

    /// What a camera ray sees, or the radiance if that needs no integration.
    fn first_hit(&self, ray: &Ray) -> Result<Hit, f64> {
        let nearest = self.nearest(ray);
        let limit = nearest.map_or(f64::INFINITY, |(t, _)| t);
        let mut light: Option<(f64, f64)> = None;
        for seen in &self.lights {
            if let Some(t) = seen.hit(ray).filter(|&t| t < light.map_or(limit, |(least, _)| least)) {
                light = Some((t, seen.radiance));
            }
        }
        match (light, nearest) {
            (Some((_, radiance)), _) => Err(radiance),
            (None, None) => Err(self.environment),
            (None, Some((_, hit))) => self.constant(&hit).map_or(Ok(hit), Err),
        }
    }

    /// The radiance of the hit if no random number can change it. Geometry decides, so `Some` is certain.
    fn constant(&self, hit: &Hit) -> Option<f64> {
        let hidden = || {
            self.facing_lights(hit).all(|light| {
                let corners = light.rectangle.corners();
                let segments = corners.map(|corner| Ray { origin: hit.point, direction: corner - hit.point });
                self.objects.iter().any(|object| {
                    object.shape.excludes(hit.point)
                        && segments.iter().all(|segment| object.shape.blocks(segment))
                })
            })
        };
        let dark = match self.integrator {
            Integrator::AmbientOcclusion { distance } => {
                let free = |shape: &super::Shape| shape.is_beyond(hit.point, hit.normal, distance);
                return self.objects.iter().all(|object| free(&object.shape)).then_some(1.0);
            }
            _ if hit.material.is_black() => true,
            Integrator::Light => hidden(),
            Integrator::LightAndBsdf => self.environment == 0.0 && hidden(),
            Integrator::OneBounce => false,
        };
        dark.then_some(0.0)
    }

    /// One sample of the radiance that leaves the hit; the first group drawn is `first`.
    fn shade(&self, hit: &Hit, draw: &mut impl Draw, first: u32) -> f64 {
        let surface = Surface::new(hit);
        match self.integrator {
            Integrator::AmbientOcclusion { distance } => {
                let direction = surface.world * cosine_hemisphere(draw(first)) * distance;
                f64::from(!self.blocked(&Ray { origin: hit.point, direction }))
            }
            Integrator::Light => self.direct(&surface, draw, first, |_, _| 1.0),
            Integrator::LightAndBsdf => {
                let balance = |light: f64, bsdf: f64| light / (light + bsdf);
                self.direct(&surface, draw, first, balance) + self.reflected(&surface, draw(first + 1))
            }
            Integrator::OneBounce => {
                let direct = self.direct(&surface, draw, first, |_, _| 1.0);
                let Some((weight, ray, _)) = surface.reflect(draw(first + 1)) else { return direct };
                direct
                    + weight
                        * match self.nearest(&ray) {
                            None => self.environment,
                            Some((_, next)) => self.direct(&Surface::new(&next), draw, first + 2, |_, _| 1.0),
                        }
            }
        }
    }

    /// Light from one point on the lights; `weight` is told the densities of that point and of its direction
    /// by reflection, per steradian.
    fn direct(
        &self,
        surface: &Surface,
        draw: &mut impl Draw,
        group: u32,
        weight: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let count = self.facing_lights(&surface.hit).count();
        if count == 0 {
            return 0.0;
        }
        let [u, v] = draw(group);
        let strip = u * count as f64;
        let chosen = (strip as usize).min(count - 1);
        let Some(light) = self.facing_lights(&surface.hit).nth(chosen) else { return 0.0 };
        let to = light.rectangle.at([strip - chosen as f64, v]) - surface.hit.point;
        let direction = to.normalize();
        let cosine = -direction.dot(&light.rectangle.normal());
        let local = surface.world.tr_mul(&direction);
        if cosine <= 0.0 || local.z <= 0.0 {
            return 0.0;
        }
        let value = surface.hit.material.value_cos(&surface.outgoing, &local);
        if value == 0.0 || self.blocked(&Ray { origin: surface.hit.point, direction: to }) {
            return 0.0;
        }
        let density = to.norm_squared() / (cosine * light.rectangle.area() * count as f64);
        let reflected = surface.hit.material.density(&surface.outgoing, &local);
        value * light.radiance / density * weight(density, reflected)
    }

    /// Light that a reflected ray runs into, weighted against [`direct`](Self::direct) by the balance
    /// heuristic.
    fn reflected(&self, surface: &Surface, uv: [f64; 2]) -> f64 {
        let Some((weight, ray, density)) = surface.reflect(uv) else { return 0.0 };
        let end = self.nearest(&ray).map(|(t, _)| t);
        let mut radiance = if end.is_none() { self.environment } else { 0.0 };
        let count = self.facing_lights(&surface.hit).count() as f64;
        for light in self.facing_lights(&surface.hit) {
            if let Some(t) = light.hit(&ray).filter(|&t| end.is_none_or(|end| t < end)) {
                let cosine = -ray.direction.dot(&light.rectangle.normal());
                let by_light = t * t / (cosine * light.rectangle.area() * count);
                radiance += light.radiance * density / (density + by_light);
            }
        }
        weight * radiance
    }
}

/// A hit with its local frame.
struct Surface {
    hit: Hit,
    /// Local to world.
    world: Matrix3<f64>,
    /// Local direction towards the viewer.
    outgoing: Vector3<f64>,
}

impl Surface {
    fn new(hit: &Hit) -> Self {
        let world = frame(&hit.normal);
        Self { hit: *hit, world, outgoing: world.tr_mul(&hit.outgoing) }
    }

    /// A reflected ray with its weight (value · cosine / density) and density, unless nothing goes there.
    fn reflect(&self, uv: [f64; 2]) -> Option<(f64, Ray, f64)> {
        let material = self.hit.material;
        let local = material.sample(&self.outgoing, uv);
        let value = material.value_cos(&self.outgoing, &local);
        if value == 0.0 {
            return None;
        }
        let density = material.density(&self.outgoing, &local);
        // Lambert's ratio is the albedo, exactly.
        let weight = if let Material::Lambert { albedo } = material { albedo } else { value / density };
        Some((weight, Ray { origin: self.hit.point, direction: self.world * local }, density))
    }
}
