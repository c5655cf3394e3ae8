//! Which channels of an EXR file are its picture.

use exr::meta::header::Header;

/// Channels that make a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Layer {
    /// Which part of the file.
    pub part: usize,
    /// Red, green and blue, by their places in the part; all the same where there is only luminance.
    pub colors: [usize; 3],
    pub alpha: Option<usize>,
    /// What stands before the names of the channels, if anything.
    prefix: String,
    /// Name of the part, if it has one.
    part_name: String,
}

/// Why there is no such layer.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Missing {
    /// No channels that make a picture, but these.
    Colors(Vec<String>),
    /// No layer of the name, but these; several, where no name was given.
    Layer(Vec<String>),
}

/// What Blender calls its finished picture.
const FINISHED: &str = "Combined";

impl Layer {
    /// The name to choose it by.
    fn name(&self) -> String {
        match (self.part_name.as_str(), self.prefix.as_str()) {
            (name, "") | ("", name) => name.into(),
            (part, prefix) if part == prefix => part.into(),
            (part, prefix) => format!("{part}.{prefix}"),
        }
    }

    fn is_called(&self, name: &str) -> bool {
        let is_part = self.prefix.is_empty() && self.part_name == name;
        is_part || self.prefix == name || self.name() == name
    }
}

/// The layer of that name; without one, the first without a prefix, or else the only one, or the only one
/// that is finished.
pub(super) fn choose(headers: &[Header], wanted: Option<&str>) -> Result<Layer, Missing> {
    let layers: Vec<Layer> =
        headers.iter().enumerate().flat_map(|(part, header)| layers(part, header)).collect();
    if layers.is_empty() {
        let channels = headers.iter().flat_map(|header| &header.channels.list);
        return Err(Missing::Colors(channels.map(|channel| channel.name.to_string()).collect()));
    }
    let named = || Missing::Layer(layers.iter().map(Layer::name).filter(|name| !name.is_empty()).collect());
    if let Some(name) = wanted {
        return layers.iter().find(|layer| layer.is_called(name)).cloned().ok_or_else(named);
    }
    let is_finished = |layer: &&Layer| layer.name().rsplit('.').next() == Some(FINISHED);
    let only = |found: &mut dyn Iterator<Item = &Layer>| {
        let first = found.next().cloned();
        first.filter(|_| found.next().is_none())
    };
    let unnamed = layers.iter().find(|layer| layer.prefix.is_empty()).cloned();
    unnamed
        .or_else(|| only(&mut layers.iter()))
        .or_else(|| only(&mut layers.iter().filter(is_finished)))
        .ok_or_else(named)
}

/// All of a part.
fn layers(part: usize, header: &Header) -> Vec<Layer> {
    let channels: Vec<(String, String)> = header
        .channels
        .list
        .iter()
        .map(|channel| {
            let name = channel.name.to_string();
            match name.rsplit_once('.') {
                Some((prefix, last)) => (prefix.into(), last.into()),
                None => (String::new(), name),
            }
        })
        .collect();
    let mut prefixes: Vec<&String> = Vec::new();
    for (prefix, _) in &channels {
        // Channels are sorted, so that those of a layer follow each other.
        if prefixes.last() != Some(&prefix) {
            prefixes.push(prefix);
        }
    }
    let part_name = header.own_attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
    let mut found: Vec<Layer> = Vec::new();
    for prefix in prefixes {
        let place = |name: &str| channels.iter().position(|(own, last)| own == prefix && last == name);
        // The Y of a vector, of XYZ, or beside chroma is no picture in grey.
        let luminance =
            || place("Y").filter(|_| ["X", "RY", "BY"].into_iter().all(|name| place(name).is_none()));
        let colors = match [place("R"), place("G"), place("B")] {
            [Some(red), Some(green), Some(blue)] => Some([red, green, blue]),
            _ => luminance().map(|grey| [grey; 3]),
        };
        if let Some(colors) = colors
            && !found.iter().any(|layer| layer.prefix == *prefix)
        {
            let [prefix, part_name] = [prefix.clone(), part_name.clone()];
            found.push(Layer { part, colors, alpha: place("A"), prefix, part_name });
        }
    }
    found
}
