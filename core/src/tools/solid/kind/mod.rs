//! The list of solids, each described in a file of its own.
//!
//! From a kind and half extents to the inside test, the test of the swept volume and the support, in tool space. Knows
//! no voxels and no pose.

mod capsule;
mod cone;
mod cuboid;
mod cylinder;
mod ellipsoid;
mod pyramid;
mod rounded_cuboid;
pub mod torus;

use std::sync::LazyLock;

use glam::DVec3;

use super::parts::MinkowskiParts;
use super::simd_real::SimdReal;
use super::spec::SolidSpec;

/// Generates the enum and its list, and forwards each computation to the file of the solid, so that it is compiled into
/// the loops that call it.
macro_rules! solids {
    ($($id:ident = $file:ident),* $(,)?) => {
        /// The kind of a solid. In tool space it lies in [-1, 1] on every axis.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum Solid {
            $(
                #[doc = concat!("Described in `", stringify!($file), ".rs`.")]
                $id
            ),*
        }

        impl Solid {
            /// All solids, in the order in which interfaces offer them.
            pub const ALL: [Solid; [$(Solid::$id),*].len()] = [$(Solid::$id),*];

            /// Returns the description.
            pub const fn spec(self) -> &'static SolidSpec {
                match self {
                    $(Solid::$id => &$file::SPEC),*
                }
            }

            /// Tests whether one point or eight lie inside.
            #[inline(always)]
            pub(super) fn holds<N: SimdReal>(self, parts: &MinkowskiParts, p: [N; 3]) -> N::Mask {
                match self {
                    $(Solid::$id => $file::holds(parts, p)),*
                }
            }

            /// Returns whether the solid passes over one point or eight when it moves by `displacement`. Points with a
            /// value up to `margin` instead of 0 count as inside.
            #[inline(always)]
            pub(super) fn passes<N: SimdReal>(
                self,
                parts: &MinkowskiParts,
                p: [N; 3],
                displacement: DVec3,
                margin: f64,
            ) -> N::Mask {
                match self {
                    $(Solid::$id => $file::passes(parts, p, displacement, margin)),*
                }
            }

            /// Returns the greatest change of the value over `offset` (at least 0 on each axis), for any signs of its
            /// components.
            #[inline(always)]
            pub(super) fn slack(self, parts: &MinkowskiParts, offset: DVec3) -> f64 {
                match self {
                    $(Solid::$id => $file::slack(parts, offset)),*
                }
            }

            /// Returns the maximum of `direction . p` over the solid.
            #[inline(always)]
            pub(super) fn support(self, parts: &MinkowskiParts, direction: DVec3) -> f64 {
                match self {
                    $(Solid::$id => $file::support(parts, direction)),*
                }
            }

            /// Returns a point of the solid that lies furthest along `direction`.
            pub(super) fn furthest(self, parts: &MinkowskiParts, direction: DVec3) -> DVec3 {
                match self {
                    $(Solid::$id => $file::furthest(parts, direction)),*
                }
            }
        }
    };
}

solids! {
    Ellipsoid = ellipsoid,
    Cuboid = cuboid,
    Pyramid = pyramid,
    Cylinder = cylinder,
    Cone = cone,
    Torus = torus,
    Capsule = capsule,
    RoundedCuboid = rounded_cuboid,
}

impl Solid {
    /// Returns the name in the text form.
    pub const fn name(self) -> &'static str {
        self.spec().name
    }

    /// Returns the solid with a name.
    pub fn named(name: &str) -> Option<Solid> {
        Solid::ALL.into_iter().find(|solid| solid.name() == name)
    }

    /// Returns all names, for messages: separated by commas, `or` before the last.
    pub fn names() -> &'static str {
        static NAMES: LazyLock<String> = LazyLock::new(|| {
            let names: Vec<&str> = Solid::ALL.iter().map(|solid| solid.name()).collect();
            match names.split_last() {
                Some((last, first)) => format!("{} or {last}", first.join(", ")),
                None => String::new(),
            }
        });
        &NAMES
    }
}
