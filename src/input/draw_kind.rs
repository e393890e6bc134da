//! The tools that draw a solid over the picture, by the shape of a drag, each described once.
//!
//! Holds their texts and requirements: `editor::draw` turns the drags into solids.

/// The description of a tool that draws.
#[derive(Clone, Copy, Debug)]
pub struct DrawSpec {
    /// In tables of keys, and in the remembered state.
    pub name: &'static str,
    /// In the interface.
    pub label: &'static str,
    /// Explains the tool in one sentence without full stop, after its title and a colon.
    pub help: &'static str,
    /// Words of other programs for searches, besides those of `help`, separated by spaces.
    pub synonyms: &'static str,
    /// Advice after a drag without effect: how to get a solid.
    pub advice: &'static str,
    /// A hand in the room of a headset, where there is no picture, can draw it.
    pub by_hand: bool,
}

/// Makes the enum, its list and the descriptions from the table.
macro_rules! draw_kinds {
    ($($(#[$doc:meta])* $id:ident { $($field:ident: $value:expr),* $(,)? })*) => {
        /// The shape that a drag of the pointer draws.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum DrawKind {
            $($(#[$doc])* $id),*
        }

        impl DrawKind {
            /// All of them, in the order in which interfaces offer them.
            pub const ALL: [DrawKind; [$(DrawKind::$id),*].len()] = [$(DrawKind::$id),*];

            /// Returns its description.
            pub const fn spec(self) -> &'static DrawSpec {
                match self {
                    $(DrawKind::$id => &DrawSpec { $($field: $value),* }),*
                }
            }
        }
    };
}

draw_kinds! {
    /// An outline by hand: everything behind it, or a slab.
    Lasso {
        name: "lasso",
        label: "Lasso",
        help: "Lasso: draw an outline; everything behind it is cut or painted, or a slab is added",
        synonyms: "trim slice polygon freehand extrude",
        advice: "Drag around the area with the button held down",
        by_hand: false,
    }
    /// Likewise with an upright rectangle.
    Rectangle {
        name: "rectangle",
        label: "Rectangle",
        help: "Rectangle: drag from corner to corner; everything behind it is cut or painted, or a slab is added",
        synonyms: "trim square crop extrude",
        advice: "Drag from one corner of a rectangle to the other",
        by_hand: false,
    }
    /// A line across the picture: everything on one side of it.
    Plane {
        name: "plane-cut",
        label: "Plane cut",
        help: "Plane cut: drag a line across the sculpture; the hatched side goes, or the other if inverted",
        synonyms: "slice split halve half space section trim knife",
        advice: "Drag a line across the sculpture to cut along it",
        by_hand: false,
    }
    /// The base of a box on a face.
    Box {
        name: "box",
        label: "Box",
        help: "Box: drag its base on a face, let go, choose its height and click",
        synonyms: "block cuboid brick wall rectangle",
        advice: "Drag over a visible face",
        by_hand: false,
    }
    /// A straight tube.
    Line {
        name: "line",
        label: "Line",
        help: "Line: drag from end to end; a straight tube, or a cone, with round ends",
        synonyms: "rod stick pipe capsule strut edge",
        advice: "Drag from one end to the other",
        by_hand: true,
    }
    /// A tube along a curve by hand.
    Curve {
        name: "curve",
        label: "Curve",
        help: "Curve: draw a path by hand, or click from point to point; a tube along it, which may taper",
        synonyms: "spline pipe worm handle rope freehand sweep snake",
        advice: "Drag from one end to the other",
        by_hand: true,
    }
    /// A profile, turned about the vertical through its start.
    Lathe {
        name: "lathe",
        label: "Lathe",
        help: "Lathe: press on the axis and draw half a profile; it is turned about the vertical",
        synonyms: "revolve pottery vase bowl wheel turned spin",
        advice: "Press on the axis and draw half of the outline beside it",
        by_hand: false,
    }
    /// Nothing: a press puts letters on the surface.
    Text {
        name: "text",
        label: "Text",
        help: "Text: press on the surface where the letters should stand",
        synonyms: "type write lettering engrave emboss inscription word",
        advice: "Enter some text in the options of the tool first",
        by_hand: false,
    }
}

impl DrawKind {
    /// Returns its name in key tables and files.
    pub const fn name(self) -> &'static str {
        self.spec().name
    }
}
