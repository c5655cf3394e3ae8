//! Convex primitives and their intersection with rays.

use nalgebra::{Point3, Vector3};

/// A half-line; `direction` need not have unit length, and parameters are in units of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: Point3<f64>,
    /// Where it goes.
    pub direction: Vector3<f64>,
}

impl Ray {
    /// The point at parameter `t`.
    pub fn at(&self, t: f64) -> Point3<f64> {
        self.origin + self.direction * t
    }
}

/// A rectangle with perpendicular edges, seen from both sides; its normal is along `edge_u × edge_v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// The corner at `(u, v) = (0, 0)`.
    pub corner: Point3<f64>,
    /// From the corner to `(1, 0)`.
    pub edge_u: Vector3<f64>,
    /// From the corner to `(0, 1)`; perpendicular to `edge_u`.
    pub edge_v: Vector3<f64>,
}

impl Rectangle {
    /// The point at `(u, v)` in the unit square; uniform numbers give uniform points.
    pub fn at(&self, [u, v]: [f64; 2]) -> Point3<f64> {
        self.corner + self.edge_u * u + self.edge_v * v
    }

    /// The four corners, in order around the rectangle.
    pub fn corners(&self) -> [Point3<f64>; 4] {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|uv| self.at(uv))
    }

    /// Unit normal.
    pub fn normal(&self) -> Vector3<f64> {
        self.edge_u.cross(&self.edge_v).normalize()
    }

    /// Area in square scene units.
    pub fn area(&self) -> f64 {
        self.edge_u.cross(&self.edge_v).norm()
    }

    /// Ray parameter of the hit, above 0.
    pub fn hit(&self, ray: &Ray) -> Option<f64> {
        let normal = self.edge_u.cross(&self.edge_v);
        let t = (self.corner - ray.origin).dot(&normal) / ray.direction.dot(&normal);
        let at = ray.at(t) - self.corner;
        let inside = |edge: &Vector3<f64>| (0.0..=edge.norm_squared()).contains(&at.dot(edge));
        // A parallel ray has t infinite or NaN and lies inside neither edge.
        (t > 0.0 && inside(&self.edge_u) && inside(&self.edge_v)).then_some(t)
    }
}

/// A primitive. Every one is convex, on which the test for full shadow relies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// An infinite plane.
    Plane {
        /// Any of its points.
        point: Point3<f64>,
        /// Unit normal.
        normal: Vector3<f64>,
    },
    /// A sphere, also seen from within.
    Sphere {
        /// Centre.
        center: Point3<f64>,
        /// Radius, above 0.
        radius: f64,
    },
    /// A rectangle.
    Rectangle(Rectangle),
    /// A box along the axes, also seen from within.
    Cuboid {
        /// Least corner.
        min: Point3<f64>,
        /// Greatest corner.
        max: Point3<f64>,
    },
}

impl Shape {
    /// The shape displaced.
    pub fn moved(self, by: Vector3<f64>) -> Self {
        match self {
            Shape::Plane { point, normal } => Shape::Plane { point: point + by, normal },
            Shape::Sphere { center, radius } => Shape::Sphere { center: center + by, radius },
            Shape::Rectangle(rectangle) => {
                Shape::Rectangle(Rectangle { corner: rectangle.corner + by, ..rectangle })
            }
            Shape::Cuboid { min, max } => Shape::Cuboid { min: min + by, max: max + by },
        }
    }

    /// Parameter (above 0) of the first hit and the unit normal there, on whichever side it points.
    pub fn hit(&self, ray: &Ray) -> Option<(f64, Vector3<f64>)> {
        match self {
            Shape::Plane { point, normal } => {
                let t = (point - ray.origin).dot(normal) / ray.direction.dot(normal);
                (t > 0.0 && t.is_finite()).then_some((t, *normal))
            }
            Shape::Sphere { center, radius } => {
                let t = first_root(ray, *center, *radius)?;
                Some((t, (ray.at(t) - center) / *radius))
            }
            Shape::Rectangle(rectangle) => Some((rectangle.hit(ray)?, rectangle.normal())),
            Shape::Cuboid { min, max } => {
                let (enter, exit) = slabs(ray, min, max)?;
                let (t, axis) = if enter.0 > 0.0 { enter } else { exit };
                let mut normal = Vector3::zeros();
                normal[axis] = 1.0;
                (t > 0.0).then_some((t, normal))
            }
        }
    }

    /// Whether the surface meets the open segment from the ray's origin to `t = 1`, less a rounding margin.
    pub fn blocks(&self, ray: &Ray) -> bool {
        self.hit(ray).is_some_and(|(t, _)| t < 1.0 - 1e-9)
    }

    /// Whether the point is not within the solid. Seen from there, the region behind the shape is convex:
    /// with two points it holds the segment between them.
    pub fn excludes(&self, point: Point3<f64>) -> bool {
        match self {
            Shape::Plane { .. } | Shape::Rectangle(_) => true,
            Shape::Sphere { center, radius } => (point - center).norm() >= *radius,
            Shape::Cuboid { min, max } => (0..3).any(|i| point[i] <= min[i] || point[i] >= max[i]),
        }
    }

    /// Whether no point of the shape lies within `distance` of `point` *and* above the plane there.
    ///
    /// Conservative: `true` is always right, `false` may be over-careful.
    pub fn is_beyond(&self, point: Point3<f64>, normal: Vector3<f64>, distance: f64) -> bool {
        // Points of the plane itself, reached only by rounding, do not count as above it.
        const ON_PLANE: f64 = 1e-9;
        match self {
            Shape::Plane { point: on, normal: other } => {
                let height = (on - point).dot(other).abs();
                height >= distance || (height <= ON_PLANE && normal.cross(other).norm() < ON_PLANE)
            }
            Shape::Sphere { center, radius } => {
                let to = center - point;
                (to.norm() - radius).abs() >= distance || to.dot(&normal) + radius <= ON_PLANE
            }
            Shape::Rectangle(rectangle) => {
                let (u, v) = (rectangle.edge_u, rectangle.edge_v);
                let inside = |edge: Vector3<f64>| {
                    ((point - rectangle.corner).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0)
                };
                let nearest = rectangle.at([inside(u), inside(v)]);
                let below = |corner: Point3<f64>| (corner - point).dot(&normal) <= ON_PLANE;
                (nearest - point).norm() >= distance || rectangle.corners().into_iter().all(below)
            }
            Shape::Cuboid { min, max } => {
                let nearest = point.coords.sup(&min.coords).inf(&max.coords);
                let (center, half) = (nalgebra::center(min, max), (max - min) / 2.0);
                let reach = half.dot(&normal.abs());
                let within = (nearest - point.coords).norm() < distance;
                !within || (center - point).dot(&normal) + reach <= ON_PLANE
            }
        }
    }
}

/// Smallest positive root of the ray against a sphere, by the formula without cancellation.
fn first_root(ray: &Ray, center: Point3<f64>, radius: f64) -> Option<f64> {
    let from = ray.origin - center;
    let a = ray.direction.norm_squared();
    let half_b = ray.direction.dot(&from);
    let c = from.norm_squared() - radius * radius;
    let discriminant = half_b * half_b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -(half_b + discriminant.sqrt().copysign(half_b));
    let (one, two) = (q / a, c / q);
    let (near, far) = if one < two { (one, two) } else { (two, one) };
    if near > 0.0 { Some(near) } else { (far > 0.0).then_some(far) }
}

/// Where the ray enters and leaves the box, each with its axis; entry may lie behind the origin.
fn slabs(ray: &Ray, min: &Point3<f64>, max: &Point3<f64>) -> Option<((f64, usize), (f64, usize))> {
    let mut enter = (f64::NEG_INFINITY, 0);
    let mut exit = (f64::INFINITY, 0);
    for axis in 0..3 {
        let inverse = ray.direction[axis].recip();
        let a = (min[axis] - ray.origin[axis]) * inverse;
        let b = (max[axis] - ray.origin[axis]) * inverse;
        if a.min(b) > enter.0 {
            enter = (a.min(b), axis);
        }
        if a.max(b) < exit.0 {
            exit = (a.max(b), axis);
        }
    }
    (enter.0 < exit.0).then_some((enter, exit))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray { origin: origin.into(), direction: direction.into() }
    }

    #[test]
    fn hits_are_where_geometry_says() {
        let sphere = Shape::Sphere { center: [0.0, 0.0, 3.0].into(), radius: 1.0 };
        assert_eq!(sphere.hit(&ray([0.0; 3], [0.0, 0.0, 1.0])).unwrap().0, 2.0);
        assert_eq!(sphere.hit(&ray([0.0, 0.0, 3.0], [0.0, 0.0, 2.0])).unwrap().0, 0.5);
        assert!(sphere.hit(&ray([0.0; 3], [0.0, 0.0, -1.0])).is_none());
        let cuboid = Shape::Cuboid { min: [-1.0, -1.0, 2.0].into(), max: [1.0, 1.0, 4.0].into() };
        assert_eq!(cuboid.hit(&ray([0.0; 3], [0.0, 0.0, 1.0])), Some((2.0, Vector3::z())));
        assert_eq!(cuboid.hit(&ray([0.0, 0.0, 3.0], [4.0, 0.0, 0.0])), Some((0.25, Vector3::x())));
        assert!(cuboid.hit(&ray([2.0, 0.0, 0.0], [0.0, 0.0, 1.0])).is_none());
        assert!(!cuboid.blocks(&ray([0.0, 0.0, 3.0], [0.0, 0.1, 0.0]))); // stays within
        assert!(!cuboid.blocks(&ray([0.0; 3], [0.0, 0.0, 1.9])));
        let plane = Shape::Plane { point: [0.0, -1.0, 0.0].into(), normal: Vector3::y() };
        assert_eq!(plane.hit(&ray([0.0; 3], [1.0, -1.0, 0.0])).unwrap().0, 1.0);
        assert!(plane.hit(&ray([0.0; 3], [1.0, 0.0, 0.0])).is_none());
    }

    #[test]
    fn a_rectangle_ends_at_its_edges() {
        let (edge_u, edge_v) = ([2.0, 0.0, 0.0].into(), [0.0, 3.0, 0.0].into());
        let card = Rectangle { corner: [0.0, 0.0, 5.0].into(), edge_u, edge_v };
        let hits = |x, y| card.hit(&ray([x, y, 0.0], [0.0, 0.0, 1.0])).is_some();
        assert!(hits(0.1, 0.1) && hits(1.9, 2.9));
        assert!(!hits(-0.1, 0.1) && !hits(0.1, 3.1) && !hits(2.1, 0.1));
        assert!(card.hit(&ray([0.5, 0.5, 5.0], [1.0, 0.0, 0.0])).is_none()); // within its plane
        assert_eq!((card.area(), card.normal()), (6.0, Vector3::z()));
        assert_eq!(card.at([0.5, 0.5]), Point3::new(1.0, 1.5, 5.0));
    }

    #[test]
    fn beyond_is_never_claimed_of_a_shape_that_rays_reach() {
        let shapes = [
            Shape::Sphere { center: [0.3, 1.2, 0.1].into(), radius: 0.5 },
            Shape::Sphere { center: [0.0, 0.0, 0.0].into(), radius: 3.0 },
            Shape::Cuboid { min: [0.5, -1.0, -1.0].into(), max: [1.0, 0.8, 2.0].into() },
            Shape::Plane { point: [0.0, 0.0, 0.0].into(), normal: Vector3::y() },
            Shape::Plane { point: [0.0, 0.7, 0.0].into(), normal: [0.6, 0.8, 0.0].into() },
            Shape::Rectangle(Rectangle {
                corner: [-1.0, 0.9, -1.0].into(),
                edge_u: [1.0, 0.0, 0.0].into(),
                edge_v: [0.0, 0.0, 3.0].into(),
            }),
        ];
        let mut claimed = 0;
        for (case, shape) in shapes.iter().enumerate() {
            for distance in [0.2, 0.6, 1.0, 2.0] {
                let beyond = shape.is_beyond(Point3::origin(), Vector3::y(), distance);
                claimed += u32::from(beyond);
                let reached = (0..4096).any(|i| {
                    let (u, v) = (f64::from(i % 64) + 0.5, f64::from(i / 64) + 0.5);
                    let (y, phi) = (u / 64.0, v / 64.0 * std::f64::consts::TAU);
                    let r = (1.0 - y * y).sqrt();
                    let direction = [r * phi.cos(), y, r * phi.sin()].map(|c| c * distance);
                    shape.blocks(&ray([0.0, 1e-7, 0.0], direction))
                });
                assert!(!(beyond && reached), "shape {case} at distance {distance}");
            }
        }
        assert!(claimed >= 8, "{claimed}"); // and the claim is made where it is true
    }
}
