//! The cost of features of pictures: whole pictures with a feature and without it, in turn.
//!
//! Takes the pictures of a mode; gives, for each feature of the mode, the times of pictures with it, and the additional
//! milliseconds over pictures without it. Needs a Vulkan device: without one there are only kernels.

use std::time::{Duration, Instant};

use glam::Vec3;
use serde::Serialize;

use super::pictures::{BenchLook, BenchPictures};
use super::statistics::Times;
use super::{LEAST_RUNS, Suite};
use crate::document::Document;
use crate::gpu::Result;
use crate::render::{RenderMode, SmoothSurface};
use crate::shade::ground::GROUND_COLOUR;
use crate::shade::{Ground, Lighting, Shadow};

/// Factor by which pictures of the smooth surface are magnified: seen from the usual distance, voxels of the larger
/// scenes cover less than a pixel.
const MAGNIFICATION: f32 = 4.0;

/// The shadow of a sun whose disc takes this angle, in degrees.
const SHADOW: Shadow = Shadow { sun_deg: 0.5, sample: 0 };

/// The light on it is known after the first picture: only the eye moves, not the lamp.
const GROUND: Ground = Ground {
    up: Vec3::Y,
    colour: GROUND_COLOUR,
    shadow_only: false,
    sun_deg: SHADOW.sun_deg,
    sample: 0,
};

/// The times of pictures with a feature.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct FeatureReport {
    pub name: String,
    /// Pictures with the feature.
    pub frame: Times,
    /// The median of these, less that of pictures without it.
    pub more_ms: f64,
}

/// Measures all features of a mode.
pub fn features(
    mode: RenderMode,
    lighting: &Lighting,
    document: &mut Document,
    pictures: &mut BenchPictures,
    suite: Suite,
) -> Result<Vec<FeatureReport>> {
    let plain = BenchLook {
        lighting: Lighting { occlusion: false, shadow: None, ..*lighting },
        smooth_surface: SmoothSurface::Never,
        ground: None,
        smooth_edges: false,
        magnification: 1.0,
    };
    let near = BenchLook { magnification: MAGNIFICATION, ..plain };
    let lit = |lighting| BenchLook { lighting, ..plain };
    let mut pairs = vec![
        ("occlusion", plain, lit(Lighting { occlusion: true, ..plain.lighting })),
        ("shadow", plain, lit(Lighting { shadow: Some(SHADOW), ..plain.lighting })),
        ("ground", plain, BenchLook { ground: Some(GROUND), ..plain }),
        ("smooth edges", plain, BenchLook { smooth_edges: true, ..plain }),
    ];
    if mode.can_be_smooth() {
        let smooth = BenchLook { smooth_surface: SmoothSurface::Always, ..near };
        pairs.push(("smooth surface", near, smooth));
    }
    let mut reports = Vec::new();
    for (name, without, with) in pairs {
        reports.extend(compare(name, [&without, &with], document, pictures, suite)?);
    }
    pictures.set_look(None);
    Ok(reports)
}

/// Renders pictures of two looks in turn, so that other load on the machine slows both.
fn compare(
    name: &str,
    looks: [&BenchLook; 2],
    document: &mut Document,
    pictures: &mut BenchPictures,
    suite: Suite,
) -> Result<Option<FeatureReport>> {
    let mut times: [Vec<Duration>; 2] = Default::default();
    let begun = Instant::now();
    // The first of each is not counted: it may have to prepare something.
    while times[0].len() <= suite.frames()
        && (times[0].len() <= LEAST_RUNS || begun.elapsed() < suite.patience())
    {
        for (look, times) in looks.iter().zip(&mut times) {
            if !pictures.set_look(Some(look)) {
                return Ok(None);
            }
            times.push(pictures.whole(document)?.whole());
        }
    }
    let [without, with] = times.map(|times| Times::of(&times[1..]));
    Ok(without.zip(with).map(|(without, with)| FeatureReport {
        name: name.to_string(),
        frame: with,
        more_ms: with.median_ms - without.median_ms,
    }))
}
