//! Scenes whose answer is known, crossed with every sampler.

use std::f64::consts::PI;

use fsot::{Extent, SampleTable, Site};
use nalgebra::Vector3;

use super::*;
use crate::samplers::{OwenSobol, Sampler, TableSampler, WhiteNoise};

/// One checker, every sampler.
fn every_sampler(check: impl Fn(&str, &dyn Sampler)) {
    let extent = Extent { frames: 2, height: 16, width: 16, spp: 4 };
    let table = SampleTable::white_noise(extent, 4, 3).unwrap();
    check("table", &TableSampler::new(&table));
    check("white noise", &WhiteNoise::new(1));
    check("Owen-Sobol'", &OwenSobol::new(1));
}

fn camera(eye: [f64; 3], target: [f64; 3], vertical_fov_deg: f64) -> Camera {
    Camera { eye: eye.into(), target: target.into(), vertical_fov_deg, lens: None }
}

fn empty(camera: Camera, integrator: Integrator) -> Scene {
    let (objects, lights) = (Vec::new(), Vec::new());
    Scene { name: "test", frames: 1, camera, objects, lights, environment: 0.0, integrator }
}

/// A floor at height 0, wide enough for any camera here, and a camera that looks at its origin from the side.
fn floor(material: Material, integrator: Integrator) -> Scene {
    let mut scene = empty(camera([0.0, 2.0, 4.0], [0.0; 3], 1.0), integrator);
    let plane = Shape::Plane { point: [0.0; 3].into(), normal: Vector3::y() };
    scene.objects.push(Object::at_rest(plane, material));
    scene
}

fn ceiling_light(half: f64, height: f64) -> Light {
    let side = 2.0 * half;
    let corner = [-half, height, -half].into();
    Light::at_rest(
        Rectangle { corner, edge_u: [side, 0.0, 0.0].into(), edge_v: [0.0, 0.0, side].into() },
        3.0,
    )
}

/// Mean over the film's pixels and the standard error from their spread: all pixels estimate about the same.
fn mean_and_error(film: &Film) -> (f64, f64) {
    let n = film.values().len() as f64;
    let mean = film.values().iter().sum::<f64>() / n;
    let spread = film.values().iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (spread / n).sqrt())
}

/// Checks the mean over a narrow image within five standard errors, plus 1e-4 for the width of the view.
fn check_mean(scene: &Scene, expected: f64, spp: u32) {
    every_sampler(|name, sampler| {
        let (mean, error) = mean_and_error(&render(scene, sampler, [16, 16], spp).unwrap());
        // The table repeats after its four samples, at other pixels: its error is that of fewer samples.
        let allowed = 5.0 * error * if name == "table" { 2.0 } else { 1.0 } + 1e-4 * expected;
        assert!((mean - expected).abs() < allowed, "{name}: {mean} ± {error}, not {expected}");
        assert!(error < 0.1 * expected, "{name}: {error} tells nothing");
    });
}

#[test]
fn a_white_lambertian_furnace_is_one_in_every_pixel() {
    let mut scene = empty(camera([0.0, 0.0, 3.0], [0.0; 3], 60.0), Integrator::LightAndBsdf);
    scene.environment = 1.0;
    let ball = Shape::Sphere { center: [0.0; 3].into(), radius: 1.0 };
    scene.objects.push(Object::at_rest(ball, Material::Lambert { albedo: 1.0 }));
    every_sampler(|name, sampler| {
        for integrator in [Integrator::LightAndBsdf, Integrator::OneBounce] {
            scene_is_one(name, sampler, &Scene { integrator, ..scene.clone() });
        }
    });
}

fn scene_is_one(name: &str, sampler: &dyn Sampler, scene: &Scene) {
    let film = render(scene, sampler, [16, 16], 3).unwrap();
    assert!(film.values().iter().all(|&value| value == 1.0), "{name}");
}

#[test]
fn a_glossy_furnace_loses_what_single_scattering_loses() {
    // Straight from above, the lobe's albedo by quadrature over incoming angles (it is symmetric about the
    // normal): ∫ value_cos 2π sin θ dθ.
    for alpha in [0.1, 0.5, 1.0] {
        let material = Material::Ggx { alpha, reflectance: 1.0 };
        let mut scene = floor(material, Integrator::LightAndBsdf);
        scene.camera = camera([0.0, 5.0, 0.01], [0.0; 3], 0.5);
        scene.environment = 1.0;
        let n = 20_000;
        let albedo: f64 = (0..n)
            .map(|i| {
                let theta = (f64::from(i) + 0.5) / f64::from(n) * PI / 2.0;
                let incoming = Vector3::new(theta.sin(), 0.0, theta.cos());
                material.value_cos(&Vector3::z(), &incoming) * 2.0 * PI * theta.sin() * PI
                    / 2.0
                    / f64::from(n)
            })
            .sum();
        if alpha == 1.0 {
            // There D = 1/π and G2 = 2 cos θ / (1 + cos θ), so the albedo is ∫ c / (1 + c) dc = 1 − ln 2.
            assert!((albedo - (1.0 - 2.0_f64.ln())).abs() < 1e-8, "{albedo}");
        }
        check_mean(&scene, albedo, 16);
    }
}

#[test]
fn an_unblocked_rectangle_gives_lamberts_irradiance() {
    let material = Material::Lambert { albedo: 0.5 };
    for (half, height) in [(0.5, 1.0), (2.0, 0.7)] {
        for integrator in [Integrator::Light, Integrator::LightAndBsdf] {
            let mut scene = floor(material, integrator);
            let light = ceiling_light(half, height);
            scene.lights.push(light);
            // The camera sits outside and must not look through the emitting side.
            scene.camera = camera([0.0, 0.3, 4.0], [0.0; 3], 0.05);
            let expected = 0.5 / PI * light.irradiance([0.0; 3].into(), &Vector3::y());
            check_mean(&scene, expected, 16);
            // Two half lights are the whole one.
            let [mut left, mut right] = [light; 2];
            left.rectangle.edge_u *= 0.5;
            right.rectangle.edge_u *= 0.5;
            right.rectangle.corner += right.rectangle.edge_u;
            scene.lights = vec![left, right];
            check_mean(&scene, expected, 16);
        }
    }
}

#[test]
fn light_samples_and_both_strategies_agree_on_a_glossy_floor() {
    let material = Material::Ggx { alpha: 0.5, reflectance: 0.9 };
    let mut scene = floor(material, Integrator::Light);
    scene.lights.push(ceiling_light(1.0, 1.5));
    scene.camera = camera([0.0, 1.0, 4.0], [0.0; 3], 0.05);
    let by_light = Reference::render(&scene, [4, 4], 16384).unwrap();
    let (expected, _) = mean_and_error(&by_light.mean);
    scene.integrator = Integrator::LightAndBsdf;
    check_mean(&scene, expected, 32);
}

#[test]
fn an_integrating_sphere_spreads_light_evenly() {
    // Within a Lambertian sphere every patch exchanges with every other alike, so a light of flux Φ = π L A
    // gives, after one reflection, the irradiance ρ Φ / (4πR²) everywhere, whatever the place and pose of the
    // light.
    let (albedo, radius) = (0.8, 2.0);
    let mut scene = empty(camera([0.0, 1.0, 0.0], [0.3, 0.5, -2.0], 0.5), Integrator::OneBounce);
    let ball = Shape::Sphere { center: [0.0; 3].into(), radius };
    scene.objects.push(Object::at_rest(ball, Material::Lambert { albedo }));
    // A light below the camera that shines down, so that the wall in view is lit indirectly only.
    let light = ceiling_light(0.1, -1.5);
    scene.lights.push(light);
    let flux = PI * light.radiance * light.rectangle.area();
    let irradiance = albedo * flux / (4.0 * PI * radius * radius);
    check_mean(&scene, albedo / PI * irradiance, 256);
}

#[test]
fn a_heaviside_card_covers_a_segment_of_the_lens() {
    // White background, black half-plane card whose edge crosses the lens at signed distance d (in lens
    // radii) from its centre as seen from the focused point: the free share is (acos d − d √(1−d²)) / π.
    let (radius, focus, depth) = (0.5, 8.0, 2.0);
    for d in [-0.6, 0.0, 0.35, 0.9_f64] {
        let mut camera = camera([0.0; 3], [0.0, 0.0, -1.0], 1e-3);
        camera.lens = Some(Lens { radius, focus_distance: focus });
        let mut scene = empty(camera, Integrator::Light);
        scene.environment = 1.0;
        // A ray that starts at height h on the lens has shrunk to h (1 − depth/focus) at the card.
        let edge = d * radius * (1.0 - depth / focus);
        let card = Rectangle {
            corner: [-100.0, edge - 100.0, -depth].into(),
            edge_u: [200.0, 0.0, 0.0].into(),
            edge_v: [0.0, 100.0, 0.0].into(),
        };
        let black = Material::Lambert { albedo: 0.0 };
        scene.objects.push(Object::at_rest(Shape::Rectangle(card), black));
        let free = (d.acos() - d * (1.0 - d * d).sqrt()) / PI;
        check_mean(&scene, free, 64);
    }
}

#[test]
fn a_heaviside_wall_hides_its_form_factor() {
    // An endless wall of height h at distance d hides (1 − d/√(d² + h²)) / 2 of a cosine-weighted hemisphere.
    for (distance, height) in [(0.5, 0.5), (0.1, 1.0), (1.0, 0.3)] {
        let mut scene =
            floor(Material::Lambert { albedo: 0.5 }, Integrator::AmbientOcclusion { distance: 1e5 });
        scene.camera = camera([2.0, 2.0, 0.0], [0.0; 3], 0.005);
        let wall = Rectangle {
            corner: [-distance, 0.0, -1e4].into(),
            edge_u: [0.0, 0.0, 2e4].into(),
            edge_v: [0.0, height, 0.0].into(),
        };
        scene.objects.push(Object::at_rest(Shape::Rectangle(wall), Material::Lambert { albedo: 0.0 }));
        let hidden = (1.0 - distance / distance.hypot(height)) / 2.0;
        check_mean(&scene, 1.0 - hidden, 64);
    }
    let scene = floor(Material::Lambert { albedo: 0.0 }, Integrator::AmbientOcclusion { distance: 1.0 });
    every_sampler(|name, sampler| scene_is_one(name, sampler, &scene)); // nothing stands there
}

#[test]
fn the_thread_count_changes_nothing() {
    for name in Scene::NAMES {
        let mut scene = Scene::by_name(name).unwrap();
        scene.frames = scene.frames.min(2);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&scene, &WhiteNoise::new(5), [24, 32], 2).unwrap())
        };
        assert_eq!(with(1), with(2), "{name}");
    }
}

#[test]
fn frames_differ_where_something_moves() {
    let mut scene = Scene::by_name("animated_soft_shadow").unwrap();
    assert_eq!(scene.frames, 30);
    scene.frames = 8;
    let film = Reference::render(&scene, [32, 32], 64).unwrap().mean;
    for frame in 1..8 {
        let pairs = film.frame(frame).unwrap().iter().zip(film.frame(frame - 1).unwrap());
        let changed = pairs.filter(|(a, b)| (*a - *b).abs() > 0.05).count();
        assert!(changed > 0 && changed < 32 * 32 / 2, "frame {frame}: {changed}");
    }
}

#[test]
fn only_stated_dimensions_are_drawn() {
    struct Watch<'w>(&'w (dyn Fn(u32) + Sync));
    impl Sampler for Watch<'_> {
        fn sample(&self, site: Site, sample: u32, dim: u32) -> f32 {
            (self.0)(dim);
            WhiteNoise::new(2).sample(site, sample, dim)
        }
    }
    for name in Scene::NAMES {
        let mut scene = Scene::by_name(name).unwrap();
        scene.frames = 1;
        let seen = std::sync::Mutex::new(std::collections::BTreeSet::new());
        let note = |dim| {
            seen.lock().unwrap().insert(dim as usize);
        };
        render(&scene, &Watch(&note), [16, 16], 1).unwrap();
        let seen: Vec<usize> = seen.into_inner().unwrap().into_iter().collect();
        assert_eq!(seen, (0..scene.dims()).collect::<Vec<_>>(), "{name}");
        assert_eq!(scene.dims(), if name == "defocus" || name == "glossy" { 4 } else { 2 });
    }
}

#[test]
fn an_empty_picture_is_refused() {
    let scene = Scene::by_name("soft_shadow").unwrap();
    let error = render(&scene, &WhiteNoise::new(0), [16, 16], 0).unwrap_err();
    assert!(error.to_string().contains("spp is 0"), "{error}");
    assert!(render(&scene, &WhiteNoise::new(0), [0, 16], 1).is_err());
    assert!(Scene::by_name("no such scene").is_none());
}
