//! How files of pictures are read.

/// How the file of a picture is read; the default suits almost all.
///
/// ```
/// use fsot::targets::{Density, PictureOptions, Tone, Transfer};
///
/// // Numbers of light, though the file doesn't say so, and every texel as it is.
/// let options =
///     PictureOptions { transfer: Transfer::Linear, most_pixels: None, ..PictureOptions::default() };
/// let density = Density::open_with("data/lantern.png", Tone::Dark, &options)?;
/// assert_eq!(density.size(), [360, 270]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureOptions {
    /// From the numbers of a file to light.
    pub transfer: Transfer,
    /// Which layer of an EXR file is read: the name that stands before `.R`, `.G` and `.B`, or that of a
    /// part. `None` takes the channels without a name, or else the one layer that there is, or that is
    /// called `Combined`.
    pub layer: Option<String>,
    /// A picture of more pixels is averaged down to as many while it is read; `None` leaves every pixel as
    /// it is. At least 1 counts.
    ///
    /// What is averaged is what draws points (a [density](crate::targets::Density),
    /// [inks](crate::targets::Inks)), or light ([`Picture`](super::Picture)), by area: no mass is lost, and
    /// none moves farther than one of the coarser pixels is wide. Sides become as many times shorter as each
    /// other; a whole number of times where that divides both and leaves at least half of these pixels.
    ///
    /// The default is 2²²: the law along a direction has 2048 pieces at most, which 2048² pixels fill, and
    /// among a million points each has four pixels. Choose `None` where single texels matter, as in the map
    /// of a sky with a small sun.
    pub most_pixels: Option<usize>,
    /// A file with more pixels is refused, before memory is set aside for it: 2²⁷ by default. What reading
    /// takes in time grows with the pixels of the file, what it takes in memory with those that are kept.
    pub limit_pixels: usize,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self { transfer: Transfer::default(), layer: None, most_pixels: Some(1 << 22), limit_pixels: 1 << 27 }
    }
}

/// From the numbers of a file to light.
///
/// What a PNG file says of its colours counts in the order of its specification (third edition): `cICP`,
/// then `iCCP`, `sRGB`, and `gAMA` with `cHRM`; a file that says nothing is sRGB.
///
/// * `cICP`: the curves of BT.709, BT.2020 and their like, sRGB, linear, powers 2.2, 2.6 and 2.8, and PQ,
///   where 203 cd/m² is the white of paper; the colours of Rec. 709, BT.601, BT.2020, DCI-P3 and Display P3.
/// * `iCCP`: profiles of curves and a matrix, as nearly all cameras, screens and painting programs write
///   them. Such as sRGB's, within 0.001, are read as sRGB.
/// * `gAMA`: the power that it says, but sRGB's curve within 2 % of 1/2.2, which is what it means there.
///
/// `mDCV` and `cLLI` are for screens, and change nothing. All else (HLG, printers' profiles) is refused in
/// words. Colours become those of Rec. 709. EXR is linear;
/// its `chromaticities` count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Transfer {
    /// As the file says.
    #[default]
    FromFile,
    /// sRGB, whatever the file says of its colours; EXR files are linear all the same.
    Srgb,
    /// Linear, whatever the file says of its colours.
    Linear,
}
