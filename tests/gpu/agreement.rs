//! Compares the device's index maps with those of the exact ray caster, pixel by pixel.
//!
//! Both traverse the same voxels by the same arithmetic, so on a device with correctly rounded `f32` division they agree
//! everywhere. Vulkan allows a division to be off by 2.5 ULP (that a product and a sum be fused is forbidden); then a ray that passes within about a millionth of its length of a voxel's edge may be found on the other side
//! of it. There the two see neighbours across an edge of the picture: the device's voxel is one that the caster sees
//! through one of the nine pixels around, or if the ray is moved by less than half a pixel.

use glam::{UVec2, Vec2};
use virtual_sculpture::sculpture::{Grid, NO_VOXEL};
use virtual_sculpture::surface::{IndexMap, raycast};

/// Whether the caster sees `voxel` through one of the nine pixels around (x, y), or by a ray
/// less than half a pixel away.
fn in_silhouette(grid: &Grid, cast: &IndexMap, pixel: UVec2, voxel: u32) -> bool {
    let seen = |x: u32, y: u32| cast.get(x, y).unwrap_or(NO_VOXEL) == voxel;
    let near = |p: u32, size: u32| p.saturating_sub(1)..(p + 2).min(size);
    let around = near(pixel.y, cast.rays.size.y)
        .any(|y| near(pixel.x, cast.rays.size.x).any(|x| seen(x, y)));
    around
        || [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y].into_iter().any(|offset| {
            [1e-3, 0.1, 0.5].into_iter().any(|part: f32| {
                let at = pixel.as_vec2() + 0.5 + offset * part;
                let direction = cast.rays.direction_at(at.x, at.y);
                let hit = raycast::cast(grid, cast.rays.origin, direction);
                hit.map_or(NO_VOXEL, |hit| grid.voxel_index(hit.voxel)) == voxel
            })
        })
}

/// Asserts that `drawn`, from the device, differs from `cast` in at most `share` of the covered pixels.
pub fn compare(name: &str, grid: &Grid, cast: &IndexMap, drawn: &IndexMap, share: f32) -> usize {
    let mut different = 0;
    let mut covered = 0;
    let size = cast.rays.size;
    for y in 0..size.y {
        for x in 0..size.x {
            let (exact, found) = (cast.get(x, y), drawn.get(x, y));
            covered += usize::from(exact.is_some() || found.is_some());
            if exact != found {
                different += 1;
                let voxel = found.unwrap_or(NO_VOXEL);
                assert!(
                    in_silhouette(grid, cast, UVec2::new(x, y), voxel),
                    "{name}: at {x}, {y} the caster sees {:?}, the device {:?}, from {}",
                    exact.map(|v| grid.voxel_coords(v)),
                    found.map(|v| grid.voxel_coords(v)),
                    cast.rays.origin,
                );
            }
        }
    }
    assert!(
        different as f32 <= share * covered as f32,
        "{name}: {different} of {covered} pixels differ"
    );
    different
}
