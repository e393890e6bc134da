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
    #[error("this is a folder, a pipe or a device, not a file; choose a file")]
    NotAFile,
    #[error("the file extension `{0}` is unknown; use .vsc, .pvm or .raw")]
    UnknownEnding(String),
    #[error("the file name has no extension; add .vsc, .pvm or .raw")]
    NoEnding,
    #[error(
        "reading this file needs {needed_mib} MiB, more than the {budget_mib} MiB allowed; \
         raise memory.grid_mib or memory.colour_mib in the settings"
    )]
    Memory { needed_mib: u64, budget_mib: u64 },
    #[error(transparent)]
    Grid(#[from] GridError),

    #[error("this image cannot be used: {0}; choose a PNG or JPEG file")]
    Picture(String),
    #[error("the file is empty")]
    Empty,
    #[error("this is not a PVM volume: it begins with `{0}`, not with PVM, PVM2, PVM3 or a DDS id")]
    NotPvm(String),
    #[error("the DDS stream is of type `{}`; only v3d and v3e are supported", .0.escape_default())]
    DdsVersion(String),
    #[error("the DDS stream is empty; the file is damaged")]
    DdsEmpty,
    #[error("the DDS stream does not contain a PVM volume: it unpacks to `{0}`")]
    NotPvmInside(String),
    #[error("the header ends before its {0} line; the file is truncated")]
    HeaderCut(&'static str),
    #[error("the header is longer than {} KiB; the file is damaged", super::pvm::HEADER_LIMIT >> 10)]
    HeaderTooLong,
    #[error("the header's {what} line is `{line}`, but must be {rule}")]
    Header { what: &'static str, line: String, rule: &'static str },
    #[error(
        "the header's lines end with CR LF: the file was copied as text; copy it as binary data"
    )]
    TextCopy,
    #[error("the header asks for 2^32 bytes of voxels or more, which a PVM volume cannot have")]
    HeaderTooLarge,
    #[error(
        "the header asks for {expected} bytes of voxels, but {found} follow; the file is truncated"
    )]
    VoxelsCut { expected: u64, found: u64 },
    #[error("there are {0} unexpected bytes after the volume; the file is damaged")]
    Trailing(u64),
    #[error("the four texts after the voxels are incomplete; the file is truncated")]
    TextsCut,
    #[error("the texts after the voxels are longer than {} MiB", super::pvm::TEXTS_LIMIT >> 20)]
    TextsTooLong,

    #[error("this is not a .vsc sculpture: it begins with `{0}`")]
    NotVsc(String),
    #[error(
        "the file has format version {0}, but this program reads only version 1; update the program"
    )]
    VscVersion(u32),
    #[error("the file is damaged: {0}")]
    Damaged(&'static str),
    #[error(
        "a .vsc file always stores the whole sculpture; leave out `{0}`, or save as .pvm or .raw"
    )]
    FormOfVsc(ExportForm),

    #[error(
        "a .raw file does not describe its contents; give its size and type, such as 128x128x64:u16le"
    )]
    NoRawLayout,
    #[error("{expected} bytes were expected for {layout}, but the file has {found}")]
    RawLength { layout: String, expected: u64, found: u64 },

    #[error("voxels of {0} bytes are not supported; voxels must have 1 to 4 bytes")]
    Components(u32),
    #[error("{colouring} colours are made from densities, but this volume holds {samples}")]
    NotDensities { colouring: Colouring, samples: Samples },
    #[error("packed colours have 8, 16 or 24 bits, but this volume holds {0}")]
    NotPacked(Samples),
    #[error(
        "a threshold cannot be used with packed colours, where 0 means empty and everything else filled"
    )]
    ThresholdOfPacked,
    #[error(
        "the colours need {needed_mib} MiB, more than the {budget_mib} MiB allowed; \
         read it with fewer bits of colour, or raise memory.colour_mib in the settings"
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
