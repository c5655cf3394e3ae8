//! What the page says, section by section.

use maud::{Markup, html};

use super::figures;
use super::page::{Figure, breakable, kind, picture, plot, points, room, section, table};
use super::panels::{self, Panels};
use super::{Column, Report, chart};
use crate::Failure;
use crate::draw::raster::Grey;
use crate::inspect::{filter, shape};

/// What the tables are, and how good.
pub fn introduction(report: &Report) -> Markup {
    html! {
        p.lead {
            "A renderer takes the random numbers of each pixel from such a table. With independent random \
             numbers, "
            em { "white noise" }
            ", each pixel errs on its own, and the picture looks grainy. In a good table the errors of \
             neighbouring pixels and frames cancel, so that whatever smooths the picture afterwards (the \
             eye, a denoiser, temporal antialiasing) takes most of the error away. This page shows how \
             much is left."
        }
        (table("the tables and their most important figures", &html! {
            thead { tr {
                th scope="col" { "table" }
                th.number scope="col" { a href="#filtered-error" { "filtered error" } }
                th.number scope="col" { a href="#bias" { "bias" } }
                th.number scope="col" { a href="#bound" { "bound" } }
                th scope="col" { "shape" } th scope="col" { a href="#filter" { "filter" } }
            } }
            tbody { @for column in &report.columns { tr {
                // What a narrow screen shows first.
                th scope="row" { (breakable(&column.label)) }
                td.number { (figures::ratio(column.error())) }
                td.number { (figures::ratio(column.shown().bias.table.mean.mean)) }
                td.number { (figures::ratio(column.bound.ratio_to_white_noise)) }
                td.long { (typeset(&shape(&column.inspection.table))) }
                td.long { (typeset(&filter(&column.inspection))) }
            } } }
        }))
        p {
            "Figures are ratios to white noise of the same shape: 1 is as good as independent random \
             numbers, 0 is no error at all."
            @if let Some(words) = shown(report) { " " (words) }
        }
    }
}

/// What was written for terminals.
fn typeset(words: &str) -> String {
    words.replace("^2", "²").replace("-r", "−r").replace(" x ", " × ")
}

/// Which dimensions the pictures show, where there are others.
fn shown(report: &Report) -> Option<&'static str> {
    let more = report.columns.iter().any(|column| column.inspection.table.dims() > 2);
    more.then_some("Pictures show the first two dimensions of each sample; figures are of all.")
}

/// White noise's label.
const WHITE: &str = "white noise";

/// White noise and the tables, with the figure that says how good they are.
fn all(report: &Report) -> impl Iterator<Item = (&str, &Panels, Option<&Column>)> {
    let tables = report.columns.iter().map(|column| (column.label.as_str(), &column.panels, Some(column)));
    std::iter::once((WHITE, &report.white, None)).chain(tables)
}

/// Says so where pictures leave out a part of the frame.
fn is_cut(report: &Report, pick: fn(&Panels) -> &Grey) -> Markup {
    let is_cut = |column: &Column| panels::is_cut(pick(&column.panels), &column.inspection.table);
    html! { @if report.columns.iter().any(is_cut) { p { "Only a corner of the larger frames is shown." } } }
}

/// One picture of each.
fn pictures(
    report: &Report,
    pick: impl Fn(&Panels) -> Option<&Grey>,
    alt: impl Fn(&str, Option<&Column>) -> String,
) -> Result<Vec<Figure>, Failure> {
    let room = room(1 + report.columns.len());
    let picked = all(report).filter_map(|(label, panels, column)| Some((label, pick(panels)?, column)));
    picked.map(|(label, grey, column)| picture(label, grey, &alt(label, column), room)).collect()
}

/// The numbers themselves.
pub fn samples(report: &Report) -> Result<Markup, Failure> {
    let room = room(1 + report.columns.len());
    let texture = pictures(
        report,
        |panels| Some(&panels.texture),
        |label, _| format!("First number of each pixel of {label} as a grey level"),
    )?;
    let of = |pick: fn(&Panels) -> &super::panels::Dots, what: &str| -> Vec<Figure> {
        let all = all(report);
        all.map(|(label, panels, _)| {
            points(label, pick(panels), &format!("{what} of {label} as points"), room)
        })
        .collect()
    };
    let block = of(|panels| &panels.block, "Samples of neighbouring pixels");
    let frame = of(|panels| &panels.frame, "Samples of a frame");
    let cut = is_cut(report, |panels| &panels.texture);
    let one = report.columns.iter().any(|column| column.inspection.table.dims() == 1);
    let axes = html! {
        "The first dimension goes to the right, the second up"
        @if one { "; where there is only one, the pixels follow each other upwards" }
        "."
    };
    Ok(section(
        "samples",
        "The samples",
        &html! {
            (kind("First number of each pixel", &texture, &html! {
                p { "The first frame as a texture: black is 0, white is 1. Blue noise has no clumps of \
                     dark or light pixels; white noise has." }
                (cut)
            }))
            (kind("Samples of neighbouring pixels", &block, &html! {
                p { "Each point is a sample, a place in the square of all random numbers. What is smoothed \
                     together should fill the square evenly, without holes and clusters. " (axes) }
            }))
            (kind("Samples of a frame", &frame, &html! {
                p { "The whole should fill the square up to its sides." }
            }))
        },
    ))
}

/// The error of one integrand.
pub fn edge(report: &Report) -> Result<Markup, Failure> {
    let before = pictures(
        report,
        |panels| Some(&panels.edge.before),
        |label, _| format!("Error of each pixel of {label} for an edge, as a grey level"),
    )?;
    let after = pictures(
        report,
        |panels| Some(&panels.edge.after),
        |label, column| match column {
            Some(column) => {
                let error = figures::ratio(column.error());
                format!(
                    "The same error of {label} after the filter; over all integrands {error} of white noise's"
                )
            }
            None => format!("The same error of {label} after the filter"),
        },
    )?;
    Ok(section(
        "edge",
        "The error of an edge",
        &html! {
            (kind("Before the filter", &before, &html! {
                p { "Each pixel of the last frame asks with its own samples which share of the square lies \
                     on one side of an edge, as a renderer asks which part of a light is hidden. Grey is \
                     no error, dark is too little, light is too much; black and white are two standard \
                     deviations of white noise." }
                (is_cut(report, |panels| &panels.edge.before))
            }))
            (kind("After the filter", &after, &html! {
                p { "What the filter leaves of it: the flatter the grey, the better. Black and white are \
                     three standard deviations of what it leaves of white noise." }
            }))
        },
    ))
}

/// Where in frequency the error is.
pub fn spectra(report: &Report) -> Result<Markup, Failure> {
    let alt = |axes: &'static str| {
        move |label: &str, column: Option<&Column>| {
            let low = column.and_then(|column| column.shown().low);
            let low = low.map(|low| format!("; power at low frequencies {}", figures::ratio(low)));
            format!("Power of the error of {label} over frequency in {axes}{}", low.unwrap_or_default())
        }
    };
    let xy = pictures(report, |panels| Some(&panels.xy), alt("x and y"))?;
    let xt = pictures(report, |panels| panels.xt.as_ref(), alt("x and time"))?;
    let lines = report.radial();
    let has_rings = lines.iter().any(|(_, bins)| !bins.is_empty());
    // exp(-2 pi^2 s^2 f^2) = 1/2 for the filter exp(-r^2/s^2).
    let sigma = report.columns[0].inspection.sigma();
    let half_power = (0.5 * std::f64::consts::LN_2).sqrt() / (std::f64::consts::PI * sigma);
    let radial = [plot("", &chart::radial(&lines, half_power), 560)];
    Ok(section(
        "spectra",
        "Frequencies of the error",
        &html! {
            (kind("In the picture: x and y", &xy, &html! {
                p { "How much of the error changes slowly across the picture (in the middle, where eyes \
                     and filters see it) and how much from pixel to pixel (at the border, where they \
                     don't). Black is none, grey as much as white noise has, white twice as much or more: \
                     a dark middle is blue noise." }
                (direction(report))
            }))
            @if !xt.is_empty() {
                (kind("Over time: x and t", &xt, &html! {
                    p { "Along a row of pixels (to the right) and over the frames (down); zero is in the \
                         middle of either. The dark middle is error that a filter in space and time takes \
                         away. Slanted stripes are of a table that began as one frame, displaced from frame \
                         to frame." }
                }))
            }
            @if has_rings {
                (kind("In all directions together", &radial, &html! {
                    p.legend { @for (at, (label, _)) in lines.iter().enumerate() {
                        span { svg viewBox="0 0 28 10" aria-hidden="true" {
                            path class={ "line l" (chart::number(at)) } d="M1 5H27" {}
                        } " " (label) }
                    } }
                    p { "The same power, averaged over the directions of the picture; 1 is white noise’s, \
                         and each line of the grid is a tenth of the one above." }
                }))
            }
        },
    ))
}

/// Whether the error prefers a direction, where tiles are large enough to have some.
fn direction(report: &Report) -> Markup {
    let known =
        report.columns.iter().filter_map(|column| Some((column, figures::anisotropy(column.shown())?)));
    let known: Vec<(&Column, String)> = known.collect();
    html! { @if !known.is_empty() { p {
        "A round dark disc prefers no direction. Power along y over that along x, in rings from 0.15, 0.25 \
         and 0.35 to 0.5 cycles per pixel: "
        @for (at, (column, rings)) in known.iter().enumerate() {
            @if at > 0 { "; " }
            @if report.columns.len() > 1 { (column.label) " " }
            (rings)
        }
        ". White noise has 1."
    } } }
}

/// Single coordinates and pairs, up to the faces.
pub fn coordinates(report: &Report) -> Result<Markup, Failure> {
    let figure = |column: &Column, dim: usize| {
        let profile = column.profiles.get(dim)?;
        let face = profile.marginal.faces[2];
        let alt = format!(
            "Density of dimension {dim} of {}; within {} of the faces {:.2}",
            column.label, face.within, face.density
        );
        let label = format!("{}, dimension {dim}", column.label);
        Some(plot(&label, &chart::marginal(profile, &alt), 300))
    };
    // Tables stand side by side, below them their second dimensions.
    let of_dim = |dim: usize| report.columns.iter().filter_map(move |column| figure(column, dim));
    let (headings, plots): (_, Vec<Vec<Figure>>) = match report.columns.as_slice() {
        [one] => (&["Each dimension"][..], vec![(0..2).filter_map(|dim| figure(one, dim)).collect()]),
        _ => (&["First dimension", "Second dimension"], (0..2).map(|dim| of_dim(dim).collect()).collect()),
    };
    let density = pictures(
        report,
        |panels| panels.density.as_ref(),
        |label, _| format!("Samples of {label} per cell of the square, as grey levels"),
    )?;
    Ok(section(
        "coordinates",
        "Evenness, up to the faces",
        &html! {
            p { "A renderer that gets too few numbers near 0 or 1 is wrong everywhere, and no filter \
                 helps. Values of each dimension are counted in bins that are fine next to the faces of \
                 the cube: 1 is even, 2 and more are at the top. Two thirds of the bins of independent \
                 random numbers end within the band." }
            @for (at, plots) in plots.iter().enumerate().filter(|(_, plots)| !plots.is_empty()) {
            (kind(headings[at], plots, &html! {}))
        }
            (figures::faces(report))
            @if !density.is_empty() {
                (kind("Cells of the square", &density, &html! {
                    p { "All samples, counted in equal cells: black is none, grey the mean, white twice \
                         the mean or more. The first dimension goes to the right, the second up." }
                }))
            }
        },
    ))
}

/// The figures.
pub fn figures(report: &Report) -> Markup {
    section(
        "figures",
        "Figures",
        &html! {
            p { "Ratios to white noise of the same shape, whose own figure is 1 by definition; ± is the \
                 standard error that the choice of integrands or slices leaves. What each line means is \
                 said "
                a href="#meanings" { "below" } "." }
            (figures::all(report))
        },
    )
}

/// The conventions, a sentence or two each.
pub fn meanings(report: &Report) -> Markup {
    section(
        "meanings",
        "What the figures mean",
        &html! { dl { @for (id, term, meaning) in figures::meanings(report) {
            dt id=(id) { (term) } dd { (meaning) }
        } } },
    )
}

/// How the tables were made.
pub fn origins(report: &Report) -> Markup {
    section(
        "origins",
        "How the tables were made",
        &html! { @for column in &report.columns {
            h3 { (column.label) }
            p { (column.origin.words) }
            @if let Some(command) = &column.origin.command {
                p { "The same version of fsot on the same kind of machine makes the same bits again by" }
                pre { code { (command) } }
            }
            @if let Some(configuration) = &column.origin.configuration {
                details { summary { "configuration" } pre { code { (configuration) } } }
            }
        } },
    )
}
