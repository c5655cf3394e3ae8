//! Reflection: Lambert's, and a GGX microfacet lobe with a constant Fresnel factor.
//!
//! Directions are unit vectors in a frame whose third axis is the surface normal and point away from the
//! surface; both have positive third components, else nothing is reflected.

use std::f64::consts::{FRAC_1_PI, TAU};

use fsot::targets::VectorMap;
use nalgebra::{Matrix3, Vector3};

/// What a surface does with light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Reflects evenly.
    Lambert {
        /// Reflected share, in `[0, 1]`.
        albedo: f64,
    },
    /// GGX microfacets[^walter] with height-correlated Smith masking[^heitz] and single scattering.
    ///
    /// Light that would bounce between facets is lost, so even with `reflectance` 1 a rough lobe reflects
    /// less than it receives. What is exactly 1 is the *weak* white furnace: the lobe without shadowing,
    /// integrated over the whole sphere.
    ///
    /// [^walter]: Walter, Marschner, Li, Torrance 2007, "Microfacet models for refraction".
    /// [^heitz]: Heitz 2014, "Understanding the masking-shadowing function", JCGT 3(2).
    Ggx {
        /// Roughness of the distribution of normals, in `[0.01, 1]`.
        alpha: f64,
        /// Reflected share at every facet, in `[0, 1]`.
        reflectance: f64,
    },
}

impl Material {
    /// Whether nothing is ever reflected.
    pub fn is_black(&self) -> bool {
        matches!(self, Material::Lambert { albedo: 0.0 } | Material::Ggx { reflectance: 0.0, .. })
    }

    /// Value times the cosine of `incoming`, in 1/steradian.
    pub fn value_cos(&self, outgoing: &Vector3<f64>, incoming: &Vector3<f64>) -> f64 {
        if outgoing.z <= 0.0 || incoming.z <= 0.0 {
            return 0.0;
        }
        match *self {
            Material::Lambert { albedo } => albedo * FRAC_1_PI * incoming.z,
            Material::Ggx { alpha, reflectance } => {
                let half = (outgoing + incoming).normalize();
                let masking = 1.0 / (1.0 + lambda(outgoing, alpha) + lambda(incoming, alpha));
                reflectance * facets(&half, alpha) * masking / (4.0 * outgoing.z)
            }
        }
    }

    /// Density per steradian with which [`sample`](Self::sample) finds `incoming`.
    pub fn density(&self, outgoing: &Vector3<f64>, incoming: &Vector3<f64>) -> f64 {
        match *self {
            Material::Lambert { .. } => FRAC_1_PI * incoming.z.max(0.0),
            Material::Ggx { alpha, .. } => {
                let half = (outgoing + incoming).normalize();
                facets(&half, alpha) / (1.0 + lambda(outgoing, alpha)) / (4.0 * outgoing.z)
            }
        }
    }

    /// A direction from two uniform numbers: cosine-weighted for Lambert, from the distribution of visible
    /// normals for GGX[^caps]. The latter may point below the surface, where the value is 0.
    ///
    /// [^caps]: Dupuy and Benyoub 2023, "Sampling visible GGX normals with spherical caps".
    pub fn sample(&self, outgoing: &Vector3<f64>, uv: [f64; 2]) -> Vector3<f64> {
        match *self {
            Material::Lambert { .. } => cosine_hemisphere(uv),
            Material::Ggx { alpha, .. } => {
                let stretched = Vector3::new(alpha * outgoing.x, alpha * outgoing.y, outgoing.z).normalize();
                let z = (1.0 - uv[1]) * (1.0 + stretched.z) - stretched.z;
                let r = (1.0 - z * z).max(0.0).sqrt();
                let (sin, cos) = (TAU * uv[0]).sin_cos();
                let cap = Vector3::new(r * cos, r * sin, z) + stretched;
                let half = Vector3::new(alpha * cap.x, alpha * cap.y, cap.z.max(0.0)).normalize();
                half * (2.0 * outgoing.dot(&half)) - outgoing
            }
        }
    }
}

/// GGX distribution of normals, per steradian; its cosine-weighted integral is 1.
fn facets(half: &Vector3<f64>, alpha: f64) -> f64 {
    if half.z <= 0.0 {
        return 0.0;
    }
    let slope_sq = (half.x * half.x + half.y * half.y) / (alpha * alpha);
    FRAC_1_PI / (alpha * alpha * (slope_sq + half.z * half.z).powi(2))
}

/// Smith's auxiliary function of GGX; masking is `1 / (1 + Λ)`.
fn lambda(direction: &Vector3<f64>, alpha: f64) -> f64 {
    let cos_sq = direction.z * direction.z;
    let tan_sq = (1.0 - cos_sq).max(0.0) / cos_sq;
    ((1.0 + alpha * alpha * tan_sq).sqrt() - 1.0) / 2.0
}

/// A direction above the surface with density cos θ / π.
pub fn cosine_hemisphere(uv: [f64; 2]) -> Vector3<f64> {
    VectorMap::CosineHemisphere.vector(uv).into()
}

/// A rotation whose columns are two tangents and the unit normal (Duff et al. 2017).
pub fn frame(normal: &Vector3<f64>) -> Matrix3<f64> {
    let sign = 1.0_f64.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vector3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let bitangent = Vector3::new(b, sign + normal.y * normal.y * a, -normal.y);
    Matrix3::from_columns(&[tangent, bitangent, *normal])
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn towards(cos: f64) -> Vector3<f64> {
        Vector3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
    }

    /// Midpoint rule over the sphere, in the polar angle and azimuth.
    fn integral(integrand: impl Fn(&Vector3<f64>) -> f64) -> f64 {
        let (rows, columns) = (800, 400);
        let (dt, dp) = (TAU / 2.0 / f64::from(rows), TAU / f64::from(columns));
        (0..rows * columns)
            .map(|i| {
                let (theta, phi) = ((f64::from(i / columns) + 0.5) * dt, (f64::from(i % columns) + 0.5) * dp);
                let (sin, cos) = theta.sin_cos();
                integrand(&Vector3::new(sin * phi.cos(), sin * phi.sin(), cos)) * sin * dt * dp
            })
            .sum()
    }

    #[test]
    fn weak_white_furnace_is_one() {
        // ∫ G1(o) D(h) / (4 cos o) over the sphere of incoming directions (Heitz 2014, eq. 86): the density
        // of visible-normal sampling, so this is also its normalisation. The midpoint rule on 800 x 400
        // points meets a jump at h·n = 0: its error is of the order of 1/800.
        for (alpha, cos) in [(0.15, 0.9), (0.5, 0.5), (1.0, 0.2), (1.0, 1.0)] {
            let ggx = Material::Ggx { alpha, reflectance: 1.0 };
            let outgoing = towards(cos);
            assert_relative_eq!(integral(|i| ggx.density(&outgoing, i)), 1.0, epsilon = 1.5e-3);
        }
    }

    #[test]
    fn reflection_is_reciprocal_and_loses_energy() {
        for alpha in [0.2, 0.6, 1.0] {
            let ggx = Material::Ggx { alpha, reflectance: 1.0 };
            let (a, b) = (towards(0.7), Vector3::new(-0.48, 0.6, 0.64));
            assert_relative_eq!(
                ggx.value_cos(&a, &b) * a.z,
                ggx.value_cos(&b, &a) * b.z,
                max_relative = 1e-12
            );
            let albedo = integral(|i| ggx.value_cos(&a, i));
            assert!(albedo < 1.0 && albedo > 0.3, "{alpha}: {albedo}");
        }
        let smooth = Material::Ggx { alpha: 0.05, reflectance: 1.0 };
        assert_relative_eq!(integral(|i| smooth.value_cos(&towards(0.9), i)), 1.0, epsilon = 5e-3);
        let lambert = Material::Lambert { albedo: 0.8 };
        assert_relative_eq!(integral(|i| lambert.value_cos(&towards(0.3), i)), 0.8, epsilon = 1e-4);
    }

    #[test]
    fn sampling_has_the_stated_density() {
        // Mean of value / density over a 256² midpoint grid of numbers against the quadrature of the value.
        for material in [Material::Ggx { alpha: 0.4, reflectance: 1.0 }, Material::Lambert { albedo: 1.0 }] {
            for cos in [0.9, 0.3] {
                let outgoing = towards(cos);
                // An asymmetric test function, so that a mirrored direction would show.
                let test =
                    |i: &Vector3<f64>| material.value_cos(&outgoing, i) * (1.0 + 0.5 * i.x + 0.3 * i.y * i.z);
                let n = 256;
                let mean = (0..n * n)
                    .map(|k| {
                        let uv = [k / n, k % n].map(|c| (f64::from(c) + 0.5) / f64::from(n));
                        let incoming = material.sample(&outgoing, uv);
                        assert_relative_eq!(incoming.norm(), 1.0, epsilon = 1e-9);
                        let value = test(&incoming);
                        if value == 0.0 { 0.0 } else { value / material.density(&outgoing, &incoming) }
                    })
                    .sum::<f64>()
                    / f64::from(n * n);
                assert_relative_eq!(mean, integral(test), epsilon = 1e-3);
            }
        }
    }

    #[test]
    fn frames_are_rotations() {
        for normal in [Vector3::z(), -Vector3::z(), Vector3::x(), Vector3::new(0.48, -0.6, 0.64)] {
            let frame = frame(&normal);
            assert_relative_eq!(frame.determinant(), 1.0, epsilon = 1e-12);
            assert_relative_eq!(frame.transpose() * frame, Matrix3::identity(), epsilon = 1e-12);
            assert_eq!(frame.column(2), normal);
        }
    }
}
