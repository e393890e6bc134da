//! Owns what can be wrong with a file, in words for the person: what it is and what to do.
//! The caller names the file.

use thiserror::Error;

use super::options::{Colouring, ExportForm};
use super::volume::Samples;
use crate::sculpture::GridError;

/// Why a file cannot be read or written.
#[derive(Debug, Error)]
pub enum FormatError {
    #[error("{0}")]
    Io(#[from] std::io::Error),
    #[error("the work was cancelled")]
    Cancelled,
    #[error("this is not a file but a folder, a pipe or a device; name a file")]
    NotAFile,
    #[error("the ending `{0}` is not one of those known: .vsc, .pvm, .raw")]
    UnknownEnding(String),
    #[error("the name has no ending that tells the format; give it .vsc, .pvm or .raw")]
    NoEnding,
    #[error(
        "reading this takes {needed_mib} MiB, more than the {budget_mib} MiB allowed; \
         raise memory.grid_mib or memory.colour_mib in the configuration"
    )]
    Memory { needed_mib: u64, budget_mib: u64 },
    #[error(transparent)]
    Grid(#[from] GridError),

    #[error("this is no picture that can be used: {0}; take a PNG or JPEG file")]
    Picture(String),
    #[error("the file is empty")]
    Empty,
    #[error("this is no PVM volume: it begins with `{0}`, not with PVM, PVM2, PVM3 or a DDS id")]
    NotPvm(String),
    #[error("the DDS stream is of the kind `{}`; only v3d and v3e are known", .0.escape_default())]
    DdsVersion(String),
    #[error("the DDS stream holds nothing: it ends before its first byte; the file is damaged")]
    DdsEmpty,
    #[error("the DDS stream holds no PVM volume: it unpacks to `{0}`")]
    NotPvmInside(String),
    #[error("the header ends before its line with the {0}; the file is cut short")]
    HeaderCut(&'static str),
    #[error("the header is longer than {} KiB; the file is damaged", super::pvm::HEADER_LIMIT >> 10)]
    HeaderTooLong,
    #[error("the header's line with the {what} is `{line}`, but must be {rule}")]
    Header { what: &'static str, line: String, rule: &'static str },
    #[error(
        "the header's lines end with CR LF: the file was copied as text; copy it as binary data"
    )]
    TextCopy,
    #[error("the header asks for 2^32 bytes of voxels or more, which a PVM volume cannot have")]
    HeaderTooLarge,
    #[error(
        "the header asks for {expected} bytes of voxels, but {found} follow; the file is cut short"
    )]
    VoxelsCut { expected: u64, found: u64 },
    #[error("the volume should end {0} bytes earlier; the file is damaged")]
    Trailing(u64),
    #[error("the four texts behind the voxels are incomplete; the file is cut short")]
    TextsCut,
    #[error("the texts behind the voxels are longer than {} MiB", super::pvm::TEXTS_LIMIT >> 20)]
    TextsTooLong,

    #[error("this is no .vsc sculpture: it begins with `{0}`")]
    NotVsc(String),
    #[error("the file is of version {0}, but this program knows version 1; take a newer program")]
    VscVersion(u32),
    #[error("the file is damaged: {0}")]
    Damaged(&'static str),
    #[error("a .vsc file holds the sculpture as it is; leave out `{0}`, or choose .pvm or .raw")]
    FormOfVsc(ExportForm),

    #[error("a raw file does not say what it holds; give size and type, such as 128x128x64:u16le")]
    NoRawLayout,
    #[error("{expected} bytes were expected for {layout}, but the file has {found}")]
    RawLength { layout: String, expected: u64, found: u64 },

    #[error("voxels of {0} bytes are neither densities nor colours; 1 to 4 bytes can be shown")]
    Components(u32),
    #[error("{colouring} colours are made from densities, but this volume holds {samples}")]
    NotDensities { colouring: Colouring, samples: Samples },
    #[error("packed colours have 8, 16 or 24 bits, but this volume holds {0}")]
    NotPacked(Samples),
    #[error("a threshold cannot be used with packed colours: there 0 is empty and all else is not")]
    ThresholdOfPacked,
    #[error(
        "the colours need {needed_mib} MiB, more than the {budget_mib} MiB allowed; \
         read it with fewer bits of colour or raise memory.colour_mib in the configuration"
    )]
    ColourMemory { needed_mib: u64, budget_mib: u64 },

    #[error(
        "the sculpture takes {0} bytes in this form, but a PVM volume must stay below 2^32; \
         save it as packed colours of 8 or 16 bits, or as densities"
    )]
    TooLargeForPvm(u64),
    #[error("a PVM volume cannot hold {0}")]
    NotInPvm(Samples),
    #[error("the {0} text contains a NUL, which ends a text in PVM; remove it")]
    NulInText(&'static str),
    #[error("the sculpture has no colours; save it as densities")]
    NoColours,
}

/// Shows the first bytes of something unexpected, with all that is not plain text escaped.
pub(super) fn excerpt(bytes: &[u8]) -> String {
    const MOST: usize = 24;
    match bytes.get(..MOST) {
        Some(start) if bytes.len() > MOST => format!("{}...", start.escape_ascii()),
        _ => bytes.escape_ascii().to_string(),
    }
}
