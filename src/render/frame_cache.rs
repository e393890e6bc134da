//! The frame cache: the values that the current pictures were made from, and the redraw plan of a new frame
//! description.
//!
//! Pure values: knows no device and no pass.

use std::time::Instant;

use glam::Affine3A;

use super::frame_desc::{FrameDesc, SmoothSurface};
use super::normal_stage::NormalsChange;
use super::overlay_pixels::PictureOfGrid;
use super::overlay_scene::{OverlayLine, ToolPreview};
use super::{Background, MAX_EYES, MaskShown, VideoView};
use super::{RenderMode, Shading};
use crate::document::Document;
use crate::shade::{Ground, Lighting};
use crate::surface::{PixelRects, changed_pixels};
use crate::view::{Eye, PixelRays};

/// The values on which the index maps of pictures depend.
#[derive(Clone, Copy, PartialEq)]
struct SampleKey {
    revision: u64,
    eyes: [Option<Eye>; MAX_EYES],
    world_from_grid: Affine3A,
    mode: RenderMode,
    smooth: bool,
    mask: Option<MaskShown>,
}

impl SampleKey {
    /// Returns whether both differ by edits of the sculpture only.
    fn differs_by_edits_only(&self, other: &SampleKey) -> bool {
        *self == SampleKey { revision: self.revision, ..*other }
    }
}

/// The values on which the current pictures depend.
pub(super) struct FrameCache {
    sample: SampleKey,
    lighting: Lighting,
    background: Background,
    ground: Option<Ground>,
    smooth_edges: bool,
    smooth_surface: SmoothSurface,
    video: Option<(Instant, VideoView)>,
    previews: Vec<ToolPreview>,
    lines: Vec<OverlayLine>,
}

impl FrameCache {
    /// Returns the key of the pictures of `desc`, reusing the allocations of a former one. `smooth`: they show the
    /// smooth surface.
    pub fn new(
        former: Option<FrameCache>,
        document: &Document,
        desc: &FrameDesc,
        smooth: bool,
    ) -> FrameCache {
        let (mut previews, mut lines) =
            former.map_or_else(Default::default, |f| (f.previews, f.lines));
        previews.clear();
        previews.extend_from_slice(desc.previews);
        lines.clear();
        lines.extend_from_slice(desc.lines);
        let FrameDesc { lighting, background, ground, smooth_edges, smooth_surface, .. } = *desc;
        let video = desc.video.map(|video| video.key());
        FrameCache {
            sample: sample_key(document, desc, smooth),
            lighting,
            background,
            ground,
            smooth_edges,
            smooth_surface,
            video,
            previews,
            lines,
        }
    }

    /// Returns whether pictures of `desc` (of the voxels) differ from these by some edits of the sculpture, and by
    /// nothing else.
    pub fn is_edited_only(&self, document: &Document, desc: &FrameDesc) -> bool {
        let sample = sample_key(document, desc, false);
        self.sample != sample && self.sample.differs_by_edits_only(&sample)
    }

    /// Returns whether pictures of `desc` show the same points of the sculpture as these.
    pub fn is_of(&self, document: &Document, desc: &FrameDesc) -> bool {
        self.sample == sample_key(document, desc, self.sample.smooth)
    }

    pub fn mode(&self) -> RenderMode {
        self.sample.mode
    }
}

/// The part of a picture to repeat.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Redraw {
    All,
    /// The pixels that changed bricks, tools and lines may affect.
    Changed,
}

/// The stages to repeat in a frame.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct RedrawPlan {
    pub sample: Option<Redraw>,
    pub shade: Option<Redraw>,
    pub compose: Option<Redraw>,
}

impl RedrawPlan {
    /// Returns whether the pictures stay as they are.
    pub fn is_nothing(&self) -> bool {
        let RedrawPlan { sample, shade, compose } = self;
        sample.is_none() && shade.is_none() && compose.is_none()
    }

    /// Returns the plan from the pictures of `before` to those of `desc`. `changes_known`: the bricks changed since are
    /// known. `smooth`: [`super::level_stage::LevelStage::state`].
    pub fn new(
        before: Option<&FrameCache>,
        document: &Document,
        desc: &FrameDesc,
        changes_known: bool,
        normals: NormalsChange,
        smooth: Option<bool>,
    ) -> RedrawPlan {
        let all = Some(Redraw::All);
        let Some(before) = before else {
            return RedrawPlan { sample: all, shade: all, compose: all };
        };
        let sample = sample_key(document, desc, smooth.is_some());
        let same_light = before.lighting == desc.lighting;
        // Any change of the document may change the shadow.
        let same_ground = before.ground == desc.ground
            && (desc.ground.is_none() || before.sample.revision == sample.revision);
        let same_back = before.background == desc.background
            && same_ground
            && before.smooth_edges == desc.smooth_edges
            // The picture at rest depends on it.
            && before.smooth_surface == desc.smooth_surface
            && before.video == desc.video.map(|video| video.key());
        let same_tools = before.previews == desc.previews && before.lines == desc.lines;
        // While the view is still, an edit changes only some of the pixels.
        let redraw_if = |partial: bool| if partial { Redraw::Changed } else { Redraw::All };
        let still = changes_known && before.sample.differs_by_edits_only(&sample);
        let resample = before.sample != sample || smooth == Some(true);
        let reshade = resample || !same_light || normals != NormalsChange::None;
        let recompose = reshade || !(same_back && same_tools);
        // Filters read the pixels around.
        let is_local = desc.lighting.reach_vx().is_some() && normals != NormalsChange::All;
        let shade_redraw = redraw_if(still && same_light && is_local);
        // Points cover more than their pixels.
        let within_pixels = desc.mode.shading() != Shading::Points;
        let compose_redraw = match reshade {
            true => shade_redraw,
            false => redraw_if(still),
        };
        RedrawPlan {
            sample: resample.then_some(redraw_if(still)),
            shade: reshade.then_some(shade_redraw),
            compose: recompose.then_some(match same_back && within_pixels {
                true => compose_redraw,
                false => Redraw::All,
            }),
        }
    }
}

/// Returns the pixels of `eye`, which has `rays`, to repeat for [`Redraw::Changed`]: those of tools or lines that
/// differ from `before`, and those whose voxel or shade may have changed with the `changed` bricks.
pub(super) fn pixels_to_compose(
    before: &FrameCache,
    document: &Document,
    changed: &[u32],
    desc: &FrameDesc,
    eye: &Eye,
    rays: &PixelRays,
) -> PixelRects {
    let mut rects = changed_pixels(document.grid(), changed, rays, desc.reach_vx());
    let clip_from_grid = eye.clip_from_grid(&desc.world_from_grid);
    let picture = PictureOfGrid { clip_from_grid, size: eye.size };
    let former = (before.previews.as_slice(), before.lines.as_slice());
    picture.add_changes(former, (desc.previews, desc.lines), &mut rects);
    rects.without_overlap()
}

fn sample_key(document: &Document, desc: &FrameDesc, smooth: bool) -> SampleKey {
    let mut eyes = [None; MAX_EYES];
    for (key, eye) in eyes.iter_mut().zip(desc.eyes) {
        *key = Some(*eye);
    }
    SampleKey {
        revision: document.revision(),
        eyes,
        world_from_grid: desc.world_from_grid,
        mode: desc.mode,
        smooth,
        mask: desc.mask_shown(document),
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, Vec3};

    use super::super::SmoothSurface;
    use super::*;
    use crate::document::Limits;
    use crate::sculpture::history::Contents;
    use crate::sculpture::{ColourDepth, Grid, Material, Rgb};
    use crate::shade::Smoothing;
    use crate::view::Camera;

    #[test]
    fn an_unchanged_frame_is_not_drawn_again_and_a_local_change_only_in_part() {
        let grid = Grid::new(glam::UVec3::splat(16), Vec3::ONE, 1 << 20).unwrap();
        let material = Material::for_grid(&grid, ColourDepth::None, Rgb::default());
        let mut document =
            Document::from_contents(Contents::new(grid, material), Limits::default());
        let eyes = [Camera::default().eye(UVec2::new(40, 30))];
        let line = OverlayLine {
            from: Vec3::ZERO,
            to: Vec3::ONE,
            colour: Rgb::default(),
            width_px: 1.0,
            opacity: [1.0; 2],
        };
        let desc = FrameDesc {
            eyes: &eyes,
            world_from_grid: Affine3A::IDENTITY,
            mode: RenderMode::Ray,
            smooth_surface: SmoothSurface::Never,
            sample: 0,
            lighting: Lighting::default(),
            show_mask: false,
            background: Background::Keep,
            ground: None,
            smooth_edges: false,
            video: None,
            previews: &[],
            lines: &[],
        };
        let steps = |sample, shade, compose| RedrawPlan { sample, shade, compose };
        let (all, some) = (Some(Redraw::All), Some(Redraw::Changed));
        assert_eq!(
            RedrawPlan::new(None, &document, &desc, true, NormalsChange::None, None),
            steps(all, all, all)
        );

        let shown = FrameCache::new(None, &document, &desc, false);
        let to = |document: &Document, desc: &FrameDesc| {
            RedrawPlan::new(Some(&shown), document, desc, true, NormalsChange::None, None)
        };
        assert_eq!(to(&document, &desc), steps(None, None, None));
        for (normals, shaded) in [(NormalsChange::Some, some), (NormalsChange::All, all)] {
            let plan = RedrawPlan::new(Some(&shown), &document, &desc, true, normals, None);
            assert_eq!(plan, steps(None, shaded, shaded));
        }
        // The levels of the smooth surface follow the normals; showing it at all is another picture.
        let smooth = |before: &FrameCache, smooth| {
            RedrawPlan::new(Some(before), &document, &desc, true, NormalsChange::None, smooth)
        };
        let shown_smooth = FrameCache::new(None, &document, &desc, true);
        assert_eq!(smooth(&shown_smooth, Some(false)), steps(None, None, None));
        assert_eq!(smooth(&shown_smooth, Some(true)), steps(some, some, some));
        assert_eq!(smooth(&shown, Some(true)), steps(all, all, all));
        assert_eq!(smooth(&shown_smooth, None), steps(all, all, all));
        let with_line = FrameDesc { lines: &[line], ..desc };
        assert_eq!(to(&document, &with_line), steps(None, None, some));
        let before_black = Background::Gradient { top: Vec3::ZERO, bottom: Vec3::ZERO };
        let shot_before_black = FrameDesc { background: before_black, lines: &[line], ..desc };
        assert_eq!(to(&document, &shot_before_black), steps(None, None, all));
        let mut dark = desc;
        dark.lighting.ambient = 0.0;
        assert_eq!(to(&document, &dark), steps(None, all, all));
        let moved = FrameDesc { world_from_grid: Affine3A::from_translation(Vec3::X), ..desc };
        assert_eq!(to(&document, &moved), steps(all, all, all));

        document.apply(&"add cuboid at=8,8,8 half=2,2,2 colour=#ffffff".parse().unwrap()).unwrap();
        assert_eq!(to(&document, &desc), steps(some, some, some));
        assert_eq!(
            RedrawPlan::new(Some(&shown), &document, &desc, false, NormalsChange::None, None),
            steps(all, all, all)
        );
        assert_eq!(to(&document, &dark), steps(some, all, all));
        // Points cover more than their pixels.
        let points = FrameDesc { mode: RenderMode::RayPoints, ..desc };
        let of_points = FrameCache::new(None, &document, &points, false);
        let points = FrameDesc { lines: &[line], ..points };
        let to_points =
            RedrawPlan::new(Some(&of_points), &document, &points, true, NormalsChange::None, None);
        assert_eq!(to_points, steps(None, None, all));
        // Occlusion reaches voxels around the changed ones, filters reach their neighbours in the picture.
        let (mut occluded, mut filtered) = (desc, desc);
        occluded.lighting.occlusion = true;
        filtered.lighting.smooth_normals = Smoothing::Near;
        let shown =
            [&occluded, &filtered].map(|desc| FrameCache::new(None, &document, desc, false));
        document.apply(&"undo 1".parse().unwrap()).unwrap();
        for (shown, (desc, part)) in shown.iter().zip([(&occluded, some), (&filtered, all)]) {
            let plan =
                RedrawPlan::new(Some(shown), &document, desc, true, NormalsChange::None, None);
            assert_eq!(plan, steps(some, part, part));
        }
    }
}
