//! GPU times by timestamp queries: available if the queue has timestamps, and not longer than the wall clock.

use std::time::Instant;

use glam::{UVec2, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{FRAMES_IN_FLIGHT, Frames, Timer, run_once};
use virtual_sculpture::render::renderer::DeviceTimes;
use virtual_sculpture::render::{Background, FrameDesc, Renderer, SmoothSurface};
use virtual_sculpture::render::{RenderMode, Sampling, Shading};
use virtual_sculpture::scenes;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Material, Rgb};
use virtual_sculpture::shade::Lighting;
use virtual_sculpture::view::{Camera, Eye};

use super::fixture::with_device;

fn document() -> Document {
    let grid = scenes::cheese(64, 30, 3).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    Document::from_contents(Contents::new(grid, material), Limits::default())
}

/// An eye that is a little elsewhere at each `step`.
fn eye(step: usize) -> Eye {
    let from = Vec3::new(0.8, 0.6, 1.0) + Vec3::X * 0.01 * step as f32;
    Camera::framing(55.0, from, Vec3::Y).eye(UVec2::new(320, 240))
}

fn desc<'a>(document: &Document, eyes: &'a [Eye], mode: RenderMode) -> FrameDesc<'a> {
    FrameDesc {
        eyes,
        world_from_grid: document.world_from_grid(),
        smooth_surface: SmoothSurface::Never,
        sample: 0,
        mode,
        lighting: Lighting::default(),
        show_mask: false,
        background: Background::Gradient { top: Vec3::ONE, bottom: Vec3::ZERO },
        ground: None,
        smooth_edges: false,
        video: None,
        previews: &[],
        lines: &[],
    }
}

#[test]
fn parts_of_a_frame_are_timed_once_they_are_done() {
    with_device(|device| {
        let Some(mut timer) = Timer::<3>::new(device, "test").unwrap() else {
            assert_eq!(device.time_stamp_bits(), 0);
            return;
        };
        assert_eq!(timer.latest().unwrap(), [None; 3]);
        let mut frames = Frames::new(device).unwrap();
        for frame in 0..3 * FRAMES_IN_FLIGHT {
            let start = Instant::now();
            let mut recorder = frames.begin().unwrap();
            let former = timer.begin(&mut recorder, frames.slot()).unwrap();
            // The third part was recorded in the slots' first frames only.
            let ran = frame >= FRAMES_IN_FLIGHT;
            assert_eq!([former[0], former[1]].map(|time| time.is_some()), [ran, false]);
            let had_third = ran && frame < 2 * FRAMES_IN_FLIGHT;
            assert_eq!(former[2].is_some(), had_third, "frame {frame}");
            timer.start(&mut recorder, 0);
            if frame < FRAMES_IN_FLIGHT {
                timer.start(&mut recorder, 2);
                timer.stop(&mut recorder, 2);
            }
            // A part that never ends has no time.
            timer.start(&mut recorder, 1);
            timer.stop(&mut recorder, 0);
            let serial = frames.submit(recorder, &[], &[]).unwrap();
            device.wait(serial).unwrap();
            let wall_ms = start.elapsed().as_secs_f32() * 1e3;
            let [whole, unended, _] = timer.latest().unwrap();
            assert!((0.0..=wall_ms).contains(&whole.unwrap()) && unended.is_none());
        }
        // An abandoned frame reports nothing and does no harm.
        let mut recorder = frames.begin().unwrap();
        timer.begin(&mut recorder, frames.slot()).unwrap();
        timer.start(&mut recorder, 0);
        drop(recorder);
        assert_eq!(timer.latest().unwrap(), [None; 3]);
        run_once(device, |_| Ok(())).unwrap();
    });
}

#[test]
fn every_mode_says_what_the_device_took_for_it() {
    with_device(|device| {
        let stamped = device.time_stamp_bits() > 0;
        let mut document = document();
        let mut frames = Frames::new(device).unwrap();
        let mut renderer = Renderer::new(device, FORMAT).unwrap();
        for mode in RenderMode::ALL {
            for step in 0..3 {
                let eyes = [eye(step)];
                let desc = desc(&document, &eyes, mode);
                let start = Instant::now();
                let mut recorder = frames.begin().unwrap();
                renderer.paint(&mut recorder, frames.slot(), &mut document, &desc).unwrap();
                let serial = frames.submit(recorder, &[], &[]).unwrap();
                device.wait(serial).unwrap();
                let wall_ms = start.elapsed().as_secs_f32() * 1e3;
                let times = renderer.times_when_done().unwrap();
                trials::note!("{mode:?}: {:?} of {wall_ms} ms", times.device);
                let DeviceTimes { sample_ms, shade_ms, compose_ms } = times.device;
                let samples = matches!(mode.sampling(), Sampling::Slicing | Sampling::March);
                let shades = mode.shading() == Shading::Device;
                assert_eq!(
                    [sample_ms, shade_ms, compose_ms].map(|time| time.is_some()),
                    [samples, shades, true].map(|has| has && stamped),
                    "{mode:?}"
                );
                let parts = [sample_ms, shade_ms, compose_ms].into_iter().flatten();
                assert!(parts.clone().all(|ms| ms > 0.0), "{mode:?}: {:?}", times.device);
                let all: f32 = parts.sum();
                assert!(all <= wall_ms, "{mode:?}: {:?} in {wall_ms} ms", times.device);
                // Of the sampling that was waited for, also a part of its own time.
                if let (Some(sample_ms), Some(_)) = (sample_ms, times.read_back_ms) {
                    assert!(sample_ms <= times.sample_ms, "{mode:?}: {times:?}");
                }
            }
        }
    });
}

#[test]
fn the_times_without_waiting_are_of_earlier_pictures() {
    with_device(|device| {
        let mut document = document();
        let mut frames = Frames::new(device).unwrap();
        let mut renderer = Renderer::new(device, FORMAT).unwrap();
        let mode = RenderMode::MarchGpu;
        for step in 0..=FRAMES_IN_FLIGHT {
            let known = renderer.times().device;
            assert_eq!(known, DeviceTimes::default(), "nothing is known before step {step}");
            let eyes = [eye(step)];
            let mut recorder = frames.begin().unwrap();
            let desc = desc(&document, &eyes, mode);
            renderer.paint(&mut recorder, frames.slot(), &mut document, &desc).unwrap();
            frames.submit(recorder, &[], &[]).unwrap();
        }
        let DeviceTimes { sample_ms, shade_ms, compose_ms } = renderer.times().device;
        let known = [sample_ms, shade_ms, compose_ms].map(|time| time.is_some());
        assert_eq!(known, [device.time_stamp_bits() > 0; 3]);
        // Nothing new is painted: what is known stays known.
        let eyes = [eye(FRAMES_IN_FLIGHT)];
        let mut recorder = frames.begin().unwrap();
        let desc = desc(&document, &eyes, mode);
        renderer.paint(&mut recorder, frames.slot(), &mut document, &desc).unwrap();
        frames.submit(recorder, &[], &[]).unwrap();
        assert!(renderer.times().device.compose_ms.is_some() == known[2]);
        device.wait_idle().unwrap();
    });
}
