//! The page around the sections, and the pieces that they are made of.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::panels::Dots;
use super::{Report, chart, sections};
use crate::Failure;
use crate::draw::raster::Grey;

/// The whole file.
pub fn html(report: &Report) -> Result<String, Failure> {
    let title = match report.columns.as_slice() {
        [one] => format!("{}: a table of random numbers", one.label),
        many => format!("{} tables of random numbers", many.len()),
    };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                // Nothing is fetched and nothing runs, whatever a table is called.
                meta http-equiv="Content-Security-Policy"
                    content="default-src 'none'; img-src data:; style-src 'unsafe-inline'";
                meta name="generator" content=(concat!("fsot ", env!("CARGO_PKG_VERSION")));
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                header { h1 { (title) } (sections::introduction(report)) }
                main {
                    (sections::samples(report)?)
                    (sections::edge(report)?)
                    (sections::spectra(report)?)
                    (sections::coordinates(report)?)
                    (sections::figures(report))
                    (sections::meanings(report))
                    (sections::origins(report))
                }
                footer {
                    p { "Made by fsot " (env!("CARGO_PKG_VERSION")) " with" }
                    pre { code { (report.command) } }
                }
            }
        }
    };
    Ok(page.into_string())
}

/// A section with a heading.
pub fn section(id: &str, heading: &str, inside: &Markup) -> Markup {
    let named = format!("{id}-heading");
    html! { section id=(id) aria-labelledby=(named) { h2 id=(named) { (heading) } (inside) } }
}

/// A picture with what it is of, and the pixels of the page that it takes across.
pub struct Figure {
    width: usize,
    inside: Markup,
    is_plot: bool,
}

/// Figures of one kind, side by side, and how to read them.
pub fn kind(heading: &str, figures: &[Figure], words: &Markup) -> Markup {
    let width: usize = figures.iter().map(|figure| figure.width).sum();
    html! {
        div.kind {
            h3 { (heading) }
            div.figures style=(format!("--across:calc({width}px + {}rem)", figures.len() - 1)) {
                @for figure in figures {
                    figure.plot[figure.is_plot] style=(format!("--width:{}px", figure.width)) {
                        (figure.inside)
                    }
                }
            }
            div.words { (words) }
        }
    }
}

/// Pixels of the page that a picture may take: fewer where many stand side by side.
pub fn room(pictures: usize) -> usize {
    if pictures <= 3 { MOST } else { 192 }
}

/// A grey picture, its pixels enlarged by a whole number.
pub fn picture(label: &str, picture: &Grey, alt: &str, room: usize) -> Result<Figure, Failure> {
    let [width, height] = [picture.width(), picture.height()];
    let side = width.max(height);
    let mut zoom = (room / side).max(1);
    if side * zoom < LEAST && side * (zoom + 1) <= MOST {
        zoom += 1;
    }
    let [width, height] = [width, height].map(|side| side * zoom);
    let bytes = STANDARD.encode(picture.to_png()?);
    let inside = html! {
        img src={ "data:image/png;base64," (bytes) } width=(width) height=(height) alt=(alt);
        figcaption { (breakable(label)) }
    };
    // A caption needs a place, however narrow the picture is.
    Ok(Figure { width: width.max(LEAST), inside, is_plot: false })
}

/// Points in a square.
pub fn points(label: &str, dots: &Dots, alt: &str, room: usize) -> Figure {
    let inside = html! {
        (chart::dots(dots, alt))
        figcaption { (breakable(label)) br; small { (dots.what) } }
    };
    Figure { width: room, inside, is_plot: false }
}

/// A plot of this width.
pub fn plot(label: &str, plot: &Markup, width: usize) -> Figure {
    let inside = html! { (plot) @if !label.is_empty() { figcaption { (breakable(label)) } } };
    Figure { width, inside, is_plot: true }
}

/// A name that may be broken behind its marks.
pub fn breakable(name: &str) -> Markup {
    html! { @for part in name.split_inclusive(['_', '-', '/', '.']) { (part) wbr; } }
}

/// What a narrow screen scrolls.
pub fn table(about: &str, inside: &Markup) -> Markup {
    html! { div.table role="region" tabindex="0" aria-label=(about) { table { (inside) } } }
}

/// Pixels of the page that a picture takes across, unless its own are more.
const MOST: usize = 256;
/// Pictures below this are enlarged further, if they don't become too large.
const LEAST: usize = 160;
