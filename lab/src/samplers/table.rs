//! A sample table as a renderer reads it: tiled over the image and the animation.

use fsot::{Extent, SampleTable, Site};

use super::{Sampler, WhiteNoise, mixed};

/// Reads an optimised table at pixel `(x mod width, y mod height)` of frame `t mod frames`.
///
/// What the table does not hold is filled in, and costs quality, never correctness:
/// * samples beyond the table's `spp` come from the same table [displaced](Extent::displacement): block `k`
///   of `spp` samples by the `k`-th point of the R2 sequence, so each block alone keeps its blue noise;
/// * dimensions beyond the table's are white noise.
#[derive(Clone, Copy, Debug)]
pub struct TableSampler<'t> {
    table: &'t SampleTable,
    offset: Site,
    beyond: WhiteNoise,
}

impl<'t> TableSampler<'t> {
    /// The table with its first pixel at the origin.
    pub fn new(table: &'t SampleTable) -> Self {
        Self { table, offset: Site { frame: 0, y: 0, x: 0 }, beyond: WhiteNoise::new(0x7ab1e) }
    }

    /// The table displaced: the origin reads the table's pixel `offset`. Another realisation of the same
    /// noise.
    pub fn shifted(mut self, offset: Site) -> Self {
        let Extent { frames, height, width, .. } = self.table.extent();
        self.offset = Site { frame: offset.frame % frames, y: offset.y % height, x: offset.x % width };
        let words = [offset.frame as u64, offset.y as u64, offset.x as u64];
        self.beyond = WhiteNoise::new(mixed(0x7ab1e, &words));
        self
    }
}

impl Sampler for TableSampler<'_> {
    fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
        if dim as usize >= self.table.dims() {
            return self.beyond.sample(site, sample, dim);
        }
        let Extent { frames, height, width, spp } = self.table.extent();
        let Site { y, x, .. } = self.table.extent().displacement((sample as usize / spp) as u64);
        let site = Site {
            frame: site.frame % frames + self.offset.frame,
            y: site.y % height + self.offset.y + y,
            x: site.x % width + self.offset.x + x,
        };
        self.table.sample(site, sample as usize % spp)[dim as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: Extent = Extent { frames: 2, height: 8, width: 8, spp: 2 };

    #[test]
    fn the_table_tiles_the_image() {
        let table = SampleTable::white_noise(EXTENT, 3, 1).unwrap();
        let sampler = TableSampler::new(&table);
        for (frame, y, x, sample, dim) in [(0, 0, 0, 0, 0), (1, 7, 3, 1, 2), (0, 4, 6, 1, 1)] {
            let expected = table.view()[[frame, y, x, sample, dim]];
            for tiles in 0..3 {
                let site = Site { frame: frame + 2 * tiles, y: y + 16 * tiles, x: x + 8 * tiles };
                assert_eq!(sampler.sample(site, sample as u32, dim as u32), expected);
            }
            let offset = Site { frame: 1, y: 3, x: 5 };
            let site = Site { frame: frame + 1, y: y + 5, x: x + 3 };
            assert_eq!(sampler.shifted(offset).sample(site, sample as u32, dim as u32), expected);
        }
    }

    #[test]
    fn later_blocks_are_the_same_tile_elsewhere() {
        let table = SampleTable::white_noise(EXTENT, 2, 1).unwrap();
        let sampler = TableSampler::new(&table);
        let block = |block: u32| {
            let mut values: Vec<f32> = (0..128)
                .flat_map(|i| {
                    let site = Site { frame: i / 64, y: i / 8 % 8, x: i % 8 };
                    [0, 1].map(|s| sampler.sample(site, 2 * block + s, 0))
                })
                .collect();
            let first = values[0];
            values.sort_by(f32::total_cmp);
            (first, values)
        };
        let (first, values) = block(0);
        for later in 1..4 {
            let (other, moved) = block(later);
            assert_eq!(moved, values);
            assert_ne!(other, first);
        }
    }

    #[test]
    fn missing_dimensions_are_noise_and_differ_between_pixels() {
        let table = SampleTable::white_noise(EXTENT, 2, 1).unwrap();
        let sampler = TableSampler::new(&table);
        let at = |x| sampler.sample(Site { frame: 0, y: 0, x }, 0, 2);
        assert_ne!(at(0), at(1));
        assert_ne!(at(0), at(8)); // not tiled
    }
}
