//! Adjusts the surface of thin parts so that they keep their volume.
//!
//! Normals and depths come from smoothed bits. Smoothing moves both surfaces of a plate towards each other if it is not
//! much thicker than the Gaussian is wide. A run of few voxels along an axis whose ends face away from each other is
//! thin: the planes of its ends are moved so that their distance equals the length of the run. A part that is thin
//! along two axes or more, a bar or a needle, has planes further out, since the corners of a mesh lie within them. The
//! edge of something thick is no thin part, although its runs are short, too: they are longer further inside.
//!
//! Takes the bits of a brick and those around it, and planes of surface voxels; returns other planes. Knows no pages.

use glam::{IVec3, Vec3};

use super::LEAST;
use crate::shade::normal_field::PackedDepth;

/// The bits of the 27 bricks at and around one: number `x + 3 y + 9 z`, a word for each z, bit `x + 8 y`.
pub(super) type BricksAround = [[u64; 8]; 27];

/// The plane of a surface voxel: its normal and, in units of a level, the depth of the voxel's centre below it. Without
/// a normal, the depth applies in every direction.
pub(super) type SurfacePlane = (Vec3, f32);

/// The longest run that is thin.
const MOST_VX: i32 = 5;
/// The component of its normal along the axis from which the end of a run faces along it partly, and wholly.
const FACING: [f32; 2] = [0.3, 0.6];
/// The distance further inside at which runs of an edge are longer, their least extra length, and the least component
/// of the mean normal of the ends that counts as leading inside.
const INSIDE_VX: i32 = 2;
const LONGER_VX: i32 = 2;
const LEADS_INSIDE: f32 = 0.3;
/// The extra distance of the planes of a bar of one voxel beyond its sides.
const CORNERS_VX: f32 = 0.28;

/// Returns whether a voxel exists, by coordinates of the brick in the middle, from -8 to 15.
#[inline(always)]
fn exists(bricks: &BricksAround, at: IVec3) -> bool {
    let brick = ((at + 8) >> 3i32).dot(IVec3::new(1, 3, 9)) as usize;
    let local = at & 7;
    bricks[brick][local.z as usize] >> (local.x + 8 * local.y) & 1 != 0
}

/// Returns whether the run of `length` voxels along `axis` through `middle` belongs to the edge of something thick.
/// `normals` is the sum of the normals of its ends.
fn is_edge(bricks: &BricksAround, middle: IVec3, axis: usize, length: i32, normals: Vec3) -> bool {
    let mut aside = normals;
    aside[axis] = 0.0;
    let outwards = aside.abs().max_position();
    if aside[outwards].abs() < LEADS_INSIDE {
        return false;
    }
    let inside = middle - IVec3::AXES[outwards] * (INSIDE_VX * aside[outwards].signum() as i32);
    if !exists(bricks, inside) {
        return false;
    }
    // As far as the bricks are known.
    let reach =
        |unit: IVec3| (1..=MOST_VX).take_while(|s| exists(bricks, inside + unit * *s)).count();
    let unit = IVec3::AXES[axis];
    1 + reach(unit) as i32 + reach(-unit) as i32 >= length + LONGER_VX
}

/// Returns the plane of the surface voxel `at`, moved from `own` if the voxel belongs to a thin part. `plane` gives the
/// planes of other surface voxels.
#[inline(always)]
pub(super) fn moved(
    bricks: &BricksAround,
    at: IVec3,
    own: SurfacePlane,
    plane: &impl Fn(IVec3) -> Option<SurfacePlane>,
) -> SurfacePlane {
    let (normal, depth) = own;
    // The weight and the shift of the plane for the thin runs along each axis, summed.
    let (mut weights, mut shifts) = (0.0, 0.0);
    let (mut thin_axes, mut is_alone, mut least) = (0.0f32, false, MOST_VX);
    for (axis, unit) in IVec3::AXES.into_iter().enumerate() {
        let mut of_axis = 0.0f32;
        for outwards in [unit, -unit] {
            if exists(bricks, at + outwards) {
                continue;
            }
            if !exists(bricks, at - outwards) {
                if is_edge(bricks, at, axis, 1, normal) {
                    break;
                }
                (is_alone, of_axis, least) = (true, 1.0, 1);
                break;
            }
            let [facing, fully] = FACING;
            let along = normal[axis] * outwards[axis] as f32;
            if along <= facing {
                continue;
            }
            let end = (2..=MOST_VX).find(|&steps| !exists(bricks, at - outwards * steps));
            let Some(length) = end else { continue };
            let Some((other, other_depth)) = plane(at - outwards * (length - 1)) else { continue };
            if is_edge(bricks, at - outwards * ((length - 1) / 2), axis, length, normal + other) {
                continue;
            }
            let other_along = -other[axis] * outwards[axis] as f32;
            let weight = ((along.min(other_along) - facing) / (fully - facing)).clamp(0.0, 1.0);
            if weight > 0.0 {
                let apart = depth / along + other_depth / other_along;
                let missing = along * 0.5 * (PackedDepth::PER_VX - apart);
                let share = weight * along * along;
                (weights, shifts) = (weights + share, shifts + share * missing * weight);
                (of_axis, least) = (of_axis.max(weight), least.min(length));
            }
        }
        thin_axes += of_axis;
    }
    // The corners of a bar's mesh lie within its planes: the thicker the bar, the less.
    let corners = (thin_axes - 1.0).clamp(0.0, 1.0) / (least * least) as f32;
    let corners = corners * CORNERS_VX * PackedDepth::PER_VX;
    match is_alone {
        true => (Vec3::ZERO, 0.5 * PackedDepth::PER_VX + corners),
        false if weights > 0.0 => (normal, (depth + shifts / weights + corners).max(LEAST.into())),
        false => own,
    }
}
