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
    html! { section id=(id) aria-labelledby={ (id) "-heading" } { h2 id={ (id) "-heading" } { (heading) } (inside) } }
}

/// Pictures of one kind, side by side, and how to read them.
pub fn kind(heading: &str, pictures: &[Markup], words: &Markup) -> Markup {
    html! {
        div.kind {
            h3 { (heading) }
            div.pictures { @for picture in pictures { (picture) } }
            div.words { (words) }
        }
    }
}

/// A grey picture, its pixels enlarged by a whole number.
pub fn picture(label: &str, picture: &Grey, alt: &str) -> Result<Markup, Failure> {
    let [width, height] = [picture.width(), picture.height()];
    let zoom = (WIDTH / width.max(height)).max(1);
    let bytes = STANDARD.encode(picture.to_png()?);
    Ok(html! {
        figure style=(format!("--width:{}px", width * zoom)) {
            img src={ "data:image/png;base64," (bytes) } width=(width * zoom) height=(height * zoom) alt=(alt);
            figcaption { (label) }
        }
    })
}

/// Points in a square.
pub fn points(label: &str, dots: &Dots, alt: &str) -> Markup {
    html! {
        figure style=(format!("--width:{WIDTH}px")) {
            (chart::dots(dots, alt))
            figcaption { (label) br; small { (dots.what) } }
        }
    }
}

/// A plot of this width.
pub fn plot(label: &str, plot: &Markup, width: usize) -> Markup {
    html! {
        figure.plot style=(format!("--width:{width}px")) { (plot) @if !label.is_empty() { figcaption { (label) } } }
    }
}

/// What a narrow screen scrolls.
pub fn table(about: &str, inside: &Markup) -> Markup {
    html! { div.table role="region" tabindex="0" aria-label=(about) { table { (inside) } } }
}

/// Pixels of the page that a picture may take, or that its side is enlarged to.
const WIDTH: usize = 256;
