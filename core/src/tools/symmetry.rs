//! Symmetry: computes the images of a tool that are applied together with it.
//!
//! Mirror planes are perpendicular to the grid axes at its centre, between two voxels (even) or through the middle of
//! one (odd); one more may lie anywhere; and tools may be repeated around an axis. Images preserve lengths and angles
//! in the world, also where voxels are not cubes. Computes images of points, directions and rotations; knows no tool.

use glam::{DMat3, DQuat, DVec3, IVec3, Mat3, Quat, UVec3, Vec3};

use crate::refusal::InvalidValue;
use crate::sculpture::canvas_frame::CanvasFrame;
use crate::sculpture::orientation::Orientation;

/// The position of a mirror plane relative to the voxels.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Parity {
    /// Between two voxels: mirrored shapes have an even number of voxels across.
    Even,
    /// Through the middle of a voxel, which is its own image.
    Odd,
}

impl Parity {
    /// Both parities.
    pub const ALL: [Parity; 2] = [Parity::Even, Parity::Odd];

    /// Returns the name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            Parity::Even => "even",
            Parity::Odd => "odd",
        }
    }
}

/// Greatest number of images of a tool.
pub const MAX_IMAGES: usize = 64;
/// Greatest distance from the origin, in voxels.
const FURTHEST_VX: f32 = 1e6;

/// A mirror plane in any position.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MirrorPlane {
    /// A point of the plane, in voxel coordinates.
    pub at_vx: Vec3,
    /// Normal in the world, along axes of the grid; of any length.
    pub normal: Vec3,
}

/// An axis around which tools are repeated.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Radial {
    /// A point of the axis, in voxel coordinates.
    pub at_vx: Vec3,
    /// Direction in the world, along axes of the grid; of any length.
    pub axis: Vec3,
    /// Number of copies around the axis, at least 2.
    pub count: u32,
}

/// The symmetry in use: mirror planes perpendicular to the grid axes, one in any position, and an axis of rotation.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Symmetry {
    /// The parity of the mirror plane of each axis, if it has one.
    pub axes: [Option<Parity>; 3],
    /// A further mirror plane.
    pub plane: Option<MirrorPlane>,
    /// The axis of rotation.
    pub radial: Option<Radial>,
}

impl Symmetry {
    /// Creates a symmetry of mirror planes through the grid's centre alone.
    pub const fn of_axes(axes: [Option<Parity>; 3]) -> Symmetry {
        Symmetry { axes, plane: None, radial: None }
    }

    /// Returns an error that names the invalid value, if there is one.
    pub fn check(&self) -> Result<(), InvalidValue> {
        let place = |field, at: Vec3| {
            let is_near = at.is_finite() && at.abs().max_element() <= FURTHEST_VX;
            InvalidValue::check(is_near, field, "must be within a million voxels", at)
        };
        let direction = |field, v: Vec3| {
            let length = v.as_dvec3().length();
            let is_direction = length > 1e-12 && length.is_finite();
            InvalidValue::check(is_direction, field, "must have a direction", v)
        };
        if let Some(MirrorPlane { at_vx, normal }) = self.plane {
            place("mirror plane", at_vx)?;
            direction("normal of the mirror plane", normal)?;
        }
        if let Some(Radial { at_vx, axis, count }) = self.radial {
            place("axis of rotation", at_vx)?;
            direction("axis of rotation", axis)?;
            let is_count = (2..=MAX_IMAGES as u32).contains(&count);
            InvalidValue::check(is_count, "rotation", "repeats a tool 2 to 64 times", count)?;
        }
        let rule = "may give a tool 64 images; use fewer planes or a smaller count";
        let images = self.image_count();
        InvalidValue::check(images <= MAX_IMAGES, "symmetry", rule, images)
    }

    fn image_count(&self) -> usize {
        let planes = self.axes.iter().flatten().count() + usize::from(self.plane.is_some());
        (1 << planes) * self.radial.map_or(1, |radial| radial.count as usize)
    }

    /// Returns the symmetry about the same voxels after a grid of `dims` voxels was reoriented.
    pub fn oriented(&self, orientation: Orientation, dims: UVec3) -> Symmetry {
        let place = |v: IVec3| orientation.destination(v, dims).as_vec3();
        let first = place(IVec3::ZERO);
        let turn = Mat3::from_cols(
            place(IVec3::X) - first,
            place(IVec3::Y) - first,
            place(IVec3::Z) - first,
        );
        let point = |p: Vec3| turn * (p - 0.5) + first + 0.5;
        Symmetry {
            axes: orientation.permuted(self.axes),
            plane: self.plane.map(|MirrorPlane { at_vx, normal }| MirrorPlane {
                at_vx: point(at_vx),
                normal: turn * normal,
            }),
            radial: self.radial.map(|Radial { at_vx, axis, count }| Radial {
                at_vx: point(at_vx),
                axis: turn * axis,
                count,
            }),
        }
    }

    /// Returns the positions of the axis-aligned planes in a grid of `dims` voxels, in voxel coordinates.
    pub fn planes(&self, dims: UVec3) -> [Option<f32>; 3] {
        std::array::from_fn(|axis| {
            let middle = (dims[axis] / 2) as f32;
            self.axes[axis].map(|parity| match parity {
                Parity::Even => middle,
                Parity::Odd => middle + 0.5,
            })
        })
    }

    /// Returns all images in a grid of `dims` voxels with edges of `voxel_size`, starting with the identity. The
    /// symmetry must be valid.
    pub fn images(&self, dims: UVec3, voxel_size: Vec3) -> Vec<SymmetryTransform> {
        let mut images = vec![SymmetryTransform { planes: [None; 3], moved: None }];
        let mut planes: Vec<(usize, f32)> = Vec::new();
        let of_axes = self.planes(dims).into_iter().enumerate();
        planes.extend(of_axes.filter_map(|(axis, plane)| Some((axis, plane?))));
        // An axis-aligned plane is as exact as those of the axes.
        let along = self.plane.and_then(|plane| {
            let axis = grid_axis(plane.normal)?;
            self.axes[axis].is_none().then_some((axis, plane.at_vx[axis]))
        });
        planes.extend(along);
        for (axis, plane) in planes {
            let mirrored = |image: &SymmetryTransform| {
                let mut image = *image;
                image.planes[axis] = Some(plane);
                image
            };
            let more: Vec<SymmetryTransform> = images.iter().map(mirrored).collect();
            images.extend(more);
        }
        let stretch = voxel_size.as_dvec3() / voxel_size.as_dvec3().min_element();
        if let Some(plane) = self.plane.filter(|_| along.is_none()) {
            let mirror = Move::mirror(&plane, stretch);
            let more: Vec<SymmetryTransform> =
                images.iter().map(|image| image.then(mirror)).collect();
            images.extend(more);
        }
        if let Some(radial) = self.radial {
            let turned = |k: u32| {
                let turn = Move::turn(&radial, k, stretch);
                images.iter().map(move |image| match radial.half_turn(k, image) {
                    Some(planes) => SymmetryTransform { planes, moved: None },
                    None => image.then(turn),
                })
            };
            let more: Vec<SymmetryTransform> = (1..radial.count).flat_map(turned).collect();
            images.extend(more);
        }
        images
    }
}

impl Symmetry {
    /// Returns the positions of the axis-aligned planes, in the coordinates of a grid in `frame`.
    pub fn planes_in(&self, frame: &CanvasFrame) -> [Option<f32>; 3] {
        let origin = frame.origin.as_vec3();
        let mut planes = self.planes(frame.home);
        planes.iter_mut().enumerate().for_each(|(axis, plane)| {
            *plane = plane.map(|at| at - origin[axis]);
        });
        planes
    }

    /// Returns all images in the coordinates of a grid in `frame`, as [`Symmetry::images`] does.
    pub fn images_in(&self, frame: &CanvasFrame, voxel_size: Vec3) -> Vec<SymmetryTransform> {
        let images = self.images(frame.home, voxel_size);
        match frame.origin {
            IVec3::ZERO => images,
            origin => images.iter().map(|image| image.shifted(-origin)).collect(),
        }
    }

    /// Returns the symmetry moved by a number of voxels, but for the planes of the axes.
    pub fn shifted(&self, by: IVec3) -> Symmetry {
        let by = by.as_vec3();
        let plane = |plane: MirrorPlane| MirrorPlane { at_vx: plane.at_vx + by, ..plane };
        let radial = |radial: Radial| Radial { at_vx: radial.at_vx + by, ..radial };
        Symmetry { axes: self.axes, plane: self.plane.map(plane), radial: self.radial.map(radial) }
    }
}

impl Radial {
    /// Returns the planes of `image` with two more if the `k`th turn is half a turn about a grid axis. Such a turn
    /// equals two mirror planes, and is as exact.
    fn half_turn(&self, k: u32, image: &SymmetryTransform) -> Option<[Option<f32>; 3]> {
        let axis = grid_axis(self.axis).filter(|_| 2 * k == self.count && image.moved.is_none())?;
        let mut planes = image.planes;
        for other in (0..3).filter(|other| *other != axis) {
            if planes[other].replace(self.at_vx[other]).is_some() {
                return None;
            }
        }
        Some(planes)
    }
}

/// Returns the point in voxel coordinates that all axis-aligned mirror planes pass through.
pub(super) fn origin_of(images: &[SymmetryTransform]) -> DVec3 {
    let plane = |axis: usize| images.iter().find_map(|image| image.planes[axis]);
    DVec3::from([0, 1, 2].map(|axis| plane(axis).map_or(0.0, f64::from)))
}

/// Returns the grid axis along which a direction lies.
fn grid_axis(direction: Vec3) -> Option<usize> {
    let mut others = (0..3).filter(|axis| direction[*axis] != 0.0);
    others.next().filter(|_| others.next().is_none())
}

/// A reflection or a rotation, in units of the smallest voxel edge.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Move {
    /// Orthogonal.
    linear: DMat3,
    offset: DVec3,
    /// Voxel edges in units of the smallest.
    stretch: DVec3,
}

impl Move {
    fn mirror(plane: &MirrorPlane, stretch: DVec3) -> Move {
        let normal = plane.normal.as_dvec3().normalize();
        let outer = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Move::about(plane.at_vx, DMat3::IDENTITY - outer * 2.0, stretch)
    }

    /// Returns the `k`th rotation around the axis.
    fn turn(radial: &Radial, k: u32, stretch: DVec3) -> Move {
        let angle = std::f64::consts::TAU * f64::from(k) / f64::from(radial.count);
        let turn = DMat3::from_axis_angle(radial.axis.as_dvec3().normalize(), angle);
        Move::about(radial.at_vx, turn, stretch)
    }

    /// Returns the motion by `linear` that keeps a point (voxel coordinates) fixed.
    fn about(at_vx: Vec3, linear: DMat3, stretch: DVec3) -> Move {
        // Quarter turns are exact.
        let snapped = |v: f64| if (v - v.round()).abs() < 1e-12 { v.round() } else { v };
        let linear = DMat3::from_cols_array(&linear.to_cols_array().map(snapped));
        let at = at_vx.as_dvec3() * stretch;
        Move { linear, offset: at - linear * at, stretch }
    }

    fn after(&self, first: &Move) -> Move {
        Move {
            linear: self.linear * first.linear,
            offset: self.linear * first.offset + self.offset,
            stretch: self.stretch,
        }
    }
}

/// An image: reflected at the plane of each axis that has one, then moved.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SymmetryTransform {
    planes: [Option<f32>; 3],
    moved: Option<Move>,
}

impl SymmetryTransform {
    /// Creates a reflection at the planes (voxel coordinates) of the axes that have one.
    pub const fn of_planes(planes: [Option<f32>; 3]) -> SymmetryTransform {
        SymmetryTransform { planes, moved: None }
    }

    /// Returns the same image in coordinates that are larger by `by` voxels.
    fn shifted(&self, by: IVec3) -> SymmetryTransform {
        let by = by.as_dvec3();
        let mut shifted = *self;
        for (axis, plane) in shifted.planes.iter_mut().enumerate() {
            *plane = plane.map(|at| (f64::from(at) + by[axis]) as f32);
        }
        shifted.moved = self.moved.map(|Move { linear, offset, stretch }| {
            let by = by * stretch;
            Move { linear, offset: offset + by - linear * by, stretch }
        });
        shifted
    }

    fn then(&self, next: Move) -> SymmetryTransform {
        let moved = self.moved.map_or(next, |first| next.after(&first));
        SymmetryTransform { moved: Some(moved), ..*self }
    }

    /// Returns whether it consists of axis-aligned planes alone, and so differs in signs only.
    pub(super) fn is_along_grid(&self) -> bool {
        self.moved.is_none()
    }

    fn mirrored(&self, mut p: DVec3) -> DVec3 {
        for (axis, plane) in self.planes.into_iter().enumerate() {
            if let Some(plane) = plane {
                p[axis] = 2.0 * f64::from(plane) - p[axis];
            }
        }
        p
    }

    /// Returns -1 for each axis that is reflected before the motion, 1 for the others.
    pub(super) fn signs(&self) -> DVec3 {
        DVec3::from(self.planes.map(|plane| if plane.is_some() { -1.0 } else { 1.0 }))
    }

    /// Returns the image of a point in grid coordinates: exact for voxel centres where planes are axis-aligned.
    pub fn point_exactly(&self, p: DVec3) -> DVec3 {
        let p = self.mirrored(p);
        match &self.moved {
            Some(moved) => (moved.linear * (p * moved.stretch) + moved.offset) / moved.stretch,
            None => p,
        }
    }

    /// Returns the image of a point relative to `origin` ([`origin_of`] all images). Axis-aligned images differ in
    /// signs only and are rounded alike.
    pub(super) fn relative(&self, p: DVec3, origin: DVec3) -> DVec3 {
        match self.moved {
            Some(_) => self.point_exactly(p) - origin,
            None => (p - origin) * self.signs(),
        }
    }

    /// Returns the point in grid coordinates whose image is `p`.
    pub fn origin_of(&self, p: DVec3) -> DVec3 {
        self.mirrored(match &self.moved {
            Some(Move { linear, offset, stretch }) => {
                linear.transpose() * (p * *stretch - *offset) / *stretch
            }
            None => p,
        })
    }

    /// Returns the image of a point in grid coordinates.
    pub fn point(&self, p: Vec3) -> Vec3 {
        match self.moved {
            Some(_) => self.point_exactly(p.as_dvec3()).as_vec3(),
            None => {
                let mut p = p;
                for (axis, plane) in self.planes.into_iter().enumerate() {
                    if let Some(plane) = plane {
                        p[axis] = 2.0 * plane - p[axis];
                    }
                }
                p
            }
        }
    }

    /// Returns the image of a direction in grid coordinates.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.vector_exactly(v.as_dvec3()).as_vec3()
    }

    /// Returns the image of a direction in grid coordinates.
    pub(super) fn vector_exactly(&self, v: DVec3) -> DVec3 {
        let v = v * self.signs();
        match &self.moved {
            Some(moved) => moved.linear * (v * moved.stretch) / moved.stretch,
            None => v,
        }
    }

    /// Returns the image of a direction in the world, along axes of the grid.
    pub(super) fn normal(&self, normal: DVec3) -> DVec3 {
        self.linear() * normal
    }

    /// Returns the orthogonal map of directions in the world.
    pub(super) fn linear(&self) -> DMat3 {
        let mirror = DMat3::from_diagonal(self.signs());
        self.moved.map_or(mirror, |moved| moved.linear * mirror)
    }

    /// Returns whether it is a reflection, which reverses the sense of rotations.
    pub(super) fn is_reflection(&self) -> bool {
        self.linear().determinant() < 0.0
    }

    /// Returns the rotation of the mirrored image of a shape. A reflection is no rotation; but a shape that is
    /// symmetric about its own x plane, as every solid is, may be reflected there as well, which makes it one.
    pub fn rotation(&self, of: Quat) -> Quat {
        if self.moved.is_some() {
            let own = if self.is_reflection() { DVec3::new(-1.0, 1.0, 1.0) } else { DVec3::ONE };
            let rotation = DMat3::from_quat(of.as_dquat().normalize());
            let rotation = self.linear() * rotation * DMat3::from_diagonal(own);
            return DQuat::from_mat3(&rotation).normalize().as_quat().normalize();
        }
        let mirrored = self.planes.iter().filter(|plane| plane.is_some()).count();
        let mut rotation = of;
        for (axis, plane) in self.planes.into_iter().enumerate() {
            if plane.is_some() {
                rotation = conjugated(rotation, axis);
            }
        }
        // S R = (S R S) S, and S X is a rotation by half a turn, or by none.
        let odd = mirrored % 2 == 1;
        let own: [bool; 3] =
            std::array::from_fn(|axis| self.planes[axis].is_some() ^ (odd && axis == 0));
        rotation
            * match own {
                [false, true, true] => Quat::from_xyzw(1.0, 0.0, 0.0, 0.0),
                [true, false, true] => Quat::from_xyzw(0.0, 1.0, 0.0, 0.0),
                [true, true, false] => Quat::from_xyzw(0.0, 0.0, 1.0, 0.0),
                _ => Quat::IDENTITY,
            }
    }
}

/// Returns S R S for the reflection S along an axis: the component about that axis stays, the others are reversed.
fn conjugated(rotation: Quat, axis: usize) -> Quat {
    let mut v = -rotation.xyz();
    v[axis] = -v[axis];
    Quat::from_xyzw(v.x, v.y, v.z, rotation.w)
}
