//! Curves and points as SVG, in the colours of the page: no library of plots leaves colours to a style sheet.

use std::fmt::Write;

use fsot::metrics::RadialBin;
use maud::{Markup, html};

use super::marginals::Profile;
use super::panels::Dots;

/// Margins of a plot: left, top, right, bottom.
const MARGINS: [f64; 4] = [38.0, 8.0, 12.0, 34.0];

/// A frame with two axes.
struct Plot {
    size: [f64; 2],
    /// What lies at the left and the right edge.
    x: [f64; 2],
    /// What lies at the lower and the upper edge.
    y: [f64; 2],
}

impl Plot {
    fn across(&self, x: f64) -> f64 {
        let share = (x - self.x[0]) / (self.x[1] - self.x[0]);
        MARGINS[0] + share * (self.size[0] - MARGINS[0] - MARGINS[2])
    }

    /// What lies outside is drawn at the edge.
    fn up(&self, y: f64) -> f64 {
        let share = ((y - self.y[0]) / (self.y[1] - self.y[0])).clamp(0.0, 1.0);
        self.size[1] - MARGINS[3] - share * (self.size[1] - MARGINS[1] - MARGINS[3])
    }

    fn path(&self, points: impl Iterator<Item = [f64; 2]>) -> String {
        let mut path = String::new();
        for (at, [x, y]) in points.enumerate() {
            let verb = if at == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{verb}{:.1} {:.1}", self.across(x), self.up(y));
        }
        path
    }

    fn horizontal(&self, y: f64, class: &str) -> Markup {
        let ends = self.path(self.x.map(|x| [x, y]).into_iter());
        html! { path class=(class) d=(ends) {} }
    }

    fn vertical(&self, x: f64, class: &str) -> Markup {
        let ends = self.path(self.y.map(|y| [x, y]).into_iter());
        html! { path class=(class) d=(ends) {} }
    }

    fn label_below(&self, x: f64, text: &str) -> Markup {
        let [x, y] = [self.across(x), self.size[1] - MARGINS[3] + 14.0].map(place);
        html! { text x=(x) y=(y) text-anchor="middle" { (text) } }
    }

    fn label_left(&self, y: f64, text: &str) -> Markup {
        html! { text x=(place(MARGINS[0] - 5.0)) y=(place(self.up(y) + 4.0)) text-anchor="end" { (text) } }
    }

    fn caption_below(&self, text: &str) -> Markup {
        let middle = 0.5 * (self.across(self.x[0]) + self.across(self.x[1]));
        html! { text x=(place(middle)) y=(place(self.size[1] - 4.0)) text-anchor="middle" { (text) } }
    }

    fn frame(&self) -> Markup {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, k]| [self.x[i], self.y[k]]);
        html! { path class="frame" d={ (self.path(corners.into_iter())) "Z" } {} }
    }

    fn svg(&self, alt: &str, inside: &Markup) -> Markup {
        html! {
            svg viewBox=(format!("0 0 {} {}", self.size[0], self.size[1])) role="img" aria-label=(alt) {
                (inside) (self.frame())
            }
        }
    }
}

/// To a tenth of a pixel.
fn place(at: f64) -> String {
    format!("{at:.1}")
}

/// Power by frequency, on a scale of powers of ten. The first line is white noise's.
pub fn radial(lines: &[(&str, &[RadialBin])], half_power: f64) -> Markup {
    let inside = |bins: &&[RadialBin]| bins.iter().filter(|bin| bin.frequency <= 0.5).copied().collect();
    let curves: Vec<Vec<RadialBin>> = lines.iter().map(|(_, bins)| inside(bins)).collect();
    let powers = curves.iter().flatten().map(|bin| bin.power).filter(|power| *power > 0.0);
    let least = powers.fold(0.5, f64::min).log10().floor().max(-4.0);
    let most = curves.iter().flatten().map(|bin| bin.power).fold(3.0, f64::max).log10().min(4.0);
    let plot = Plot { size: [520.0, 300.0], x: [0.0, 0.5], y: [least, most] };
    let ticks =
        (least as i32..=most as i32).map(|exponent| (f64::from(exponent), 10_f64.powi(exponent).to_string()));
    let alt = format!(
        "Power of the error over frequency, from 0 to half a cycle per pixel: {}",
        lines.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    );
    plot.svg(
        &alt,
        &html! {
            @for (exponent, text) in ticks {
                (plot.horizontal(exponent, if exponent == 0.0 { "one" } else { "grid" }))
                (plot.label_left(exponent, &text))
            }
            @for tenth in 0..=5_u32 { (plot.label_below(f64::from(tenth) * 0.1, &format!("0.{tenth}"))) }
            (plot.caption_below("cycles per pixel"))
            @if half_power < 0.5 {
                (plot.vertical(half_power, "half"))
                text x=(place(plot.across(half_power) + 5.0)) y=(place(plot.size[1] - MARGINS[3] - 6.0)) {
                    "the filter halves the power here"
                }
            }
            @for (at, bins) in curves.iter().enumerate() {
                path class={ "line l" (number(at)) } d=(plot.path(bins.iter().map(|bin| {
                    [bin.frequency, bin.power.max(1e-9).log10()]
                }))) {}
                // A tile of two pixels has a single ring.
                @if let [bin] = bins[..] {
                    circle class={ "line l" (number(at)) } r="3" cx=(place(plot.across(bin.frequency)))
                        cy=(place(plot.up(bin.power.max(1e-9).log10()))) {}
                }
            }
        },
    )
}

/// The class of a line: white noise is 0, tables follow.
pub fn number(line: usize) -> usize {
    if line == 0 { 0 } else { (line - 1) % 6 + 1 }
}

/// Density along a coordinate: next to 0, between, and next to 1.
pub fn marginal(profile: &Profile, alt: &str) -> Markup {
    let size = [300.0, 165.0];
    let plot = Plot { size, x: [0.0, 3.0], y: [0.0, 2.0] };
    // Three parts of equal width.
    let parts = profile.parts.iter().enumerate();
    plot.svg(
        alt,
        &html! {
            @for (part, bins) in parts.clone() {
                @let step = 1.0 / bins.densities.len() as f64;
                @let ends = [1.0 - bins.deviation, 1.0 + bins.deviation];
                @let corners = [[0.0, ends[0]], [1.0, ends[0]], [1.0, ends[1]], [0.0, ends[1]]];
                path class="band" d={
                    (plot.path(corners.into_iter().map(|[x, y]| [part as f64 + x, y]))) "Z"
                } {}
                @let tops = bins.densities.iter().enumerate().flat_map(|(bin, &density)| {
                    [bin, bin + 1].map(|edge| [part as f64 + edge as f64 * step, density])
                });
                @let from = std::iter::once([part as f64, 0.0]);
                @let to = std::iter::once([part as f64 + 1.0, 0.0]);
                path class="bars" d={ (plot.path(from.chain(tops).chain(to))) "Z" } {}
            }
            (plot.horizontal(1.0, "one"))
            @for edge in [1.0, 2.0] { (plot.vertical(edge, "cut")) }
            @for (at, text) in [(0.0, "0"), (1.0, "0.02"), (2.0, "0.98"), (3.0, "1")] {
                (plot.label_below(at, text))
            }
            @for density in 0..=2_u8 { (plot.label_left(density.into(), &density.to_string())) }
            (plot.caption_below("value; its ends are widened"))
        },
    )
}

/// A square with points. They are as wide as their number allows.
pub fn dots(dots: &Dots, alt: &str) -> Markup {
    let radius = (160.0 / (dots.points.len().max(1) as f64).sqrt()).clamp(5.0, 14.0);
    let mut places: Vec<[i32; 2]> =
        dots.points.iter().map(|[x, y]| [(x * 1000.0) as i32, ((1.0 - y) * 1000.0) as i32]).collect();
    // By rows: steps between neighbours are short numbers.
    places.sort_unstable_by_key(|&[x, y]| [y, x]);
    let mut path = String::from("M0 0");
    let mut last = [0, 0];
    for [x, y] in places {
        let _ = write!(path, "m{} {}h0", x - last[0], y - last[1]);
        last = [x, y];
    }
    html! {
        svg class="dots" viewBox="-8 -8 1016 1016" role="img" aria-label=(alt) {
            rect x="0" y="0" width="1000" height="1000" {}
            path d=(path) style=(format!("stroke-width:{:.0}", 2.0 * radius)) {}
        }
    }
}
