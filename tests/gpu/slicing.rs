//! Compares the slicing pass with the exact ray caster, pixel by pixel.

use std::sync::Arc;

use virtual_sculpture::gpu::{Device, Frames, ResourceUse, read_image_once};
use virtual_sculpture::render::{EyeTask, IndexTarget, Slicing, Volume};
use virtual_sculpture::sculpture::Grid;
use virtual_sculpture::surface::slices::SliceAreas;
use virtual_sculpture::surface::{IndexMap, raycast};
use virtual_sculpture::view::PixelRays;

use super::agreement::compare;
use super::fixture::with_device;
use super::subjects::{self, SIZE};

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
            let task = EyeTask::whole(eye, *rays);
            slicing.record(&mut recorder, &volume, &mut areas, &task, &mut target).unwrap();
            frames.submit(recorder, &[], &[]).unwrap();
            let size = [SIZE.x, SIZE.y, 1];
            let part = target.index().image().layer(eye);
            let bytes = read_image_once(device, part, size, 4, ResourceUse::COLOUR_TARGET).unwrap();
            let mut map = IndexMap::new(*rays);
            map.reset(grid.dims(), *rays);
            map.voxels = bytemuck::pod_collect_to_vec(&bytes);
            map
        })
        .collect()
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
                different += compare(subject.name, &subject.grid, &cast, sliced, 0.005);
                covered += cast.covered();
            }
            assert!(covered > 0, "{} is not in the picture", subject.name);
            trials::note!("{}: {different} of {covered} pixels differ", subject.name);
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
