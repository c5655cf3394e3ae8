//! Names that are told apart.

use std::collections::BTreeSet;

/// The same names, each of which is there once: one that is taken, but for the case of its letters, gets a
/// number, from 2.
///
/// ```
/// let names = ["mask", "Mask", "mask #2"].map(String::from);
/// let told_apart = fsot_lab::names::distinct(names, " #");
/// assert_eq!(told_apart, ["mask", "Mask #2", "mask #2 #2"]);
/// ```
pub fn distinct(names: impl IntoIterator<Item = String>, separator: &str) -> Vec<String> {
    let mut taken = BTreeSet::new();
    // Some file systems do not tell `A` from `a`.
    let mut take = |name: &str| taken.insert(name.to_lowercase());
    let tell_apart = |name: String| {
        let mut candidate = name.clone();
        for number in 2.. {
            if take(&candidate) {
                break;
            }
            candidate = format!("{name}{separator}{number}");
        }
        candidate
    };
    names.into_iter().map(tell_apart).collect()
}

/// The name with nothing in it that a file system or a shell could misunderstand, and short enough to be part
/// of a file's name.
///
/// Different names may become the same: [`distinct`] comes after it.
pub fn plain(name: &str) -> String {
    const LONGEST: usize = 150;
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    name.chars().map(|c| if is_plain(c) { c } else { '_' }).take(LONGEST).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_becomes_the_same_is_numbered() {
        let labels = ["white noise", "white_noise", "White?noise", "white_noise-2", "\u{e4}", "\u{f6}"];
        let told_apart = distinct(labels.map(plain), "-");
        let expected = ["white_noise", "white_noise-2", "White_noise-3", "white_noise-2-2", "_", "_-2"]
            .map(String::from);
        assert_eq!(told_apart, expected);
        assert_eq!(plain(&"x".repeat(1000)).len(), 150);
    }
}
