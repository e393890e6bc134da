//! Describes a brush: its texts, its options, its interactive use and the effect of its command. Each description is
//! written once, in the file of the brush.

pub use super::brush_use::ContactKind;
use super::change::{BrushChange, Site};
use super::dab::Dab;
use super::param::{Key, Param};
use super::{BrushDirection, BrushId, BrushUse};
use crate::refusal::InvalidValue;

/// The description of a brush.
#[derive(Clone, Copy, Debug)]
pub struct BrushSpec {
    /// Used in scripts, in labels of undo steps, and in stored settings.
    pub name: &'static str,
    /// Used in tables of keys.
    pub action: &'static str,
    /// Shown in the interface.
    pub label: &'static str,
    /// Explains the brush in one sentence, after its title and a colon.
    pub help: &'static str,
    /// Explains in the manual its effect on the clay, in sentences without markup.
    pub effect: &'static str,
    /// Its effect on volume, colours and flat faces, for the manual.
    pub keeps: Keeps,
    /// Search terms from other programs, besides the words of `help`, separated by spaces.
    pub synonyms: &'static str,
    /// The group with which interfaces show it.
    pub group: BrushGroup,
    /// Its options, in the order in which panels show them.
    pub options: &'static [Param],
    /// The manner in which a stroke uses it.
    pub stroke: BrushStroke,
    /// Spacing of uses along a stroke, as a share of the radius.
    pub spacing: f32,
    /// The spacing with an image in place of the colour; `None` for a brush that takes no image.
    pub image_spacing: Option<f32>,
    /// The modifier that inverts the tool.
    pub inverse: Inverse,
    /// A brush with which it shares its options, except for radius and outline.
    pub options_of: Option<BrushId>,
    /// The option that pen pressure controls.
    pub pressure: Option<Key<f32>>,
    /// The colour of its outline.
    pub tint: OutlineColour,
    /// Whether it applies the current colour.
    pub gives_colour: bool,
    /// Whether it can add voxels, and so reach the border of the grid.
    pub adds: bool,
    /// The message after a use that has met the surface and changed nothing.
    pub idle: &'static str,
    /// Makes the use of an interactive dab; `None` where it would change nothing.
    pub dab: fn(&Dab) -> Option<BrushUse>,
    /// Its command; `None` if its interactive commands are those of another brush.
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
    /// For brushes that add clay in the surrounding colours and expose the inside where they cut.
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
    /// The place where it is used.
    pub contact: ContactKind,
    /// Its parameters, in the order of the text form.
    pub params: &'static [Param],
    /// Whether it replaces what the stroke has done, on the surface as it was at the start of the stroke.
    pub replaces_stroke: bool,
    /// Whether a sculpture without colours refuses it.
    pub needs_colours: bool,
    /// Computes the change of a use, which must have been checked.
    pub apply: fn(&BrushUse, &Site) -> Result<BrushChange, InvalidValue>,
}

impl Script {
    /// Returns a command under an outline.
    pub(super) const fn under(
        params: &'static [Param],
        apply: fn(&BrushUse, &Site) -> Result<BrushChange, InvalidValue>,
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
        apply: fn(&BrushUse, &Site) -> Result<BrushChange, InvalidValue>,
    ) -> Option<Script> {
        Some(Script { contact, params, replaces_stroke: false, needs_colours: false, apply })
    }

    /// Returns a command that moves a ball of clay and replaces what the stroke has done.
    pub(super) const fn of_clay(
        contact: ContactKind,
        params: &'static [Param],
        apply: fn(&BrushUse, &Site) -> Result<BrushChange, InvalidValue>,
    ) -> Option<Script> {
        Some(Script { contact, params, replaces_stroke: true, needs_colours: false, apply })
    }
}

/// The groups of brushes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum BrushGroup {
    /// Brushes that change voxels under an outline in the picture.
    Surface,
    /// Brushes that deform clay.
    Deform,
    /// Brushes that protect the surface. The one that removes protection is offered as the inverse of the other.
    Mask,
}

/// The manner in which a stroke uses a brush.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum BrushStroke {
    /// Under an outline that lies in the picture, at a spacing along the path of the pointer.
    Picture {
        /// Whether it is applied repeatedly while it is held in one place.
        repeats: bool,
    },
    /// In a ball that moves over the surface.
    Surface {
        /// The normal of the surface.
        normal: SurfaceNormal,
    },
    /// In a grabbed ball of clay that follows the drag.
    Held {
        /// Whether it turns instead of moving along.
        turns: bool,
    },
}

/// The place whose normal a brush uses.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SurfaceNormal {
    /// The normal of the surface around the press, for the whole stroke. `on_plane`: all uses lie in the plane there.
    OfPress {
        /// Whether the centres of all uses lie in one plane.
        on_plane: bool,
    },
    /// The normal of the surface around each use, as it was at the start of the stroke.
    OfEachUse,
}

/// The effect of the modifier that inverts the tool.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Inverse {
    /// None.
    Same,
    /// The brush works in the opposite sense.
    Sense,
    /// Another brush is used.
    Brush(BrushId),
}

/// The colour of a brush's outline.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum OutlineColour {
    /// The colour of tools that cut.
    Cut,
    /// The colour of tools that neither cut nor add.
    Neutral,
    /// The colour of the mask.
    Mask,
    /// The current colour.
    Colour,
}

impl BrushSpec {
    /// Defaults of a brush under an outline in the picture.
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
        tint: OutlineColour::Colour,
        gives_colour: false,
        adds: false,
        idle: "Nothing changed",
        dab: |dab| Some(dab.used(BrushDirection::None)),
        script: None,
    };

    /// Defaults of a brush that deforms clay.
    pub(super) const DEFORM: BrushSpec = BrushSpec {
        group: BrushGroup::Deform,
        stroke: BrushStroke::Surface { normal: SurfaceNormal::OfPress { on_plane: false } },
        spacing: 0.2,
        pressure: Some(super::keys::STRENGTH),
        tint: OutlineColour::Neutral,
        adds: true,
        idle: "Nothing changed: the clay is already as the brush makes it",
        dab: |dab| Some(dab.along_normal()),
        ..BrushSpec::SURFACE
    };

    /// Returns the title over its options: the first words of the help.
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

    /// Returns whether it grabs clay.
    pub fn is_held(&self) -> bool {
        matches!(self.stroke, BrushStroke::Held { .. })
    }
}
