//! The frame description: how a sculpture is to be seen, as values. What a renderer takes beside the document.

use glam::Affine3A;

use super::overlay::{Line, ToolPreview};
use super::{Background, RenderMode, Surface, Video};
use crate::document::Document;
use crate::sculpture::Grid;
use crate::shade::{Ground, LevelSet, Lighting, NORMAL_REACH_VX, ShadePose};
use crate::view::Eye;

/// When pictures show the surface between the voxels, where a voxel covers more than a pixel, in modes that can.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SmoothSurface {
    #[default]
    Never,
    /// Once a picture is refined ([`super::Renderer::set_refinement`]): it takes many times as long as the voxels.
    AtRest,
    Always,
}

/// A frame description: how a sculpture is to be seen.
#[derive(Clone, Copy, Debug)]
pub struct FrameDesc<'a> {
    /// One or two of the same size in pixels.
    pub eyes: &'a [Eye],
    pub world_from_grid: Affine3A,
    pub mode: RenderMode,
    pub smooth_surface: SmoothSurface,
    /// Edges are smooth in pictures that are not refined.
    pub smooth_edges: bool,
    /// Which of the samples of antialiased pictures this is ([`FrameDesc::of_sample`]); 0 for other pictures.
    pub sample: u32,
    pub lighting: Lighting,
    pub background: Background,
    /// The ground below the sculpture.
    pub ground: Option<Ground>,
    /// Replaces the background.
    pub video: Option<Video<'a>>,
    /// The tool previews.
    pub previews: &'a [ToolPreview],
    pub lines: &'a [Line],
}

impl<'a> FrameDesc<'a> {
    /// This description of one of the samples of an antialiased picture, which these eyes take; each has sharp edges.
    pub fn of_sample(self, eyes: &'a [Eye], sample: u32) -> FrameDesc<'a> {
        let lighting = self.lighting.of_sample(sample);
        let ground = self.ground.map(|ground| ground.of_sample(sample));
        FrameDesc { eyes, sample, lighting, ground, smooth_edges: false, ..self }
    }
}

impl FrameDesc<'_> {
    /// Whether pictures of `grid` that show the smooth surface `when` do so.
    pub(super) fn is_smooth(&self, when: SmoothSurface, grid: &Grid) -> bool {
        let rays = |eye: &Eye| eye.pixel_rays(&self.world_from_grid);
        self.smooth_surface == when
            && self.mode.can_be_smooth()
            && self.eyes.iter().any(|eye| LevelSet::shows(grid, &rays(eye)))
    }

    pub(super) fn pose(&self, eye: &Eye) -> ShadePose {
        ShadePose { eye_from_world: eye.eye_from_world, world_from_grid: self.world_from_grid }
    }

    /// How far from a changed voxel those are whose shade may differ, where that is local.
    pub(super) fn reach_vx(&self) -> u32 {
        self.lighting.reach_vx().unwrap_or(NORMAL_REACH_VX)
    }

    /// The surface of the document's sculpture in one colour. `estimates`: see [`Surface::estimates`].
    pub(super) fn surface(&self, document: &Document, estimates: bool, eye: &Eye) -> Surface<'_> {
        Surface {
            dims: document.grid().dims(),
            colours: None,
            base: document.material().base(),
            normals: None,
            estimates,
            pose: self.pose(eye),
            lighting: &self.lighting,
        }
    }
}
