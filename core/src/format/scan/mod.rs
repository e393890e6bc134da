//! Reads scans of medicine and science: DICOM, NIfTI, NRRD, MetaImage, VTK image data of both kinds, and TIFF stacks.
//!
//! Takes a path; gives a volume with the spacing of its voxels, how its axes lie in the patient or the world, and notes on
//! what was left out. Headers are checked against the limits before memory is allocated, and compressed voxels are
//! unpacked no further than the header asks for. Knows no sculpture.

pub mod base64;
mod dicom;
mod frame;
mod meta;
mod nifti;
mod nrrd;
mod nrrd_header;
mod numbers;
mod segments;
mod tiff;
mod unit;
mod unpack;
mod vti;
mod vtk;

use std::path::{Component, Path, PathBuf};

use glam::{UVec3, Vec3};

pub use self::dicom::{has_dicom, is_dicom};
pub use self::frame::Frame;
use super::options::ImportOptions;
use super::{FormatError, Volume, Volumes, budget_bytes, prepare, store};
use crate::progress::Progress;
use crate::sculpture::{Grid, Limits};

/// The format, by the ending of the file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// `.nii`, `.nii.gz`, `.hdr` with `.img`.
    Nifti,
    /// `.nrrd`, `.nhdr`.
    Nrrd,
    /// VTK image data.
    Vti,
    /// Legacy files of VTK: structured points.
    Vtk,
    /// MetaImage, `.mha`, `.mhd`.
    Meta,
    /// Pages of one file, or numbered files in a folder.
    Tiff,
    /// A file, or all files of a series in a folder.
    Dicom,
}

impl Kind {
    /// Endings with their formats.
    pub const ENDINGS: [(&'static str, Kind); 16] = [
        ("nii", Kind::Nifti),
        ("nii.gz", Kind::Nifti),
        ("hdr", Kind::Nifti),
        ("hdr.gz", Kind::Nifti),
        ("img", Kind::Nifti),
        ("img.gz", Kind::Nifti),
        ("nrrd", Kind::Nrrd),
        ("nhdr", Kind::Nrrd),
        ("vti", Kind::Vti),
        ("vtk", Kind::Vtk),
        ("mha", Kind::Meta),
        ("mhd", Kind::Meta),
        ("tif", Kind::Tiff),
        ("tiff", Kind::Tiff),
        ("dcm", Kind::Dicom),
        ("dicom", Kind::Dicom),
    ];
}

/// Whether the name is that of the voxels of a pair whose header is not there.
pub fn lacks_header(path: &Path) -> bool {
    nifti::header_of(path).is_err()
}

/// A scan as it was read.
pub struct Scan {
    pub volume: Volume,
    pub frame: Frame,
    /// Format and packing, for people.
    pub kind: String,
    /// Whether the file says that its numbers are labels.
    pub is_label: bool,
    /// Which of several volumes it is.
    pub volumes: Volumes,
    /// Notes on what was left out or interpreted otherwise, for people.
    pub notes: Vec<String>,
}

/// How it is said which option takes another of several volumes.
const OTHER_TIME: &str = "the option `time` takes another";
const OTHER_CHANNEL: &str = "the option `channel` takes another";

/// The input of a reader besides the bytes.
pub struct Reading<'a> {
    path: &'a Path,
    options: &'a ImportOptions,
    limits: &'a Limits,
    progress: &'a dyn Progress,
}

impl Reading<'_> {
    /// An error if no grid can hold what becomes of such a volume.
    fn admit(&self, dims: UVec3, voxel_size: Vec3) -> Result<(), FormatError> {
        let (dims, voxel_size) = prepare::prepared(dims, voxel_size, self.options)?;
        Ok(Grid::check(dims, voxel_size, self.limits.grid_bytes)?)
    }

    /// Which volume is read of a file that has so many times and one channel.
    fn volumes(&self, times: u64) -> Result<Volumes, FormatError> {
        Volumes::of(self.options, 1, times)
    }

    /// Note that the first of several volumes was read, unless one was asked for.
    fn first_of(&self, volumes: u64) -> Option<String> {
        let is_open = volumes > 1 && self.options.time.is_none();
        is_open.then(|| format!("first of {volumes} volumes taken; {OTHER_TIME}"))
    }

    /// Memory that is left beside a file of that length.
    fn rest_bytes(&self, file_bytes: u64) -> u64 {
        budget_bytes(self.limits).saturating_sub(file_bytes)
    }

    /// A whole file.
    fn read(&self, path: &Path) -> Result<Vec<u8>, FormatError> {
        store::read(path, budget_bytes(self.limits), |_| Ok(()), self.progress)
    }

    /// Another file that belongs to this one.
    fn read_beside(&self, path: &Path) -> Result<Vec<u8>, FormatError> {
        let name = super::error::excerpt(path.file_name().unwrap_or_default().as_encoded_bytes());
        self.read(path).map_err(|error| match error {
            FormatError::Io(error) => FormatError::Scan(format!(
                "its voxels are in {name}, which cannot be read: {error}; keep both files in one folder"
            )),
            error => error,
        })
    }

    /// The path of a file that a header names: in the same folder or below, wherever else the name points.
    fn beside(&self, name: &str) -> Result<PathBuf, FormatError> {
        let is_below = |part| matches!(part, Component::Normal(_) | Component::CurDir);
        if name.is_empty() || !Path::new(name).components().all(is_below) {
            return Err(FormatError::Scan(format!(
                "the header says that its voxels are in `{}`; put it beside the header: only files in its own folder or below are read",
                name.escape_debug()
            )));
        }
        Ok(self.path.parent().unwrap_or(Path::new("")).join(name))
    }
}

/// The kind of scan that a folder holds, if any.
pub fn kind_of_folder(folder: &Path) -> Option<Kind> {
    match has_dicom(folder) {
        true => Some(Kind::Dicom),
        false => tiff::first_of(folder).map(|_| Kind::Tiff),
    }
}

/// Reads a scan. Returns it with the length of its file, or of all files of its series.
pub fn load(
    path: &Path,
    kind: Kind,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<(Scan, u64), FormatError> {
    let first = match kind {
        Kind::Tiff if path.is_dir() => tiff::first_of(path),
        Kind::Nifti => nifti::header_of(path)?,
        _ => None,
    };
    let path = first.as_deref().unwrap_or(path);
    let reading = Reading { path, options, limits, progress };
    let of_file = |read: &dyn Fn(Vec<u8>) -> Result<Scan, FormatError>| {
        let file = reading.read(path)?;
        let file_bytes = file.len() as u64;
        Ok((read(file)?, file_bytes))
    };
    match kind {
        Kind::Nifti => of_file(&|file| nifti::read(path, file, &reading)),
        Kind::Nrrd => of_file(&|file| nrrd::read(file, &reading)),
        Kind::Vtk => of_file(&|file| vtk::read(file, &reading)),
        Kind::Meta => of_file(&|file| meta::read(file, &reading)),
        Kind::Vti => of_file(&|file| vti::read(file, &reading)),
        Kind::Tiff => of_file(&|file| tiff::read(path, file, &reading)),
        Kind::Dicom => dicom::read(path, &reading),
    }
}
