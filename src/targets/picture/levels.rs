//! From the levels of pixels to light.

use super::light::Light;

/// What whole numbers from 0 to a highest level mean: grey, colours, with or without alpha.
pub(super) struct Levels<'a> {
    light: &'a Light,
    channels: usize,
    /// Light of each level of red, green and blue.
    levels: [Vec<f32>; 3],
    /// Share of the highest level.
    shares: Vec<f32>,
}

impl<'a> Levels<'a> {
    /// For pixels of 1 (grey), 2 (grey and alpha), 3 (colours) or 4 channels (colours and alpha).
    pub fn new(light: &'a Light, channels: usize, most: u16) -> Self {
        let unit = f32::from(most);
        // Grey is multiplied and colours are divided, which differs in the last bit: so did the crate
        // `image`, which read files before, and a seed promises its points.
        let share = |sample: u16| match channels < 3 {
            true => f32::from(sample) * unit.recip(),
            false => f32::from(sample) / unit,
        };
        let shares: Vec<f32> = (0..=most).map(share).collect();
        let levels =
            [0, 1, 2].map(|channel| shares.iter().map(|&share| (light.curves[channel])(share)).collect());
        Self { light, channels, levels, shares }
    }

    /// The pixel with this level in each channel: red, green and blue, multiplied by alpha, and alpha.
    pub fn pixel(&self, level: impl Fn(usize) -> usize) -> [f32; 4] {
        let [red, green, blue] = &self.levels;
        let grey = || [red, green, blue].map(|channel| channel[level(0)]);
        let colors = || [red[level(0)], green[level(1)], blue[level(2)]];
        let (colors, alpha) = match self.channels {
            1 => (grey(), 1.0),
            2 => (grey(), self.shares[level(1)]),
            3 => (colors(), 1.0),
            _ => (colors(), self.shares[level(3)]),
        };
        covered(self.light.in_rec_709(colors), alpha)
    }
}

/// Light of a pixel that covers so much of its area.
pub(super) fn covered(light: [f32; 3], alpha: f32) -> [f32; 4] {
    let [red, green, blue] = light.map(|light| light * alpha);
    [red, green, blue, alpha]
}
