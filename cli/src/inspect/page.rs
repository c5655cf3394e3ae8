//! The page: white noise and the table, row by row.

use fsot::metrics::{Integrands, Spectra};
use fsot::{Extent, SampleTable};

use super::Inspection;
use super::figures::GroupFigures;
use super::integrand::{ErrorPictures, ordinary_half_plane};
use super::panels::{Content, Curves, HEIGHT, Panel, SIDE, spectrum};
use super::report::{filter, shape};
use crate::Failure;
use crate::draw::canvas::{Canvas, LINE, MARGIN, grey};
use crate::draw::raster::Grey;

/// Most samples that a scatter plot shows.
const MOST_DOTS: usize = 16_384;

/// A heading over panels that stand side by side.
struct Row {
    heading: String,
    panels: Vec<Panel>,
}

/// Draws the page of a table whose first dimension group was measured.
pub fn draw(inspection: &Inspection, shown: &GroupFigures) -> Result<Grey, Failure> {
    let Inspection { table, integrands, seed, .. } = inspection;
    let extent = table.extent();
    // Another seed than a table's own, which may have started from white noise of this very seed.
    let white = SampleTable::white_noise(extent, table.dims(), seed ^ 0x0077_6869_7465)?;
    let dims = shown.dims.as_slice();
    let of_white = Spectra::measure(&white, dims, &Integrands::random(dims.len(), *integrands, *seed)?)?;

    let error = shown.errors.spatio_temporal.mean.mean;
    let mut rows = vec![
        Row {
            heading: "WHITE NOISE of the same shape".into(),
            panels: errors(inspection, &white, dims, &of_white)?,
        },
        Row {
            heading: format!("THIS TABLE: squared error after the blur is {error:.3} of white noise's"),
            panels: errors(inspection, table, dims, &shown.spectra)?,
        },
    ];
    if extent.frames > 1 {
        rows.push(time(&of_white, &shown.spectra));
    }
    rows.push(samples(table, &white, dims));
    rows.push(statistics(inspection, shown, &of_white));

    let width = 3 * SIDE + 4 * MARGIN;
    let which = match dims {
        [a, b] if table.dims() > 2 => format!("Dimensions {a} and {b} are shown."),
        _ => String::new(),
    };
    let introduction = [
        format!("{}: {}", inspection.name, shape(table)),
        which,
        "Each pixel asks with its own samples which share of the samples' domain".into(),
        "lies on one side of an edge. Left: its error, grey is none. Middle: what".into(),
        "a blur leaves of it, as an eye or a denoiser blurs. Right: at which".into(),
        "frequencies the error is, low ones in the middle. A dark middle is blue".into(),
        "noise: the blur takes it away. White noise is an even grey.".into(),
        format!("The blur: {}.", filter(inspection)),
    ];
    let top = 2 * MARGIN + introduction.len() * LINE;
    let row_height = LINE + 6 + HEIGHT + MARGIN;
    let mut canvas = Canvas::new(width, top + rows.len() * row_height);
    for (line, text) in introduction.iter().enumerate() {
        canvas.write([MARGIN, MARGIN + line * LINE], text, width - 2 * MARGIN);
    }
    for (number, Row { heading, panels }) in rows.iter().enumerate() {
        let y = top + number * row_height;
        canvas.block([MARGIN, y - 8], [width - 2 * MARGIN, 2], 90);
        canvas.write([MARGIN, y], heading, width - 2 * MARGIN);
        let mut x = MARGIN;
        for panel in panels {
            panel.draw(&mut canvas, [x, y + LINE + 6]);
            x += panel.width() + MARGIN;
        }
    }
    Ok(canvas.into_picture())
}

/// Error of a half-plane before and after the filter, and the spectrum over all integrands.
fn errors(
    inspection: &Inspection,
    table: &SampleTable,
    dims: &[usize],
    spectra: &Spectra,
) -> Result<Vec<Panel>, Failure> {
    let integrand = ordinary_half_plane(dims.len(), inspection.seed)?;
    let pictures = ErrorPictures::new(table, dims, &integrand, &inspection.kernel)?;
    let panel = |caption: &str, errors: &[f64], end: f64| {
        let levels = errors.iter().map(|error| grey(0.5 + 0.5 * error / end)).collect();
        let ends = format!("black -{end:.2}, white +{end:.2}");
        Panel::new([caption, &ends], Content::Picture { columns: pictures.columns, levels, stretch: false })
    };
    let [before, after] = if pictures.cut {
        ["error of an edge (cut)", "the same, blurred (cut)"]
    } else {
        ["error of an edge", "the same, blurred"]
    };
    Ok(vec![
        panel(before, &pictures.raw, 2.0 * pictures.white[0]),
        panel(after, &pictures.filtered, 3.0 * pictures.white[1]),
        Panel::new(["error spectrum, x and y", "black 0, grey 1, white 2"], spectrum(&spectra.xy)),
    ])
}

fn time(white: &Spectra, table: &Spectra) -> Row {
    let text = [
        "Left, middle: spectrum",
        "of the error along a row",
        "(across) and over the",
        "frames (down).",
        "",
        "Zero frequency is in the",
        "middle of either axis.",
        "",
        "Dark middle: the error",
        "is gone after a blur in",
        "space and time.",
    ];
    let text = Content::Text(text.map(String::from).to_vec());
    let scale = "black 0, grey 1, white 2";
    Row {
        heading: "TIME: error spectrum in x and t".into(),
        panels: vec![
            Panel::new(["white noise", scale], spectrum(&white.xt)),
            Panel::new(["this table", scale], spectrum(&table.xt)),
            Panel::new(["", ""], text),
        ],
    }
}

/// Samples of a block of pixels of white noise and of the table, and of the whole table.
fn samples(table: &SampleTable, white: &SampleTable, dims: &[usize]) -> Row {
    let Extent { height, width, spp, .. } = table.extent();
    let block = [8, 4, 2].into_iter().find(|side| side * side * spp <= 256).unwrap_or(1);
    let [rows, columns] = [height, width].map(|side| side.min(block));
    let count = rows * columns * spp;
    let sites: Vec<usize> = (0..rows).flat_map(|y| (0..columns).map(move |x| y * width + x)).collect();
    let dots = |table: &SampleTable, sites: &[usize]| -> Vec<[f64; 2]> {
        let samples = sites.iter().flat_map(|&site| {
            let pixel = &table.values()[site * spp * table.dims()..][..spp * table.dims()];
            pixel.chunks_exact(table.dims())
        });
        let total = (sites.len() * spp) as f64;
        // In one dimension the order of the samples spreads them upwards.
        let upwards =
            |i: usize, sample: &[f32]| dims.get(1).map_or((i as f64 + 0.5) / total, |&d| sample[d].into());
        samples.enumerate().map(|(i, sample)| [sample[dims[0]].into(), upwards(i, sample)]).collect()
    };
    let size = if count <= 256 { 6 } else { 2 };
    let block_note = format!("{columns} x {rows} px, samples: {count}");
    let all = table.extent().samples();
    let kept: Vec<usize> = (0..table.extent().sites().min((MOST_DOTS / spp).max(1))).collect();
    let all_points = dots(table, &kept);
    let all_note = if all_points.len() == all {
        format!("all samples: {all}")
    } else {
        format!("first {} of {all}", all_points.len())
    };
    let all_size = if all_points.len() <= 256 { 6 } else { 2 };
    let axes = match dims {
        [a, b] => format!("dimension {a} to the right, dimension {b} up"),
        _ => "dimension 0 to the right, number of the sample up".into(),
    };
    Row {
        heading: format!("SAMPLES in [0, 1): {axes}"),
        panels: vec![
            Panel::new(
                ["white noise, neighbours", &block_note],
                Content::Dots { points: dots(white, &sites), size },
            ),
            Panel::new(
                ["this table, neighbours", &block_note],
                Content::Dots { points: dots(table, &sites), size },
            ),
            Panel::new(["this table", &all_note], Content::Dots { points: all_points, size: all_size }),
        ],
    }
}

/// Histogram of the table and the radial averages of the spectra.
fn statistics(inspection: &Inspection, shown: &GroupFigures, white: &Spectra) -> Row {
    let evenness = &shown.evenness;
    let columns = evenness.per_side;
    // The second dimension goes up.
    let cells: Vec<u8> =
        evenness.counts.chunks(columns).rev().flatten().map(|&count| grey(0.5 * count)).collect();
    let levels = if evenness.dims == 2 { cells } else { cells.repeat(columns) };
    let spread = match columns {
        1 => "too few samples".into(),
        _ => format!("uneven {:.2}, random 1", evenness.spread),
    };
    let table = shown.spectra.radial();
    let curves = Curves {
        white: white.radial(),
        // exp(-2 pi^2 s^2 f^2) = 1/2 for the filter exp(-r^2/s^2).
        half_power: (0.5 * std::f64::consts::LN_2).sqrt() / (std::f64::consts::PI * inspection.sigma()),
        table,
    };
    let power = if curves.table.is_empty() {
        let text = ["A single pixel has no", "frequencies."];
        Panel::new(["", ""], Content::Text(text.map(String::from).to_vec()))
    } else {
        let captions = [
            "bold: this table; thin: white noise (expected 1)",
            "power over cycles/pixel; | blur halves the power",
        ];
        Panel::new(captions, Content::Curves(curves))
    };
    Row {
        heading: "HISTOGRAM: black 0, grey mean, white twice. SPECTRUM: power by frequency".into(),
        panels: vec![
            Panel::new(
                [&format!("table, {} cells", evenness.cells()), &spread],
                Content::Picture { columns, levels, stretch: false },
            ),
            power,
        ],
    }
}
