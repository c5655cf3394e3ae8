//! What a denoiser may know of a pixel without noise: where its surface is and how it is turned.

use fsot::config::RangeError;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::error::{RenderError, not_empty};
use super::scene::Scene;

/// The surface in the middle of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// Where the pixel's central ray meets it, in scene units.
    pub point: Point3<f64>,
    /// Its unit normal, towards the camera.
    pub normal: Vector3<f64>,
    /// Distance from the camera along the ray, in scene units.
    pub depth: f64,
}

/// Guides of one frame, row by row; `None` where the ray sees the background or a light.
#[derive(Clone, Debug, PartialEq)]
pub struct Guides {
    height: usize,
    width: usize,
    pixels: Vec<Option<Guide>>,
}

impl Guides {
    /// Traces one ray a pixel, through the middle of the lens if there is one: what is out of focus has sharp
    /// guides.
    ///
    /// # Errors
    /// A resolution of 0.
    pub fn render(scene: &Scene, frame: usize, resolution: [usize; 2]) -> Result<Self, RenderError> {
        let [height, width] = resolution;
        not_empty("height", height)?;
        not_empty("width", width)?;
        let still = scene.at_frame(frame);
        let mut pixels = vec![None; height * width];
        pixels.par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                let ray = still.camera.ray([y, x], resolution, [0.5; 2]);
                let nearest = still.nearest(&ray);
                let limit = nearest.map_or(f64::INFINITY, |(depth, _)| depth);
                let light = still.lights.iter().any(|light| light.hit(&ray).is_some_and(|t| t < limit));
                if let (Some((depth, hit)), false) = (nearest, light) {
                    *pixel = Some(Guide { point: hit.point, normal: hit.normal, depth });
                }
            }
        });
        Ok(Self { height, width, pixels })
    }

    /// Guides that are known from elsewhere, row by row.
    ///
    /// # Errors
    /// A resolution of 0; a number of guides that does not fit it; a guide that is not finite, whose normal
    /// is not a unit vector (to 1e-3) or whose depth is not positive.
    pub fn new([height, width]: [usize; 2], pixels: Vec<Option<Guide>>) -> Result<Self, RenderError> {
        not_empty("height", height)?;
        not_empty("width", width)?;
        let (given, expected) = (pixels.len(), height * width);
        if given != expected {
            return Err(RenderError::Length { given, expected });
        }
        for Guide { point, normal, depth } in pixels.iter().flatten() {
            let checks = [
                (
                    "a coordinate of a guide's point",
                    point.coords.sum(),
                    f64::is_finite as fn(f64) -> bool,
                    "finite",
                ),
                ("the length of a guide's normal", normal.norm(), |norm| (norm - 1.0).abs() < 1e-3, "of 1"),
                (
                    "the depth of a guide",
                    *depth,
                    |depth| depth > 0.0 && depth.is_finite(),
                    "above 0 and finite",
                ),
            ];
            if let Some((name, value, _, expected)) = checks.into_iter().find(|check| !check.2(check.1)) {
                return Err(RangeError::new(name, value, expected).into());
            }
        }
        Ok(Self { height, width, pixels })
    }

    /// Height and width in pixels.
    pub fn resolution(&self) -> [usize; 2] {
        [self.height, self.width]
    }

    /// The guides, row by row.
    pub fn pixels(&self) -> &[Option<Guide>] {
        &self.pixels
    }
}
