//! Compares the ray march with the exact ray caster.

use std::sync::Arc;

use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::{
    EyeTask, IndexReadback, IndexTarget, PixelStage, RayMarch, Volume,
};
use virtual_sculpture::sculpture::Grid;
use virtual_sculpture::surface::{IndexMap, pixels_of_grid, raycast};
use virtual_sculpture::view::PixelRays;

use super::agreement::compare;
use super::fixture::with_device;
use super::subjects::{self, SIZE};

/// Index maps of one grid, two eyes a frame.
fn march(
    device: &Arc<Device>,
    pass: &mut RayMarch,
    grid: &Grid,
    views: &[PixelRays],
) -> Vec<IndexMap> {
    let volume = Volume::new(device, grid).unwrap();
    let mut target = IndexTarget::new(device, SIZE, 2).unwrap();
    let mut readbacks = [IndexReadback::new(device), IndexReadback::new(device)];
    let mut frames = Frames::new(device).unwrap();
    let mut maps = Vec::new();
    for pair in views.chunks(2) {
        let mut recorder = frames.begin().unwrap();
        let slot = frames.slot();
        pass.begin(slot);
        for (eye, rays) in (0..).zip(pair) {
            let visible = pixels_of_grid(grid, rays);
            let task = EyeTask { visible, ..EyeTask::whole(eye, *rays) };
            pass.record(&mut recorder, &volume, &task, &mut target).unwrap();
        }
        for (eye, (rays, readback)) in (0..).zip(pair.iter().zip(&mut readbacks)) {
            let task = EyeTask::whole(eye, *rays);
            readback.record(&mut recorder, slot, &mut target, &task).unwrap();
        }
        let serial = frames.submit(recorder, &[], &[]).unwrap();
        for (rays, readback) in pair.iter().zip(&mut readbacks) {
            let mut map = IndexMap::new(*rays);
            readback.submitted(slot, serial);
            readback.fetch(slot, grid.dims(), &mut map).unwrap();
            maps.push(map);
        }
    }
    maps
}

/// Off by rounding is allowed, and only along edges; exact is what lavapipe is.
#[test]
fn the_ray_march_equals_the_caster() {
    with_device(|device| {
        for stage in PixelStage::ALL {
            let mut pass = RayMarch::new(device, stage, 2).unwrap();
            for subject in subjects::all() {
                let rays: Vec<_> = subject.views.iter().map(|v| v.rays()).collect();
                let maps = march(device, &mut pass, &subject.grid, &rays);
                let (mut different, mut pixels) = (0, 0);
                for (marched, rays) in maps.iter().zip(&rays) {
                    let mut cast = IndexMap::new(*rays);
                    raycast::sample(&subject.grid, rays, &mut cast);
                    different += compare(subject.name, &subject.grid, &cast, marched, 0.005);
                    pixels += cast.voxels.len();
                }
                trials::note!("{} {stage:?}: {different} of {pixels} pixels differ", subject.name);
                let most = 1e-4 * pixels as f32;
                assert!(different as f32 <= most, "{} {stage:?}: {different}", subject.name);
            }
        }
    });
}
