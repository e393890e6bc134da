//! Owns the vocabulary of change: every way in which a sculpture can be altered is a
//! [`Command`], with a stable text form so that a script is a list of them.
//!
//! Knows what can be said, not how it is done: `document` carries out what concerns the
//! sculpture, `session` what concerns files.
//!
//! Grammar, one command a line: a verb, then words, quoted strings and `key=value` pairs in any
//! order; `#` opens a comment at the start of a line. See [`crate::command_text`].

use std::path::PathBuf;

use glam::{UVec3, Vec3};

use crate::format::options::{ExportForm, ImportOptions};
use crate::sculpture::edit::EditOp;
use crate::sculpture::{ColourDepth, Placement, Rgb};
use crate::tools::construct::Primitive;
use crate::tools::spray::Spray;

/// What a new sculpture is made of.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NewSculpture {
    /// Size in voxels.
    pub dims: UVec3,
    /// Edge lengths of a voxel in world units.
    pub voxel_size: Vec3,
    pub colour_depth: ColourDepth,
    /// Colour of all voxels until they are painted.
    pub base: Rgb,
    /// Begin with a solid block rather than with nothing.
    pub solid: bool,
}

/// The surface that the rays of a spray tool are cast on.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SpraySurface {
    /// As it is now, so that strokes bite deeper where they overlap.
    #[default]
    Now,
    /// As it was before the first spray of the stroke that asked for this.
    Stroke,
}

/// A value that changes a sculpture.
#[derive(Clone, PartialEq, Debug)]
pub enum Command {
    /// Replace the sculpture by a new one.
    New(NewSculpture),
    /// Replace the sculpture by the contents of a file.
    Open { path: PathBuf, import: ImportOptions },
    /// Write the sculpture to a file, in the format its name's ending says.
    Save { path: PathBuf, form: ExportForm },
    /// Open a stroke: the commands up to `End` are one undo step.
    Begin { label: String },
    /// Close the open stroke.
    End,
    /// Close the open stroke and take back what it did.
    Cancel,
    /// Add, subtract or recolour the voxels inside a solid.
    Construct { op: EditOp, primitive: Primitive },
    /// Use a spray tool once, where its rays meet the surface.
    Spray { spray: Spray, surface: SpraySurface },
    /// Make every voxel of the grid exist; new ones get the colour, or the base colour.
    Fill { colour: Option<Rgb> },
    /// Remove every voxel.
    Clear,
    /// Take back the last `steps` steps, or all of them.
    Undo { steps: Option<u32> },
    /// Do again the last `steps` undone steps, or all of them.
    Redo { steps: Option<u32> },
    /// Move the sculpture in the world. Not an undo step: it changes no voxel.
    Place(Placement),
}

/// Name and explanation of a command, for menus, the palette and help.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CommandHelp {
    pub verb: &'static str,
    /// Arguments in the text form.
    pub usage: &'static str,
    pub tooltip: &'static str,
}

/// Every command, in the order of the manual.
pub const COMMANDS: &[CommandHelp] = &[
    CommandHelp {
        verb: "new",
        usage: "dims=X,Y,Z [size=SX,SY,SZ] [colour=0|8|16|24] [base=#rrggbb] [fill=solid|empty]",
        tooltip: "Replace the sculpture by a new block of voxels",
    },
    CommandHelp {
        verb: "open",
        usage: "\"PATH\" [threshold=auto|N] [colouring=auto|none|grey|tissue|packed] [colour=0|8|16|24] [raw=LAYOUT]",
        tooltip: "Replace the sculpture by the contents of a file",
    },
    CommandHelp {
        verb: "save",
        usage: "\"PATH\" [form=auto|densities|rgba|packed]",
        tooltip: "Write the sculpture to a file",
    },
    CommandHelp {
        verb: "begin",
        usage: "[\"LABEL\"]",
        tooltip: "Open a stroke: all commands up to `end` are one undo step",
    },
    CommandHelp { verb: "end", usage: "", tooltip: "Close the open stroke" },
    CommandHelp { verb: "cancel", usage: "", tooltip: "Close the open stroke and take it back" },
    CommandHelp {
        verb: "add",
        usage: "ellipsoid|cuboid|pyramid at=X,Y,Z half=A[,B,C] [turn=RX,RY,RZ | turn=X,Y,Z,W] colour=#rrggbb",
        tooltip: "Make the voxels inside a solid exist; new ones get the colour",
    },
    CommandHelp {
        verb: "subtract",
        usage: "ellipsoid|cuboid|pyramid at=X,Y,Z half=A[,B,C] [turn=...]",
        tooltip: "Remove the voxels inside a solid",
    },
    CommandHelp {
        verb: "recolour",
        usage: "ellipsoid|cuboid|pyramid at=X,Y,Z half=A[,B,C] [turn=...] colour=#rrggbb",
        tooltip: "Give the voxels inside a solid the colour",
    },
    CommandHelp {
        verb: "spray",
        usage: "paintbrush|devourer|erosion|dilation|growth|smooth|clay eye=X,Y,Z aim=X,Y,Z across=X,Y,Z down=X,Y,Z radius=RAYS [outline=round|square] [reach=VOXELS] [surface=now|stroke] [colour=#rrggbb] [cover=0..1] [bite=round|square] [threshold=1..26] [around=1..8]",
        tooltip: "Use a spray tool where the rays under its footprint meet the surface",
    },
    CommandHelp {
        verb: "fill",
        usage: "[colour=#rrggbb]",
        tooltip: "Make every voxel of the grid exist",
    },
    CommandHelp { verb: "clear", usage: "", tooltip: "Remove every voxel" },
    CommandHelp { verb: "undo", usage: "[N|all]", tooltip: "Take back the last steps" },
    CommandHelp { verb: "redo", usage: "[N|all]", tooltip: "Do undone steps again" },
    CommandHelp {
        verb: "place",
        usage: "[turn=...] [move=X,Y,Z] [scale=S]",
        tooltip: "Turn, move and scale the sculpture in the world",
    },
];

impl Command {
    /// The verb of the text form.
    pub fn verb(&self) -> &'static str {
        match self {
            Command::New(_) => "new",
            Command::Open { .. } => "open",
            Command::Save { .. } => "save",
            Command::Begin { .. } => "begin",
            Command::End => "end",
            Command::Cancel => "cancel",
            Command::Construct { op: EditOp::Add(_), .. } => "add",
            Command::Construct { op: EditOp::Subtract, .. } => "subtract",
            Command::Construct { op: EditOp::Recolour(_), .. } => "recolour",
            Command::Spray { .. } => "spray",
            Command::Fill { .. } => "fill",
            Command::Clear => "clear",
            Command::Undo { .. } => "undo",
            Command::Redo { .. } => "redo",
            Command::Place(_) => "place",
        }
    }

    /// What the history list calls a step made by this command alone.
    pub fn label(&self) -> String {
        match self {
            Command::Construct { primitive, .. } => {
                format!("{} {}", self.verb(), primitive.solid.name())
            }
            Command::Spray { spray, .. } => spray.effect.name().to_string(),
            _ => self.verb().to_string(),
        }
    }
}
