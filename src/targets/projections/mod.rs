//! Laws of densities, along many directions at once.
//!
//! A pixel projects on a trapezoid, whose density has kinks where its corners project, with slopes that
//! change by `±1 / (|px| |py|)` for pixels that project on lengths `px` and `py`. All kinks of a picture lie
//! at corners of the grid and sum up to the mixed second difference of the values there, so that one pass
//! over the corners gives slope, density, distribution function and its integral at the knots of every law,
//! exactly. Between knots the density is linear, with the exact mass and mean.
//!
//! * Kinks are linear in the picture: those of some pictures give the laws of all of their sums.
//! * Knots are where they are needed. Corners with a kink that moves a part of a point are knots themselves,
//!   so that a bright pixel keeps its shape. The others lie densely where there are many points.
//! * Where points are too few to tell pixels from each other, blocks of pixels are averaged, which have no
//!   kinks inside.

mod line;
mod planes;
mod survey;

use rayon::prelude::*;

use self::line::{Change, Grid, Line};
use self::planes::{IN_FLIGHT, Plane, Strip};
use self::survey::Survey;
use super::density::Density;
use super::watch::{Stopped, Watch};
use crate::laws::Pieces;

/// Densities whose sum's laws are asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    /// What is added, at least one, all of one size.
    pub densities: &'a [Density],
    /// Points that are to have these laws; `None` for any number.
    pub points: Option<usize>,
}

/// A number of points where none is known.
const ANY: usize = 1 << 16;
/// Changes that are kept at once: 24 MiB of them.
const MOST_CHANGES: usize = (24 << 20) / size_of::<Change>();
/// Share of the time that goes to the survey, about.
const SURVEYED: f64 = 0.1;

/// The laws of sums of densities of one size, along directions in each. The same bits at any thread count.
pub(crate) fn laws(
    asked: &[Asked],
    directions: &[Vec<f64>],
    watch: &mut Watch,
) -> Result<Vec<Vec<Pieces>>, Stopped> {
    let mut densities: Vec<&Density> = Vec::new();
    let mut sums: Vec<Vec<usize>> = Vec::new();
    for asked in asked {
        let mut place = |density| {
            let known = densities.iter().position(|known| known.is_same(density));
            known.unwrap_or_else(|| {
                densities.push(density);
                densities.len() - 1
            })
        };
        sums.push(asked.densities.iter().map(&mut place).collect());
    }
    let Some(size) = densities.first().map(|density| density.size()) else { return Ok(Vec::new()) };
    let masses: Vec<f64> = densities.par_iter().map(|density| density.mass()).collect();
    let mass_of = |sum: &[usize]| sum.iter().map(|&of| masses[of]).sum::<f64>();
    let most = asked.iter().map(|asked| asked.points.unwrap_or(ANY)).max().unwrap_or(ANY);
    let is_open = asked.iter().any(|asked| asked.points.is_none());
    let planes = densities.iter().enumerate().map(|(index, density)| {
        let holding = asked.iter().zip(&sums).filter(|(_, sum)| sum.contains(&index));
        let points = holding.map(|(asked, sum)| asked.points.unwrap_or(ANY) as f64 / mass_of(sum));
        let most = if is_open || !density.is_averaged() { usize::MAX } else { most };
        Plane::new(density.values(), size, points.fold(0.0, f64::max), most)
    });
    let planes: Vec<Plane> = planes.collect();
    let survey = Survey::of(size, &planes, &mut watch.part(0.0, SURVEYED))?;

    let lines: Vec<Option<Line>> = directions.iter().map(|direction| Line::new(direction, size)).collect();
    let together = (MOST_CHANGES / (planes.len() * survey.most_pieces())).clamp(1, lines.len().max(1));
    let mut laws = vec![Vec::with_capacity(directions.len()); sums.len()];
    for (group, lines) in lines.chunks(together).enumerate() {
        let share = |groups: usize| (groups * together) as f64 / directions.len() as f64;
        let watch = &mut watch.part(SURVEYED, 1.0);
        let watch = &mut watch.part(share(group), share(group + 1).min(1.0));
        let mut views: Vec<View> = lines.par_iter().map(|line| View::new(*line, &survey)).collect();
        if views.iter().any(View::takes_kinks) {
            add_kinks(&planes, &mut views, watch)?;
        }
        for (laws, sum) in laws.iter_mut().zip(&sums) {
            let mass = mass_of(sum);
            laws.par_extend(views.par_iter().map(|view| view.law(mass, sum)));
        }
    }
    Ok(laws)
}

/// Adds the kinks of all corners to the laws along slanted lines.
fn add_kinks(planes: &[Plane], views: &mut [View], watch: &mut Watch) -> Result<(), Stopped> {
    let (rows, mut strips) = (planes[0].strips().collect::<Vec<_>>(), Vec::new());
    for (index, together) in rows.chunks(IN_FLIGHT).enumerate() {
        for (number, plane) in planes.iter().enumerate() {
            plane.fill_all(together, &mut strips);
            views.par_iter_mut().for_each(|view| view.add(number, &strips));
        }
        let done = index * IN_FLIGHT + together.len();
        watch.tell(done as f64 / rows.len() as f64)?;
    }
    Ok(())
}

/// What is gathered along a line.
#[derive(Clone, Debug)]
struct View {
    /// None along no direction.
    line: Option<Line>,
    grid: Grid,
    /// By picture and piece.
    changes: Vec<Vec<Change>>,
}

impl View {
    /// Nothing yet along a slanted line, and all that there is along an axis.
    fn new(line: Option<Line>, survey: &Survey) -> Self {
        let grid = line.map_or_else(Grid::default, |line| survey.grid(&line));
        let changes = survey.sums.iter().map(|sums| {
            let mut changes = vec![[0.0; 4]; grid.pieces()];
            if let Some((line, axis)) = line.and_then(|line| Some((line, line.axis?))) {
                line.add_sums(axis, &sums[axis], &grid, &mut changes);
            }
            changes
        });
        let changes = changes.collect();
        Self { line, grid, changes }
    }

    /// Whether the kinks of corners are still to be added.
    fn takes_kinks(&self) -> bool {
        self.line.is_some_and(|line| line.axis.is_none())
    }

    /// Adds the kinks in some strips of a picture.
    fn add(&mut self, number: usize, strips: &[Strip]) {
        if let Some(line) = self.line.filter(|line| line.axis.is_none()) {
            let changes = &mut self.changes[number];
            strips.iter().for_each(|strip| line.add(&strip.kinks, &self.grid, changes));
        }
    }

    /// The law of some pictures together, of this mass.
    fn law(&self, mass: f64, of: &[usize]) -> Pieces {
        let Some(line) = self.line else { return Pieces::of_samples(vec![0.0]) };
        let changes = (0..self.grid.pieces()).map(|piece| {
            let add = |sum: Change, &plane: &usize| {
                let change = &self.changes[plane][piece];
                std::array::from_fn(|power| sum[power] + change[power])
            };
            of.iter().fold([0.0; 4], add)
        });
        line.law(mass, &self.grid, changes)
    }
}
