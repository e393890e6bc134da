//! The slicing pass against the exact ray caster, pixel by pixel.
//!
//! Both walk the same voxels by the same arithmetic, so on a device whose `f32` division and
//! multiplication round correctly they agree everywhere. Where they do not, Vulkan allows a
//! division to be off by 2.5 units in the last place and a product and a sum to be fused; then
//! a ray that passes within about a millionth of its length of a voxel's edge may be found on
//! the edge's other side. There the two see neighbours across an edge of the picture: the
//! device's voxel is one that the caster sees through one of the nine pixels around, or one
//! that it sees when the ray is moved by less than half a pixel.

use std::sync::Arc;

use glam::{UVec2, Vec2};
use virtual_sculpture::gpu::{Device, Frames, Use, read_image_once};
use virtual_sculpture::render::{IndexTarget, Slicing, Volume};
use virtual_sculpture::sculpture::{Grid, NO_VOXEL};
use virtual_sculpture::surface::slices::SliceAreas;
use virtual_sculpture::surface::{IndexMap, raycast};
use virtual_sculpture::view::PixelRays;

use crate::fixture::with_device;
use crate::subjects::{self, SIZE};

/// Index maps of one grid from several eyes.
fn slice(
    device: &Arc<Device>,
    slicing: &mut Slicing,
    mut areas: SliceAreas,
    grid: &Grid,
    views: &[PixelRays],
) -> Vec<IndexMap> {
    let volume = Volume::new(device, grid).unwrap();
    areas.update(grid, None);
    let mut target = IndexTarget::new(device, SIZE, 2).unwrap();
    let mut frames = Frames::new(device).unwrap();
    views
        .iter()
        .enumerate()
        .map(|(i, rays)| {
            let eye = i as u32 % 2;
            let mut recorder = frames.begin().unwrap();
            slicing.begin(frames.slot(), &volume);
            slicing.record(&mut recorder, &volume, &mut areas, rays, &mut target, eye).unwrap();
            frames.submit(recorder, &[], &[]).unwrap();
            let size = [SIZE.x, SIZE.y, 1];
            let part = target.index().image().layer(eye);
            let bytes = read_image_once(device, part, size, 4, Use::COLOUR_TARGET).unwrap();
            IndexMap { rays: *rays, voxels: bytemuck::pod_collect_to_vec(&bytes) }
        })
        .collect()
}

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

fn compare(name: &str, grid: &Grid, cast: &IndexMap, sliced: &IndexMap) -> usize {
    let mut different = 0;
    let mut covered = 0;
    for y in 0..SIZE.y {
        for x in 0..SIZE.x {
            let (exact, found) = (cast.get(x, y), sliced.get(x, y));
            covered += usize::from(exact.is_some() || found.is_some());
            if exact != found {
                different += 1;
                let voxel = found.unwrap_or(NO_VOXEL);
                assert!(
                    in_silhouette(grid, cast, UVec2::new(x, y), voxel),
                    "{name}: at {x}, {y} the caster sees {:?}, slicing {:?}, from {}",
                    exact.map(|v| grid.voxel_coords(v)),
                    found.map(|v| grid.voxel_coords(v)),
                    cast.rays.origin,
                );
            }
        }
    }
    assert!(
        different as f32 <= 0.005 * covered as f32,
        "{name}: {different} of {covered} pixels differ"
    );
    different
}

/// With slabs of `slab_bricks` layers of bricks and layers of `thickness_vx` voxels.
fn all_subjects(slab_bricks: u32, thickness_vx: Option<u32>) {
    with_device(|device| {
        let mut slicing = Slicing::new(device).unwrap();
        if let Some(thickness_vx) = thickness_vx {
            slicing = slicing.with_thickness(thickness_vx);
        }
        for subject in subjects::all() {
            let rays: Vec<_> = subject.views.iter().map(|v| v.rays()).collect();
            let areas = SliceAreas::with_slab_bricks(slab_bricks);
            let maps = slice(device, &mut slicing, areas, &subject.grid, &rays);
            let mut different = 0;
            let mut covered = 0;
            for (sliced, rays) in maps.iter().zip(&rays) {
                let mut cast = IndexMap::new(*rays);
                raycast::sample(&subject.grid, rays, &mut cast);
                different += compare(subject.name, &subject.grid, &cast, sliced);
                covered += cast.covered();
            }
            assert!(covered > 0, "{} is not in the picture", subject.name);
            println!("{}: {different} of {covered} pixels differ", subject.name);
        }
    });
}

#[test]
fn slabs_of_two_bricks_equal_the_caster() {
    all_subjects(2, None);
}

#[test]
fn slabs_of_one_brick_equal_the_caster() {
    all_subjects(1, None);
}

#[test]
fn slices_of_one_voxel_equal_the_caster() {
    all_subjects(1, Some(1));
}

#[test]
fn layers_of_four_voxels_in_thicker_slabs_equal_the_caster() {
    all_subjects(3, Some(4));
}
