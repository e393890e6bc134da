#![doc = include_str!("../README.md")]
#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::too_many_lines))]

// The rooms are public for the program, which shares their types, and hidden from the documentation: the names below are
// the interface.
#[doc(hidden)]
pub mod command;
#[doc(hidden)]
pub mod document;
#[doc(hidden)]
pub mod format;
#[doc(hidden)]
pub mod mesh;
#[doc(hidden)]
pub mod persist;
#[doc(hidden)]
pub mod print_check;
#[doc(hidden)]
pub mod progress;
#[doc(hidden)]
pub mod refusal;
#[doc(hidden)]
pub mod resample;
#[doc(hidden)]
pub mod scenes;
#[doc(hidden)]
pub mod sculpture;
#[doc(hidden)]
pub mod session;
#[doc(hidden)]
pub mod shade;
#[doc(hidden)]
pub mod surface;
#[doc(hidden)]
pub mod tools;
#[doc(hidden)]
pub mod trace;
#[doc(hidden)]
pub mod view;
#[doc(hidden)]
pub mod voxelise;

// The vector and matrix types of the interface: callers need this version of them.
pub use glam;

// A sculpture and its parts.
#[doc(inline)]
pub use document::{Applied, CommandError, Document};
#[doc(inline)]
pub use sculpture::edit::EditOp;
#[doc(inline)]
pub use sculpture::history::{Contents, SurfaceKind};
#[doc(inline)]
pub use sculpture::orientation::{Orientation, Up};
#[doc(inline)]
pub use sculpture::region::VoxelBox;
#[doc(inline)]
pub use sculpture::{ColourDepth, Digest, Grid, GridError, Limits, Material, Placement, Rgb};

// Errors that all modules share, and errors of work that a document or a session runs for its caller.
#[doc(inline)]
pub use persist::journal::JournalError;
#[doc(inline)]
pub use refusal::{InvalidValue, MemoryBudget, OverBudget};
#[doc(inline)]
pub use sculpture::orient::OrientError;
#[doc(inline)]
pub use tools::pieces::PiecesError;
#[doc(inline)]
pub use tools::repair::RepairError;
#[doc(inline)]
pub use trace::TraceError;
#[doc(inline)]
pub use voxelise::VoxeliseError;

// Changes as values and as text.
#[doc(inline)]
pub use command::text::{ParseError, ScriptError, parse_script};
#[doc(inline)]
pub use command::{Area, COMMANDS, Command, CommandHelp, NewSculpture, SelectOp};
#[doc(inline)]
pub use tools::brush::spec::ContactKind;
#[doc(inline)]
pub use tools::brush::{BrushId, BrushUse};
#[doc(inline)]
pub use tools::repair::Repair;
#[doc(inline)]
pub use tools::solid::{Primitive, Solid};
#[doc(inline)]
pub use tools::symmetry::Symmetry;

// A sculpture with its files, and long work.
#[doc(inline)]
pub use progress::{Progress, ProgressReport, Stage};
#[doc(inline)]
pub use session::{FileIdentity, Holder, Session, SessionError};

// Files.
#[doc(inline)]
pub use format::options::{
    Colouring, Existence, ExportForm, ExportOptions, ImportOptions, MeshFill, MeshSize, RawLayout,
    ScanRegion,
};
#[doc(inline)]
pub use format::{
    Densities, FormatError, Histogram, Info, Loaded, MeshOptions, MeshUp, READ_ENDINGS, Samples,
    Texts, Volume, WRITE_ENDINGS, info, info_with, load, load_volume, save, save_with,
};

// The surface as triangles, and whether it can be printed.
#[doc(inline)]
pub use mesh::{Mesh, MeshError, MeshKind, VertexColours};
#[doc(inline)]
pub use print_check::{CheckError, CheckOptions, Checked, check as check_print};

// Pictures.
#[doc(inline)]
pub use shade::{
    Lighting, NormalField, Pixels, ShadePose, ShadeSource, Smoothing, SoftwareShader, portrait,
};
#[doc(inline)]
pub use surface::{IndexMap, raycast};
#[doc(inline)]
pub use view::{Camera, Eye, PixelRays};
