//! Values of a configuration file, as short as on the command line or as long as in the library.

use std::fmt::{Formatter, Result as Written};
use std::marker::PhantomData;
use std::path::PathBuf;

use fsot::config::{DimensionGroup, Domain};
use fsot::kernel::{SpatialKernel, TemporalKernel};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer, StrDeserializer};
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};

use super::stencil::Stencil;
use crate::temporal;

/// What a value may be written as.
trait Forms: Sized {
    /// All of it, for messages.
    const EXPECTED: &'static str;

    fn of_words<E: Error>(words: &str) -> Result<Self, E>;

    fn of_list<'de, A: SeqAccess<'de>>(_: A) -> Result<Self, A::Error> {
        Err(A::Error::custom(format!("a list where there should be {}", Self::EXPECTED)))
    }

    fn of_map<'de, A: MapAccess<'de>>(_: A) -> Result<Self, A::Error> {
        Err(A::Error::custom(format!("a table where there should be {}", Self::EXPECTED)))
    }
}

struct AnyForm<T>(PhantomData<T>);

impl<'de, T: Forms> Visitor<'de> for AnyForm<T> {
    type Value = T;

    fn expecting(&self, out: &mut Formatter) -> Written {
        out.write_str(T::EXPECTED)
    }

    fn visit_str<E: Error>(self, words: &str) -> Result<T, E> {
        T::of_words(words)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<T, A::Error> {
        T::of_list(list)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        T::of_map(map)
    }
}

/// Temporal kernels, as words or as the library's.
#[derive(Clone, Debug, PartialEq)]
pub struct Temporal(pub TemporalKernel);

impl Forms for Temporal {
    const EXPECTED: &'static str = "a temporal kernel such as \"ema:0.1\"";

    fn of_words<E: Error>(words: &str) -> Result<Self, E> {
        temporal::parse(words).map(Self).map_err(E::custom)
    }

    fn of_map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        TemporalKernel::deserialize(MapAccessDeserializer::new(map)).map(Self)
    }
}

/// Dimension groups: words for all of them, or a list of words, of dimensions or of the library's.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups(pub Vec<DimensionGroup>);

impl Forms for Groups {
    const EXPECTED: &'static str = "dimension groups such as [\"0,1\", \"2,3:0.5\"]";

    fn of_words<E: Error>(words: &str) -> Result<Self, E> {
        groups(words).map_err(E::custom)
    }

    fn of_list<'de, A: SeqAccess<'de>>(mut list: A) -> Result<Self, A::Error> {
        let mut groups = Vec::new();
        while let Some(Group(group)) = list.next_element()? {
            groups.push(group);
        }
        Ok(Self(groups))
    }
}

struct Group(DimensionGroup);

impl Forms for Group {
    const EXPECTED: &'static str = "a dimension group such as \"0,1:0.5\" or [0, 1]";

    fn of_words<E: Error>(words: &str) -> Result<Self, E> {
        group(words).map(Self).map_err(E::custom)
    }

    fn of_list<'de, A: SeqAccess<'de>>(list: A) -> Result<Self, A::Error> {
        let dims = Vec::<usize>::deserialize(SeqAccessDeserializer::new(list))?;
        Ok(Self(DimensionGroup::new(dims)))
    }

    fn of_map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        DimensionGroup::deserialize(MapAccessDeserializer::new(map)).map(Self)
    }
}

/// How dimensions end: all alike, or each in its own way.
#[derive(Clone, Debug, PartialEq)]
pub enum Domains {
    All(Domain),
    Each(Vec<Domain>),
}

impl Domains {
    pub fn any_wraps(&self) -> bool {
        match self {
            Self::All(domain) => *domain == Domain::Torus,
            Self::Each(domains) => domains.contains(&Domain::Torus),
        }
    }
}

impl Forms for Domains {
    const EXPECTED: &'static str = "\"interval\", \"torus\", or a list with one of them for each dimension";

    fn of_words<E: Error>(words: &str) -> Result<Self, E> {
        Domain::deserialize(StrDeserializer::new(words)).map(Self::All)
    }

    fn of_list<'de, A: SeqAccess<'de>>(list: A) -> Result<Self, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(Self::Each)
    }
}

/// Where the weights over pixels come from.
#[derive(Clone, Debug, PartialEq)]
pub enum KernelSource {
    /// A file with taps.
    File(PathBuf),
    /// Rows of weights.
    Rows(Stencil),
    /// One of the library's.
    Given(SpatialKernel),
}

impl Forms for KernelSource {
    const EXPECTED: &'static str =
        "a kernel: the name of a file, rows of weights, or a table such as { box = { size_px = 3 } }";

    fn of_words<E: Error>(words: &str) -> Result<Self, E> {
        Ok(Self::File(words.into()))
    }

    fn of_list<'de, A: SeqAccess<'de>>(list: A) -> Result<Self, A::Error> {
        let rows = Vec::deserialize(SeqAccessDeserializer::new(list))?;
        Stencil::of_rows(rows).map(Self::Rows).map_err(A::Error::custom)
    }

    fn of_map<'de, A: MapAccess<'de>>(map: A) -> Result<Self, A::Error> {
        SpatialKernel::deserialize(MapAccessDeserializer::new(map)).map(Self::Given)
    }
}

macro_rules! in_any_form {
    ($($type:ty),*) => {$(
        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                from.deserialize_any(AnyForm(PhantomData))
            }
        }
    )*};
}

in_any_form!(Temporal, Groups, Group, Domains, KernelSource);

/// Groups such as `0,1:1;2,3:1`.
pub fn groups(text: &str) -> Result<Groups, String> {
    text.split(';').map(group).collect::<Result<_, _>>().map(Groups)
}

/// A group such as `0,1`, `0-3:0.5` or `0,2-4:1`.
fn group(text: &str) -> Result<DimensionGroup, String> {
    // Dimensions beyond any table would only make the list long.
    const MOST: usize = 1 << 16;
    let malformed = || format!("'{text}' is no dimension group: write for example 0,1:1 or 0-3:0.5");
    let (list, weight) = text.split_once(':').unwrap_or((text, "1"));
    let weight = weight.trim().parse().map_err(|_| malformed())?;
    let mut dims = Vec::new();
    for item in list.split(',') {
        let (first, last) = item.split_once('-').unwrap_or((item, item));
        let [first, last] =
            [first, last].map(|dim| dim.trim().parse::<usize>().ok().filter(|&dim| dim < MOST));
        match (first, last) {
            (Some(first), Some(last)) if first <= last => dims.extend(first..=last),
            _ => return Err(malformed()),
        }
    }
    Ok(DimensionGroup { dims, weight })
}
