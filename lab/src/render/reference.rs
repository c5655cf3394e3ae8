//! References: many-sample quasi-Monte Carlo with its own error, kept in a directory of the caller's.

use std::fs;
use std::io::Write;
use std::path::Path;

use fsot::files::WholeFile;

use super::error::{RenderError, not_empty};
use super::film::Film;
use super::integrate::{Pixel, for_each_pixel};
use super::scene::Scene;
use crate::samplers::{OwenSobol, Sampler};

/// Independent randomisations; their spread is the reference's standard error.
const RANDOMISATIONS: u32 = 8;

/// The truth about a scene, how far to trust it, and how noisy one sample is.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Mean radiance.
    pub mean: Film,
    /// Standard error of `mean`, from the spread of eight independent randomisations.
    pub standard_error: Film,
    /// Variance of *one* sample: white noise at `n` samples a pixel has the expected squared error
    /// `variance / n`.
    pub variance: Film,
}

impl Reference {
    /// Renders with `spp` Owen-scrambled Sobol' samples a pixel: eight randomisations of `spp / 8` each,
    /// rounded up.
    ///
    /// Powers of two are best. The time is that of [`render`](super::render) at `spp` samples; constant
    /// pixels cost nothing.
    ///
    /// # Errors
    /// A resolution or a number of samples or frames of 0.
    pub fn render(scene: &Scene, resolution: [usize; 2], spp: u32) -> Result<Self, RenderError> {
        not_empty("spp", spp as usize)?;
        let shape = [scene.frames, resolution[0], resolution[1]];
        let mut mean = Film::black(shape)?;
        let mut standard_error = mean.clone();
        let mut variance = mean.clone();
        let mut pixels = vec![[0.0; 3]; mean.values().len()];
        let each = spp.div_ceil(RANDOMISATIONS);
        for_each_pixel(scene, resolution, &mut pixels, |still, pixel, site, out| {
            if let Pixel::Constant(value) = pixel {
                *out = [*value, 0.0, 0.0];
                return;
            }
            // Sums are of differences from one sample, so that a constant pixel has variance 0 exactly.
            let mut origin = None;
            let (mut means, mut square) = ([0.0; RANDOMISATIONS as usize], 0.0);
            for (seed, mean) in (0..).zip(&mut means) {
                let sobol = OwenSobol::new(0x4ef0 + seed);
                for sample in 0..each {
                    let mut draw = |group: u32| sobol.sample_2d(site, sample, 2 * group).map(f64::from);
                    let value = still.estimate(pixel, resolution, &mut draw);
                    let difference = value - *origin.get_or_insert(value);
                    *mean += difference;
                    square += difference * difference;
                }
                *mean /= f64::from(each);
            }
            let count = f64::from(RANDOMISATIONS);
            let mean = means.iter().sum::<f64>() / count;
            let spread: f64 = means.iter().map(|m| (m - mean) * (m - mean)).sum();
            let samples = count * f64::from(each);
            let variance = (square - samples * mean * mean).max(0.0) / (samples - 1.0);
            *out = [origin.unwrap_or(0.0) + mean, (spread / (count - 1.0) / count).sqrt(), variance];
        });
        for (i, film) in [&mut mean, &mut standard_error, &mut variance].into_iter().enumerate() {
            film.values_mut().iter_mut().zip(&pixels).for_each(|(value, pixel)| *value = pixel[i]);
        }
        Ok(Self { mean, standard_error, variance })
    }

    /// The reference from a file in `directory`, or rendered and put there.
    ///
    /// The file's name holds scene, resolution, `spp`, the crate's version and a fingerprint of the scene. A
    /// file of another length, with a wrong checksum or an impossible value is not trusted: it is rendered
    /// anew and replaced.
    ///
    /// # Errors
    /// As [`render`](Self::render), and a directory that cannot be made or written to.
    pub fn cached(
        scene: &Scene,
        resolution: [usize; 2],
        spp: u32,
        directory: impl AsRef<Path>,
    ) -> Result<Self, RenderError> {
        let (directory, [height, width]) = (directory.as_ref(), resolution);
        let name = format!(
            "{}-{height}x{width}-{spp}spp-v{}-{:016x}.ref",
            scene.name,
            env!("CARGO_PKG_VERSION"),
            checksum(format!("{scene:?}").as_bytes()),
        );
        let path = directory.join(name);
        if let Some(found) =
            fs::read(&path).ok().and_then(|bytes| Self::decode(&bytes, [scene.frames, height, width]))
        {
            return Ok(found);
        }
        let made = Self::render(scene, resolution, spp)?;
        fs::create_dir_all(directory).map_err(|source| RenderError::Io {
            verb: "create",
            path: directory.into(),
            source,
        })?;
        let bytes = made.encode();
        WholeFile::write(&path, |out| out.write_all(&bytes))
            .and_then(WholeFile::commit)
            .map_err(|source| RenderError::Io { verb: "write", path, source })?;
        Ok(made)
    }

    /// Checksum, then mean, standard error and variance as little-endian `f64`.
    fn encode(&self) -> Vec<u8> {
        let films = [&self.mean, &self.standard_error, &self.variance];
        let values = films.into_iter().flat_map(|film| film.values());
        let payload: Vec<u8> = values.flat_map(|value| value.to_le_bytes()).collect();
        [&checksum(&payload).to_le_bytes(), payload.as_slice()].concat()
    }

    /// `None` if anything is wrong.
    fn decode(bytes: &[u8], shape: [usize; 3]) -> Option<Self> {
        let sites: usize = shape.iter().product();
        let (sum, payload) = bytes.split_first_chunk()?;
        if payload.len() != 3 * 8 * sites || checksum(payload) != u64::from_le_bytes(*sum) {
            return None;
        }
        let values: Vec<f64> = payload.as_chunks().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
        if !values.iter().all(|value| value.is_finite()) || values[sites..].iter().any(|&value| value < 0.0) {
            return None;
        }
        let mut films = values.chunks_exact(sites).map(|film| Film::new(shape, film.to_vec()).ok());
        let mut next = || films.next().flatten();
        Some(Self { mean: next()?, standard_error: next()?, variance: next()? })
    }
}

/// FNV-1a, 64 bits.
fn checksum(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RESOLUTION: [usize; 2] = [16, 16];

    #[test]
    fn two_references_agree_within_their_errors() {
        let scene = Scene::by_name("soft_shadow").unwrap();
        let coarse = Reference::render(&scene, RESOLUTION, 256).unwrap();
        let fine = Reference::render(&scene, RESOLUTION, 4096).unwrap();
        // Over all pixels the mean of (difference / error)² is that of a t² with 7 degrees of freedom, 7/5,
        // with a standard deviation of about 3 a pixel: over 100 pixels and more 1.4 ± 0.3. Errors over 5
        // times are a bug.
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..fine.mean.values().len() {
            let error = coarse.standard_error.values()[i].hypot(fine.standard_error.values()[i]);
            let difference = coarse.mean.values()[i] - fine.mean.values()[i];
            if error > 0.0 {
                sum += (difference / error).powi(2);
                count += 1.0;
            } else {
                assert_eq!(difference, 0.0);
            }
        }
        assert!(count > 100.0 && sum / count > 0.5 && sum / count < 2.9, "{sum} / {count}");
        let total = |reference: &Reference| reference.standard_error.values().iter().sum::<f64>();
        assert!(total(&fine) < total(&coarse) / 4.0); // at least the rate of plain Monte Carlo
    }

    #[test]
    fn a_damaged_file_is_made_again() {
        let directory = tempfile::tempdir().unwrap();
        let scene = Scene::by_name("ambient_occlusion").unwrap();
        let made = Reference::cached(&scene, RESOLUTION, 64, directory.path()).unwrap();
        let path = fs::read_dir(directory.path()).unwrap().next().unwrap().unwrap().path();
        let intact = fs::read(&path).unwrap();
        assert_eq!(Reference::decode(&intact, [1, 16, 16]).unwrap(), made);
        let mut flipped = intact.clone();
        flipped[1000] ^= 1;
        let mut infinite = intact.clone();
        infinite[8..16].copy_from_slice(&f64::INFINITY.to_le_bytes());
        let sum = checksum(&infinite[8..]).to_le_bytes();
        infinite[..8].copy_from_slice(&sum);
        for damaged in [&intact[..intact.len() - 8], &flipped, &infinite, &[]] {
            fs::write(&path, damaged).unwrap();
            assert_eq!(Reference::cached(&scene, RESOLUTION, 64, directory.path()).unwrap(), made);
            assert_eq!(fs::read(&path).unwrap(), intact);
        }
        let other = Scene { environment: 1.0, ..scene };
        Reference::cached(&other, RESOLUTION, 64, directory.path()).unwrap();
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2);
    }
}
