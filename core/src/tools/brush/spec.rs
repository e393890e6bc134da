//! Describes a brush: its texts, its options, the manner in which a hand uses it and what a command of it does, each written
//! once in the file of the brush.

pub use super::brush_use::ContactKind;
use super::change::{Change, Site};
use super::dab::Dab;
use super::param::{Key, Param};
use super::{BrushId, BrushUse, Frame};
use crate::refusal::InvalidValue;

/// The description of a brush.
#[derive(Clone, Copy, Debug)]
pub struct BrushSpec {
    /// In scripts, in labels of undo steps, and in what is remembered.
    pub name: &'static str,
    /// In tables of keys.
    pub action: &'static str,
    /// In the interface.
    pub label: &'static str,
    /// Explains the brush in one sentence, after its title and a colon.
    pub help: &'static str,
    /// Explains in the manual what it does to the clay, in sentences without markup.
    pub effect: &'static str,
    /// Its effect on volume, colours and flat faces, for the manual.
    pub keeps: Keeps,
    /// Words of other programs that find it, besides those of `help`, separated by spaces.
    pub synonyms: &'static str,
    /// The family with which interfaces show it.
    pub group: BrushGroup,
    /// Its options, in the order in which panels show them.
    pub options: &'static [Param],
    /// The manner in which a stroke uses it.
    pub stroke: BrushStroke,
    /// Distance of two uses, as a share of the radius.
    pub spacing: f32,
    /// The same with an image in place of the colour; none for a brush that takes no image.
    pub image_spacing: Option<f32>,
    /// The modifier that inverts the tool.
    pub inverse: Inverse,
    /// Options that it has in common with another brush are those of that one, but for radius and outline.
    pub options_of: Option<BrushId>,
    /// The option that the pressure of a pen leads.
    pub pressure: Option<Key<f32>>,
    /// The colour of its outline.
    pub tint: Tint,
    /// It gives the colour in hand.
    pub gives_colour: bool,
    /// It can add voxels, and so meet the walls of the grid.
    pub adds: bool,
    /// Explains a use that has met the surface and changed nothing.
    pub idle: &'static str,
    /// The use that a hand makes; none where it would change nothing.
    pub dab: fn(&Dab) -> Option<BrushUse>,
    /// Its command; none if the commands of a hand are those of another brush.
    pub script: Option<Script>,
}

/// The effect of a brush on properties of the sculpture, in a few words each.
#[derive(Clone, Copy, Debug)]
pub struct Keeps {
    /// On the volume.
    pub volume: &'static str,
    /// On the colours.
    pub colour: &'static str,
    /// On flat faces.
    pub flat_faces: &'static str,
}

impl Keeps {
    /// New clay has the colours around it; the inside of the clay shows where some is removed.
    pub(super) const AROUND: &'static str =
        "new clay: the colours around it; cuts show the colour inside";

    pub(super) const fn of(
        volume: &'static str,
        colour: &'static str,
        flat_faces: &'static str,
    ) -> Keeps {
        Keeps { volume, colour, flat_faces }
    }
}

/// The command of a brush.
#[derive(Clone, Copy, Debug)]
pub struct Script {
    /// Where it is used.
    pub contact: ContactKind,
    /// Its parameters, in the order in which the text form has them.
    pub params: &'static [Param],
    /// On the surface as it was when the stroke began it takes the place of what the stroke has done.
    pub replaces_stroke: bool,
    /// A sculpture without colours refuses it.
    pub needs_colours: bool,
    /// The change that a use makes, which has been checked.
    pub apply: fn(&BrushUse, &Site) -> Result<Change, InvalidValue>,
}

impl Script {
    /// Returns a command under an outline.
    pub(super) const fn under(
        params: &'static [Param],
        apply: fn(&BrushUse, &Site) -> Result<Change, InvalidValue>,
    ) -> Option<Script> {
        Some(Script {
            contact: ContactKind::Footprint,
            params,
            replaces_stroke: false,
            needs_colours: false,
            apply,
        })
    }

    /// Returns a command in a ball.
    pub(super) const fn in_ball(
        contact: ContactKind,
        params: &'static [Param],
        apply: fn(&BrushUse, &Site) -> Result<Change, InvalidValue>,
    ) -> Option<Script> {
        Some(Script { contact, params, replaces_stroke: false, needs_colours: false, apply })
    }

    /// Returns a command that moves a ball of clay, which takes the place of what the stroke has done.
    pub(super) const fn of_clay(
        contact: ContactKind,
        params: &'static [Param],
        apply: fn(&BrushUse, &Site) -> Result<Change, InvalidValue>,
    ) -> Option<Script> {
        Some(Script { contact, params, replaces_stroke: true, needs_colours: false, apply })
    }
}

/// The families of brushes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum BrushGroup {
    /// Brushes that change voxels under an outline in the picture.
    Surface,
    /// Brushes that deform clay.
    Deform,
    /// Brushes that protect the surface. The one that takes protection away is offered as the inverse of the other.
    Mask,
}

/// The manner in which a stroke uses a brush.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum BrushStroke {
    /// Under an outline that lies in the picture, at a spacing along the path of the pointer.
    Picture {
        /// It is used again while it is held in one place.
        repeats: bool,
    },
    /// In a ball that goes over the surface.
    Surface {
        /// The normal of the surface.
        normal: SurfaceNormal,
    },
    /// In a ball of clay that is held and follows the drag.
    Held {
        /// It turns instead of going along.
        turns: bool,
    },
}

/// The place whose normal a brush uses.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SurfaceNormal {
    /// That of the surface around the press, for the whole stroke. `on_plane`: all uses lie in the plane there.
    OfPress {
        /// The middles of all uses lie in one plane.
        on_plane: bool,
    },
    /// That of the surface around each use, as it was when the stroke began.
    OfEachUse,
}

/// The effect of the modifier that inverts the tool.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Inverse {
    /// None.
    Same,
    /// The brush works in the other sense.
    Sense,
    /// Another brush is used.
    Brush(BrushId),
}

/// The colour of a brush's outline.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Tint {
    /// That of tools that cut.
    Cut,
    /// That of tools that neither cut nor add.
    Neutral,
    /// That of the mask.
    Mask,
    /// The colour in hand.
    Colour,
}

impl BrushSpec {
    /// A brush under an outline in the picture.
    pub(super) const SURFACE: BrushSpec = BrushSpec {
        name: "",
        action: "",
        label: "",
        help: "",
        effect: "",
        keeps: Keeps::of("", "", ""),
        synonyms: "",
        group: BrushGroup::Surface,
        options: &[],
        stroke: BrushStroke::Picture { repeats: false },
        spacing: 0.35,
        image_spacing: None,
        inverse: Inverse::Same,
        options_of: None,
        pressure: None,
        tint: Tint::Colour,
        gives_colour: false,
        adds: false,
        idle: "Nothing changed",
        dab: |dab| Some(dab.used(Frame::None)),
        script: None,
    };

    /// A brush that deforms clay.
    pub(super) const DEFORM: BrushSpec = BrushSpec {
        group: BrushGroup::Deform,
        stroke: BrushStroke::Surface { normal: SurfaceNormal::OfPress { on_plane: false } },
        spacing: 0.2,
        pressure: Some(super::keys::STRENGTH),
        tint: Tint::Neutral,
        adds: true,
        idle: "Nothing changed: the clay is already as the brush makes it",
        dab: |dab| Some(dab.along_normal()),
        ..BrushSpec::SURFACE
    };

    /// Over its options: the first words of the help.
    pub fn title(&self) -> &'static str {
        self.help.split(':').next().unwrap_or(self.label)
    }

    /// Returns the parameters of its command.
    pub fn params(&self) -> &'static [Param] {
        self.script.map_or(&[], |script| script.params)
    }

    /// Returns whether it works under an outline in the picture.
    pub fn is_in_picture(&self) -> bool {
        matches!(self.stroke, BrushStroke::Picture { .. })
    }

    /// Returns whether it takes hold of clay.
    pub fn is_held(&self) -> bool {
        matches!(self.stroke, BrushStroke::Held { .. })
    }
}
