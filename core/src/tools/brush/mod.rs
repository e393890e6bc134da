//! Brushes: a footprint in the picture or a ball on the surface, and the voxels that change under it. Each has a file that
//! describes it, and a row in the list below.
//!
//! From a grid and one use of a brush to the voxels to remove, to add and to paint. Changes nothing; knows no document.

mod clay;
mod crease;
pub mod deform;
mod devour;
mod dilate;
mod draw;
mod erode;
mod fill;
mod flatten;
pub mod footprint;
mod grab;
mod grow;
mod inflate;
pub mod kernel;
pub mod keys;
mod mask;
pub mod options;
mod paint;
pub mod param;
mod pinch;
mod scrape;
mod smear;
mod smooth;
pub mod spec;
pub mod spray;
#[cfg(test)]
mod spray_tests;
pub mod stencil;
mod twist;
mod unmask;

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

            /// Its description.
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
    Pinch = pinch,
    Smear = smear,
    Twist = twist,
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::deform::DeformKind;
    use super::spray::SprayKind;
    use super::*;

    #[test]
    fn every_brush_is_in_hand_once_and_has_words_of_its_own() {
        let sprays = SprayKind::ALL.map(SprayKind::brush);
        let deforms = DeformKind::ALL.map(DeformKind::brush);
        let all: HashSet<BrushId> = sprays.into_iter().chain(deforms).collect();
        assert_eq!(all.len(), sprays.len() + deforms.len());
        assert_eq!(all, BrushId::ALL.iter().copied().collect());
        let specs: Vec<&BrushSpec> = BrushId::ALL.iter().map(|brush| brush.spec()).collect();
        let texts = |of: fn(&BrushSpec) -> &str| -> HashSet<&str> {
            specs.iter().map(|spec| of(spec)).collect()
        };
        assert_eq!(texts(|spec| spec.name).len(), specs.len());
        assert_eq!(texts(|spec| spec.action).len(), specs.len());
        assert_eq!(texts(|spec| spec.label).len(), specs.len());
        assert_eq!(texts(|spec| spec.help).len(), specs.len());
        for spec in specs {
            let is_word = |text: &str| {
                !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c == '-')
            };
            assert!(is_word(spec.name) && is_word(spec.action), "{spec:?}");
            assert!(spec.synonyms.split(' ').all(is_word), "{spec:?}");
            assert!(spec.help.starts_with(spec.label), "{spec:?}");
        }
    }
}
