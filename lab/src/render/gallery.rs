//! The five validation scenes.

use nalgebra::Vector3;

use super::bsdf::Material;
use super::camera::{Camera, Lens};
use super::light::Light;
use super::scene::{Integrator, Object, Scene};
use super::shape::{Rectangle, Shape};

impl Scene {
    /// Names of the validation scenes.
    pub const NAMES: [&'static str; 5] =
        ["soft_shadow", "defocus", "glossy", "ambient_occlusion", "animated_soft_shadow"];

    /// The validation scene with this name.
    ///
    /// | name | dimensions | frames | what varies |
    /// |---|---|---|---|
    /// | `soft_shadow` | light | 1 | penumbrae of a sphere and a box, the fall-off of an area light |
    /// | `defocus` | lens, light | 1 | three spheres at different depths, two out of focus |
    /// | `glossy` | light, bsdf | 1 | rough floor and spheres, three lights, multiple importance sampling |
    /// | `ambient_occlusion` | direction | 1 | contact shadows within 1.5 units |
    /// | `animated_soft_shadow` | light | 30 | a sphere that crosses the floor |
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "soft_shadow" => Some(soft_shadow()),
            "defocus" => Some(defocus()),
            "glossy" => Some(glossy()),
            "ambient_occlusion" => Some(ambient_occlusion()),
            "animated_soft_shadow" => Some(animated_soft_shadow()),
            _ => None,
        }
    }
}

const GREY: Material = Material::Lambert { albedo: 0.7 };

fn sphere(center: [f64; 3], radius: f64, material: Material) -> Object {
    Object::at_rest(Shape::Sphere { center: center.into(), radius }, material)
}

fn cuboid(min: [f64; 3], max: [f64; 3], material: Material) -> Object {
    Object::at_rest(Shape::Cuboid { min: min.into(), max: max.into() }, material)
}

/// A square floor around the origin at height 0, so that there is a background beyond it.
fn floor(half_side: f64, material: Material) -> Object {
    let side = 2.0 * half_side;
    Object::at_rest(
        Shape::Rectangle(Rectangle {
            corner: [-half_side, 0.0, -half_side].into(),
            edge_u: [0.0, 0.0, side].into(),
            edge_v: [side, 0.0, 0.0].into(),
        }),
        material,
    )
}

/// A square light that shines down from around `center`.
fn lamp(center: [f64; 3], side: f64, radiance: f64) -> Light {
    let corner = [center[0] - side / 2.0, center[1], center[2] - side / 2.0].into();
    let (edge_u, edge_v) = ([side, 0.0, 0.0].into(), [0.0, 0.0, side].into());
    Light::at_rest(Rectangle { corner, edge_u, edge_v }, radiance)
}

fn camera(eye: [f64; 3], target: [f64; 3]) -> Camera {
    Camera { eye: eye.into(), target: target.into(), vertical_fov_deg: 40.0, lens: None }
}

fn soft_shadow() -> Scene {
    Scene {
        name: "soft_shadow",
        frames: 1,
        camera: camera([0.0, 3.2, 6.5], [0.0, 0.7, 0.0]),
        objects: vec![
            floor(3.5, GREY),
            sphere([-1.0, 1.2, 0.3], 0.8, GREY),
            cuboid([0.6, 0.0, -0.9], [1.6, 1.6, 0.1], GREY),
        ],
        lights: vec![lamp([-1.2, 4.2, 1.0], 2.2, 6.0)],
        environment: 0.0,
        integrator: Integrator::Light,
    }
}

fn defocus() -> Scene {
    let mut camera = camera([0.0, 1.8, 7.0], [0.0, 0.8, 0.0]);
    camera.lens = Some(Lens { radius: 0.22, focus_distance: 7.0 });
    Scene {
        name: "defocus",
        frames: 1,
        camera,
        objects: vec![
            floor(5.0, GREY),
            sphere([-0.9, 0.6, 2.8], 0.6, GREY),
            sphere([0.1, 0.8, 0.0], 0.8, GREY),
            sphere([1.9, 0.9, -3.2], 0.9, GREY),
        ],
        lights: vec![lamp([-0.8, 5.0, 3.2], 1.6, 16.0)],
        environment: 0.0,
        integrator: Integrator::Light,
    }
}

fn glossy() -> Scene {
    let lobe = |alpha| Material::Ggx { alpha, reflectance: 0.8 };
    // Three upright lights at the back that face the viewer, each mirrored in the floor.
    let back = |x: f64, width: f64, radiance: f64| {
        let corner = [x - width / 2.0, 0.8, -3.0].into();
        let (edge_u, edge_v) = ([width, 0.0, 0.0].into(), [0.0, 1.4, 0.0].into());
        Light::at_rest(Rectangle { corner, edge_u, edge_v }, radiance)
    };
    Scene {
        name: "glossy",
        frames: 1,
        camera: camera([0.0, 2.6, 7.5], [0.0, 0.7, 0.0]),
        objects: vec![
            floor(4.0, lobe(0.25)),
            sphere([-1.8, 0.6, 0.6], 0.6, lobe(0.5)),
            sphere([0.0, 0.6, 0.6], 0.6, lobe(0.3)),
            sphere([1.8, 0.6, 0.6], 0.6, lobe(0.15)),
        ],
        lights: vec![
            back(-2.2, 0.4, 12.0),
            back(0.0, 1.2, 6.0),
            back(2.2, 0.4, 12.0),
            lamp([0.0, 4.5, 2.0], 1.5, 9.0),
        ],
        environment: 0.0,
        integrator: Integrator::LightAndBsdf,
    }
}

fn ambient_occlusion() -> Scene {
    Scene {
        name: "ambient_occlusion",
        integrator: Integrator::AmbientOcclusion { distance: 1.5 },
        lights: Vec::new(),
        objects: vec![
            floor(4.0, GREY),
            sphere([-1.1, 0.8, 0.0], 0.8, GREY),
            cuboid([0.5, 0.0, -1.0], [1.5, 1.6, 0.0], GREY),
            cuboid([0.1, 0.0, 0.6], [2.2, 0.4, 1.0], GREY),
        ],
        ..soft_shadow()
    }
}

fn animated_soft_shadow() -> Scene {
    let mut scene = soft_shadow();
    scene.name = "animated_soft_shadow";
    scene.frames = 30;
    // About one pixel a frame at 128 × 128.
    scene.objects[1] = sphere([-1.9, 1.0, 0.8], 0.6, GREY);
    scene.objects[1].velocity = Vector3::new(0.05, 0.0, 0.0);
    scene
}
