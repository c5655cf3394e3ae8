//! What is seen of a table at a glance, within a fraction of a second: what a notebook shows.

use fsot::kernel::TemporalKernel;
use fsot::metrics::{Integrands, Spectra};
use fsot::{Extent, Kernel, SampleTable};
use ndarray::{ArrayView5, Slice};

use super::edge::{Edge, ordinary_half_plane};
use super::panels;
use super::sheet::{Cell, row};
use crate::Failure;
use crate::draw::raster::Grey;

/// Pixels per side of a picture at most: pictures of noise compress badly, and a sheet shall take less than 100 kB.
const LARGEST_SIDE: usize = 96;

/// Samples of a frame that are looked at.
const MOST_SAMPLES: usize = 1 << 20;
/// Samples of a pixel that are looked at.
const MOST_SPP: usize = 4096;

/// Values of integrands that take some hundredths of a second.
const AFFORDABLE: usize = 2_000_000;
/// Integrands per family of a small table's spectrum.
const MOST_INTEGRANDS: usize = 32;

/// Pictures of the first frame of a table.
#[derive(Clone, Debug)]
pub struct Glance {
    /// What each shows, in a few words, and the picture.
    pub pictures: Vec<(String, Grey)>,
    /// All of them side by side.
    pub sheet: Grey,
}

impl Glance {
    /// Looks at the first frame of a table `[frame, y, x, sample, dim]`, and at its first two dimensions.
    ///
    /// Of large frames pictures show a corner; of those of more than a million samples nothing else is
    /// looked at, and no spectrum is drawn.
    ///
    /// # Errors
    /// What is no table.
    ///
    /// ```
    /// use fsot::{Extent, SampleTable};
    /// use fsot_cli::report::Glance;
    ///
    /// let table = SampleTable::white_noise(Extent::still(16, 16), 2, 0)?;
    /// assert_eq!(Glance::new(table.view())?.pictures.len(), 5);
    /// # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
    /// ```
    pub fn new(table: ArrayView5<'_, f32>) -> Result<Self, Failure> {
        let (_, height, width, spp, dims) = table.dim();
        let (spp, dims) = (spp.min(MOST_SPP), dims.min(2));
        let is_whole = height.saturating_mul(width).saturating_mul(spp) <= MOST_SAMPLES;
        let side = LARGEST_SIDE.min((MOST_SAMPLES / spp.max(1)).isqrt());
        let [rows, columns] = [height, width].map(|len| if is_whole { len } else { len.min(side) });
        let shown = [1, rows, columns, spp, dims];
        let part = table.slice_each_axis(|along| Slice::from(..shown[along.axis.index()]));
        let extent = Extent::still(rows, columns).with_spp(spp);
        let frame = &SampleTable::new(extent, dims, part.iter().copied().collect())?;
        let dims: Vec<usize> = (0..dims).collect();

        let texture = panels::texture(frame, &dims, side);
        let [shown_columns, shown_rows] = [texture.width(), texture.height()];
        let of = match [shown_columns, shown_rows] == [width, height] {
            true => String::new(),
            false => format!(", {shown_columns} × {shown_rows} pixels of {width} × {height}"),
        };
        let dots = panels::frame(frame, &dims);
        // Under the filter of the eye, without one over frames.
        let eye = Kernel::gaussian(2.1).with_temporal(TemporalKernel::None);
        let edge = Edge::new(frame, &dims, &ordinary_half_plane(dims.len(), 0)?, &eye, side)?;
        let mut cells = vec![
            (format!("first number of each pixel{of}"), Cell::Grey(texture)),
            (format!("samples: {}", dots.what), Cell::Dots(dots)),
            ("error of an edge in each pixel".to_owned(), Cell::Grey(edge.before)),
            ("the same, smoothed; with more contrast".to_owned(), Cell::Grey(edge.after)),
        ];
        if is_whole {
            let per_family = (AFFORDABLE / 4 / extent.samples()).clamp(1, MOST_INTEGRANDS);
            let integrands = Integrands::random(dims.len(), per_family, 0)?;
            let spectra = Spectra::measure(frame, &dims, &integrands)?;
            let spectrum = panels::spectrum(&spectra.xy, LARGEST_SIDE);
            cells.push(("spectrum of the error: black none, grey white noise".into(), Cell::Grey(spectrum)));
        }
        let sheet = row(cells.iter().map(|(_, cell)| cell));
        let pictures = cells.into_iter().map(|(what, cell)| (what, cell.picture())).collect();
        Ok(Self { pictures, sheet })
    }
}
