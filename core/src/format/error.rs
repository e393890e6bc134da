//! Errors of reading and writing files. Messages are for users: they say what is wrong and what to do, but name no
//! setting or flag, which only the program has.
//! Callers add the name of the file, and the list of formats gives the extensions that messages name. Knows no format.

use glam::UVec3;
use thiserror::Error;

use super::options::{Colouring, ExportForm, MeshUp, ScanRegion};
use super::volume::Samples;
use crate::mesh::MeshError;
use crate::progress::Progress;
use crate::refusal::{InvalidValue, OverBudget};
use crate::sculpture::GridError;
use crate::sculpture::orient::OrientError;
use crate::tools::pieces::PiecesError;
use crate::voxelise::VoxeliseError;

/// The way out where a file's colours need too much memory.
pub(super) const FEWER_BITS: &str = "read it with fewer bits of colour";

/// Why a file cannot be read or written.
#[derive(Debug, Error)]
pub enum FormatError {
    /// The operating system's error.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// [`crate::progress::Progress::is_cancelled`] returned true.
    #[error("the work was cancelled")]
    Cancelled,
    /// The path names something that is not a regular file.
    #[error("this is a folder, a pipe or a device, not a file; choose a file")]
    NotAFile,
    /// The path names a folder that holds no scan.
    #[error(
        "this folder holds neither DICOM nor TIFF files; choose a file, or the folder of a scan"
    )]
    NoScanInFolder,
    /// No format has this file extension.
    #[error(
        "the file extension `{ending}` is unknown; read are {known}; voxels alone, under any name, with a layout such as 128x128x64:u16le"
    )]
    UnknownEnding {
        /// With its dot.
        ending: String,
        /// Those that are read.
        known: String,
    },
    /// The path has no file extension to choose the format by.
    #[error("the file name has no extension; add one of {0}")]
    NoEnding(String),
    /// A file is to be written under a name that no format has.
    #[error("{why} of a format that is written; choose one of {written}")]
    NotWritten {
        /// Begins the message.
        why: String,
        /// Extensions of the files that are written.
        written: String,
    },
    /// A file that holds something else than its name says, which is not read.
    #[error("choose another file; the name is that of another kind of file: this one holds {0}")]
    OtherContent(&'static str),
    /// A file that is packed, whatever its name says.
    #[error("this file holds {0}; unpack it first, and open what is inside")]
    Packed(&'static str),
    /// Reading needs more memory than the limits allow.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The file's grid is not possible.
    #[error(transparent)]
    Grid(#[from] GridError),

    /// The image cannot be decoded.
    #[error("this image cannot be used: {0}; choose a PNG or JPEG file")]
    Picture(String),
    /// The file has no bytes.
    #[error("the file is empty; copy or export it again")]
    Empty,
    /// The file does not start as a PVM volume does.
    #[error(
        "this is not a PVM volume: it begins with `{0}`, not with PVM, PVM2, PVM3 or a DDS id; export it as PVM again"
    )]
    NotPvm(String),
    /// An unknown version of DDS compression.
    #[error("the DDS stream is of type `{}`; only v3d and v3e are supported; pack it as one of these, or not at all", .0.escape_default())]
    DdsVersion(String),
    /// DDS compression of nothing.
    #[error("the DDS stream is empty; the file is damaged: copy it again")]
    DdsEmpty,
    /// DDS compression of something that is not a PVM volume.
    #[error(
        "the DDS stream does not contain a PVM volume: it unpacks to `{0}`; the file is damaged: copy it again"
    )]
    NotPvmInside(String),
    /// The PVM header ends before the named line.
    #[error("the header ends before its {0} line; the file is truncated: copy it again")]
    HeaderCut(&'static str),
    /// The PVM header is longer than any valid one.
    #[error("the header is longer than {} KiB; the file is damaged: copy it again", super::limits::HEADER_LIMIT >> 10)]
    HeaderTooLong,
    /// A line of the PVM header is not valid.
    #[error(
        "the header's {} line is `{}`, but {}; export it again",
        .0.field, .0.value.as_deref().unwrap_or_default(), .0.rule
    )]
    Header(InvalidValue),
    /// The line ends of the PVM header were converted.
    #[error(
        "the header's lines end with CR LF: the file was copied as text; copy it as binary data"
    )]
    TextCopy,
    /// The size in the PVM header is out of range.
    #[error(
        "the header asks for 2^32 bytes of voxels or more, which a PVM volume cannot have; export a smaller part, or as NRRD"
    )]
    HeaderTooLarge,
    /// The file has fewer bytes of voxels than its header says.
    #[error(
        "the header asks for {expected} bytes of voxels, but {found} follow; the file is truncated: copy it again"
    )]
    VoxelsCut {
        /// Bytes expected.
        expected: u64,
        /// Bytes found.
        found: u64,
    },
    /// The file has bytes after its end.
    #[error("there are {0} unexpected bytes after the volume; the file is damaged: copy it again")]
    Trailing(u64),
    /// The texts after the voxels end too early.
    #[error("the four texts after the voxels are incomplete; the file is truncated: copy it again")]
    TextsCut,
    /// The texts after the voxels are longer than allowed.
    #[error("the texts after the voxels are longer than {} MiB; remove or shorten them", super::limits::TEXTS_LIMIT >> 20)]
    TextsTooLong,

    /// The file does not start as a .vsc file does.
    #[error("this is not a .vsc sculpture: it begins with `{0}`; open it under its own name")]
    NotVsc(String),
    /// A .vsc file of an unknown version.
    #[error(
        "the file has format version {0}, but this program reads only version 1; update the program"
    )]
    VscVersion(u32),
    /// A .vsc file whose parts contradict each other or their checksums.
    #[error("the file is damaged: {0}; copy it again, or open an earlier copy")]
    Damaged(&'static str),
    /// An export form was given for .vsc, which has only one.
    #[error(
        "a .vsc file always stores the whole sculpture; leave out `{form}`, or save as {volumes}"
    )]
    FormOfVsc {
        /// The form asked for.
        form: ExportForm,
        /// Extensions of the files that have forms.
        volumes: String,
    },

    /// A model of another program is damaged, at a place.
    #[error("{place}: {what}; the file is damaged or cut: copy it again, or export it once more")]
    Malformed {
        /// Where in the file.
        place: String,
        /// The fault that was found there.
        what: String,
    },
    /// A file that a mesh names, but that cannot be read beside it.
    #[error(
        "the mesh needs {name:?}, but {why}; put it beside the mesh, or export the mesh as .glb, which holds all in one file"
    )]
    Beside {
        /// As the mesh names it.
        name: String,
        /// Why it cannot be read.
        why: String,
    },
    /// The voxels of a scan without its header.
    #[error(
        "a file of this name holds the voxels of a scan, whose header of the same name and the ending .hdr is not beside \
         it; put it there, or describe the voxels by a layout such as 128x128x64:u16le"
    )]
    NoScanHeader,
    /// A scan that is not what its name says, or of a kind that is not read.
    #[error("{0}")]
    Scan(String),
    /// A file named .vox that is neither MagicaVoxel's nor Voxlap's.
    #[error(
        "this is neither a MagicaVoxel nor a Voxlap file: it begins with `{0}`; export it as .vox again"
    )]
    NotVox(String),
    /// A mesh cannot become a sculpture.
    #[error(transparent)]
    Voxelise(VoxeliseError),
    /// A mesh without a surface.
    #[error("the file holds no triangles, but points at most; export the surface")]
    NoTriangles,
    /// A model in which no voxel exists and that says no size.
    #[error("the file holds no visible voxels; show hidden objects and export it again")]
    NoVoxels,
    /// A model whose copies of copies are too many.
    #[error("the file places more than 2^32 voxels, most of them copies; export it with fewer")]
    TooManyVoxels,
    /// An export form was given for a format that has only one.
    #[error("files of this kind have only one form; leave out `{form}`, or save as {volumes}")]
    FormOfModel {
        /// The form asked for.
        form: ExportForm,
        /// Extensions of the files that have forms.
        volumes: String,
    },
    /// A format that can only be read.
    #[error("files of this kind can only be read; choose one of {0}")]
    ReadOnly(String),
    /// A .vox file cannot store so many voxels.
    #[error(
        "the sculpture has more voxels than the 2^29 that a .vox file can hold; save it as .qb"
    )]
    TooLargeForVox,

    /// A .raw file without a layout.
    #[error(
        "a .raw file does not describe its contents; give its size and type, such as 128x128x64:u16le"
    )]
    NoRawLayout,
    /// The length of a .raw file does not match its layout.
    #[error(
        "{expected} bytes were expected for {layout}, but the file has {found}; give its layout anew, `:skip=` for a header"
    )]
    RawLength {
        /// The layout that was given.
        layout: String,
        /// Bytes expected.
        expected: u64,
        /// Bytes found.
        found: u64,
    },

    /// A region that is not in the volume.
    #[error(
        "the region {region} reaches beyond the {}x{}x{} voxels of the file, which are counted from 0; choose a smaller one",
        dims.x, dims.y, dims.z
    )]
    Region {
        /// The region asked for.
        region: ScanRegion,
        /// Size of the volume in voxels.
        dims: UVec3,
    },
    /// A channel or a time that the file does not have.
    #[error("{what} {asked} was asked for, but the file has {}", number_of(*.count))]
    NoSuchVolume {
        /// `channel` or `time`.
        what: &'static str,
        /// Its number.
        asked: u64,
        /// How many there are.
        count: u64,
    },

    /// Unsupported number of bytes per voxel.
    #[error(
        "voxels of {0} bytes are not supported; voxels must have 1 to 4 bytes; export it with fewer"
    )]
    Components(u32),
    /// A colouring that needs densities, of a volume that has none.
    #[error(
        "{colouring} colours are made from densities, but this volume holds {samples}; leave the colouring out"
    )]
    NotDensities {
        /// The colouring asked for.
        colouring: Colouring,
        /// The volume's sample type.
        samples: Samples,
    },
    /// Packed colours were asked for, of a volume of another sample type.
    #[error("packed colours have 8, 16 or 24 bits, but this volume holds {0}; leave `packed` out")]
    NotPacked(Samples),
    /// A threshold was given for packed colours.
    #[error(
        "a threshold cannot be used with packed colours, where 0 means empty and everything else filled; leave one of them out"
    )]
    ThresholdOfPacked,

    /// PVM cannot store so many bytes.
    #[error(
        "the sculpture takes {0} bytes in this form, but a PVM volume must stay below 2^32; \
         save it as packed colours of 8 or 16 bits, or as densities"
    )]
    TooLargeForPvm(u64),
    /// PVM cannot store this sample type.
    #[error("a PVM volume cannot hold {0}; save it as .vsc")]
    NotInPvm(Samples),
    /// A text cannot be stored since PVM ends texts with NUL.
    #[error("the {0} text contains a NUL, which ends a text in PVM; remove it")]
    NulInText(&'static str),
    /// A mesh was asked for under a name of another format.
    #[error("a mesh is written to a {0} file; choose such a name")]
    NotAMeshFile(String),
    /// An export form of volumes was given for a mesh.
    #[error("`{form}` is a form of volumes; leave it out for a mesh, or save as {volumes}")]
    FormOfMesh {
        /// The form asked for.
        form: ExportForm,
        /// Extensions of the files that have forms.
        volumes: String,
    },
    /// The same axis points up in every file of the format.
    #[error(
        "a .{extension} file always has the {up} axis up, which programs turn as they need; leave out the axis"
    )]
    FixedUp {
        /// Of the format.
        extension: &'static str,
        /// The axis.
        up: MeshUp,
    },
    /// Points alone, but not in a file that can hold them.
    #[error("only {0} files hold points without triangles; choose a name that ends in {0}")]
    NoPoints(String),
    /// An option breaks a rule.
    #[error(transparent)]
    Invalid(#[from] InvalidValue),
    /// A mesh of an empty sculpture.
    #[error("the sculpture has no voxels, so it has no surface; there is nothing to export")]
    NoSurface,
    /// More vertices or triangles than the format can count.
    #[error(
        "the mesh has {0} vertices or triangles, more than the format can count; \
         limit its triangles, or export a smaller part of the sculpture"
    )]
    TooLargeForMesh(u64),
    /// A .glb file must stay below 4 GiB.
    #[error(
        "the mesh takes {0} bytes, but a .glb file must stay below 2^32; \
         limit its triangles, or choose .ply"
    )]
    TooLargeForGlb(u64),
    /// There is no mesh.
    #[error(transparent)]
    Mesh(MeshError),
    /// An export form of colours, but the sculpture stores none.
    #[error("the sculpture has no colours; save it as densities")]
    NoColours,
}

/// Returns the number of available items, with the range to choose from.
fn number_of(count: u64) -> String {
    match count {
        1 => "only one; leave the option out".to_string(),
        count => format!("{count}; choose one from 1 to {count}"),
    }
}

impl From<MeshError> for FormatError {
    fn from(error: MeshError) -> FormatError {
        match error {
            MeshError::Cancelled => FormatError::Cancelled,
            MeshError::Grid(error) => FormatError::Grid(error),
            MeshError::OverBudget(over) => FormatError::OverBudget(over),
            MeshError::TooLarge(_) => FormatError::Mesh(error),
        }
    }
}

impl From<OrientError> for FormatError {
    fn from(error: OrientError) -> FormatError {
        match error {
            OrientError::Grid(error) => FormatError::Grid(error),
            OrientError::OverBudget(over) => FormatError::OverBudget(over.advise(FEWER_BITS)),
            OrientError::Cancelled => FormatError::Cancelled,
        }
    }
}

impl From<PiecesError> for FormatError {
    fn from(error: PiecesError) -> FormatError {
        match error {
            PiecesError::Cancelled => FormatError::Cancelled,
            PiecesError::OverBudget(over) => FormatError::OverBudget(over),
        }
    }
}

impl From<VoxeliseError> for FormatError {
    fn from(error: VoxeliseError) -> FormatError {
        match error {
            VoxeliseError::Cancelled => FormatError::Cancelled,
            VoxeliseError::Grid(error) => FormatError::Grid(error),
            VoxeliseError::OverBudget(over) => FormatError::OverBudget(over),
            error => FormatError::Voxelise(error),
        }
    }
}

/// Returns an error if the work has been cancelled.
pub(super) fn go_on(progress: &dyn Progress) -> Result<(), FormatError> {
    if progress.is_cancelled() { Err(FormatError::Cancelled) } else { Ok(()) }
}

/// Returns a message of a library, without control characters that it may quote from the file.
pub(super) fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{FFFD}' } else { c }).collect()
}

/// Returns the first bytes of unexpected data, with everything but plain text escaped.
pub(super) fn excerpt(bytes: &[u8]) -> String {
    const MOST: usize = 24;
    match bytes.get(..MOST) {
        Some(start) if bytes.len() > MOST => format!("{}...", start.escape_ascii()),
        _ => bytes.escape_ascii().to_string(),
    }
}
