//! Solids that are drawn rather than placed in a box. Each has a file that describes it, and a row in the list below.
//!
//! Maps a [`DrawnSolid`] to the [`crate::sculpture::region::Region`] of its voxels ([`region`]). Knows no grid's
//! contents and no document.

pub mod curve;
mod extrusion;
mod fields;
mod frame;
mod half_space;
mod lathe;
mod outline;
mod plane_rows;
pub mod region;
mod ring;
mod spec;
mod tube;

use glam::{DVec3, Vec3};

use crate::refusal::InvalidValue;
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

pub use fields::{ControlPoint, FURTHEST_VX, Field, FieldValue, MAX_POINTS, SolidPose, is_place};
pub use spec::DrawnSpec;
use spec::{DrawnShape, Surface};

/// Makes the enums and the list, and delegates each computation to the file of the solid.
macro_rules! drawn_solids {
    ($($id:ident = $file:ident),* $(,)?) => {
        $(pub use $file::$id;)*

        /// A solid that is drawn.
        #[derive(Clone, PartialEq, Debug)]
        pub enum DrawnSolid {
            $(
                #[doc = concat!("Described in `", stringify!($file), ".rs`.")]
                $id($id)
            ),*
        }

        impl DrawnSolid {
            /// The descriptions of all drawn solids, in the order of help.
            pub const ALL: [&'static DrawnSpec; [$(stringify!($id)),*].len()] = [$(&$id::SPEC),*];

            /// Returns its description.
            pub const fn spec(&self) -> &'static DrawnSpec {
                match self {
                    $(DrawnSolid::$id(_) => &$id::SPEC),*
                }
            }

            /// Returns its fields, in the order of the text form.
            pub fn fields(&mut self) -> Vec<Field<'_>> {
                match self {
                    $(DrawnSolid::$id(solid) => solid.fields()),*
                }
            }

            fn check_together(&self) -> Result<(), &'static str> {
                match self {
                    $(DrawnSolid::$id(solid) => solid.check()),*
                }
            }

            fn surface(&self, stretch: DVec3) -> DrawnSurface {
                match self {
                    $(DrawnSolid::$id(solid) => DrawnSurface::$id(solid.surface(stretch))),*
                }
            }
        }

        $(
            impl From<$id> for DrawnSolid {
                fn from(solid: $id) -> DrawnSolid {
                    DrawnSolid::$id(solid)
                }
            }
        )*

        /// The surface of a drawn solid.
        #[derive(Clone, Debug)]
        enum DrawnSurface {
            $($id(<$id as DrawnShape>::Surface)),*
        }

        impl Surface for DrawnSurface {
            fn bounds(&self) -> [DVec3; 2] {
                match self {
                    $(DrawnSurface::$id(surface) => surface.bounds()),*
                }
            }

            fn longest(&self) -> f64 {
                match self {
                    $(DrawnSurface::$id(surface) => surface.longest()),*
                }
            }

            #[inline]
            fn distance(&self, p: DVec3, pieces: &[u32]) -> f64 {
                match self {
                    $(DrawnSurface::$id(surface) => surface.distance(p, pieces)),*
                }
            }

            fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage {
                match self {
                    $(DrawnSurface::$id(surface) => surface.coverage(points, margin)),*
                }
            }

            fn is_plane(&self) -> bool {
                match self {
                    $(DrawnSurface::$id(surface) => surface.is_plane()),*
                }
            }

            fn pieces_near(&self, low: DVec3, high: DVec3) -> Vec<u32> {
                match self {
                    $(DrawnSurface::$id(surface) => surface.pieces_near(low, high)),*
                }
            }
        }
    };
}

drawn_solids! {
    HalfSpace = half_space,
    Ring = ring,
    Tube = tube,
    Lathe = lathe,
    Extrusion = extrusion,
}

impl DrawnSolid {
    /// Returns its name in the text form.
    pub const fn name(&self) -> &'static str {
        self.spec().name
    }

    /// Returns the description of the solid with this name.
    pub fn named(name: &str) -> Option<&'static DrawnSpec> {
        DrawnSolid::ALL.into_iter().find(|spec| spec.name == name)
    }

    /// Checks all fields and their rules. The error says which rule is broken.
    pub fn check(&self) -> Result<(), InvalidValue> {
        let invalid =
            |rule| InvalidValue::without_value(self.name(), format!("is not valid: {rule}"));
        self.check_rules().map_err(invalid)
    }

    fn check_rules(&self) -> Result<(), &'static str> {
        let mut solid = self.clone();
        // Of several errors, one in a position is reported first.
        let (lengths, others): (Vec<_>, Vec<_>) =
            solid.fields().into_iter().partition(Field::is_length);
        others.iter().chain(&lengths).try_for_each(Field::check)?;
        self.check_together()
    }

    /// Returns the same solid, moved by a number of voxels.
    pub fn shifted(&self, by_vx: Vec3) -> DrawnSolid {
        let mut solid = self.clone();
        solid.fields().into_iter().for_each(|field| field.shift(by_vx));
        solid
    }
}
