//! The frame description: the view of a sculpture, as values. A renderer takes it beside the document.

use glam::Affine3A;

use super::overlay_scene::{OverlayLine, ToolPreview};
use super::{Background, LitSurface, RenderMode, Video};
use crate::document::Document;
use crate::sculpture::Rgb;
use crate::sculpture::history::{Contents, SurfaceKind};
use crate::shade::{
    Ground, LevelSet, Lighting, NORMAL_REACH_VX, NormalField, ShadePose, ShadeSource, ShownColours,
};
use crate::view::Eye;

/// When pictures show the smooth surface between the voxels, if a voxel covers more than a pixel. Applies to modes that
/// can, and to sculptures not shown as cubes ([`SurfaceKind`]).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SmoothSurface {
    #[default]
    Never,
    /// At once on a GPU. Elsewhere it takes many times as long as the voxels, and is shown once a picture is refined
    /// ([`super::Renderer::set_refinement`]).
    AtRest,
    Always,
}

impl SmoothSurface {
    /// Returns the choice for a window or a headset: the smooth surface at rest, if requested.
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

/// A frame description: the view of a sculpture.
#[derive(Clone, Copy, Debug)]
pub struct FrameDesc<'a> {
    /// One or two of the same size in pixels.
    pub eyes: &'a [Eye],
    pub world_from_grid: Affine3A,
    pub mode: RenderMode,
    pub smooth_surface: SmoothSurface,
    /// Antialiases pictures that are not refined.
    pub smooth_edges: bool,
    /// Index of the sample of antialiased pictures ([`FrameDesc::of_sample`]); 0 for other pictures.
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
    pub lines: &'a [OverlayLine],
}

impl<'a> FrameDesc<'a> {
    /// Returns this description for one sample of an antialiased picture, with the eyes of the sample and sharp edges.
    pub fn of_sample(self, eyes: &'a [Eye], sample: u32) -> FrameDesc<'a> {
        let lighting = self.lighting.of_sample(sample);
        let ground = self.ground.map(|ground| ground.of_sample(sample));
        FrameDesc { eyes, sample, lighting, ground, smooth_edges: false, ..self }
    }
}

/// A visible mask.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct MaskShown {
    /// Replaces the colour of every voxel.
    instead: Option<Rgb>,
}

impl MaskShown {
    /// Returns the colours for shaders on a device; without a mask those of the voxels, which looks replace.
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

    /// Returns the distance from a changed voxel within which shades may differ, if that is limited.
    pub(super) fn reach_vx(&self) -> u32 {
        self.lighting.reach_vx().unwrap_or(NORMAL_REACH_VX)
    }

    /// Returns the surface of the document's sculpture in one colour. `estimates`: see [`LitSurface::estimates`].
    pub(super) fn surface(
        &self,
        document: &Document,
        estimates: bool,
        eye: &Eye,
    ) -> LitSurface<'_> {
        LitSurface {
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

    /// Checks that a headset shows the surface on GPUs: its pictures are never refined, so it needs `Always`.
    #[test]
    fn gpus_show_the_smooth_surface_always_and_processors_at_rest() {
        use SmoothSurface::{Always, AtRest, Never};
        let asked = SmoothSurface::on_screen(true);
        // The default mode of windows and headsets on a GPU.
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
