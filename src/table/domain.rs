//! How one dimension of the unit cube ends: as an interval with two faces, or as a torus that wraps.

use serde::{Deserialize, Serialize};

/// Topology of one dimension of the sample space `[0, 1)`.
///
/// Integrands of a renderer are not periodic, so [`Domain::Interval`] is the default; on a torus the table
/// may be shifted by any offset per dimension (Cranley–Patterson rotation) without changing its quality.
///
/// ```
/// use fsot::config::Domain;
///
/// assert_eq!(Domain::Torus.admit(1.25), 0.25);
/// assert_eq!(Domain::Interval.admit(-0.1), 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Domain {
    /// `0` and `1` are two different ends.
    #[default]
    Interval,
    /// `0` and `1` are the same place.
    Torus,
}

/// The largest `f32` below 1.
pub const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl Domain {
    /// Brings a finite coordinate back into `[0, 1)`: clamped to the faces of an interval, wrapped on a
    /// torus.
    ///
    /// The result is never 1.0, also where rounding would give it. What is not a number becomes 0.
    #[inline(always)]
    #[allow(clippy::manual_clamp)] // `clamp` would let NaN through
    pub fn admit(self, coordinate: f32) -> f32 {
        let inside = match self {
            Domain::Interval => coordinate,
            Domain::Torus => coordinate - coordinate.floor(),
        };
        inside.max(0.0).min(BELOW_ONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_never_appears() {
        for domain in [Domain::Interval, Domain::Torus] {
            for coordinate in [
                1.0,
                -1e-9,
                -f32::MIN_POSITIVE,
                1.0 - 1e-8,
                -0.0,
                2.0,
                -1.0,
                1e9,
                -1e9,
                f32::INFINITY,
                f32::NAN,
            ] {
                let inside = domain.admit(coordinate);
                assert!((0.0..1.0).contains(&inside), "{domain:?} {coordinate} -> {inside}");
            }
        }
        assert_eq!(BELOW_ONE.next_up(), 1.0);
    }

    #[test]
    fn an_interval_clamps_and_a_torus_wraps() {
        assert_eq!(Domain::Interval.admit(1.25), BELOW_ONE);
        assert_eq!(Domain::Interval.admit(-0.25), 0.0);
        assert_eq!(Domain::Torus.admit(1.25), 0.25);
        assert_eq!(Domain::Torus.admit(-0.25), 0.75);
    }
}
