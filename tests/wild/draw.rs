//! Random configurations, most of them sound, some with a number from the ends of its type in them.

use fsot::classes::{Classes, Demand, FilterForm, LabelSet, PrefixLength, PrefixLengths, PrefixOf, Ramp};
use fsot::config::{
    Descent, DimensionGroup, Domain, LabelSubsets, Role, Schedule, Slicing, Sweeps, Term, Work,
};
use fsot::kernel::{SpatialKernel, SpatialTap, TemporalKernel};
use fsot::targets::{Density, PointCloud, Target};
use fsot::{Config, Extent, Kernel, Until};
use rand::{Rng, RngExt};

use crate::odd::{Odd, Windows};

/// What a configuration is drawn from.
pub struct Draw<R> {
    pub random: R,
    /// How often a number is an odd one.
    pub odd: f64,
}

impl<R: Rng> Draw<R> {
    pub fn chance(&mut self, share: f64) -> bool {
        self.random.random::<f64>() < share
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.random.random_range(0..end)
    }

    pub fn pick<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())].clone()
    }

    fn list<T>(&mut self, most: usize, mut of: impl FnMut(&mut Self) -> T) -> Vec<T> {
        (0..self.below(most + 1)).map(|_| of(self)).collect()
    }

    /// A number in a range, or an odd one.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        if self.chance(self.odd) {
            let odd = [
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
                f64::MAX,
                f64::MIN,
                f64::MIN_POSITIVE,
                5e-324,
                -5e-324,
                0.0,
                -0.0,
                -1.0,
                1.0,
                1.0 - f64::EPSILON / 2.0,
                1.0 - 1e-8,
                1e-30,
                1e-12,
                1e6,
                1e15,
                1e200,
                1e-200,
            ];
            return self.pick(&odd);
        }
        if low > 0.0 && self.chance(0.5) {
            return low * (high / low).powf(self.random.random());
        }
        low + (high - low) * self.random.random::<f64>()
    }

    /// A number from 1 to some, or an odd one.
    pub fn count(&mut self, most: usize) -> usize {
        if self.chance(self.odd) {
            let odd = [0, usize::MAX, usize::MAX / 2, 1 << 31, 1 << 32, 1000, 65_537, 1_000_000];
            return self.pick(&odd);
        }
        1 + self.below(most)
    }

    /// The same of samples and dimensions, none of which are so many that a table of them takes long.
    fn len(&mut self, most: usize) -> usize {
        match self.count(most) {
            1000..=1_000_000 => 1 << 31,
            len => len,
        }
    }

    fn extent(&mut self) -> Extent {
        let [frames, height, width, spp] = [self.pick(&[1, 1, 1, 2, 5]), 9, 9, self.pick(&[1, 1, 1, 4])];
        let [frames, height, width, spp] = [frames, height, width, spp].map(|most| self.len(most));
        Extent { frames, height, width, spp }
    }

    fn dims(&mut self) -> usize {
        let most = self.pick(&[1, 2, 2, 2, 3, 4, 4, 9]);
        if self.chance(0.5 * self.odd) { self.pick(&[16, 32, 65]) } else { self.len(most) }
    }

    fn dims_of(&mut self, dims: usize) -> Vec<usize> {
        let dims = dims.clamp(1, 8);
        let mut all: Vec<usize> = (0..dims).filter(|_| self.chance(0.6)).collect();
        if all.is_empty() && !self.chance(self.odd) {
            all.push(self.below(dims));
        }
        if self.chance(self.odd) {
            let more = self.pick(&[0, 1, dims, 63, 64, usize::MAX]);
            all.push(more);
        }
        all
    }

    pub fn kernel(&mut self) -> Kernel {
        let offset = |draw: &mut Self| match draw.chance(draw.odd) {
            true => draw.pick(&[i32::MIN, i32::MAX, -100_000, 77]),
            false => draw.below(7) as i32 - 3,
        };
        let taps = |draw: &mut Self| {
            draw.list(6, |draw| {
                let [dy, dx] = [(); 2].map(|()| offset(draw));
                SpatialTap { dy, dx, weight: draw.number(0.0, 1.0) }
            })
        };
        let spatial = match self.below(6) {
            0 => SpatialKernel::Box { size_px: self.count(5) },
            1 => SpatialKernel::Binomial { size_px: self.count(7) },
            2 => SpatialKernel::Taps(taps(self)),
            3 => SpatialKernel::PerFrame(self.list(3, taps)),
            _ => SpatialKernel::Gaussian { sigma_px: self.number(0.3, 6.0) },
        };
        let temporal = match self.below(9) {
            0 => TemporalKernel::Gaussian { sigma_frames: self.number(0.3, 6.0) },
            1 => TemporalKernel::Ema { alpha: self.number(0.05, 1.0) },
            2 => TemporalKernel::Box { frames: self.count(5) },
            3 => TemporalKernel::Binomial { frames: self.count(5) },
            4 => TemporalKernel::Perceptual { fps: self.number(1.0, 240.0) },
            5 => TemporalKernel::Taps(self.list(5, |draw| draw.number(0.0, 1.0))),
            _ => TemporalKernel::None,
        };
        let truncation = if self.chance(0.3) { self.number(0.0, 0.5) } else { 1e-3 };
        Kernel { truncation, ..Kernel::product(spatial, temporal) }
    }

    fn form(&mut self) -> FilterForm {
        if self.chance(0.3) { FilterForm::Weighted } else { FilterForm::LevelSets }
    }

    fn lengths(&mut self, most: usize) -> PrefixLengths {
        match self.below(3) {
            0 => PrefixLengths::Every,
            1 => PrefixLengths::PowersOfTwo,
            _ => PrefixLengths::Given(self.list(4, |draw| {
                let length = if draw.chance(draw.odd) { draw.count(9) } else { 1 + draw.below(most) };
                PrefixLength { length, weight: draw.number(0.01, 2.0) }
            })),
        }
    }

    fn classes(&mut self, extent: &Extent) -> Classes {
        // Lists of an extent that is absurd would be as absurd.
        let samples = extent.samples().clamp(1, 4096);
        let samples = if self.chance(self.odd) { self.below(9) } else { samples };
        match self.below(10) {
            0 => Classes::WholeTable,
            1 => Classes::PerFrame,
            2 => Classes::PerPixel,
            3 => {
                let labels: Vec<u32> = (0..samples).map(|_| self.below(4) as u32).collect();
                let subsets = self.list(5, |draw| {
                    let labels = draw.list(4, |draw| draw.below(5) as u32);
                    LabelSet { labels, weight: draw.number(0.1, 10.0) }
                });
                Classes::Labelled { labels: labels.into(), subsets }
            }
            4 => {
                let coordinates: Vec<f64> = (0..samples).map(|i| (0.618 * i as f64).fract()).collect();
                let mut coordinates = coordinates;
                if self.chance(3.0 * self.odd) && samples > 0 {
                    coordinates[0] = self.number(0.0, 1.0);
                }
                let ramps = self.list(3, |draw| draw.pick(&[Ramp::Rising, Ramp::Falling]));
                Classes::Ramps { coordinates: coordinates.into(), ramps }
            }
            5 => {
                let of = self.pick(&[PrefixOf::Table, PrefixOf::Pixel]);
                Classes::Prefixes { of, lengths: self.lengths(extent.spp.clamp(1, 64)) }
            }
            6 => Classes::custom(Windows {
                members: self.below(6),
                samples: self.list(8, |draw| (draw.count(samples.max(1)) as u32, draw.number(0.0, 1.0))),
                weight: self.number(0.1, 10.0),
            }),
            _ => Classes::Lattice { kernel: self.kernel(), form: self.form() },
        }
    }

    fn density(&mut self) -> Option<Density> {
        let [width, height] = [(); 2].map(|()| 1 + self.below(4));
        let values = (0..width * height).map(|_| self.number(0.0, 1.0) as f32).collect();
        Density::new(width, height, values).ok()
    }

    fn target(&mut self) -> Target {
        match self.below(12) {
            0 => self.density().map_or(Target::UniformCube, |density| Target::Density(density.into())),
            1 => {
                let dims = 1 + self.below(3);
                let points = (0..dims * (1 + self.below(9))).map(|_| self.random.random::<f32>()).collect();
                PointCloud::new(dims, points).map_or(Target::UniformCube, |cloud| Target::Cloud(cloud.into()))
            }
            2 => Target::custom(Odd {
                dims: 1 + self.below(3),
                kind: self.below(5),
                numbers: [self.number(-0.1, 0.2), self.number(0.2, 1.0)],
            }),
            _ => Target::UniformCube,
        }
    }

    fn term(&mut self, extent: &Extent, dims: usize) -> Term {
        let (classes, target) = (self.classes(extent), self.target());
        let seen = match target.dims() {
            Some(seen) if self.chance(0.95) => (0..seen).collect(),
            _ => self.dims_of(dims),
        };
        let role = if self.chance(0.3) { Role::Balance } else { Role::Descend };
        let weight = if self.chance(0.1) { self.number(1e-6, 1e6) } else { self.number(0.01, 2.0) };
        Term { classes, target, dims: seen, weight, role }
    }

    fn schedule(&mut self) -> Schedule {
        let [first, last] = [(); 2].map(|()| self.number(1e-3, 5.0));
        self.pick(&[
            Schedule::constant(first),
            Schedule::geometric(first, last),
            Schedule::cosine(first, last),
        ])
    }

    fn descent(&mut self) -> Descent {
        let rate = self.schedule();
        match self.below(3) {
            0 => Descent::Sgd { rate, momentum: self.number(0.0, 0.999) },
            1 => {
                let [beta1, beta2] = [(); 2].map(|()| self.number(0.0, 0.999));
                Descent::Adam { rate, beta1, beta2, epsilon: self.number(1e-8, 1.0) }
            }
            _ => Descent::Barycentric { rate },
        }
    }

    fn groups(&mut self, dims: usize) -> Vec<DimensionGroup> {
        self.list(3, |draw| DimensionGroup::new(draw.dims_of(dims)).with_weight(draw.number(0.1, 3.0)))
    }

    pub fn config(&mut self) -> Config {
        let (extent, dims) = (self.extent(), self.dims());
        let subsets = self.pick(&[
            LabelSubsets::EachAndAll,
            LabelSubsets::Every,
            LabelSubsets::Given(vec![vec![0], vec![1, u32::MAX]]),
        ]);
        let mut config = match self.below(10) {
            0 => {
                let counts = self.list(4, |draw| draw.len(40));
                Config::classes(&counts, dims, &subsets)
            }
            1 => {
                let lengths = self.lengths(16);
                Config::progressive(self.len(64), dims, lengths)
            }
            2 => match self.density() {
                Some(density) => Config::stippling(self.len(64), density),
                None => Config::new(extent, dims),
            },
            3 => {
                let points = Extent::points(self.len(64));
                let terms = self.list(3, |draw| draw.term(&points, dims));
                Config::point_set(points.width, dims, terms)
            }
            _ => Config::new(extent, dims),
        };
        for _ in 0..self.below(4) {
            let sized = config.extent;
            config = match self.below(12) {
                0 => config.with_kernel(self.kernel()),
                1 => config.with_kernels(&self.list(3, Self::kernel)),
                2 => config.with_companions(false),
                3 => config.with_groups(&self.groups(dims)),
                4 => config.with_form(self.form()),
                5 => config.with_terms(self.list(4, |draw| draw.term(&sized, dims))),
                6 => config.with_domain(Domain::Torus),
                7 => config.with_domains(self.list(4, |draw| draw.pick(&[Domain::Torus, Domain::Interval]))),
                8 => {
                    let batch_slices = self.chance(0.5).then(|| self.count(300));
                    let (directions, axis_share) = (self.count(16), self.number(0.0, 1.0));
                    config.with_slicing(Slicing { directions, axis_share, batch_slices })
                }
                9 => config.with_descent(self.descent()),
                10 => {
                    let [rate, polish] = [(); 2].map(|()| self.schedule());
                    let [truncation, softening] = [(); 2].map(|()| self.number(0.0, 0.9));
                    config.with_sweeps(Sweeps { rate, polish, truncation, softening })
                }
                _ => config.with_balance(self.schedule()),
            };
        }
        let seed = self.pick(&[0, 1, u64::MAX, 7]);
        config.with_seed(seed)
    }

    /// A demand on a table of this extent, or on another.
    pub fn demand(&mut self, extent: &Extent) -> Option<Demand> {
        let mut shape = [extent.frames, extent.height, extent.width].map(|len| len.clamp(1, 16));
        if self.chance(0.3) {
            shape = shape.map(|_| self.count(9));
        }
        let sites = shape.iter().fold(1_usize, |sites, &len| sites.saturating_mul(len)).min(4096);
        let share = self.random.random::<f64>();
        let flags = (0..sites).map(|_| self.chance(share)).collect();
        let groups = self.list(3, |draw| draw.dims_of(3));
        Demand::new(shape, flags, groups).ok()
    }

    /// When a run ends: soon, or when it is broken off.
    pub fn until(&mut self) -> Until {
        let many = |draw: &mut Self| match draw.chance(draw.odd) {
            true => draw.pick(&[u64::MAX, u64::MAX / 16, 1 << 53, 1_000_000_000, 1_000_000]),
            false => draw.below(4) as u64,
        };
        match self.below(8) {
            0 => Until::Usual,
            1 => Until::SlicesPerClass(many(self)),
            2 => Until::Epochs(many(self)),
            3 => Until::Work(Work {
                frame_sweeps: many(self),
                slices_per_class: many(self),
                sweeps: many(self),
            }),
            4 => Until::Seconds(self.number(1e-6, 0.02)),
            5 => Until::Converged {
                improvement: self.number(0.0, 1.0),
                window_steps: many(self),
                at_most: many(self),
            },
            _ => Until::Sweeps(many(self)),
        }
    }
}
