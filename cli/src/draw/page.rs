//! A white page to put dots on.

use super::raster::Color;

/// The page; inks on it multiply, as on paper.
#[derive(Clone, Debug)]
pub struct Page {
    /// What is on it so far.
    pub picture: Color,
}

impl Page {
    /// A white page of so many pixels.
    pub fn new(width: usize, height: usize) -> Self {
        Self { picture: Color::filled(width, height, [255; 3]) }
    }

    /// A disc with a soft edge.
    pub fn dot(&mut self, [x, y]: [f64; 2], radius: f64, ink: [u8; 3]) {
        let range = |at: f64| {
            (at - radius - 1.0).floor().max(0.0) as usize..=(at + radius + 1.0).ceil().max(0.0) as usize
        };
        for row in range(y) {
            for column in range(x) {
                let Some(pixel) = self.picture.pixel_mut(column, row) else { continue };
                let distance = (column as f64 + 0.5 - x).hypot(row as f64 + 0.5 - y);
                let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
                for (value, ink) in pixel.iter_mut().zip(ink) {
                    let kept = 1.0 - cover * (1.0 - f64::from(ink) / 255.0);
                    *value = (f64::from(*value) * kept).round() as u8;
                }
            }
        }
    }

    /// Points of the unit square in a thin frame whose upper left corner is given.
    pub fn scatter<'a>(
        &mut self,
        [left, top]: [usize; 2],
        [width, height]: [usize; 2],
        radius: f64,
        points: impl IntoIterator<Item = (&'a [f32], [u8; 3])>,
    ) {
        self.frame([left, top], [width, height]);
        for (point, ink) in points {
            let x = left as f64 + f64::from(point[0]) * width as f64;
            let y = top as f64 + f64::from(point[1]) * height as f64;
            self.dot([x, y], radius, ink);
        }
    }

    fn frame(&mut self, [left, top]: [usize; 2], [width, height]: [usize; 2]) {
        let (right, bottom) = (left + width, top + height);
        for x in left.saturating_sub(1)..=right {
            for y in [top.saturating_sub(1), bottom] {
                self.set(x, y);
            }
        }
        for y in top.saturating_sub(1)..=bottom {
            for x in [left.saturating_sub(1), right] {
                self.set(x, y);
            }
        }
    }

    fn set(&mut self, x: usize, y: usize) {
        if let Some(pixel) = self.picture.pixel_mut(x, y) {
            *pixel = [190, 190, 190];
        }
    }
}
