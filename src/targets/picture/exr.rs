//! EXR: floating point, linear, colours multiplied by alpha.

use std::io::{BufRead, Seek};
use std::path::Path;

use exr::error::Error;
use exr::meta::header::Header;
use exr::prelude::*;

use super::{Picture, check_size};
use crate::error::PictureError;

/// The first bytes of any EXR file.
pub(super) const SIGNATURE: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

pub(super) fn read(file: impl BufRead + Seek, path: &Path) -> std::result::Result<Picture, PictureError> {
    let refused = |source: Error| PictureError::Exr { path: path.into(), source };
    let reader = exr::block::read(file, false).map_err(refused)?;
    let Some(header) = reader.headers().iter().find(|header| has_colors(header)) else {
        return Err(refused(Error::Invalid("it has no flat part with channels R, G and B".into())));
    };
    // Pixels of the data window are kept inside of the display window; the rest of that is empty.
    let window = header.shared_attributes.display_window;
    let offset = header.own_attributes.layer_position - window.position;
    let Vec2(width, height) = window.size;
    check_size(path, [width, height])?;
    let empty = [0.0, 0.0, 0.0, if has_channel(header, "A") { 0.0 } else { 1.0 }];
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            move |_, _| vec![empty; width * height],
            move |pixels, at, (red, green, blue, alpha): (f32, f32, f32, f32)| {
                let Vec2(x, y) = at.to_i32() + offset;
                if let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y))
                    && x < width
                    && y < height
                {
                    pixels[y * width + x] = straight([red, green, blue, alpha]);
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_chunks(reader)
        .map_err(refused)?;
    Picture::new(width, height, image.layer_data.channel_data.pixels)
        .map_err(|problem| PictureError::Density { path: path.into(), problem })
}

fn has_colors(header: &Header) -> bool {
    !header.deep && ["R", "G", "B"].iter().all(|name| has_channel(header, name))
}

fn has_channel(header: &Header, name: &str) -> bool {
    header.channels.find_index_of_channel(&Text::from(name)).is_some()
}

/// Colours without the alpha that they were multiplied by.
fn straight([red, green, blue, alpha]: [f32; 4]) -> [f32; 4] {
    let share = if alpha > 0.0 { alpha.recip() } else { 0.0 };
    [red * share, green * share, blue * share, alpha]
}
