//! Which pixels of a scene have any variance.

use fsot::classes::Demand;
use fsot::{Extent, Site};

use super::error::RenderError;
use super::integrate::{Pixel, for_each_pixel};
use super::scene::Scene;
use crate::samplers::{OwenSobol, Sampler};

/// Samples that must agree to the last bit before a pixel behind a lens counts as constant.
const PROBES: u32 = 256;

/// The pixels whose value depends on the random numbers, per frame, and the groups of dimensions consumed.
///
/// Through a pinhole the answer is geometric and certain: background, visible lights, black or averted
/// surfaces, full shadow and free hemispheres are recognised exactly (`integrate`), and every other pixel is
/// demanded, also where the variance is only that of a fully visible area light.
///
/// Behind a lens it is found by probing: a pixel counts as constant if 256 Owen-scrambled Sobol' samples of
/// it and of each of its eight neighbours agree exactly. What such a pixel may hide covers less than about
/// 1/256 of its lens and of its neighbours' lenses.
///
/// # Errors
/// A resolution or a number of frames of 0.
pub fn demand(scene: &Scene, resolution: [usize; 2]) -> Result<Demand, RenderError> {
    let [height, width] = resolution;
    let extent = Extent { frames: scene.frames, height, width, spp: 1 };
    extent.validate(1)?;
    // Bits of the constant, or none.
    let mut constants = vec![None; extent.sites()];
    for_each_pixel(scene, resolution, &mut constants, |still, pixel, site, constant| {
        *constant = match pixel {
            Pixel::Constant(value) => Some(value.to_bits()),
            Pixel::Surface(_) => None,
            Pixel::Lens(_) => probe(still, pixel, resolution, site),
        };
    });
    let lens = scene.camera.lens.is_some();
    let wanted = |index: usize| {
        let here = constants[index];
        let site = extent.site(index);
        let neighbours = || {
            let rows = site.y.saturating_sub(1)..(site.y + 2).min(height);
            rows.flat_map(|y| (site.x.saturating_sub(1)..(site.x + 2).min(width)).map(move |x| (y, x)))
                .all(|(y, x)| constants[extent.site_index(Site { y, x, ..site })] == here)
        };
        here.is_none() || lens && !neighbours()
    };
    let pixels = (0..extent.sites()).map(wanted).collect();
    Ok(Demand::new([scene.frames, height, width], pixels, scene.dimension_groups())?)
}

/// The pixel's value if all probes agree.
fn probe(still: &Scene, pixel: &Pixel, resolution: [usize; 2], site: Site) -> Option<u64> {
    let sobol = OwenSobol::new(0x9_0be5);
    let value = |sample| {
        let mut draw = |group: u32| sobol.sample_2d(site, sample, 2 * group).map(f64::from);
        still.estimate(pixel, resolution, &mut draw).to_bits()
    };
    let first = value(0);
    (1..PROBES).all(|sample| value(sample) == first).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::render;
    use crate::samplers::WhiteNoise;

    #[test]
    fn every_pixel_that_noise_can_change_is_demanded() {
        let resolution = [32, 32];
        for name in Scene::NAMES {
            let mut scene = Scene::by_name(name).unwrap();
            scene.frames = scene.frames.min(3);
            let demand = demand(&scene, resolution).unwrap();
            assert_eq!(demand.dims(), scene.dims());
            let first = render(&scene, &WhiteNoise::new(0), resolution, 1).unwrap();
            for seed in 1..24 {
                let film = render(&scene, &WhiteNoise::new(seed), resolution, 1).unwrap();
                for (index, (a, b)) in film.values().iter().zip(first.values()).enumerate() {
                    assert!(a == b || demand.pixels()[index], "{name}, seed {seed}: pixel {index} {a} {b}");
                }
            }
            assert!(demand.share() > 0.2 && demand.share() < 0.9, "{name}: {}", demand.share());
        }
    }

    #[test]
    fn no_number_is_drawn_where_none_is_demanded() {
        struct Telltale;
        impl Sampler for Telltale {
            fn sample(&self, site: Site, _: u32, dim: u32) -> f32 {
                panic!("drew dimension {dim} at {site:?}")
            }
        }
        // A floor seen from above whose light shines away from it.
        let mut scene = Scene::by_name("soft_shadow").unwrap();
        for light in &mut scene.lights {
            std::mem::swap(&mut light.rectangle.edge_u, &mut light.rectangle.edge_v);
        }
        assert_eq!(demand(&scene, [16, 16]).unwrap().count(), 0);
        render(&scene, &Telltale, [16, 16], 4).unwrap();
    }
}
