//! Brushes: a footprint in the picture or a ball on the surface, and the voxels that change under it. Each brush has a
//! file that describes it, and an entry in the list below.
//!
//! From a grid and one use of a brush to the voxels to remove, to add and to paint. Changes nothing; knows no document.

pub mod brush_use;
pub mod change;
mod clay;
mod crease;
pub mod dab;
mod devour;
mod dilate;
mod draw;
mod erode;
pub mod falloff;
mod fill;
mod flatten;
pub mod footprint;
mod grab;
mod grow;
mod inflate;
pub mod kernel;
pub mod keys;
pub mod limits;
mod mask;
mod mix;
pub mod options;
mod paint;
pub mod param;
mod pinch;
mod polish;
mod scrape;
mod smear;
mod smooth;
pub mod spec;
mod stencil;
#[cfg(test)]
mod tests;
mod twist;
mod unmask;

pub use brush_use::{BrushBall, BrushDirection, BrushSurface, BrushUse, Contact};
use spec::BrushSpec;

macro_rules! brushes {
    ($($id:ident = $file:ident),* $(,)?) => {
        /// A brush, without its options.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum BrushId {
            $(
                #[doc = concat!("Described in `", stringify!($file), ".rs`.")]
                $id
            ),*
        }

        impl BrushId {
            /// All brushes, in the order in which interfaces offer them.
            pub const ALL: &[BrushId] = &[$(BrushId::$id),*];

            /// Returns the description.
            pub const fn spec(self) -> &'static BrushSpec {
                match self {
                    $(BrushId::$id => &$file::SPEC),*
                }
            }
        }
    };
}

brushes! {
    Paint = paint,
    Devour = devour,
    Clay = clay,
    Erode = erode,
    Dilate = dilate,
    Grow = grow,
    Smooth = smooth,
    Mask = mask,
    Unmask = unmask,
    Grab = grab,
    Draw = draw,
    Inflate = inflate,
    Crease = crease,
    Flatten = flatten,
    Scrape = scrape,
    Fill = fill,
    Polish = polish,
    Pinch = pinch,
    Smear = smear,
    Twist = twist,
}
