//! Draws the pictures that `fsot points stipple` and `color-stipple` read: a lantern in grey, a garden in
//! colour.
//!
//! `cargo run --release -p fsot-lab --bin pictures -- data`

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use fsot_cli::draw::raster::Color;
use fsot_lab::draw::srgb;
use fsot_lab::program::{self, Failure};

/// Draw the pictures that the stipplings start from.
#[derive(Parser)]
struct Arguments {
    /// Where lantern.png and garden.png go; made if absent.
    #[arg(value_name = "DIR", default_value = "data")]
    folder: PathBuf,
}

fn main() -> ExitCode {
    program::main(run)
}

fn run(Arguments { folder }: &Arguments) -> Result<(), Failure> {
    program::make_folder(folder)?;
    draw(360, 270, lantern).save(&folder.join("lantern.png"))?;
    draw(320, 240, garden).save(&folder.join("garden.png"))
}

/// A picture of what `scene` is at each place, x from 0 to the aspect ratio and y from 0 to 1, downwards.
fn draw(width: usize, height: usize, scene: impl Fn(f64, f64) -> [f64; 3]) -> Color {
    Color::from_fn(width, height, |column, row| {
        let mut sum = [0.0; 3];
        for sub in 0..16 {
            let x = (column as f64 + (f64::from(sub % 4) + 0.5) / 4.0) / height as f64;
            let y = (row as f64 + (f64::from(sub / 4) + 0.5) / 4.0) / height as f64;
            let light = scene(x, y);
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light.clamp(0.0, 1.0) / 16.0);
        }
        sum.map(srgb)
    })
}

/// A shaded ball and a ring on a table, under a white sky.
fn lantern(x: f64, y: f64) -> [f64; 3] {
    let mut light = if y > 0.78 { 0.75 - 0.9 * (y - 0.78) } else { 1.0 };
    // Shadow on the table.
    let shadow = ((x - 0.62) / 0.36).hypot((y - 0.86) / 0.07);
    if y > 0.78 && shadow < 1.0 {
        light *= 0.25 + 0.75 * shadow.powi(3);
    }
    let ring = (x - 0.98).hypot(y - 0.34);
    if (ring - 0.2).abs() < 0.045 {
        light = 0.12 + 0.55 * ((y - 0.34) / 0.4 + 0.5).clamp(0.0, 1.0);
    }
    let (u, v) = ((x - 0.45) / 0.33, (y - 0.5) / 0.33);
    if u.hypot(v) < 1.0 {
        let w = (1.0 - u * u - v * v).sqrt();
        let diffuse = (-0.5 * u - 0.6 * v + 0.62 * w).max(0.0);
        let glint = (-0.28 * u - 0.34 * v + 0.9 * w).max(0.0).powi(60);
        light = 0.03 + 0.85 * diffuse + glint;
    }
    [light; 3]
}

/// A sun, hills and three flowers.
fn garden(x: f64, y: f64) -> [f64; 3] {
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| -> [f64; 3] {
        std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t.clamp(0.0, 1.0))
    };
    let mut light = mix([0.25, 0.55, 0.95], [1.0, 1.0, 1.0], y / 0.55);
    if (x - 1.05).hypot(y - 0.22) < 0.13 {
        light = [1.0, 0.8, 0.1];
    }
    if y > 0.6 + 0.08 * (4.0 * x).sin() {
        light = mix([0.35, 0.7, 0.15], [0.03, 0.2, 0.05], (y - 0.55) / 0.45);
    }
    let flowers =
        [(0.3, 0.5, [0.9, 0.05, 0.1]), (0.68, 0.58, [0.85, 0.1, 0.75]), (1.02, 0.64, [0.95, 0.45, 0.02])];
    for (left, top, colour) in flowers {
        if (x - left).abs() < 0.012 && y > top && y < 0.97 {
            light = [0.05, 0.3, 0.08];
        }
        let (radius, angle) = ((x - left).hypot(y - top), (y - top).atan2(x - left));
        if radius < 0.11 + 0.04 * (6.0 * angle).cos() {
            light = mix(colour, [0.2, 0.0, 0.05], 1.0 - radius / 0.1);
        }
        if radius < 0.035 {
            light = [1.0, 0.85, 0.2];
        }
    }
    light
}
