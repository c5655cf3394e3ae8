//! Ways of reading a table.

use fsot::{Extent, SampleTable, Site};
use fsot_lab::samplers::{Sampler, WhiteNoise};

use crate::Failure;

/// The tables that are read.
pub struct Source<'a> {
    pub table: &'a SampleTable,
    pub still: &'a SampleTable,
}

/// Where a number is used.
#[derive(Clone, Copy)]
pub struct Place {
    site: Site,
    sample: usize,
    dim: usize,
    /// Which use of the table in this frame.
    number: usize,
}

impl Place {
    /// As far away.
    fn moved(self, y: usize, x: usize) -> Self {
        Self { site: Site { y: self.site.y + y, x: self.site.x + x, ..self.site }, ..self }
    }

    fn at_frame(self, frame: usize) -> Self {
        Self { site: Site { frame, ..self.site }, ..self }
    }

    /// A random number of the pixel alone, the same in every frame.
    fn random(self) -> f32 {
        let dim = 64 * self.number + self.dim;
        WhiteNoise::new(1).sample(Site { frame: 0, ..self.site }, self.sample as u32, dim as u32)
    }
}

/// The number there; the table is tiled in space and time.
fn tiled(table: &SampleTable, place: Place) -> f32 {
    let Extent { frames, height, width, .. } = table.extent();
    let Site { frame, y, x } = place.site;
    let site = Site { frame: frame % frames, y: y % height, x: x % width };
    table.sample(site, place.sample)[place.dim]
}

type Number = Box<dyn Fn(&Source, Place) -> f32 + Sync>;

/// A way of reading.
pub struct Way {
    pub name: String,
    number: Number,
}

impl Way {
    fn new(name: impl Into<String>, number: impl Fn(&Source, Place) -> f32 + Sync + 'static) -> Self {
        Self { name: name.into(), number: Box::new(number) }
    }

    /// All ways that there are for these tables and so many frames.
    pub fn all(source: &Source, frames: usize, uses: usize) -> Vec<Self> {
        let mut ways = vec![Self::new("as it is", as_it_is)];
        if frames > 1 {
            if source.table.extent().frames > 1 {
                ways.extend(Self::moving("as it is", as_it_is));
            }
            ways.push(Self::new("a still table, elsewhere in every frame", elsewhere));
            ways.extend(Self::moving("a still table, elsewhere", elsewhere));
        }
        ways.extend(without_table(source.table.dims(), frames));
        if frames > 1 {
            ways.extend(mistakes_in_time());
        }
        ways.extend(mistakes());
        if uses > 1 {
            ways.extend(mistakes_of_uses());
        }
        ways
    }

    /// The same while the picture moves by a pixel, or five, a frame, and the history with it.
    fn moving(name: &str, number: fn(&Source, Place) -> f32) -> [Self; 2] {
        [1, 5].map(|speed| {
            Self::new(format!("{name}; {speed} px of motion a frame"), move |source, place| {
                number(source, place.moved(0, speed * place.site.frame))
            })
        })
    }

    /// What is read for so many frames; the numbers of several uses in one sample.
    pub fn read(&self, source: &Source, extent: Extent, uses: usize) -> Result<SampleTable, Failure> {
        let dims = source.table.dims();
        let mut values = Vec::with_capacity(extent.samples() * uses * dims);
        for site in (0..extent.sites()).map(|index| extent.site(index)) {
            for sample in 0..extent.spp {
                for number in 0..uses {
                    let place = |dim| Place { site, sample, dim, number };
                    values.extend((0..dims).map(|dim| (self.number)(source, place(dim))));
                }
            }
        }
        Ok(SampleTable::new(extent, uses * dims, values)?)
    }
}

/// As the README says: further uses displaced by R2.
fn as_it_is(source: &Source, place: Place) -> f32 {
    let by = source.table.extent().displacement(place.number as u64);
    tiled(source.table, place.moved(by.y, by.x))
}

/// The still table displaced by R2 over frames and uses.
fn elsewhere(source: &Source, place: Place) -> f32 {
    // Past the frames: the first use of a frame must not be a later use of an earlier one.
    let by = source.still.extent().displacement((place.site.frame + 1000 * place.number) as u64);
    tiled(source.still, place.at_frame(0).moved(by.y, by.x))
}

/// What needs no table.
fn without_table(dims: usize, frames: usize) -> Vec<Way> {
    let white = |_: &Source, place: Place| {
        let dim = 64 * place.number + place.dim;
        WhiteNoise::new(2).sample(place.site, place.sample as u32, dim as u32)
    };
    let mut ways = vec![Way::new("no table: white noise", white)];
    if frames > 1 {
        ways.push(Way::new("no table: random per pixel, R2 over frames", |_, place| {
            (place.random() + golden(place.site.frame, place.dim)).fract()
        }));
    }
    if dims == 1 {
        let noise = |_: &Source, place: Place| gradient_noise(place);
        ways.push(Way::new("no table: interleaved gradient noise", noise));
        if frames > 1 {
            ways.extend(Way::moving("interleaved gradient noise", noise));
        }
    }
    ways
}

fn mistakes_in_time() -> Vec<Way> {
    vec![
        Way::new("the first frame again and again", |source, place| as_it_is(source, place.at_frame(0))),
        Way::new("a still table, values shifted per frame", |source, place| {
            let by = source.still.extent().displacement(place.number as u64);
            let number = tiled(source.still, place.at_frame(0).moved(by.y, by.x));
            (number + golden(place.site.frame, place.dim)).fract()
        }),
        Way::new("frames in random order", |source, place| {
            let at = Site { frame: place.site.frame, y: 0, x: 0 };
            let random = WhiteNoise::new(3).sample(at, 0, 0);
            as_it_is(source, place.at_frame((random * source.table.extent().frames as f32) as usize))
        }),
    ]
}

fn mistakes() -> Vec<Way> {
    vec![
        Way::new("values shifted per pixel", |source, place| {
            (as_it_is(source, place) + place.random()).fract()
        }),
        Way::new("8 bits", |source, place| eight_bits(as_it_is(source, place))),
        Way::new("8 bits, k/255", |source, place| {
            below_one((as_it_is(source, place) * 256.0).floor() / 255.0)
        }),
        Way::new("8 bits, taken for sRGB", |source, place| {
            let encoded = (as_it_is(source, place) * 256.0).floor() / 255.0;
            below_one(if encoded <= 0.04045 {
                encoded / 12.92
            } else {
                ((encoded + 0.055) / 1.055).powf(2.4)
            })
        }),
        Way::new("bilinear filter between four texels", |source, place| {
            let texels = [(0, 0), (0, 1), (1, 0), (1, 1)];
            texels.map(|(y, x)| as_it_is(source, place.moved(y, x))).iter().sum::<f32>() / 4.0
        }),
        Way::new("stretched over 2 x 2 pixels", |source, place| {
            let Site { frame, y, x } = place.site;
            as_it_is(source, Place { site: Site { frame, y: y / 2, x: x / 2 }, ..place })
        }),
    ]
}

fn mistakes_of_uses() -> Vec<Way> {
    vec![
        Way::new("uses at the same place", |source, place| tiled(source.table, place)),
        Way::new("uses one pixel from each other", |source, place| {
            tiled(source.table, place.moved(0, place.number))
        }),
        Way::new("uses in consecutive frames", |source, place| {
            tiled(source.table, place.at_frame(place.site.frame + place.number))
        }),
    ]
}

/// The additive recurrence of the golden ratio in one dimension, of the plastic number in two.
fn golden(frame: usize, dim: usize) -> f32 {
    let steps = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    (frame as f64 * steps[dim % 2]).fract() as f32
}

/// Jimenez 2014, "Next generation post processing in Call of Duty", moved by 5.588238 pixels a frame.
fn gradient_noise(place: Place) -> f32 {
    let Site { frame, y, x } = place.site;
    let by = 5.588_238 * (frame % 64 + 64 * place.number) as f64;
    let inner = (0.067_110_56 * (x as f64 + by) + 0.005_837_15 * (y as f64 + by)).fract();
    below_one((52.982_918_9 * inner).fract() as f32)
}

/// As a texture of eight bits decodes.
fn eight_bits(number: f32) -> f32 {
    ((number * 256.0).floor() + 0.5) / 256.0
}

fn below_one(number: f32) -> f32 {
    number.min(1.0_f32.next_down())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What each way reads of a table whose numbers say where they are from.
    #[test]
    fn ways_read_where_they_say() {
        let extent = Extent::animation(4, 8, 8);
        let values = (0..extent.samples()).map(|index| index as f32 / 256.0).collect();
        let table = SampleTable::new(extent, 1, values).unwrap();
        let still = SampleTable::new(Extent::still(8, 8), 1, table.values()[..64].to_vec()).unwrap();
        let source = Source { table: &table, still: &still };
        let place = Place { site: Site { frame: 5, y: 9, x: 2 }, sample: 0, dim: 0, number: 1 };
        let number = |frame: usize, y: usize, x: usize| (64 * frame + 8 * (y % 8) + x % 8) as f32 / 256.0;
        let by = extent.displacement(1);
        assert_eq!(as_it_is(&source, place), number(1, 1 + by.y, 2 + by.x));
        let by = extent.displacement(1005);
        assert_eq!(elsewhere(&source, place), number(0, 1 + by.y, 2 + by.x));
        let [_, moving] = Way::moving("", as_it_is);
        assert_eq!((moving.number)(&source, Place { number: 0, ..place }), number(1, 1, 2 + 25));
        assert_eq!(eight_bits(0.999_999), 255.5 / 256.0);
    }

    #[test]
    fn every_way_gives_numbers_below_one() {
        let table = SampleTable::white_noise(Extent::animation(3, 8, 8).with_spp(2), 1, 0).unwrap();
        let still = SampleTable::white_noise(Extent::still(8, 8).with_spp(2), 1, 0).unwrap();
        let source = Source { table: &table, still: &still };
        for way in Way::all(&source, 7, 2) {
            let read = way.read(&source, Extent { frames: 7, ..table.extent() }, 2).unwrap();
            assert_eq!(read.shape(), [7, 8, 8, 2, 2], "{}", way.name);
        }
    }
}
