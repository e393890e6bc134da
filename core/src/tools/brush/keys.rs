//! Options shared by several brushes. A brush lists those that it has, each with the label, the help and the default
//! that it needs. Knows no brush.

use super::falloff::Falloff;
use super::footprint::Outline;
use super::limits::{MAX_HEIGHT, MAX_REACH_VX, MAX_TWIST_DEG};
use super::param::{Choice, Domain, Key, Omitted, OptionValue, Param, ParamValue, Unit};
use crate::sculpture::Rgb;

/// Greatest length of the rope, in pixels.
const MAX_STEADY_PX: f32 = 200.0;

const BASE: Param = Param {
    key: "",
    label: "",
    help: "",
    domain: Domain::Switch,
    unit: Unit::Plain,
    first: OptionValue::On(false),
    omitted: Omitted::Required,
    logarithmic: false,
    needs_pointer: false,
};

/// Radius of the brush. Every brush has one.
pub const RADIUS: Key<f32> = Key::new(Param {
    key: "radius",
    label: "Radius",
    help: "Radius of the brush",
    domain: Domain::Radius,
    first: OptionValue::Number(20.0),
    logarithmic: true,
    ..BASE
});

/// The outline of a brush in the picture.
pub const OUTLINE: Key<Outline> = Key::new(Param {
    key: "outline",
    label: "Brush shape",
    help: "Outline of the brush in the picture",
    domain: Domain::Choice(&[
        Choice { name: Outline::Round.name(), help: "Circular brush" },
        Choice { name: Outline::Square.name(), help: "Square brush" },
    ]),
    first: OptionValue::Choice(0),
    ..BASE
});

/// Greatest distance of changed voxels from a point under the brush.
pub const REACH: Key<f32> = Key::new(Param {
    key: "reach",
    label: "Reach",
    help: "Greatest distance of changed voxels from the surface",
    domain: Domain::Number([0.0, MAX_REACH_VX]),
    unit: Unit::Voxels,
    first: OptionValue::Number(3.0),
    omitted: Omitted::Is(OptionValue::Number(3.0)),
    logarithmic: true,
    ..BASE
});

/// Greatest distance of masked voxels from the surface.
pub const MASK_DEPTH: Key<f32> = REACH
    .first(4.0)
    .label("Depth")
    .help("Greatest distance of protected voxels from the surface, outwards too");

/// The shape that is cut around a point under the brush.
pub const BITE: Key<Outline> = Key::new(Param {
    key: "bite",
    label: "Cut shape",
    help: "Shape cut around each point under the brush",
    domain: Domain::Choice(&[
        Choice { name: Outline::Round.name(), help: "Cut balls" },
        Choice { name: Outline::Square.name(), help: "Cut cubes" },
    ]),
    first: OptionValue::Choice(0),
    omitted: Omitted::Is(OptionValue::Choice(0)),
    ..BASE
});

/// A number of the 26 neighbours of a voxel.
pub const THRESHOLD: Key<u32> = Key::new(Param {
    key: "threshold",
    label: "Threshold",
    help: "Fills gaps with at least this many of their 26 neighbours; 10 or more keeps flat faces",
    domain: Domain::Whole([1, 26]),
    first: OptionValue::Whole(14),
    omitted: Omitted::Is(OptionValue::Whole(14)),
    ..BASE
});

/// Strength of one use of the brush.
pub const STRENGTH: Key<f32> = Key::new(Param {
    key: "strength",
    label: "Strength",
    help: "Strength of each use",
    domain: Domain::Number([0.0, 1.0]),
    unit: Unit::Share,
    first: OptionValue::Number(1.0),
    omitted: Omitted::Is(OptionValue::Number(1.0)),
    ..BASE
});

/// Whether overlapping uses in one stroke do not add up.
pub const ONCE_PER_STROKE: Key<bool> = Key::new(Param {
    key: "once_per_stroke",
    label: "Once per stroke",
    help: "Works on the surface from before the stroke, so that overlapping parts of the stroke are not cut or raised \
           twice",
    ..BASE
});

/// Length of the rope by which the pointer pulls the brush; 0 without one.
pub const STEADY: Key<f32> = Key::new(Param {
    key: "steady",
    label: "Steady",
    help: "The pointer pulls the brush on a rope of this length, so that a trembling hand draws an even line; 0 for no \
           rope",
    domain: Domain::Number([0.0, MAX_STEADY_PX]),
    unit: Unit::Pixels,
    first: OptionValue::Number(0.0),
    needs_pointer: true,
    ..BASE
});

/// Falloff of the effect from the centre of the ball to its rim.
pub const FALLOFF: Key<Falloff> = Key::new(Param {
    key: "falloff",
    label: "Falloff",
    help: "Falloff of the effect from the centre of the brush to its rim",
    domain: Domain::Choice(&[
        Choice {
            name: Falloff::Smooth.name(),
            help: "Decreases evenly from the centre to the rim",
        },
        Choice {
            name: Falloff::Sharp.name(),
            help: "Decreases quickly from the centre, which makes a tip",
        },
        Choice {
            name: Falloff::Flat.name(),
            help: "Constant around the centre, then decreasing, as if moved by hand",
        },
    ]),
    first: OptionValue::Choice(0),
    omitted: Omitted::Is(OptionValue::Choice(0)),
    ..BASE
});

/// The colour of new voxels, or of paint.
pub const COLOUR: Key<Rgb> = Key::new(Param {
    key: "colour",
    label: "Colour",
    help: "Colour that the brush applies",
    domain: Domain::Colour,
    ..BASE
});

/// Share of the colour that a pass mixes in.
pub const COVER: Key<f32> = Key::new(Param {
    key: "cover",
    label: "Cover",
    help: "Opacity of the colour in each pass",
    domain: Domain::Number([0.0, 1.0]),
    unit: Unit::Share,
    omitted: Omitted::Is(OptionValue::Number(1.0)),
    ..BASE
});

/// Reach of the neighbourhood of the majority filter, on each axis. Recordings of the first versions smooth with it.
pub const AROUND: Key<u32> = Key::new(Param {
    key: "around",
    label: "Around",
    help: "Reach of the neighbourhood of the majority filter, in voxels",
    domain: Domain::Whole([1, 8]),
    unit: Unit::Voxels,
    omitted: Omitted::InsteadOf(STRENGTH.param.key, OptionValue::Whole(2)),
    ..BASE
});

/// Distance that the surface must have moved towards the next voxel for it to change.
pub const ROUNDING: Key<f32> = Key::new(Param {
    key: "rounding",
    label: "Rounding",
    help: "Distance that the surface must have moved towards the next voxel for it to change",
    domain: Domain::Number([0.0, 1.0]),
    omitted: Omitted::Unwritten(OptionValue::Number(super::kernel::level::Level::NEAREST)),
    ..BASE
});

/// Displacement of the surface at the centre of the ball, in units of the smallest voxel edge.
pub const HEIGHT: Key<f32> = Key::new(Param {
    key: "height",
    label: "Height",
    help: "Displacement of the surface at the centre of the ball",
    domain: Domain::Number([-MAX_HEIGHT, MAX_HEIGHT]),
    unit: Unit::Voxels,
    ..BASE
});

/// Rotation of the centre of the ball, in degrees, counter-clockwise seen from where the normal points.
pub const ANGLE: Key<f32> = Key::new(Param {
    key: "angle",
    label: "Angle",
    help: "Rotation of the centre of the ball, in degrees",
    domain: Domain::Number([-MAX_TWIST_DEG, MAX_TWIST_DEG]),
    ..BASE
});

impl ParamValue for Outline {
    fn from_value(value: OptionValue) -> Option<Outline> {
        of_choice(&Outline::ALL, value)
    }

    fn to_value(self) -> OptionValue {
        OptionValue::Choice(self as u8)
    }
}

impl ParamValue for Falloff {
    fn from_value(value: OptionValue) -> Option<Falloff> {
        of_choice(&Falloff::ALL, value)
    }

    fn to_value(self) -> OptionValue {
        OptionValue::Choice(self as u8)
    }
}

impl Key<Falloff> {
    /// Returns the same option with another default.
    pub(super) const fn first(mut self, falloff: Falloff) -> Key<Falloff> {
        self.param.first = OptionValue::Choice(falloff as u8);
        self
    }
}

fn of_choice<T: Copy>(all: &[T], value: OptionValue) -> Option<T> {
    let OptionValue::Choice(place) = value else { return None };
    all.get(usize::from(place)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_stand_in_the_order_of_their_types() {
        let names = |param: Param| -> Vec<&str> {
            let Domain::Choice(choices) = param.domain else { panic!("{param:?}") };
            choices.iter().map(|choice| choice.name).collect()
        };
        for key in [OUTLINE, BITE] {
            assert_eq!(names(key.param), Outline::ALL.map(Outline::name));
        }
        assert_eq!(names(FALLOFF.param), Falloff::ALL.map(Falloff::name));
        for outline in Outline::ALL {
            assert_eq!(Outline::from_value(outline.to_value()), Some(outline));
        }
        for falloff in Falloff::ALL {
            assert_eq!(Falloff::from_value(falloff.to_value()), Some(falloff));
        }
        assert_eq!(Outline::from_value(OptionValue::Choice(2)), None);
        assert_eq!(Falloff::from_value(OptionValue::Number(0.0)), None);
    }
}
