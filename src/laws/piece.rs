//! One piece of a distribution function: a power law at the edge of the support, a quartic elsewhere.

/// The distribution function on `[start, start + width]`, as a function of `t` in `[0, 1]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) start: f64,
    pub(super) width: f64,
    /// Probability left of `start`.
    pub(super) below: f64,
    pub(super) rise: Rise,
}

/// How the probability grows over a piece, from 0 at `t = 0`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rise {
    /// `mass · t^exponent`.
    Power { mass: f64, exponent: f64 },
    /// `c₀ t + c₁ t² + c₂ t³ + c₃ t⁴`, nondecreasing.
    Quartic([f64; 4]),
}

impl Rise {
    /// The quartic that rises by `mass`, starts and ends with these slopes (per unit of `t`) and has this
    /// mean.
    ///
    /// It is written in Bernstein form, where ordered coefficients are enough for monotonicity; data that ask
    /// for anything else (rounding, an unresolved kink) are moved to the nearest ordered coefficients.
    pub(super) fn monotone(mass: f64, slopes: (f64, f64), mean: f64) -> Self {
        let mut first = (slopes.0 / 4.0).clamp(0.0, mass);
        let mut third = (mass - slopes.1 / 4.0).clamp(0.0, mass);
        if first > third {
            first = 0.5 * (first + third);
            third = first;
        }
        let second = (5.0 * mean - first - third - mass).clamp(first, third);
        Rise::Quartic([
            4.0 * first,
            6.0 * (second - 2.0 * first),
            4.0 * (third - 3.0 * second + 3.0 * first),
            mass - 4.0 * third + 6.0 * second - 4.0 * first,
        ])
    }
}

impl Piece {
    /// Position in the support at `t`.
    pub(super) fn position(&self, t: f64) -> f64 {
        self.start + self.width * t
    }

    /// Probability left of `t`.
    pub(super) fn cdf(&self, t: f64) -> f64 {
        match self.rise {
            Rise::Power { mass, exponent } => self.below + mass * power(t, exponent),
            Rise::Quartic([a, b, c, d]) => self.below + t * (a + t * (b + t * (c + t * d))),
        }
    }

    /// The `t` with `cdf(t) = u`, for `u` between `below` and `above = cdf(1)`.
    pub(super) fn quantile(&self, u: f64, above: f64) -> f64 {
        let sought = u - self.below;
        if sought <= 0.0 {
            return 0.0;
        }
        if u >= above {
            return 1.0;
        }
        match self.rise {
            Rise::Power { mass, exponent } => root(sought / mass, exponent).min(1.0),
            Rise::Quartic(coefficients) => solve(coefficients, sought, sought / (above - self.below)),
        }
    }

    /// Probability and mean position of `[from, to]`, with 0 ≤ `from` ≤ `to` ≤ 1.
    ///
    /// Both are formed from differences that are small themselves, so a narrow interval loses no digits.
    pub(super) fn mass_and_mean(&self, from: f64, to: f64) -> (f64, f64) {
        let step = to - from;
        match self.rise {
            Rise::Power { mass, exponent: 1.0 } => (mass * step, self.position(from + 0.5 * step)),
            Rise::Power { mass, exponent: 2.0 } => {
                let sum = from + to;
                let mean = if sum > 0.0 { (sum - from * to / sum) / 1.5 } else { 0.0 };
                (mass * step * sum, self.position(mean))
            }
            Rise::Power { mass, exponent } => {
                // With r = from/to the mass is ∝ 1 − r^e and its mean is e/(e+1) · to · (1 − r^(e+1))/(1 −
                // r^e).
                let log = (-step / to).ln_1p();
                let lost = -(exponent * log).exp_m1();
                let held = mass * to.powf(exponent) * lost;
                if held.is_nan() || held <= 0.0 {
                    return (0.0, self.position(from + 0.5 * step));
                }
                let ratio = -((exponent + 1.0) * log).exp_m1() / lost;
                (held, self.position((to * ratio * exponent / (exponent + 1.0)).clamp(from, to)))
            }
            Rise::Quartic([a, b, c, d]) => {
                // Taylor coefficients at `from`, each times its power of the step.
                let first = step * (a + from * (2.0 * b + from * (3.0 * c + from * 4.0 * d)));
                let second = step * step * (b + from * (3.0 * c + from * 6.0 * d));
                let third = step * step * step * (c + from * 4.0 * d);
                let fourth = step * step * step * step * d;
                let held = first + second + third + fourth;
                if held.is_nan() || held <= 0.0 {
                    return (0.0, self.position(from + 0.5 * step));
                }
                // ∫ (1 − share of the mass passed) = the mean's way from `from` to `to`.
                let passed = (first / 2.0 + second / 3.0 + third / 4.0 + fourth / 5.0) / held;
                (held, self.position(from + step * (1.0 - passed).clamp(0.0, 1.0)))
            }
        }
    }
}

/// `t^exponent`; one and two dimensions, whose exponents are 1 and 2, are where the time goes.
fn power(t: f64, exponent: f64) -> f64 {
    match exponent {
        1.0 => t,
        2.0 => t * t,
        _ => t.powf(exponent),
    }
}

/// Inverse of [`power`].
fn root(share: f64, exponent: f64) -> f64 {
    match exponent {
        1.0 => share,
        2.0 => share.sqrt(),
        _ => share.powf(1.0 / exponent),
    }
}

/// Root in `[0, 1]` of `c₀ t + … + c₃ t⁴ = sought`, nondecreasing: Newton's method that never leaves its
/// bracket.
fn solve([a, b, c, d]: [f64; 4], sought: f64, guess: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let mut t = guess;
    // Bisection alone would need 53 steps; Newton takes three or four of them.
    for _ in 0..64 {
        let excess = t * (a + t * (b + t * (c + t * d))) - sought;
        if excess == 0.0 {
            break;
        }
        if excess > 0.0 {
            high = t;
        } else {
            low = t;
        }
        let slope = a + t * (2.0 * b + t * (3.0 * c + t * 4.0 * d));
        let newton = t - excess / slope;
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        let moved = (next - t).abs();
        t = next;
        if moved <= 2.0 * f64::EPSILON * t {
            break;
        }
    }
    t
}
