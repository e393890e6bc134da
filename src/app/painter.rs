//! Owns the way from the workspace to the renderer: what the picture in the window shows, and what
//! the workspace hears of it.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::overlay;
use super::workspace::Workspace;
use crate::gpu::{Device, GpuError, Recorder, Result};
use crate::render::renderer::{FrameDesc, Pictures};
use crate::render::{Background, Renderer, Video, VideoView};
use crate::shade::Pixels;
use crate::ui::Theme;

/// The pictures of the sculpture in the window.
pub struct Painter {
    renderer: Renderer,
}

impl Painter {
    /// For pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<Painter> {
        Ok(Painter { renderer: Renderer::new(device, format)? })
    }

    /// Records what the workspace's next picture needs; then it is in [`Painter::pictures`].
    /// `slot`: [`crate::gpu::Frames::slot`].
    pub fn paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        workspace: &mut Workspace,
    ) -> Result<()> {
        let scene = workspace.scene();
        // A picture to be saved shows the sculpture alone.
        let (preview, lines) = match workspace.ui.screenshot {
            true => (None, Vec::new()),
            false => (overlay::preview(&scene), overlay::lines(&scene)),
        };
        let eyes = workspace.eyes();
        let mut desc = FrameDesc {
            eyes: &eyes,
            world_from_grid: workspace.world_from_grid(),
            mode: workspace.ui.view.mode,
            lighting: workspace.ui.view.lighting(),
            background: background(workspace.ui.theme),
            video: None,
            previews: preview.as_slice(),
            lines: &lines,
        };
        // Kept for as long as the desc looks at it, whatever the workspace does.
        let frame = workspace.video().map(|(frame, lens)| (frame.clone(), lens));
        desc.video = frame.as_ref().map(|(frame, lens)| {
            let settings = &workspace.ui.view.video;
            let view = VideoView {
                fit: settings.fit,
                mirror: settings.mirror,
                lens: *lens,
                beyond: Vec3::ZERO,
            };
            Video { frame, view }
        });
        // The renderer writes to the maps that nobody else holds.
        workspace.forget_seen();
        let renderer = &mut self.renderer;
        paint_what_fits(renderer, recorder, slot, workspace, &mut desc)?;
        let maps = renderer.maps();
        if let Some(map) = maps.get(workspace.pointing_eye).or(maps.first()) {
            workspace.saw(map.clone());
        }
        let times = renderer.times();
        workspace.times.sample_ms = times.sample_ms;
        workspace.times.shade_ms = times.shade_ms;
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

/// Paints a desc, in the window or in a headset. A sculpture that is too large for the device in
/// its mode is drawn in the next best, which is the workspace's from then on.
pub(super) fn paint_what_fits(
    renderer: &mut Renderer,
    recorder: &mut Recorder,
    slot: usize,
    workspace: &mut Workspace,
    desc: &mut FrameDesc,
) -> Result<()> {
    loop {
        let document = workspace.session_mut().document_mut();
        let Err(error) = renderer.paint(recorder, slot, document, desc) else { return Ok(()) };
        let too_large = matches!(error, GpuError::Limit { .. } | GpuError::OutOfMemory(_));
        let Some(mode) = desc.mode.fallback().filter(|_| too_large) else { return Err(error) };
        workspace.ui.toasts.error(format!("{error}; switched to {}", mode.label()));
        workspace.ui.view.mode = mode;
        desc.mode = mode;
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
