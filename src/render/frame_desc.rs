//! The frame description: how a sculpture is to be seen, as values. A renderer takes it beside the document.

use glam::Affine3A;

use super::overlay_scene::{Line, ToolPreview};
use super::{Background, RenderMode, Surface, Video};
use crate::document::Document;
use crate::sculpture::Rgb;
use crate::sculpture::history::{Contents, SurfaceKind};
use crate::shade::{
    Ground, LevelSet, Lighting, NORMAL_REACH_VX, NormalField, ShadePose, ShadeSource, ShownColours,
};
use crate::view::Eye;

/// When pictures show the surface between the voxels, where a voxel covers more than a pixel, in modes that can, of
/// sculptures that are not shown as cubes ([`SurfaceKind`]).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SmoothSurface {
    #[default]
    Never,
    /// At once where a GPU finds it; elsewhere it takes many times as long as the voxels, and is shown once a picture
    /// is refined ([`super::Renderer::set_refinement`]).
    AtRest,
    Always,
}

impl SmoothSurface {
    /// Returns the choice for a window or a headset: the smooth surface at rest, if it is asked for.
    pub fn on_screen(asked_for: bool) -> SmoothSurface {
        if asked_for { SmoothSurface::AtRest } else { SmoothSurface::Never }
    }

    /// Returns when pictures of `mode` show it on a device, which is a GPU or `software`.
    fn of_mode(self, mode: RenderMode, software: bool) -> SmoothSurface {
        match self {
            _ if !mode.can_be_smooth() => SmoothSurface::Never,
            SmoothSurface::AtRest if mode.shades_on_device() && !software => SmoothSurface::Always,
            asked => asked,
        }
    }
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
    /// Protected voxels are tinted.
    pub show_mask: bool,
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

/// A mask that is shown.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct MaskShown {
    /// The colour that is shown of all voxels instead of their own.
    instead: Option<Rgb>,
}

impl MaskShown {
    /// Returns the colours that shaders on a device look up; without a mask those of the voxels, which looks replace.
    pub fn colours(mask: Option<MaskShown>, contents: &Contents) -> ShownColours<'_> {
        let Contents { grid, material, .. } = contents;
        let instead = mask.and_then(|mask| mask.instead);
        let mask = contents.mask.as_deref().filter(|_| mask.is_some());
        ShownColours { grid, material, instead, mask }
    }
}

impl FrameDesc<'_> {
    /// Returns the document's mask, if there is one and pictures show it.
    pub(super) fn mask_shown(&self, document: &Document) -> Option<MaskShown> {
        let one_colour = self.mode.shades_on_device() && !self.mode.needs_colours();
        let base = || one_colour.then(|| document.material().base());
        let look = self.lighting.look.substance().map(|substance| substance.colour);
        let is_shown = self.show_mask && document.contents().mask.is_some();
        is_shown.then(|| MaskShown { instead: look.or_else(base) })
    }

    /// Returns the source of shading on the CPU.
    pub(super) fn source<'a>(
        &self,
        document: &'a Document,
        normals: &'a NormalField,
    ) -> ShadeSource<'a> {
        let Contents { grid, material, mask, .. } = document.contents();
        ShadeSource { grid, material, normals, mask: mask.as_deref().filter(|_| self.show_mask) }
    }

    /// Returns whether pictures of `contents` that show the smooth surface `when` do so on a device, a GPU or
    /// `software`.
    pub(super) fn is_smooth(
        &self,
        when: SmoothSurface,
        contents: &Contents,
        software: bool,
    ) -> bool {
        let rays = |eye: &Eye| eye.pixel_rays(&self.world_from_grid);
        contents.surface == SurfaceKind::Smooth
            && self.smooth_surface.of_mode(self.mode, software) == when
            && self.eyes.iter().any(|eye| LevelSet::shows(&contents.grid, &rays(eye)))
    }

    pub(super) fn pose(&self, eye: &Eye) -> ShadePose {
        ShadePose { eye_from_world: eye.eye_from_world, world_from_grid: self.world_from_grid }
    }

    /// Returns how far from a changed voxel those are whose shade may differ, where that is local.
    pub(super) fn reach_vx(&self) -> u32 {
        self.lighting.reach_vx().unwrap_or(NORMAL_REACH_VX)
    }

    /// Returns the surface of the document's sculpture in one colour. `estimates`: see [`Surface::estimates`].
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The headset's pictures are never refined, so it shows the surface where this is `Always`.
    #[test]
    fn gpus_show_the_smooth_surface_always_and_processors_at_rest() {
        use SmoothSurface::{Always, AtRest, Never};
        let asked = SmoothSurface::on_screen(true);
        // The mode that windows and headsets have on a GPU, if nobody chooses another.
        assert_eq!(asked.of_mode(RenderMode::usual(false), false), Always);
        for mode in RenderMode::ALL {
            let (on_gpu, on_cpu) = match mode {
                RenderMode::MarchGpu | RenderMode::Gpu | RenderMode::GpuColour => (Always, AtRest),
                RenderMode::SlicingPoints | RenderMode::RayPoints => (Never, Never),
                _ => (AtRest, AtRest),
            };
            assert_eq!(
                [false, true].map(|software| asked.of_mode(mode, software)),
                [on_gpu, on_cpu]
            );
            let not_asked = SmoothSurface::on_screen(false);
            assert_eq!(not_asked.of_mode(mode, false), Never);
            // Pictures in files wait for it.
            let in_files = if on_gpu == Never { Never } else { Always };
            assert_eq!(Always.of_mode(mode, true), in_files);
        }
    }
}
