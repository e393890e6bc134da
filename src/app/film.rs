//! Films from the window: turns the dialog's request into the job that the command line runs, on a thread.
//!
//! A turntable shows the sculpture as it is at the start. A time lapse shows what was recorded until then, or else the
//! steps that undo leads back through. Both use the side and the light of the view. Knows no window.

use glam::{Quat, Vec3};

use super::screenshot;
use super::view_source::ViewSource;
use crate::config::Config;
use crate::editor::job::Failure;
use crate::film::{self, FilmError, FilmJob, Subject};
use crate::headless::{Context, PictureRequest};
use crate::picture::outline_middle;
use crate::progress::ProgressReport;
use crate::shade::ground::GROUND_COLOUR;
use crate::ui::pictures::{FilmRequest, FilmSubject};
use crate::view::StereoLayout;

/// Returns the work that makes a film, or the reason why there is none. `config`: the settings that it starts from.
pub(super) fn work(
    source: &ViewSource,
    config: &Config,
    wanted: &FilmRequest,
) -> Result<impl FnOnce(&ProgressReport) -> Result<String, Failure> + Send + use<>, &'static str> {
    let ViewSource { session, view, .. } = source;
    let document = session.document();
    let subject = match wanted.kind {
        FilmSubject::Turntable => Subject::Sculpture {
            contents: document.share_contents(),
            placement: *document.placement(),
        },
        FilmSubject::Lapse => match session.recording() {
            Some(script) => Subject::File(script.to_path_buf()),
            None => match session.steps() {
                Some((now, store)) if !now.history.undo.is_empty() => {
                    Subject::Steps { now: Box::new(now), store }
                }
                _ => return Err("There are no steps yet for a time lapse"),
            },
        },
    };
    let path = screenshot::free_path(session.path(), "film", wanted.form.ending());
    let job = FilmJob {
        subject,
        input: None,
        out: path.clone(),
        frames: wanted.frames,
        range: Default::default(),
        fps: wanted.fps,
        spin_deg: Some(wanted.spin_deg),
        picture: picture_request(source, wanted),
        import: Default::default(),
    };
    let mut config = config.clone();
    config.render.smooth_surface = view.smooth_surface;
    config.render.smooth_normals = view.finish.smooth_normals;
    config.render.smooth_colours = view.finish.smooth_colours;
    config.render.occlusion = view.finish.occlusion;
    config.light = view.light.clone();
    let device = source.device.clone();
    Ok(move |report: &ProgressReport| {
        let context = Context { config: &config, device: &device, progress: report };
        match film::make(&job, &context) {
            Ok(_) => Ok(format!("Saved {}", path.display())),
            Err(FilmError::Cancelled) => Err(Failure::Cancelled),
            Err(error) => Err(Failure::Error(error.to_string())),
        }
    })
}

/// Returns the picture request of a frame, as the view stands.
fn picture_request(source: &ViewSource, wanted: &FilmRequest) -> PictureRequest {
    let ViewSource { session, view, eye, .. } = source;
    let document = session.document();
    let up = (document.placement().rotation * view.up).normalize_or(Vec3::Y);
    let middle = document.world_from_grid().transform_point3(outline_middle(document.grid()));
    let to_eye = eye.position() - middle;
    PictureRequest {
        size: wanted.size,
        mode: Some(view.mode),
        voxels: !view.smooth_surface,
        camera: Quat::from_rotation_arc(Vec3::Y, up).inverse() * to_eye,
        up,
        ground: view.ground.then_some(GROUND_COLOUR),
        orthographic: view.orthographic,
        stereo: Some(StereoLayout::Mono),
        samples: wanted.samples,
        ..PictureRequest::default()
    }
}
