//! The images of tools: mirrored at planes through the middle, at a plane anywhere, repeated about an axis.

use super::matrix::{Matrix, Vector, apply, dot, minus, times, transposed, unit};
use super::statement::Axes;

/// None, or a mirror plane between two voxels (`Even`) or through one (`Odd`).
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Mirror {
    Off,
    Even,
    Odd,
}

/// A mirror plane anywhere: a point in voxels, and a direction in the world.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plane {
    pub at: Vector,
    pub normal: Vector,
}

/// An axis about which tools are repeated: a point in voxels, and a direction in the world.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Radial {
    pub count: u32,
    pub about: Vector,
    pub axis: Vector,
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Symmetry {
    pub mirrors: [Mirror; 3],
    pub plane: Option<Plane>,
    pub radial: Option<Radial>,
}

/// An isometry of the world, between points in voxels of certain edges.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    linear: Matrix,
    offset: Vector,
    edges: Vector,
}

const AS_IT_IS: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Image {
    /// Returns the linear map about a fixed point (voxels).
    fn about(at: Vector, linear: Matrix, edges: Vector) -> Image {
        let at = std::array::from_fn(|i| at[i] * edges[i]);
        Image { linear, offset: minus(at, apply(&linear, at)), edges }
    }

    fn mirror(plane: &Plane, edges: Vector) -> Image {
        let n = unit(plane.normal);
        let linear =
            std::array::from_fn(|i| std::array::from_fn(|k| AS_IT_IS[i][k] - 2.0 * n[i] * n[k]));
        Image::about(plane.at, linear, edges)
    }

    /// Returns the `k`th turn, by Rodrigues' formula.
    fn turn(radial: &Radial, k: u32, edges: Vector) -> Image {
        let [x, y, z] = unit(radial.axis);
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(radial.count)).sin_cos();
        let across = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        let squared = times(&across, &across);
        let linear = std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                AS_IT_IS[i][k] + sin * across[i][k] + (1.0 - cos) * squared[i][k]
            })
        });
        Image::about(radial.about, linear, edges)
    }

    fn then(&self, next: &Image) -> Image {
        let offset = apply(&next.linear, self.offset);
        Image {
            linear: times(&next.linear, &self.linear),
            offset: std::array::from_fn(|i| offset[i] + next.offset[i]),
            edges: self.edges,
        }
    }

    /// Returns the image of a point (voxels).
    pub fn point(&self, p: Vector) -> Vector {
        let p = apply(&self.linear, std::array::from_fn(|i| p[i] * self.edges[i]));
        std::array::from_fn(|i| (p[i] + self.offset[i]) / self.edges[i])
    }

    /// Returns the point (voxels) whose image is `p`.
    pub fn origin(&self, p: Vector) -> Vector {
        let p = std::array::from_fn(|i| p[i] * self.edges[i] - self.offset[i]);
        let p = apply(&transposed(&self.linear), p);
        std::array::from_fn(|i| p[i] / self.edges[i])
    }
}

impl Symmetry {
    pub const OFF: Symmetry = Symmetry { mirrors: [Mirror::Off; 3], plane: None, radial: None };

    pub fn image_count(&self) -> usize {
        let mirrors = self.mirrors.iter().filter(|m| **m != Mirror::Off).count();
        let planes = mirrors + usize::from(self.plane.is_some());
        (1 << planes) * self.radial.map_or(1, |radial| radial.count as usize)
    }

    /// Returns the images of a tool, itself included: mirrored at each plane, then all of them about the axis.
    pub fn images(&self, dims: [usize; 3], edges: Vector) -> Vec<Image> {
        let mut images = vec![Image { linear: AS_IT_IS, offset: [0.0; 3], edges }];
        let mirrors = self.mirrors.into_iter().enumerate().filter_map(|(axis, mirror)| {
            let middle = (dims[axis] / 2) as f64;
            let at = match mirror {
                Mirror::Off => return None,
                Mirror::Even => middle,
                Mirror::Odd => middle + 0.5,
            };
            Some(Plane { at: [at; 3], normal: AS_IT_IS[axis] })
        });
        for plane in mirrors.chain(self.plane) {
            let mirror = Image::mirror(&plane, edges);
            let mirrored: Vec<Image> = images.iter().map(|image| image.then(&mirror)).collect();
            images.extend(mirrored);
        }
        let Some(radial) = self.radial else { return images };
        let turns = (0..radial.count).map(|k| Image::turn(&radial, k, edges));
        turns.flat_map(|turn| images.iter().map(move |image| image.then(&turn))).collect()
    }

    /// Returns the same symmetry about the same voxels after a grid of `dims` voxels was oriented.
    pub fn oriented(&self, dims: [usize; 3], axes: &Axes) -> Symmetry {
        let mut oriented = *self;
        let point = |p: Vector| {
            let mut to = p;
            for (i, &(axis, reversed)) in axes.iter().enumerate() {
                to[axis] = if reversed { dims[i] as f64 - p[i] } else { p[i] };
            }
            to
        };
        let direction = |v: Vector| {
            let mut to = v;
            for (i, &(axis, reversed)) in axes.iter().enumerate() {
                to[axis] = if reversed { -v[i] } else { v[i] };
            }
            to
        };
        for (i, &(axis, _)) in axes.iter().enumerate() {
            oriented.mirrors[axis] = self.mirrors[i];
        }
        oriented.plane = self
            .plane
            .map(|Plane { at, normal }| Plane { at: point(at), normal: direction(normal) });
        oriented.radial = self.radial.map(|Radial { count, about, axis }| Radial {
            count,
            about: point(about),
            axis: direction(axis),
        });
        oriented
    }
}

/// Returns whether a direction is nearly along an axis.
pub fn is_along_axis(v: Vector) -> bool {
    v.iter().filter(|c| c.abs() > 1e-9 * dot(v, v).sqrt()).count() == 1
}
