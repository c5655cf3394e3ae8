//! How pictures are read.

use clap::Args;
use fsot::targets::{PictureError, PictureOptions, Transfer};
use serde::Serialize;

use crate::Failure;

/// What a picture's file doesn't say, and how much of it is read.
#[derive(Args, Debug, Serialize)]
pub struct Reading {
    /// Take the numbers of a PNG for light, whatever the file says of its colours; it says sRGB, mostly.
    #[arg(long, conflicts_with = "srgb")]
    linear: bool,
    /// Take a PNG for sRGB, whatever the file says of its colours.
    #[arg(long)]
    srgb: bool,
    /// Layer of an EXR, such as ViewLayer.Combined [default: the channels R, G, B without a name, or the only
    /// layer, or the one called Combined].
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,
    /// Average a picture of more pixels down to so many, mass for mass; 0 leaves every pixel as it is.
    #[arg(long, value_name = "PIXELS", default_value_t = PictureOptions::default().most_pixels.unwrap_or(0))]
    most_pixels: usize,
    /// Refuse files of more pixels.
    #[arg(long, value_name = "PIXELS", default_value_t = PictureOptions::default().limit_pixels)]
    limit_pixels: usize,
}

impl Reading {
    pub fn options(&self) -> PictureOptions {
        PictureOptions {
            transfer: match (self.linear, self.srgb) {
                (true, _) => Transfer::Linear,
                (_, true) => Transfer::Srgb,
                _ => Transfer::FromFile,
            },
            layer: self.layer.clone(),
            most_pixels: (self.most_pixels > 0).then_some(self.most_pixels),
            limit_pixels: self.limit_pixels,
        }
    }
}

/// The library's word, with flags for its options.
pub fn refusal(error: PictureError) -> Failure {
    let flags = [
        ("`transfer`", "--linear or --srgb"),
        ("`layer`", "--layer"),
        ("`most_pixels`", "--most-pixels"),
        ("`limit_pixels`", "--limit-pixels"),
    ];
    let text = error.to_string();
    let said = flags.into_iter().fold(text.clone(), |text, (option, flag)| text.replace(option, flag));
    if said == text { format!("{text} by --picture").into() } else { said.into() }
}
