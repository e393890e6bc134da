//! The contents of a sculpture: all that undo restores.
//!
//! Knows no history and no record of changes.

use glam::{IVec3, UVec3};

use super::brick::{BRICK_EDGE_VX, local_index};
use super::canvas_frame::{Canvas, CanvasFrame};
use super::colour::{ColourDepth, Rgb};
use super::grid::Grid;
use super::material::Material;

/// The form in which nearby voxels are shown, and the default for their mesh.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum SurfaceKind {
    /// A smooth surface between the voxels: for clay and scans.
    #[default]
    Smooth,
    /// The cubes of the voxels: for models from voxel editors.
    Cubes,
}

impl SurfaceKind {
    /// All kinds with their names in the text form.
    pub const NAMED: [(SurfaceKind, &'static str); 2] =
        [(SurfaceKind::Smooth, "smooth"), (SurfaceKind::Cubes, "cubes")];

    /// Returns its name in the text form.
    pub fn name(self) -> &'static str {
        match self {
            SurfaceKind::Smooth => "smooth",
            SurfaceKind::Cubes => "cubes",
        }
    }
}

/// All that undo restores: existence bits, colours, the mask, the kind of surface and the frame of the canvas.
#[derive(Clone, PartialEq, Debug)]
pub struct Contents {
    /// Which voxels exist.
    pub grid: Grid,
    /// Their colours.
    pub material: Material,
    /// The voxels, existing or not, that are protected from all tools: a grid of the same size. `None` if there are
    /// none.
    pub mask: Option<Box<Grid>>,
    /// The form in which nearby voxels are shown.
    pub surface: SurfaceKind,
    /// Where the grid lies in signed coordinates.
    pub frame: CanvasFrame,
}

impl Contents {
    /// Returns contents of bits and colours with nothing protected.
    pub fn new(grid: Grid, material: Material) -> Contents {
        let frame = CanvasFrame::of(grid.dims());
        Contents { grid, material, mask: None, surface: SurfaceKind::default(), frame }
    }

    /// Returns a grid as contents without colours or a mask of its own.
    pub(crate) fn of_bits(grid: Grid) -> Contents {
        let material = Material::for_grid(&grid, ColourDepth::None, Rgb::default());
        Contents::new(grid, material)
    }

    /// Returns the box of the sculpture.
    pub fn canvas(&self) -> Canvas {
        Canvas { dims: self.grid.dims(), frame: self.frame }
    }

    /// Returns whether the voxel at `v` is protected.
    pub fn is_masked(&self, v: IVec3) -> bool {
        self.mask.as_ref().is_some_and(|mask| mask.get(v))
    }

    /// Drops a mask that protects nothing.
    pub(crate) fn drop_empty_mask(&mut self) {
        self.mask.take_if(|mask| mask.opaque_count() == 0);
    }

    /// Returns the colour of the voxel at `v`, which must lie inside the grid, whether it exists or not.
    pub fn rgb(&self, v: UVec3) -> Rgb {
        let [x, y, z] = (v % BRICK_EDGE_VX).to_array();
        self.material.rgb(v / BRICK_EDGE_VX, local_index(x, y, z))
    }

    /// Returns the colour of the voxel at `v`; `None` if it does not exist.
    pub fn colour(&self, v: IVec3) -> Option<Rgb> {
        self.grid.get(v).then(|| self.rgb(v.as_uvec3()))
    }

    /// Returns the bytes of a step that keeps all of the contents.
    pub fn kept_bytes(&self) -> usize {
        let mask = self.mask.as_ref().map_or(0, |mask| mask.heap_bytes());
        size_of::<Contents>()
            + (self.grid.heap_bytes() + self.material.heap_bytes() + mask) as usize
    }
}
