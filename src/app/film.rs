//! Films from the window: the dialog's wishes become the job that the command line runs, on a thread.
//!
//! A turntable shows the sculpture as it is at the start, a time lapse what was recorded until then, or else what undo
//! leads back to; both as the view shows it, from its side and in its light. Knows no window.

use glam::{Quat, Vec3};

use super::screenshot;
use super::workspace::Workspace;
use crate::editor::job::Failure;
use crate::film::{self, FilmError, FilmJob, Subject};
use crate::headless::{Context, PictureRequest};
use crate::picture::outline_middle;
use crate::progress::Report;
use crate::shade::ground::GROUND_COLOUR;
use crate::ui::pictures::{FilmKind, FilmRequest};
use crate::view::StereoLayout;

impl Workspace {
    /// Starts a film.
    pub(super) fn start_film(&mut self, wanted: &FilmRequest) {
        let document = self.session().document();
        let subject = match wanted.kind {
            FilmKind::Turntable => Subject::Sculpture {
                contents: document.share_contents(),
                placement: *document.placement(),
            },
            FilmKind::Lapse => match self.session().recording() {
                Some(script) => Subject::File(script.to_path_buf()),
                None => match self.session().steps() {
                    Some((now, store)) if !now.history.undo.is_empty() => {
                        Subject::Steps { now: Box::new(now), store }
                    }
                    _ => {
                        return self.ui.toasts.error("There are no steps yet for a time lapse");
                    }
                },
            },
        };
        let path = screenshot::free_path(self.session().path(), "film", wanted.form.ending());
        let job = FilmJob {
            subject,
            input: None,
            out: path.clone(),
            frames: wanted.frames,
            range: Default::default(),
            fps: wanted.fps,
            spin_deg: Some(wanted.spin_deg),
            picture: self.picture_request(wanted),
            import: Default::default(),
        };
        let mut config = self.config.clone();
        let view = &self.ui.view;
        config.render.smooth_surface = view.smooth_surface;
        config.render.smooth_normals = view.finish.smooth_normals;
        config.render.smooth_colours = view.finish.smooth_colours;
        config.render.occlusion = view.finish.occlusion;
        config.light = view.light.clone();
        let device = self.render_device.clone();
        let work = move |report: &Report| {
            let context = Context { config: &config, device: &device, progress: report };
            match film::make(&job, &context) {
                Ok(_) => Ok(format!("Saved {}", path.display())),
                Err(FilmError::Cancelled) => Err(Failure::Cancelled),
                Err(error) => Err(Failure::Error(error.to_string())),
            }
        };
        self.editor.start_side_work(work, "Film");
    }

    /// The picture of each frame: from where the view stands.
    fn picture_request(&self, wanted: &FilmRequest) -> PictureRequest {
        let document = self.session().document();
        let up = (document.placement().rotation * self.ui.view.up).normalize_or(Vec3::Y);
        let middle = document.world_from_grid().transform_point3(outline_middle(document.grid()));
        let to_eye = self.eye().position() - middle;
        PictureRequest {
            size: wanted.size,
            mode: Some(self.ui.view.mode),
            voxels: !self.ui.view.smooth_surface,
            camera: Quat::from_rotation_arc(Vec3::Y, up).inverse() * to_eye,
            up,
            ground: self.ui.view.ground.then_some(GROUND_COLOUR),
            orthographic: self.ui.view.orthographic,
            stereo: Some(StereoLayout::Mono),
            samples: wanted.samples,
            ..PictureRequest::default()
        }
    }
}
