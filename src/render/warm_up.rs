//! Warm-up of a renderer: compiles the pipelines of its first picture in advance, on a thread that may block.
//!
//! Takes the properties of a picture that select pipelines and specialization constants. Renders a small picture with
//! them and waits for it, so that no pass is missed and drivers compile even shaders that they defer to the first draw
//! call. Knows no window and no headset.

use std::time::{Duration, Instant};

use glam::{Quat, UVec2, UVec3, Vec3};

use super::SmoothSurface;
use super::overlay_scene::{OverlayLine, ToolPreview};
use super::{Background, FrameDesc, RenderMode, Renderer};
use crate::document::{Document, Limits};
use crate::gpu::{Frames, GpuError, Result};
use crate::sculpture::history::Contents;
use crate::sculpture::{Brick, ColourDepth, Grid, Material, Placement, Rgb};
use crate::shade::Lighting;
use crate::tools::solid::{Primitive, Solid};
use crate::view::Camera;

/// Edge of the sculpture in voxels.
const EDGE_VX: u32 = 16;
const SIZE_PX: UVec2 = UVec2::splat(32);
const GREY: Rgb = Rgb::new(128, 128, 128);

/// The values that determine the pipelines of a picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct WarmUp {
    pub mode: RenderMode,
    pub lighting: Lighting,
    /// [`FrameDesc::smooth_edges`].
    pub smooth_edges: bool,
    /// Bits of colour per voxel of the sculpture.
    pub depth: ColourDepth,
}

impl WarmUp {
    /// Creates all pipelines of such pictures of `renderer`, for one eye or two, including tool preview, lines and
    /// refinement, but not video and ground. Waits for the device. The next picture is drawn from scratch.
    pub fn run(&self, renderer: &mut Renderer) -> Result<()> {
        let begun = Instant::now();
        let mut document = document(self.depth)?;
        let radius = 0.5 * document.grid().dims().as_vec3().length();
        let eye = Camera::framing(radius, Vec3::ONE, Vec3::Y).eye(SIZE_PX);
        let grey = Vec3::splat(0.5);
        let centre_vx = Vec3::splat(0.5 * EDGE_VX as f32);
        let rotation = Quat::IDENTITY;
        let half = Vec3::splat(EDGE_VX as f32);
        let tool = ToolPreview {
            primitive: Primitive { solid: Solid::Ellipsoid, centre_vx, half, rotation },
            voxel_size: Vec3::ONE,
            colour: GREY,
            opacity: [0.5; 2],
        };
        let line = OverlayLine {
            from: Vec3::ZERO,
            to: 2.0 * centre_vx,
            colour: GREY,
            width_px: 2.0,
            opacity: [0.5; 2],
        };
        let desc = FrameDesc {
            eyes: &[eye; 2],
            world_from_grid: Placement::default()
                .world_from_framed(&document.contents().frame, document.grid().voxel_size()),
            mode: self.mode,
            smooth_surface: SmoothSurface::Never,
            sample: 0,
            lighting: self.lighting,
            show_mask: false,
            background: Background::Gradient { top: grey, bottom: grey },
            ground: None,
            smooth_edges: self.smooth_edges,
            video: None,
            previews: &[tool],
            lines: &[line],
        };
        let device = renderer.stages.device.clone();
        let mut frames = Frames::new(&device)?;
        let patience = renderer.stages.normals.patience;
        let (samples, at_once) = renderer.stages.refinement.policy();
        renderer.set_refinement(2);
        renderer.refine_at_once(true);
        // With estimates of normals, which take another pipeline, with all normals, and the samples of the mean;
        // finally the smooth surface.
        let (never, smooth) = (SmoothSurface::Never, SmoothSurface::on_screen(true));
        for (patience_here, smooth_surface) in [
            (Some(Duration::ZERO), never),
            (None, never),
            (None, never),
            (None, never),
            (None, smooth),
        ] {
            let desc = FrameDesc { smooth_surface, ..desc };
            renderer.set_patience(patience_here);
            let mut recorder = frames.begin()?;
            let slot = frames.slot();
            renderer.paint_with_fallback(&mut recorder, slot, &mut document, &desc, |_| true)?;
            device.wait(frames.submit(recorder, &[], &[])?)?;
        }
        renderer.set_patience(patience);
        renderer.set_refinement(samples);
        renderer.refine_at_once(at_once);
        let taken_ms = begun.elapsed().as_secs_f64() * 1e3;
        tracing::debug!("warmed up for {:?} in {taken_ms:.0} ms", self.mode);
        renderer.forget_pictures()
    }
}

/// Returns a solid cube.
fn document(depth: ColourDepth) -> Result<Document> {
    let limits = Limits::default();
    let mut grid = Grid::new(UVec3::splat(EDGE_VX), Vec3::ONE, limits.grid_bytes)
        .map_err(|error| GpuError::Host(error.to_string()))?;
    grid.fill_bricks(|_| Brick::FULL);
    let material = Material::for_grid(&grid, depth, GREY);
    Ok(Document::from_contents(Contents::new(grid, material), limits))
}
