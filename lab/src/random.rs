//! What the lab draws random numbers for; generators are the library's.

pub(crate) use fsot::random::{finalise, generator};

/// 2⁶⁴ over the golden ratio: consecutive multiples are far apart.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// What a generator is used for; part of its name.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    /// The swaps of one region in one round of an annealing.
    Swaps = 48,
    /// Where the regions of a round lie.
    Regions,
    /// The arrangement that an annealing starts from, and other starts of the compared samplers.
    Start,
}

impl From<Purpose> for u64 {
    fn from(purpose: Purpose) -> u64 {
        purpose as u64
    }
}
