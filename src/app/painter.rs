//! Owns the way from the workbench to the renderer: what the picture in the window shows, and what
//! the workbench hears of it.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::guides;
use super::workbench::Workbench;
use crate::config::Theme;
use crate::gpu::{Device, GpuError, Recorder, Result};
use crate::render::renderer::{Pictures, Shot};
use crate::render::{Background, Renderer, Video, VideoView};
use crate::shade::Pixels;

/// The pictures of the sculpture in the window.
pub struct Painter {
    renderer: Renderer,
}

impl Painter {
    /// For pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Painter> {
        Ok(Painter { renderer: Renderer::new(device, format)? })
    }

    /// Records what the workbench's next picture needs; then it is in [`Painter::pictures`].
    /// `slot`: [`crate::gpu::Frames::slot`].
    pub fn paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        bench: &mut Workbench,
    ) -> Result<()> {
        let aid = bench.aid();
        // A picture to be saved shows the sculpture alone.
        let (ghost, lines) = match bench.ui.screenshot {
            true => (None, Vec::new()),
            false => (guides::ghost(&aid), guides::lines(&aid)),
        };
        let eyes = bench.eyes();
        let mut shot = Shot {
            eyes: &eyes,
            world_from_grid: bench.world_from_grid(),
            mode: bench.ui.view.mode,
            lighting: bench.ui.view.lighting(),
            background: background(bench.ui.theme),
            video: None,
            ghosts: ghost.as_slice(),
            lines: &lines,
        };
        // Kept for as long as the shot looks at it, whatever the workbench does.
        let frame = bench.video().map(|(frame, lens)| (frame.clone(), lens));
        shot.video = frame.as_ref().map(|(frame, lens)| {
            let settings = &bench.ui.view.video;
            let view = VideoView {
                fit: settings.fit,
                mirror: settings.mirror,
                lens: *lens,
                beyond: Vec3::ZERO,
            };
            Video { frame, view }
        });
        // The renderer writes to the maps that nobody else holds.
        bench.forget_seen();
        let renderer = &mut self.renderer;
        paint_what_fits(renderer, recorder, slot, bench, &mut shot)?;
        let maps = renderer.maps();
        if let Some(map) = maps.get(bench.pointing_eye).or(maps.first()) {
            bench.saw(map.clone());
        }
        let times = renderer.times();
        bench.times.sample_ms = times.sample_ms;
        bench.times.shade_ms = times.shade_ms;
        Ok(())
    }

    /// What was painted last, in memory, with its format. Waits for the device.
    pub fn read_back(&mut self) -> Result<Option<(vk::Format, Vec<Pixels>)>> {
        let Some(pictures) = self.renderer.pictures() else { return Ok(None) };
        let format = pictures.colour.image().format();
        Ok(Some((format, self.renderer.read_back()?)))
    }

    /// What was painted last.
    pub fn pictures(&mut self) -> Option<&mut Pictures> {
        self.renderer.pictures()
    }
}

/// Paints a shot, in the window or in a headset. A sculpture that is too large for the device in
/// its mode is drawn in the next best, which is the workbench's from then on.
pub(super) fn paint_what_fits(
    renderer: &mut Renderer,
    recorder: &mut Recorder,
    slot: usize,
    bench: &mut Workbench,
    shot: &mut Shot,
) -> Result<()> {
    loop {
        let document = bench.session_mut().document_mut();
        let Err(error) = renderer.paint(recorder, slot, document, shot) else { return Ok(()) };
        let too_large = matches!(error, GpuError::Limit { .. } | GpuError::OutOfMemory(_));
        let Some(mode) = shot.mode.fallback().filter(|_| too_large) else { return Err(error) };
        bench.ui.toasts.error(format!("{error}; switched to {}", mode.label()));
        bench.ui.view.mode = mode;
        shot.mode = mode;
    }
}

/// Quiet greys, lighter above, that let any colour of stone stand out.
pub(super) fn background(theme: Theme) -> Background {
    let grey = |r: u8, g: u8, b: u8| Vec3::new(r.into(), g.into(), b.into()) / 255.0;
    match theme {
        Theme::Dark => {
            Background::Gradient { top: grey(0x3a, 0x40, 0x4c), bottom: grey(0x18, 0x1a, 0x1f) }
        }
        Theme::Light => {
            Background::Gradient { top: grey(0xf4, 0xf6, 0xf8), bottom: grey(0xc4, 0xcb, 0xd2) }
        }
    }
}
