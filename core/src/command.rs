//! Commands: every change of a sculpture is a value of [`Command`], with a stable text form, so that
//! scripts and recordings are lists of commands.
//!
//! Defines commands, not their execution: `document` executes those that concern the sculpture,
//! `session` those that concern files.
//!
//! Grammar, one command per line: a verb, then words, quoted strings and `key=value` pairs in any order;
//! `#` at the start of a line opens a comment. The room `command_text` implements it.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};

use crate::format::options::{ExportOptions, ImportOptions};
use crate::sculpture::edit::EditOp;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::VoxelBox;
use crate::sculpture::{ColourDepth, Placement, Rgb};
use crate::tools::construct::Primitive;
use crate::tools::deform::Deform;
use crate::tools::grab::Grab;
use crate::tools::mend::Mend;
use crate::tools::spray::Spray;
use crate::tools::symmetry::Symmetry;

/// Parameters of a new sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NewSculpture {
    /// Size in voxels.
    pub dims: UVec3,
    /// Edge lengths of a voxel in world units.
    pub voxel_size: Vec3,
    /// Bits of colour per voxel.
    pub colour_depth: ColourDepth,
    /// Colour of all voxels until they are painted.
    pub base: Rgb,
    /// Start with a solid block instead of an empty grid.
    pub solid: bool,
}

/// The surface that the rays of a spray tool are cast on, or the clay that a pull takes hold of.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SpraySurface {
    /// The current one, so that strokes go deeper where they overlap, and pulls go on from there.
    #[default]
    Now,
    /// The surface before the first spray with this setting in the stroke. A pull takes the place of all that the
    /// stroke has done so far.
    Stroke,
}

/// The voxels that a command about an area works on. The limit to the selection applies to all.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Area {
    /// All voxels of the grid.
    #[default]
    Grid,
    /// The boxes on the stack.
    Selection,
    /// The marker's box.
    Marker,
}

impl Area {
    /// All areas, in the order in which interfaces offer them.
    pub const ALL: [Area; 3] = [Area::Grid, Area::Selection, Area::Marker];

    /// Its name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            Area::Grid => "grid",
            Area::Selection => "selection",
            Area::Marker => "marker",
        }
    }
}

/// An operation on the stack of selected boxes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum SelectOp {
    /// Add the marker's box.
    Add,
    /// Subtract the marker's box.
    Subtract,
    /// Remove the uppermost box.
    Drop,
    /// Remove all boxes.
    Clear,
}

impl SelectOp {
    /// All operations, in the order in which interfaces offer them.
    pub const ALL: [SelectOp; 4] =
        [SelectOp::Add, SelectOp::Subtract, SelectOp::Drop, SelectOp::Clear];

    /// Its name in the text form.
    pub const fn name(self) -> &'static str {
        match self {
            SelectOp::Add => "add",
            SelectOp::Subtract => "subtract",
            SelectOp::Drop => "drop",
            SelectOp::Clear => "clear",
        }
    }
}

/// A value that changes a sculpture.
#[derive(Clone, PartialEq, Debug)]
pub enum Command {
    /// Replace the sculpture by a new one.
    New(NewSculpture),
    /// Replace the sculpture with the contents of a file.
    Open {
        /// The file to read.
        path: PathBuf,
        /// How to read it.
        import: ImportOptions,
    },
    /// Give a file's content to the commands that follow and name it, whatever is on the disk. Recordings use it, so
    /// that they replay anywhere. Changes no voxel and is no undo step.
    Embed {
        /// The name of the file.
        path: PathBuf,
        /// Its bytes: an image, or a sculpture as .vsc, whatever the name says.
        file: Arc<[u8]>,
    },
    /// Write the sculpture to a file, in the format of its extension.
    Save {
        /// The file to write.
        path: PathBuf,
        /// How to write it.
        export: ExportOptions,
    },
    /// Open a stroke: the commands up to `End` are one undo step.
    Begin {
        /// Name of the undo step.
        label: String,
    },
    /// End the open stroke.
    End,
    /// End the open stroke and revert its changes.
    Cancel,
    /// Add, subtract or recolour the voxels inside a solid.
    Construct {
        /// What happens to the voxels.
        op: EditOp,
        /// The solid.
        primitive: Primitive,
    },
    /// Use a spray tool once, where its rays meet the surface.
    Spray {
        /// The brush and its rays.
        spray: Spray,
        /// What the rays are cast on.
        surface: SpraySurface,
    },
    /// Pull at a ball of clay.
    Grab {
        /// The ball and the pull.
        grab: Grab,
        /// Which clay is pulled.
        surface: SpraySurface,
    },
    /// Use a brush that moves the surface in a ball once.
    Deform {
        /// The brush and the ball.
        deform: Deform,
        /// Which surface is moved. Of the one before the stroke, no use takes back what others have done.
        surface: SpraySurface,
    },
    /// Recolour the voxels inside a solid by an image.
    Texture {
        /// The solid.
        primitive: Primitive,
        /// The PNG or JPEG file.
        picture: PathBuf,
    },
    /// Make every voxel of the area exist; new ones get the colour, or the base colour.
    Fill {
        /// Which voxels.
        area: Area,
        /// Colour of new voxels; none for the base colour.
        colour: Option<Rgb>,
    },
    /// Remove every voxel of the area.
    Clear {
        /// Which voxels.
        area: Area,
    },
    /// Give every voxel of the area the colour.
    Dye {
        /// Which voxels.
        area: Area,
        /// Their colour afterwards.
        colour: Rgb,
    },
    /// Move and resize the marker. Like all commands about the selection it is no undo step, since it
    /// changes no voxel.
    Mark(VoxelBox),
    /// Change the stack of selected boxes.
    Select(SelectOp),
    /// Limit all tools to the selection, or not.
    Limit(bool),
    /// Allow or refuse steps that exceed the history's budget and so cannot be undone.
    Irreversible(bool),
    /// Set the mirror planes of solids and sprays.
    Symmetry(Symmetry),
    /// Copy the marker's contents to the clipboard.
    Copy,
    /// Cut the marker's contents to the clipboard.
    Cut,
    /// Paste the clipboard.
    Paste {
        /// The clip's lower corner.
        at: IVec3,
        /// How the clip is turned or mirrored.
        orientation: Orientation,
    },
    /// Turn the marker's contents about their centre and move them, with the marker.
    Move {
        /// Distance in voxels.
        by: IVec3,
        /// How the contents are turned or mirrored.
        orientation: Orientation,
    },
    /// Repeat the last operation `count` times, each time further by `step` voxels.
    Array {
        /// Number of copies.
        count: u32,
        /// Distance from each copy to the next, in voxels.
        step: IVec3,
    },
    /// Rotate or mirror the whole sculpture; its size, colours and selection follow.
    Orient(Orientation),
    /// Make the sculpture fit for printing.
    Mend(Mend),
    /// Undo the last `steps` steps, or all.
    Undo {
        /// How many; none for all.
        steps: Option<u32>,
    },
    /// Redo the last `steps` undone steps, or all.
    Redo {
        /// How many; none for all.
        steps: Option<u32>,
    },
    /// Place the sculpture in the world. No undo step, since it changes no voxel.
    Place(Placement),
}

/// Name and explanation of a command, for menus, the palette and help.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CommandHelp {
    /// The command's first word in the text form.
    pub verb: &'static str,
    /// Arguments in the text form.
    pub usage: &'static str,
    /// What the command does, in one sentence.
    pub tooltip: &'static str,
}

/// Every command, in the order of the manual.
pub const COMMANDS: &[CommandHelp] = &[
    CommandHelp {
        verb: "new",
        usage: "dims=X,Y,Z [size=SX,SY,SZ] [colour=0|8|16|24] [base=#rrggbb] [fill=solid|empty]",
        tooltip: "Replace the sculpture with a new block of voxels",
    },
    CommandHelp {
        verb: "open",
        usage: "\"PATH\" [threshold=auto|N|N..N] [colouring=auto|none|grey|tissue|labels|packed] [colour=0|8|16|24] [upright=y|z|-z|-y|x|-x] [raw=LAYOUT] [region=X,Y,Z..X,Y,Z] [cubic=no|finest|Nmm] [pieces=all|largest] [holes=open|filled] [mesh_size=VOXELS|Nmm] [mesh_fill=auto|solid|shell]",
        tooltip: "Replace the sculpture with the contents of a file",
    },
    CommandHelp {
        verb: "embed",
        usage: "\"PATH\" data=BASE64",
        tooltip: "Give an image, or a sculpture as .vsc, to the commands that follow and name it",
    },
    CommandHelp {
        verb: "save",
        usage: "\"PATH\" [form=auto|densities|rgba|packed] [mesh=smooth|faces|greedy] [triangles=N] [millimetres=X] [up=y|z] [vertices=joined|alone]",
        tooltip: "Write the sculpture to a file",
    },
    CommandHelp {
        verb: "begin",
        usage: "[\"LABEL\"]",
        tooltip: "Begin a stroke: all commands up to `end` are one undo step",
    },
    CommandHelp { verb: "end", usage: "", tooltip: "End the open stroke" },
    CommandHelp {
        verb: "cancel",
        usage: "",
        tooltip: "Cancel the open stroke and undo what it did",
    },
    CommandHelp {
        verb: "add",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=RX,RY,RZ | turn=X,Y,Z,W] [colour=#rrggbb]",
        tooltip: "Fill the voxels inside a solid (ellipsoid, cuboid, pyramid, cylinder, cone, torus, capsule or rounded-cuboid); new ones get the colour, or the base colour",
    },
    CommandHelp {
        verb: "subtract",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=...]",
        tooltip: "Remove the voxels inside a solid",
    },
    CommandHelp {
        verb: "recolour",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=...] colour=#rrggbb",
        tooltip: "Recolour the voxels inside a solid",
    },
    CommandHelp {
        verb: "spray",
        usage: "paintbrush|devourer|erosion|dilation|growth|smooth|clay eye=X,Y,Z aim=X,Y,Z across=X,Y,Z down=X,Y,Z radius=RAYS [outline=round|square] [reach=VOXELS] [surface=now|stroke] [colour=#rrggbb] [cover=0..1] [bite=round|square] [threshold=1..26] [around=1..8]",
        tooltip: "Use a brush where the rays under its footprint meet the surface",
    },
    CommandHelp {
        verb: "grab",
        usage: "at=X,Y,Z radius=VOXELS by=DX,DY,DZ [falloff=smooth|sharp|flat] [surface=now|stroke]",
        tooltip: "Pull at a ball of clay: what is in its middle goes all the way, what is at its rim stays",
    },
    CommandHelp {
        verb: "deform",
        usage: "inflate|flatten|scrape|fill at=X,Y,Z radius=VOXELS [height=VOXELS | normal=X,Y,Z [strength=0..1]] [falloff=smooth|sharp|flat] [surface=now|stroke]",
        tooltip: "Move the surface in a ball: outwards by a height (inflate), or to a plane through its middle",
    },
    CommandHelp {
        verb: "texture",
        usage: "\"PICTURE\" SOLID at=X,Y,Z half=A[,B,C] [turn=...]",
        tooltip: "Paint the voxels inside a solid with a PNG or JPEG image",
    },
    CommandHelp {
        verb: "fill",
        usage: "[grid|selection|marker] [colour=#rrggbb]",
        tooltip: "Fill every voxel of an area",
    },
    CommandHelp {
        verb: "clear",
        usage: "[grid|selection|marker]",
        tooltip: "Delete every voxel of an area",
    },
    CommandHelp {
        verb: "dye",
        usage: "[grid|selection|marker] colour=#rrggbb",
        tooltip: "Recolour every voxel of an area",
    },
    CommandHelp {
        verb: "mark",
        usage: "at=X,Y,Z size=A,B,C",
        tooltip: "Move and resize the marker: its lower corner and its size in voxels",
    },
    CommandHelp {
        verb: "select",
        usage: "add|subtract|drop|clear",
        tooltip: "Add the marker's box to the selection or subtract it, drop the last box, or clear all",
    },
    CommandHelp { verb: "limit", usage: "on|off", tooltip: "Limit all tools to the selection" },
    CommandHelp {
        verb: "symmetry",
        usage: "[x=off|even|odd] [y=off|even|odd] [z=off|even|odd]",
        tooltip: "Mirror what tools do at planes through the grid's centre",
    },
    CommandHelp { verb: "copy", usage: "", tooltip: "Copy the voxels in the marker" },
    CommandHelp {
        verb: "cut",
        usage: "",
        tooltip: "Cut the voxels in the marker to the clipboard",
    },
    CommandHelp {
        verb: "paste",
        usage: "at=X,Y,Z [axes=x,y,z]",
        tooltip: "Paste the clipboard, its axes exchanged or reversed if wanted, such as axes=y,-x,z",
    },
    CommandHelp {
        verb: "move",
        usage: "[by=X,Y,Z] [axes=x,y,z]",
        tooltip: "Move, rotate or mirror the marker's contents",
    },
    CommandHelp {
        verb: "array",
        usage: "count=N step=X,Y,Z",
        tooltip: "Repeat the last operation, each time with a further offset",
    },
    CommandHelp {
        verb: "orient",
        usage: "upright=y|z|-z|-y|x|-x | axes=x,y,z",
        tooltip: "Rotate the whole sculpture so that an axis points up, or exchange and reverse its axes, such as axes=x,-z,y",
    },
    CommandHelp {
        verb: "remove-islands",
        usage: "[keep=standing|largest] [smaller=VOXELS]",
        tooltip: "Remove the pieces that hang together with nothing, but for the largest, and for those on the bed unless only the largest is kept",
    },
    CommandHelp {
        verb: "fill-cavities",
        usage: "[smaller=VOXELS]",
        tooltip: "Fill empty places that do not reach the outside",
    },
    CommandHelp {
        verb: "thicken",
        usage: "to=VOXELS",
        tooltip: "Add voxels around walls that are thinner",
    },
    CommandHelp {
        verb: "drain",
        usage: "[diameter=VOXELS] [toward=down|nearest]",
        tooltip: "Drill a hole from each cavity to the outside",
    },
    CommandHelp { verb: "undo", usage: "[N|all]", tooltip: "Undo the last steps" },
    CommandHelp { verb: "redo", usage: "[N|all]", tooltip: "Redo undone steps" },
    CommandHelp {
        verb: "irreversible",
        usage: "on|off",
        tooltip: "Do steps that are too large to be undone, or refuse them",
    },
    CommandHelp {
        verb: "place",
        usage: "[turn=...] [move=X,Y,Z] [scale=S]",
        tooltip: "Rotate, move and scale the sculpture in the world",
    },
];

impl Command {
    /// What is left of an undo or redo of which `done` steps are done; none of other commands.
    pub fn after_steps(&self, done: u32) -> Option<Command> {
        let left = |steps: Option<u32>| match steps {
            Some(steps) => (steps > done).then(|| Some(steps - done)),
            None => Some(None),
        };
        match self {
            Command::Undo { steps } => left(*steps).map(|steps| Command::Undo { steps }),
            Command::Redo { steps } => left(*steps).map(|steps| Command::Redo { steps }),
            _ => None,
        }
    }

    /// The verb of the text form.
    pub fn verb(&self) -> &'static str {
        match self {
            Command::New(_) => "new",
            Command::Open { .. } => "open",
            Command::Embed { .. } => "embed",
            Command::Save { .. } => "save",
            Command::Begin { .. } => "begin",
            Command::End => "end",
            Command::Cancel => "cancel",
            Command::Construct { op: EditOp::Add(_), .. } => "add",
            Command::Construct { op: EditOp::Subtract, .. } => "subtract",
            Command::Construct { op: EditOp::Recolour(_), .. } => "recolour",
            Command::Spray { .. } => "spray",
            Command::Grab { .. } => "grab",
            Command::Deform { .. } => "deform",
            Command::Texture { .. } => "texture",
            Command::Fill { .. } => "fill",
            Command::Clear { .. } => "clear",
            Command::Dye { .. } => "dye",
            Command::Mark(_) => "mark",
            Command::Select(_) => "select",
            Command::Limit(_) => "limit",
            Command::Irreversible(_) => "irreversible",
            Command::Symmetry(_) => "symmetry",
            Command::Copy => "copy",
            Command::Cut => "cut",
            Command::Paste { .. } => "paste",
            Command::Move { .. } => "move",
            Command::Array { .. } => "array",
            Command::Orient(_) => "orient",
            Command::Mend(mend) => mend.verb(),
            Command::Undo { .. } => "undo",
            Command::Redo { .. } => "redo",
            Command::Place(_) => "place",
        }
    }

    /// Label of a step made by this command alone, for the history list.
    pub fn label(&self) -> String {
        match self {
            Command::Construct { primitive, .. } | Command::Texture { primitive, .. } => {
                format!("{} {}", self.verb(), primitive.solid.name())
            }
            Command::Fill { area, .. } | Command::Clear { area } | Command::Dye { area, .. }
                if *area != Area::Grid =>
            {
                format!("{} {}", self.verb(), area.name())
            }
            Command::Spray { spray, .. } => spray.effect.name().to_string(),
            Command::Deform { deform, .. } => deform.brush.kind().name().to_string(),
            _ => self.verb().to_string(),
        }
    }
}
