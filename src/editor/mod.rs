//! The editor: what a person does to the sculpture. Tools, strokes, the marker, long work and the
//! session that carries out commands.
//!
//! [`Editor`] takes actions, pointer positions with a [`Picker`](crate::picking::Picker), and commands;
//! it changes the document through its session alone. It returns the further effects of an edit as [`Outcome`]s, which
//! its owner takes after every call ([`Editor::take_outcomes`]). Knows no egui, no window, no camera and no Vulkan.

mod actions;
mod autosave;
pub mod brushes;
pub mod commands;
pub mod draw;
pub mod hand;
mod hover;
mod idle;
pub mod job;
mod lead;
mod marker;
pub mod pen_use;
mod pressure;
pub mod questions;
pub mod recovery;
pub mod sizes;
pub mod stroke;
mod surface_anchor;
mod surface_guide;
pub mod symmetry;
pub mod tool;
pub mod tool_change;
pub mod wand;

use glam::{Vec2, Vec3};

use crate::command::Command;
use crate::document::Document;
use crate::notice::Notice;
use crate::session::Session;

use autosave::Autosave;
use draw::{Drawing, Unfinished};
use hand::HandTool;
use idle::Walls;
use job::{Busy, Jobs};
use marker::MarkerTool;
use pressure::Grip;
use questions::{ChangedOnDisk, Next, Unkept};
use stroke::Stroke;
use surface_anchor::SurfaceAnchor;
use tool::ToolState;

pub use hover::PointerUse;

/// An effect of an edit, besides the change of the document.
#[derive(Clone, PartialEq, Debug)]
pub enum Outcome {
    /// Another sculpture is there: views of it begin anew.
    Replaced,
    Notice(Notice),
    /// Nothing has changed because tools are limited to the selection.
    Limited,
    /// This would lose unsaved work: the person is to be asked.
    Unsaved(Next),
    /// This cannot be undone: the person is to be asked.
    Unkept(Unkept),
    /// Another program has changed the file: the person is to be asked.
    ChangedOnDisk(ChangedOnDisk),
    /// A name for the sculpture's file is needed; then do that.
    NameNeeded(Option<Next>),
    /// A file was opened or saved by this command.
    FileUsed(Command),
    /// The program is to be left, as was asked for while there was long work.
    Leave,
    /// The work that an earlier session left is to be recovered from the journal of this number. This was asked for
    /// while there was unsaved work, which is saved now.
    Recover(u64),
}

/// The session with everything that a person has in hand.
pub struct Editor {
    session: Session,
    pub tool: ToolState,
    /// The tool in a hand in the room of a headset.
    pub hand: HandTool,
    stroke: Option<Stroke>,
    walls: Walls,
    /// A stroke that is over, but cannot be undone: the person is asked whether to keep it.
    stroke_in_question: bool,
    /// Where the tool stands on the surface.
    anchor: SurfaceAnchor,
    marker: MarkerTool,
    /// The solid that is being drawn.
    drawing: Option<Drawing>,
    /// One that is drawn by several presses, between them.
    unfinished: Option<Unfinished>,
    /// Where a hand that draws has been, in voxels; empty while none does.
    held_way: Vec<Vec3>,
    /// Where the pointer is, in pixels of the picture; none while it is elsewhere.
    pointer: Option<Vec2>,
    /// A drag of `Sculpt` that began beside the sculpture rotates it.
    rotates_instead: bool,
    /// The gesture that the pointer's button holds was ended; the button does nothing until it is released.
    lifted: bool,
    /// How a pen or the trigger of a hand is pressed; fully where nothing tells.
    grip: Grip,
    /// The size or the strength of the tool follows the pointer.
    leading: Option<lead::Leading>,
    jobs: Jobs,
    autosave: Autosave,
    /// Voxels that commands have changed since the start.
    voxels_changed: u64,
    outcomes: Vec<Outcome>,
}

impl Editor {
    pub fn new(session: Session) -> Editor {
        let tool = ToolState::new(session.document().grid().dims());
        Editor {
            session,
            tool,
            hand: HandTool::default(),
            stroke: None,
            walls: Walls::default(),
            stroke_in_question: false,
            anchor: SurfaceAnchor::default(),
            marker: MarkerTool::default(),
            drawing: None,
            unfinished: None,
            held_way: Vec::new(),
            pointer: None,
            rotates_instead: false,
            lifted: false,
            grip: Grip::default(),
            leading: None,
            jobs: Jobs::default(),
            autosave: Autosave::default(),
            voxels_changed: 0,
            outcomes: Vec::new(),
        }
    }

    pub fn session(&self) -> &Session {
        &self.session
    }

    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    pub fn document(&self) -> &Document {
        self.session.document()
    }

    /// Returns the outcomes of the calls since the last time, in order.
    pub fn take_outcomes(&mut self) -> Vec<Outcome> {
        std::mem::take(&mut self.outcomes)
    }

    /// Where the pointer is, in pixels of the picture.
    pub fn pointer(&self) -> Option<Vec2> {
        self.pointer
    }

    /// Takes where the pointer is.
    pub fn set_pointer(&mut self, at: Option<Vec2>) {
        self.pointer = at;
    }

    /// Whether voxels are being changed by a stroke that is not finished.
    pub fn is_stroking(&self) -> bool {
        self.stroke.is_some()
    }

    /// Voxels that commands have changed since the start, for what makes changes felt.
    pub fn voxels_changed(&self) -> u64 {
        self.voxels_changed
    }

    /// Long work under way, as the interface shows it.
    pub fn busy(&self) -> Option<Busy> {
        self.jobs.busy()
    }

    fn note(&mut self, text: impl Into<String>) {
        self.outcomes.push(Outcome::Notice(Notice::note(text)));
    }

    fn error(&mut self, text: impl Into<String>) {
        self.outcomes.push(Outcome::Notice(Notice::error(text)));
    }
}
