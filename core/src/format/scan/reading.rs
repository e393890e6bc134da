//! The input and the output of a reader of scans. The files that belong to the one to be read are found only in its
//! folder or below. Knows no format.

use std::io::Read;
use std::path::{Component, Path, PathBuf};

use glam::{UVec3, Vec3};

use super::frame::AxisFrame;
use crate::format::budget::check_budget;
use crate::format::layered::LayeredVolume;
use crate::format::options::ImportOptions;
use crate::format::{FormatError, Volume, Volumes, budget_bytes, error, prepare, store};
use crate::progress::Progress;
use crate::sculpture::{Grid, Limits};

/// The voxels of a scan.
pub enum ScanVolume {
    /// In memory.
    Held(Volume),
    /// In their files.
    Layered(LayeredVolume),
}

impl From<Volume> for ScanVolume {
    fn from(volume: Volume) -> ScanVolume {
        ScanVolume::Held(volume)
    }
}

impl From<LayeredVolume> for ScanVolume {
    fn from(volume: LayeredVolume) -> ScanVolume {
        ScanVolume::Layered(volume)
    }
}

impl ScanVolume {
    /// Returns the volume in memory: reads it if it lies in its files, where it must fit into `budget_bytes`.
    pub fn held(self, budget_bytes: u64, progress: &dyn Progress) -> Result<Volume, FormatError> {
        match self {
            ScanVolume::Held(volume) => Ok(volume),
            ScanVolume::Layered(volume) => {
                check_budget(volume.bytes(), budget_bytes)?;
                volume.held(progress)
            }
        }
    }
}

/// A scan as read.
pub struct Scan {
    pub volume: ScanVolume,
    pub frame: AxisFrame,
    /// Display name of the format and packing.
    pub kind: String,
    /// Whether the file declares its numbers as labels.
    pub is_label: bool,
    /// Which of several volumes it is.
    pub volumes: Volumes,
    /// Notes on what was left out or interpreted otherwise, for the user.
    pub notes: Vec<String>,
}

impl Scan {
    /// Returns a volume of a file that states nothing but its voxels.
    pub fn bare(volume: ScanVolume, kind: String, volumes: Volumes) -> Scan {
        Scan {
            volume,
            frame: AxisFrame::Unknown,
            kind,
            is_label: false,
            volumes,
            notes: Vec::new(),
        }
    }
}

/// Text that names the option that selects another of several volumes.
pub const OTHER_TIME: &str = "the option `time` takes another";
pub const OTHER_CHANNEL: &str = "the option `channel` takes another";

/// The input of a reader besides the bytes.
pub struct Reading<'a> {
    pub path: &'a Path,
    pub options: &'a ImportOptions,
    pub limits: &'a Limits,
    pub progress: &'a dyn Progress,
    /// Whether large volumes may stay in their files.
    pub in_layers: bool,
}

/// The most bytes of a header of a volume that stays in its files.
const START_BYTES: u64 = 1 << 20;

impl Reading<'_> {
    /// Returns an error if no grid can hold the result of such a volume.
    pub(crate) fn admit(&self, dims: UVec3, voxel_size: Vec3) -> Result<(), FormatError> {
        let (dims, voxel_size) = prepare::prepared(dims, voxel_size, self.options)?;
        match self.in_layers {
            // Its bits are counted as they come.
            true => Grid::check_size(dims, voxel_size)?,
            false => Grid::check(dims, voxel_size, self.limits.grid_bytes)?,
        }
        Ok(())
    }

    /// Returns the volume to read from a file with so many times and one channel.
    pub fn volumes(&self, times: u64) -> Result<Volumes, FormatError> {
        Volumes::of(self.options, 1, times)
    }

    /// Returns a note that the first of several volumes was read, unless one was requested.
    pub(crate) fn first_of(&self, volumes: u64) -> Option<String> {
        let is_open = volumes > 1 && self.options.time.is_none();
        is_open.then(|| format!("first of {volumes} volumes taken; {OTHER_TIME}"))
    }

    /// Returns the memory that is left beside a file of that length, in bytes.
    pub(crate) fn rest_bytes(&self, file_bytes: u64) -> u64 {
        budget_bytes(self.limits).saturating_sub(file_bytes)
    }

    /// Returns the first bytes of a file, to decide whether its volume may stay there.
    pub(crate) fn start(&self, path: &Path) -> Result<Vec<u8>, FormatError> {
        let mut start = Vec::new();
        store::open(path)?.take(START_BYTES).read_to_end(&mut start)?;
        Ok(start)
    }

    /// Returns whether a volume of that size should stay in its files: it takes more than a quarter of the memory that
    /// is allowed.
    pub(crate) fn is_large(&self, volume_bytes: u64) -> bool {
        self.in_layers && volume_bytes > budget_bytes(self.limits) / 4
    }

    /// Returns a whole file.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>, FormatError> {
        store::read(path, budget_bytes(self.limits), |_| Ok(()), self.progress)
    }

    /// Returns the result of `read` for a whole file, and the length of the file.
    pub(crate) fn read_whole(
        &self,
        path: &Path,
        read: impl FnOnce(Vec<u8>) -> Result<Scan, FormatError>,
    ) -> Result<(Scan, u64), FormatError> {
        let file = self.read(path)?;
        let file_bytes = file.len() as u64;
        Ok((read(file)?, file_bytes))
    }

    /// Reads another file that belongs to this one.
    pub(crate) fn read_beside(&self, path: &Path) -> Result<Vec<u8>, FormatError> {
        let name = error::excerpt(path.file_name().unwrap_or_default().as_encoded_bytes());
        self.read(path).map_err(|error| match error {
            FormatError::Io(error) => FormatError::Scan(format!(
                "its voxels are in {name}, which cannot be read: {error}; keep both files in one folder"
            )),
            error => error,
        })
    }

    /// Returns the path of a file that a header names: in the same folder or below, wherever else the name points.
    pub fn beside(&self, name: &str) -> Result<PathBuf, FormatError> {
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
