//! The final picture of the view, made on a thread while the window stays alive and shows it, and saved as a file.
//!
//! Takes the view as it is at the start; later changes do not matter to it. Knows no window.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use glam::{Mat4, UVec2, Vec3};

use super::screenshot;
use super::view_source::ViewSource;
use crate::editor::job::Failure;
use crate::picture::{self, FinalOptions, FinalPicture, PictureError, TraceOn};
use crate::progress::ProgressReport;
use crate::shade::Pixels;
use crate::trace::{Film, TraceCamera, TraceError, preview_pixels};
use crate::ui::dialogs::final_picture::Preview;
use crate::ui::pictures::FinalRequest;
use crate::view::Eye;

/// Time between two previews of an unfinished picture.
const SHOW_EVERY: Duration = Duration::from_millis(200);
/// Least time between two previews, as a multiple of the time that one takes.
const SHOW_SHARE: u32 = 20;
/// Longest side of a preview, in pixels.
const SHOWN_PX: u32 = 640;

/// Returns the work that makes a final picture of the view. `preview`: receives the unfinished picture.
pub(super) fn work(
    source: &ViewSource,
    wanted: &FinalRequest,
    preview: &Preview,
) -> impl FnOnce(&ProgressReport) -> Result<String, Failure> + Send + use<> {
    let ViewSource { session, view, eye, device } = source;
    let document = session.document();
    let contents = document.share_contents();
    let up = document.placement().rotation * view.up;
    let eye = of_size(eye, wanted.size);
    let camera = TraceCamera { eye, world_from_grid: document.world_from_grid(), up };
    let path = screenshot::free_path(session.path(), "final", wanted.file.ending());
    let options = FinalOptions {
        trace: wanted.trace,
        smooth_surface: view.smooth_surface && !wanted.on_gpu,
        denoise: wanted.denoise,
        exposure_ev: wanted.exposure_ev,
    };
    let on = match wanted.on_gpu {
        true => TraceOn::Gpu((*device).clone()),
        false => TraceOn::Cpu,
    };
    let mut watcher =
        Watcher { news: preview.news(), exposure_ev: wanted.exposure_ev, due: Instant::now() };
    move |report: &ProgressReport| {
        let watch = &mut |film: &Film, samples| watcher.watch(film, samples);
        let picture =
            FinalPicture { contents: &contents, camera: &camera, options: &options, on: &on };
        match picture::write_final(picture, &path, report, watch) {
            Ok(()) => Ok(format!("Saved {}", path.display())),
            Err(PictureError::Trace(TraceError::Cancelled)) => Err(Failure::Cancelled),
            Err(error) => Err(Failure::Error(error.to_string())),
        }
    }
}

/// Returns an eye with the same vertical field of view for a picture of another size.
fn of_size(eye: &Eye, size: UVec2) -> Eye {
    let aspect = |size: UVec2| size.x as f32 / size.y.max(1) as f32;
    let wider = Vec3::new(aspect(eye.size) / aspect(size), 1.0, 1.0);
    Eye { projection: Mat4::from_scale(wider) * eye.projection, size, ..*eye }
}

/// Gives the unfinished picture to the interface from time to time.
struct Watcher {
    news: std::sync::Arc<Mutex<Option<Pixels>>>,
    exposure_ev: f32,
    due: Instant,
}

impl Watcher {
    fn watch(&mut self, film: &Film, samples: u32) {
        let begun = Instant::now();
        if begun < self.due {
            return;
        }
        let pixels = reduced(preview_pixels(film, samples, self.exposure_ev));
        *self.news.lock().unwrap_or_else(PoisonError::into_inner) = Some(pixels);
        self.due = Instant::now() + SHOW_EVERY.max(begun.elapsed() * SHOW_SHARE);
    }
}

/// Returns every n-th pixel of a picture that is larger than a preview.
fn reduced(pixels: Pixels) -> Pixels {
    let step = pixels.size.max_element().div_ceil(SHOWN_PX).max(1);
    let mut out = Pixels::new(pixels.size.map(|edge| edge.div_ceil(step)));
    let width = out.size.x as usize;
    for (i, rgba) in out.rgba.iter_mut().enumerate() {
        let at = UVec2::new((i % width) as u32, (i / width) as u32) * step;
        *rgba = pixels.rgba[(at.x + at.y * pixels.size.x) as usize];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Camera;

    #[test]
    fn another_size_shows_the_same_height_of_the_world() {
        let eye = Camera::default().eye(UVec2::new(300, 200));
        for size in [UVec2::new(200, 200), UVec2::new(640, 100)] {
            let other = of_size(&eye, size);
            let expected = Camera::default().eye(size);
            assert!(other.projection.abs_diff_eq(expected.projection, 1e-5), "{size}");
            assert_eq!(other.size, size);
        }
    }

    #[test]
    fn large_previews_are_reduced_evenly() {
        let mut pixels = Pixels::new(UVec2::new(1500, 4));
        pixels.rgba.iter_mut().enumerate().for_each(|(i, rgba)| rgba[0] = (i % 1500 / 3) as u8);
        let small = reduced(pixels);
        assert_eq!(small.size, UVec2::new(500, 2));
        let expected = |i: usize| (i % 500) as u8;
        assert!(small.rgba.iter().enumerate().all(|(i, rgba)| rgba[0] == expected(i)));
    }
}
