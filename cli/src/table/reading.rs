//! Configurations in files: TOML or JSON, written by people or by this program.

use std::fs;
use std::path::Path;

use fsot::config::Term;
use fsot::files::{Metadata, RunRecord};
use fsot::{Config, Extent};
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};

use super::recipe::Recipe;
use super::values::KernelSource;
use crate::Failure;

/// Larger files are something else.
const MOST_BYTES: u64 = 1 << 30;
/// Likeness from which on a name is what another was meant to be.
const ALIKE: f64 = 0.75;

/// What a file says of a table. The metadata of a table say how to make that very table; names of files that
/// a file holds are meant from where it lies.
///
/// # Errors
/// What stands against it, in one sentence with file and line.
pub fn recipe(path: &Path) -> Result<Recipe, Failure> {
    let text = Text::open(path)?;
    if matches!(&text, Text::Json(text) if text.trim_start().starts_with('[')) {
        let advice = "give keys and values, or a list of terms as --terms";
        return Err(format!("{}: a list alone says nothing of a table: {advice}", path.display()).into());
    }
    let of = |fault: Fault| Failure::from(fault.sentence(path));
    let kind: Kind = text.read().map_err(of)?;
    let known = Metadata::new(Extent::still(1, 1), 1, 0, serde_json::Value::Null).format;
    if let Some(format) = kind.format.filter(|format| *format != known) {
        let advice = format!("give the .json of a table, which says {known:?}");
        return Err(format!("{}: format is {format:?}: {advice}", path.display()).into());
    }
    if kind.configuration.is_some() {
        let Whole { configuration, run } = text.read().map_err(of)?;
        return Ok(Recipe::of_config(configuration, run));
    }
    if kind.extent.is_some() {
        return Ok(Recipe::of_config(text.read().map_err(of)?, None));
    }
    let mut recipe: Recipe = text.read().map_err(of)?;
    recipe.check().map_err(|problem| format!("{}: {problem}", path.display()))?;
    if let Some(KernelSource::File(kernel)) = &mut recipe.kernel {
        *kernel = path.parent().unwrap_or(Path::new("")).join(&*kernel);
    }
    Ok(recipe)
}

/// The terms that a file lists: a list by itself, or one that is called `terms`.
///
/// # Errors
/// As [`recipe`].
pub fn terms(path: &Path) -> Result<Vec<Term>, Failure> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Listed {
        terms: Vec<Term>,
    }
    let text = Text::open(path)?;
    let listed = match text {
        Text::Json(ref text) if text.trim_start().starts_with('[') => Text::Json(text.clone()).read(),
        text => text.read().map(|Listed { terms }| terms),
    };
    listed.map_err(|fault| fault.sentence(path).into())
}

/// What tells one kind of file from another.
#[derive(Deserialize)]
struct Kind {
    format: Option<String>,
    configuration: Option<IgnoredAny>,
    extent: Option<IgnoredAny>,
}

/// The part of metadata that makes a table.
#[derive(Deserialize)]
struct Whole {
    configuration: Config,
    run: Option<RunRecord>,
}

enum Text {
    Json(String),
    Toml(String),
}

struct Fault {
    /// From 1.
    line: usize,
    reason: String,
}

impl Text {
    fn open(path: &Path) -> Result<Self, Failure> {
        let name = path.display();
        let unreadable = |error| format!("cannot read {name}: {error}; check the path and its permissions");
        let about = fs::metadata(path).map_err(unreadable)?;
        // Before opening, because opening a pipe waits for its writer.
        if !about.is_file() || about.len() > MOST_BYTES {
            return Err(format!("{name} is no configuration: give a file of TOML or JSON").into());
        }
        let bytes = fs::read(path).map_err(unreadable)?;
        let text = String::from_utf8(bytes)
            .map_err(|_| format!("{name} is no text: give a file of TOML or JSON"))?;
        // A byte order mark, as some editors write it.
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned();
        // No line of TOML begins with a brace; a list without a name is JSON as well.
        let is_json = text.trim_start().starts_with('{')
            || text.trim_start().starts_with('[') && serde_json::from_str::<IgnoredAny>(&text).is_ok();
        Ok(if is_json { Self::Json(text) } else { Self::Toml(text) })
    }

    fn read<T: DeserializeOwned>(&self) -> Result<T, Fault> {
        match self {
            Self::Json(text) => serde_json::from_str(text).map_err(|error| {
                let reason = error.to_string();
                let place = format!(" at line {} column {}", error.line(), error.column());
                Fault { line: error.line(), reason: reason.trim_end_matches(&place).to_owned() }
            }),
            Self::Toml(text) => toml::from_str(text).map_err(|error| {
                let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or("");
                Fault { line: 1 + before.matches('\n').count(), reason: error.message().trim().to_owned() }
            }),
        }
    }
}

impl Fault {
    fn sentence(&self, path: &Path) -> String {
        let Self { line, reason } = self;
        format!("{}, line {line}: {}", path.display(), advised(reason).replace('\n', " "))
    }
}

/// What serde calls the types of numbers, and what people call them.
const WORDS: [(&str, &str); 14] = [
    ("internally tagged enum Schedule", "a schedule such as { shape = \"constant\", value = 1 }"),
    ("expected usize", "expected a whole number of at least 0"),
    ("expected u64", "expected a whole number of at least 0"),
    ("expected u32", "expected a whole number of at least 0"),
    ("expected i32", "expected a whole number"),
    ("expected f64", "expected a number"),
    ("expected f32", "expected a number"),
    ("expected enum ", "expected the name of a "),
    ("expected struct ", "expected a table of keys: "),
    ("expected a sequence", "expected a list"),
    ("invalid type: sequence", "invalid type: a list"),
    ("invalid type: map", "invalid type: a table of keys"),
    ("invalid type: integer", "invalid type: the whole number"),
    ("invalid type: floating point", "invalid type: the number"),
];

/// Serde's words, with the name that was meant where one is alike.
fn advised(reason: &str) -> String {
    let mut names = reason.split('`').skip(1).step_by(2);
    let kind = [("unknown field", "key"), ("unknown variant", "name")];
    let kind = kind.into_iter().find(|(words, _)| reason.starts_with(words));
    let (Some((_, kind)), Some(given)) = (kind, names.next()) else {
        let plain = WORDS.iter().fold(reason.to_owned(), |text, (serde, plain)| text.replace(serde, plain));
        return format!("{plain}: correct that line");
    };
    let known: Vec<&str> = names.collect();
    let likeness = |name: &&str| strsim::jaro_winkler(given, name);
    let nearest = known.iter().max_by(|one, other| likeness(one).total_cmp(&likeness(other)));
    match nearest.filter(|name| likeness(name) > ALIKE) {
        Some(nearest) => format!("unknown {kind} '{given}': did you mean '{nearest}'?"),
        None if known.is_empty() => format!("unknown {kind} '{given}': leave it out"),
        None => format!("unknown {kind} '{given}': write one of {}", known.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_that_was_meant_is_found() {
        for (reason, words) in [
            ("unknown field `widht`, expected one of `width`, `height`", "did you mean 'width'?"),
            (
                "unknown field `slices-per-class`, expected `slices_per_class` or `sweeps`",
                "'slices_per_class'?",
            ),
            (
                "unknown variant `quux`, expected `box` or `taps`",
                "unknown name 'quux': write one of box, taps",
            ),
            ("unknown field `x`, there are no fields", "unknown key 'x': leave it out"),
            (
                "invalid type: string \"a\", expected usize",
                "string \"a\", expected a whole number of at least 0: correct that line",
            ),
            (
                "invalid type: floating point `0.5`, expected internally tagged enum Schedule",
                "the number `0.5`, expected a schedule such as { shape = \"constant\", value = 1 }",
            ),
            ("missing field `dims`", "missing field `dims`: correct that line"),
        ] {
            assert!(advised(reason).contains(words), "{}", advised(reason));
        }
    }
}
