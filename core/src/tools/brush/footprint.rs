//! Footprints: the area of a brush in the picture, as rays around an aim, and the rule by which it selects surface
//! voxels.
//!
//! Knows no brush and no grid; `kernel::touched` selects the voxels.

use glam::{IVec3, UVec2, Vec3};

use crate::tools::symmetry::SymmetryTransform;

/// Largest radius of a footprint, in rays.
pub const MAX_FOOTPRINT: f32 = 256.0;

/// The outline of a footprint, and the shape that is cut or added around a hit.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Outline {
    /// A disc, or a ball.
    #[default]
    Round,
    /// A square, or a cube.
    Square,
}

impl Outline {
    /// Both outlines.
    pub const ALL: [Outline; 2] = [Outline::Round, Outline::Square];

    /// Returns the name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            Outline::Round => "round",
            Outline::Square => "square",
        }
    }

    /// Returns the distance of the ray `x` to the right and `y` down from the central one, in the norm of this outline.
    #[inline(always)]
    pub fn distance(self, x: f32, y: f32) -> f32 {
        match self {
            Outline::Round => x.hypot(y),
            Outline::Square => x.abs().max(y.abs()),
        }
    }

    /// Returns whether a ray is certain to be farther than `radius` from the central one, without computing a root.
    /// Rays within a millionth of the rim are not.
    #[inline(always)]
    pub(crate) fn is_beyond(self, x: f32, y: f32, radius: f32) -> bool {
        const RIM: f32 = 1.0 + 1e-6;
        match self {
            Outline::Round => x * x + y * y > radius * radius * (RIM * RIM),
            Outline::Square => x.abs().max(y.abs()) > radius * RIM,
        }
    }
}

/// The rule by which a footprint selects surface voxels.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Coverage {
    /// Those that its rays meet: some or all of those under it, depending on the ratio of voxel to ray. The default of
    /// commands that do not state a coverage.
    #[default]
    Rays,
    /// All visible ones whose centre is projected into its outline ([`super::kernel::visible`]).
    Visible,
}

impl Coverage {
    /// Both rules.
    pub const ALL: [Coverage; 2] = [Coverage::Rays, Coverage::Visible];

    /// Returns the name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            Coverage::Rays => "rays",
            Coverage::Visible => "visible",
        }
    }
}

/// Rays under a footprint: through `aim + across * i + down * j` for i, j within `radius`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Footprint {
    /// The eye, in grid coordinates.
    pub eye_vx: Vec3,
    /// Direction of the central ray.
    pub aim: Vec3,
    /// Change of direction from a ray to its right neighbour.
    pub across: Vec3,
    /// Change of direction from a ray to the one below.
    pub down: Vec3,
    /// Radius in rays, 0 to [`MAX_FOOTPRINT`].
    pub radius: f32,
    /// Shape of the footprint in the picture.
    pub outline: Outline,
    /// The rule by which it selects voxels.
    pub coverage: Coverage,
}

/// A surface voxel under a footprint, and its distance from the footprint's centre (0) to its rim (1).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TouchedVoxel {
    /// The voxel.
    pub voxel: IVec3,
    /// The distance of the voxel's centre, or of the first ray that met it.
    pub offset: f32,
}

impl Footprint {
    /// Returns the footprint around pixel (x, y) of a picture made with `rays`, with all that is visible in it.
    pub fn of_pixel(
        rays: &crate::view::PixelRays,
        pixel: UVec2,
        radius: f32,
        outline: Outline,
    ) -> Footprint {
        Footprint {
            eye_vx: rays.origin,
            aim: rays.direction(pixel.x, pixel.y),
            across: rays.step_x,
            down: rays.step_y,
            radius,
            outline,
            coverage: Coverage::Visible,
        }
    }

    /// Returns the mirrored footprint.
    pub fn image(&self, image: &SymmetryTransform) -> Footprint {
        Footprint {
            eye_vx: image.point(self.eye_vx),
            aim: image.vector(self.aim),
            across: image.vector(self.across),
            down: image.vector(self.down),
            ..*self
        }
    }
}
