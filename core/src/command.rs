//! Commands: every change of a sculpture is a value of [`Command`] with a stable text form. Scripts and recordings are
//! lists of commands.
//!
//! Defines commands, not their execution: `document` executes those that concern the sculpture,
//! `session` those that concern files.
//!
//! Grammar, one command per line: a verb, then words, quoted strings and `key=value` pairs in any order;
//! `#` at the start of a line opens a comment. [`text`] implements it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};

use crate::format::options::{ExportOptions, ImportOptions};
use crate::resample::Resolution;
use crate::sculpture::edit::EditOp;
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::Orientation;
use crate::sculpture::region::VoxelBox;
use crate::sculpture::{ColourDepth, Placement, Rgb};
use crate::tools::brush::BrushUse;
use crate::tools::drawn::DrawnSolid;
use crate::tools::repair::Repair;
use crate::tools::solid::Primitive;
use crate::tools::symmetry::Symmetry;
use crate::tools::tint::Tint;

mod area;
mod canvas;
mod class;
mod help;
mod mask;
pub mod text;

pub use area::{Area, SelectOp};
pub use canvas::CanvasChange;
pub use class::CommandClass;
pub use help::{COMMANDS, CommandHelp};
pub use mask::{MaskArea, MaskChange, PatchRule};
pub use text::{usage_of_brush, usage_of_drawn_solid};

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
    /// Empty voxels around the block at every side.
    pub room_vx: u32,
    /// Tools that reach beyond the box make it grow.
    pub grows: bool,
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
    /// Give a file's content to the following commands that name it, whatever the disk holds. Recordings use it, so
    /// that they replay anywhere. Changes no voxel and is no undo step.
    Embed {
        /// The name of the file.
        path: PathBuf,
        /// Its bytes: an image, or a sculpture as .vsc, regardless of the name.
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
    /// Add, subtract or recolour the voxels inside a solid, or inside the volume that it sweeps.
    Construct {
        /// The operation on the voxels.
        op: EditOp,
        /// The solid.
        primitive: Primitive,
        /// The point in voxel coordinates to which its centre moves on a straight path; the whole swept volume counts.
        /// `None` if it stays.
        to_vx: Option<Vec3>,
    },
    /// Add, subtract or recolour the voxels inside a solid that is drawn.
    DrawnSolid {
        /// The operation on the voxels.
        op: EditOp,
        /// The solid.
        drawn: DrawnSolid,
    },
    /// Use a brush once.
    Brush(BrushUse),
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
        /// Colour of new voxels; `None` for the base colour.
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
    /// Change the colours of an area, voxel by voxel.
    Tint {
        /// Which voxels.
        area: Area,
        /// The change of their colours.
        tint: Tint,
    },
    /// Give the patch of one colour on the surface around a voxel another colour.
    Flood {
        /// The voxel.
        at: IVec3,
        /// The colour of the patch afterwards.
        colour: Rgb,
        /// How far colours of the patch may differ from the voxel's: a share of the range of each channel.
        tolerance: f32,
    },
    /// Change which voxels are protected from all tools. An undo step, although it changes no voxel.
    Mask(MaskChange),
    /// Move and resize the marker. Like all commands for the selection, it changes no voxel and so is no undo step.
    Mark(VoxelBox),
    /// Change the stack of selected boxes.
    Select(SelectOp),
    /// Switch the limit of all tools to the selection on or off.
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
    /// Repeat the last operation `count` times, each time `step` voxels further on.
    Array {
        /// Number of copies.
        count: u32,
        /// Distance from each copy to the next, in voxels.
        step: IVec3,
    },
    /// Rotate or mirror the whole sculpture; its size, colours and selection follow.
    Orient(Orientation),
    /// Give the sculpture another resolution; its size in the world stays.
    Resample(Resolution),
    /// Make the sculpture fit for printing.
    Repair(Repair),
    /// Move the sides of the sculpture's box, or let it grow with the tools.
    Canvas(CanvasChange),
    /// Show and export near voxels as cubes or as the smooth surface between them. An undo step, although it changes no
    /// voxel.
    Surface(SurfaceKind),
    /// Undo the last `steps` steps, or all.
    Undo {
        /// How many; `None` for all.
        steps: Option<u32>,
    },
    /// Redo the last `steps` undone steps, or all.
    Redo {
        /// How many; `None` for all.
        steps: Option<u32>,
    },
    /// Place the sculpture in the world. It changes no voxel and so is no undo step.
    Place(Placement),
}

impl Command {
    /// Returns the rest of an undo or redo after `done` steps; `None` for other commands.
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

    /// Returns whether it uses a tool at one place, which an array can repeat.
    pub const fn is_tool_use(&self) -> bool {
        matches!(self.class(), CommandClass::Tool)
    }

    /// Returns the same tool use, moved by `step` voxels; `None` if the command does not use a tool.
    pub(crate) fn shifted(&self, step: IVec3) -> Option<Command> {
        let by = step.as_vec3();
        let solid =
            |primitive: &Primitive| Primitive { centre_vx: primitive.centre_vx + by, ..*primitive };
        Some(match self {
            Command::Construct { op, primitive, to_vx } => Command::Construct {
                op: *op,
                primitive: solid(primitive),
                to_vx: to_vx.map(|to| to + by),
            },
            Command::DrawnSolid { op, drawn } => {
                Command::DrawnSolid { op: *op, drawn: drawn.shifted(by) }
            }
            Command::Texture { primitive, picture } => {
                Command::Texture { primitive: solid(primitive), picture: picture.clone() }
            }
            Command::Brush(used) => Command::Brush(used.shifted(by)),
            Command::Paste { at, orientation } => {
                Command::Paste { at: at.saturating_add(step), orientation: *orientation }
            }
            _ => return None,
        })
    }

    /// Returns the image that it paints with.
    pub fn picture(&self) -> Option<&Path> {
        match self {
            Command::Texture { picture, .. } => Some(picture),
            Command::Brush(used) => used.picture.as_deref(),
            _ => None,
        }
    }

    /// Returns the same command with another name for its image.
    pub(crate) fn with_picture(mut self, name: PathBuf) -> Command {
        match &mut self {
            Command::Texture { picture, .. } => *picture = name,
            Command::Brush(used) if used.picture.is_some() => used.picture = Some(name),
            _ => {}
        }
        self
    }

    /// Returns the verb of the text form.
    pub fn verb(&self) -> &'static str {
        match self {
            Command::New(_) => "new",
            Command::Open { .. } => "open",
            Command::Embed { .. } => "embed",
            Command::Save { .. } => "save",
            Command::Begin { .. } => "begin",
            Command::End => "end",
            Command::Cancel => "cancel",
            Command::Construct { op, .. } | Command::DrawnSolid { op, .. } => match op {
                EditOp::Add(_) => "add",
                EditOp::Subtract => "subtract",
                EditOp::Recolour(_) => "recolour",
            },
            Command::Brush(used) => text::verb_of_brush(used),
            Command::Texture { .. } => "texture",
            Command::Fill { .. } => "fill",
            Command::Clear { .. } => "clear",
            Command::Dye { .. } => "dye",
            Command::Tint { tint, .. } => tint.verb(),
            Command::Flood { .. } => "flood",
            Command::Mask(_) => "mask",
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
            Command::Repair(repair) => repair.verb(),
            Command::Canvas(_) => "canvas",
            Command::Resample(_) => "resample",
            Command::Surface(_) => "surface",
            Command::Undo { .. } => "undo",
            Command::Redo { .. } => "redo",
            Command::Place(_) => "place",
        }
    }

    /// Returns the label for the history list of a step made by this command alone.
    pub fn label(&self) -> String {
        match self {
            Command::Construct { primitive, .. } | Command::Texture { primitive, .. } => {
                format!("{} {}", self.verb(), primitive.solid.name())
            }
            Command::Fill { area, .. }
            | Command::Clear { area }
            | Command::Dye { area, .. }
            | Command::Tint { area, .. }
                if *area != Area::Grid =>
            {
                format!("{} {}", self.verb(), area.name())
            }
            Command::Mask(change) => format!("mask {}", change.name()),
            Command::Canvas(change) => format!("canvas {}", change.name()),
            Command::Surface(kind) => format!("{} {}", self.verb(), kind.name()),
            Command::DrawnSolid { drawn, .. } => format!("{} {}", self.verb(), drawn.name()),
            Command::Brush(used) if used.picture.is_none() => used.brush().spec().name.to_string(),
            _ => self.verb().to_string(),
        }
    }
}
