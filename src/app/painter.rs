//! Links workspace and renderer: gives the renderer the contents of the window's picture, and the workspace the
//! renderer's report.

use std::sync::Arc;
use std::time::Duration;

use ash::vk;
use glam::Vec3;

use super::floor;
use super::overlay;
use super::references;
use super::workspace::Workspace;
use crate::gpu::{Device, GpuError, Recorder, Result};
use crate::render::renderer::{FinishedPictures, FrameDesc};
use crate::render::{Background, Renderer, SmoothSurface, Video, VideoView};
use crate::sculpture::Rgb;
use crate::shade::ground::GROUND_COLOUR;
use crate::shade::{Ground, Pixels};
use crate::ui::{Theme, UiState, ViewState};
use crate::video::VideoOptions;
use crate::viewpoint::Viewpoint;

/// Longest time that the normals of an opened sculpture may delay a picture.
const PATIENCE: Duration = Duration::from_millis(6);

/// Samples per pixel of a resting picture.
pub(super) const REFINED_SAMPLES: u32 = 16;

/// The pictures of the sculpture in the window.
pub struct WindowPainter {
    renderer: Renderer,
}

impl WindowPainter {
    /// Creates a painter for pictures of `format`.
    pub fn new(device: &Arc<Device>, format: vk::Format) -> Result<WindowPainter> {
        Ok(WindowPainter { renderer: Renderer::new(device, format)? })
    }

    /// Records the workspace's next picture, which is in [`WindowPainter::pictures`] then. `slot`:
    /// [`crate::gpu::Frames::slot`]. Returns false if another picture of the same scene would be better.
    pub fn paint(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        workspace: &mut Workspace,
    ) -> Result<bool> {
        let scene = workspace.overlay_scene();
        // A picture to be saved shows the sculpture alone.
        let is_screenshot = workspace.ui.window_tasks.screenshot.is_some();
        let (preview, mut lines) = match is_screenshot {
            true => (None, Vec::new()),
            false => {
                let mut lines = overlay::lines(&scene);
                lines.extend(workspace.ui.dialogs.print_check.lines(scene.document));
                (overlay::preview(&scene), lines)
            }
        };
        if !is_screenshot && shows_floor(&workspace.ui.view, &workspace.viewpoint) {
            let dims = workspace.editor.document().grid().dims();
            let (up, theme) = (workspace.ui.view.up, workspace.ui.appearance.theme);
            lines.extend(floor::lines(dims, up, theme));
        }
        let eyes = workspace.eyes();
        let settings = &workspace.ui.view.video;
        // The renderer's own reference, independent of the workspace.
        let frame = workspace.viewpoint.video(settings).map(|(frame, lens)| (frame.clone(), lens));
        let video = frame.as_ref().map(|(frame, lens)| {
            let VideoOptions { fit, mirror, .. } = *settings;
            Video { frame, view: VideoView { fit, mirror, lens: *lens, beyond: Vec3::ZERO } }
        });
        let desc = FrameDesc {
            eyes: &eyes,
            world_from_grid: workspace.world_from_grid(),
            mode: workspace.ui.view.mode,
            smooth_surface: SmoothSurface::on_screen(workspace.ui.view.smooth_surface),
            sample: 0,
            lighting: workspace.ui.view.lighting(),
            show_mask: workspace.ui.view.mask && !is_screenshot,
            background: background(workspace.ui.appearance.theme),
            ground: ground(&workspace.ui.view, workspace.ui.appearance.theme, video.is_some()),
            smooth_edges: workspace.ui.view.smooth_edges,
            video,
            previews: preview.as_slice(),
            lines: &lines,
        };
        // A view that trackers or cameras move never rests.
        let rests = !is_screenshot || workspace.viewpoint.repaint_after().is_none();
        let refines = workspace.ui.view.refine && rests;
        self.take_references(recorder, slot, workspace, is_screenshot)?;
        // The renderer writes only to maps that have no other owner.
        workspace.viewpoint.forget_pick_map();
        let document = workspace.session_mut().document_mut();
        self.renderer.set_patience((!is_screenshot).then_some(PATIENCE));
        self.renderer.set_refinement(if refines { REFINED_SAMPLES } else { 1 });
        self.renderer.refine_at_once(is_screenshot);
        let report =
            self.renderer.paint_with_fallback(recorder, slot, document, &desc, |_| true)?;
        let complete = report.complete;
        workspace.take_report(report);
        Ok(complete)
    }

    /// Gives the renderer the reference pictures. Hides them if the device has no memory for them.
    fn take_references(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        workspace: &mut Workspace,
        is_screenshot: bool,
    ) -> Result<()> {
        let mut pictures = workspace.reference_pictures();
        if is_screenshot {
            pictures.iter_mut().for_each(|picture| picture.opacity = 0.0);
        }
        match self.renderer.set_references(recorder, slot, &pictures) {
            Err(reason @ (GpuError::OutOfMemory(_) | GpuError::Limit { .. })) => {
                let UiState { references, toasts, .. } = &mut workspace.ui;
                references::hide(references, toasts, &reason.to_string());
                Ok(())
            }
            result => result,
        }
    }

    /// Reads the pictures painted last back to memory, with their format. Waits for the device.
    pub fn read_back(&mut self) -> Result<Option<(vk::Format, Vec<Pixels>)>> {
        let Some(pictures) = self.renderer.pictures() else { return Ok(None) };
        let format = pictures.colour.image().format();
        Ok(Some((format, self.renderer.read_back()?)))
    }

    /// Returns the pictures painted last.
    pub fn pictures(&mut self) -> Option<&mut FinishedPictures> {
        self.renderer.pictures()
    }
}

/// Returns whether the next picture has a floor grid. A video shows a real floor, and a ground has lines of its own.
fn shows_floor(view: &ViewState, viewpoint: &Viewpoint) -> bool {
    view.floor && !view.ground && viewpoint.video(&view.video).is_none()
}

/// Returns the ground of the next picture; in a video, only the shadow on it.
fn ground(view: &ViewState, theme: Theme, in_video: bool) -> Option<Ground> {
    view.ground.then(|| Ground {
        up: view.up,
        colour: match theme {
            // Quieter before a dark background.
            Theme::Dark => Rgb::new(0x90, 0x93, 0x98),
            Theme::Light => GROUND_COLOUR,
        },
        shadow_only: in_video,
        sun_deg: view.light.sun_deg,
        sample: 0,
    })
}

/// Returns a quiet grey gradient, lighter above, that suits every colour of stone.
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

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::sync::Mutex;

    use super::*;
    use crate::config::Config;
    use crate::input::Bindings;
    use crate::render::{Fallback, RenderMode};
    use crate::session::Session;
    use crate::ui::widgets::toasts::Tone;

    /// A log in memory.
    #[derive(Clone, Default)]
    struct Log(Arc<Mutex<Vec<u8>>>);

    impl Write for Log {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_mode_that_falls_back_is_logged_and_said_once() {
        let mut config = Config::default();
        config.new.dims = [8; 3];
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        let mut workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
        let (what, limit) = ("the bit image".to_string(), "maxImageDimension3D");
        let reason = GpuError::Limit { what, needed: 4096, limit, allowed: 2048 };
        let to = RenderMode::ALL[1];
        let log = Log::default();
        let writer = log.clone();
        let lines = tracing_subscriber::fmt().with_writer(move || writer.clone()).finish();
        tracing::subscriber::with_default(lines, || {
            workspace.take_fallbacks(&[Fallback { reason, to }]);
        });
        assert_eq!(workspace.ui.view.mode, to);
        let errors = workspace.ui.toasts.texts().filter(|(tone, _)| *tone == Tone::Error);
        assert_eq!(errors.count(), 1);
        let log = String::from_utf8(log.0.lock().unwrap().clone()).unwrap();
        let told = log.lines().filter(|line| line.contains("WARN") && line.contains("switched to"));
        assert_eq!(told.count(), 1, "{log}");
        assert!(log.contains("4096") && log.contains(to.label()), "{log}");
    }
}
