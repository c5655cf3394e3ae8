//! How much is done.

use crate::measure::Trial;

/// How much is done.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Side of the tables, in pixels.
    pub tile: usize,
    /// Frames of spatio-temporal tables.
    pub tile_frames: usize,
    /// Side of single pictures and of animations, in pixels; multiples of `tile`.
    pub still: usize,
    pub animated: usize,
    /// Frames of the animations.
    pub frames: usize,
    pub reference_spp: u32,
    /// Realisations of single pictures, and of animations.
    pub repeats: [u64; 2],
    /// Share of the usual work on tables.
    pub effort: f64,
    pub spps: Vec<u32>,
    pub still_scenes: &'static [&'static str],
    pub animated_scenes: &'static [&'static str],
}

impl Scale {
    /// What the documentation reports.
    pub fn full() -> Self {
        Self {
            tile: 64,
            tile_frames: 16,
            still: 128,
            animated: 64,
            frames: 24,
            reference_spp: 1024,
            repeats: [4, 2],
            effort: 1.0,
            spps: vec![1, 4, 9, 16],
            still_scenes: &["soft_shadow", "defocus", "glossy", "ambient_occlusion"],
            animated_scenes: &["soft_shadow", "ambient_occlusion", "animated_soft_shadow"],
        }
    }

    /// Enough to see that everything works.
    pub fn quick() -> Self {
        Self {
            tile: 16,
            tile_frames: 6,
            still: 32,
            animated: 16,
            frames: 18,
            reference_spp: 64,
            repeats: [1, 1],
            effort: 0.05,
            spps: vec![1, 4],
            still_scenes: &["soft_shadow", "glossy"],
            animated_scenes: &["animated_soft_shadow"],
        }
    }

    /// What is rendered, in order.
    pub fn trials(&self) -> Vec<(Trial, u32)> {
        let stills = self.still_scenes.iter().map(|&scene| Trial { scene, animated: false });
        let animations = self.animated_scenes.iter().map(|&scene| Trial { scene, animated: true });
        stills.chain(animations).flat_map(|trial| self.spps.iter().map(move |&spp| (trial, spp))).collect()
    }
}
