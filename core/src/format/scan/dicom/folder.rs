//! Finds the DICOM files of one series in a folder.
//!
//! Takes a path; gives the files of the series with the positions of their slices. Reads only the beginnings of files.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::super::reading::Reading;
use super::data_set::{self, DataSet, ReadExtent};
use super::frames;
use super::pixels::PixelLayout;
use super::plane::FramePlane;
use super::tags;
use crate::format::{FormatError, Texts, go_on, store};

/// Number of bytes at the beginning of a file that show whether it is DICOM, and number that describe its content.
const MAGIC_BYTES: usize = 512;
const START_BYTES: u64 = 1 << 18;
/// Greatest number of files of a folder that are examined.
const MOST_FILES: usize = 1 << 16;
/// Greatest number of series that an error lists, and of characters of their names.
const SHOWN_SERIES: usize = 4;
const SHOWN_LETTERS: usize = 24;
/// Greatest number of files of a series for which similar ones are counted.
const MOST_KINDS: usize = 64;

/// The files of a series.
pub struct FoundSeries {
    pub files: Vec<PathBuf>,
    /// The planes of single-frame files; their indices are those of `files`.
    pub planes: Vec<FramePlane>,
    /// The index of the requested file.
    pub named: Option<usize>,
    pub notes: Vec<String>,
}

/// The data at the beginning of a file.
#[derive(Clone)]
struct Start {
    path: PathBuf,
    series: String,
    /// The display name.
    name: String,
    layout: PixelLayout,
    frames: usize,
    plane: FramePlane,
}

/// Returns the first bytes of a file, at most `most`.
fn start_of(path: &Path, most: u64) -> Option<Vec<u8>> {
    let file = store::open(path).ok()?;
    let mut start = Vec::new();
    file.take(most).read_to_end(&mut start).ok()?;
    Some(start)
}

/// Returns whether `path` is a DICOM file, or a folder with one in it.
pub(crate) fn has_dicom(path: &Path) -> bool {
    let is_file = |path: &Path| {
        start_of(path, MAGIC_BYTES as u64).is_some_and(|start| data_set::is_dicom(&start))
    };
    match path.is_dir() {
        true => entries(path).is_ok_and(|files| files.iter().any(|path| is_file(path))),
        false => is_file(path),
    }
}

/// Returns the files of a folder, sorted by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)?
        .take(MOST_FILES)
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    files.sort();
    Ok(files)
}

impl Start {
    /// Returns `None` for a file that is not DICOM, or holds no readable picture.
    fn read(path: &Path) -> Option<Start> {
        let magic = start_of(path, MAGIC_BYTES as u64)?;
        if !data_set::is_dicom(&magic) {
            return None;
        }
        let start = start_of(path, START_BYTES)?;
        let (syntax, bytes) = data_set::open(&start, ReadExtent::Start, START_BYTES * 16).ok()?;
        let data = DataSet::parse(&bytes, syntax, ReadExtent::Start).ok()?;
        let layout = PixelLayout::of(&data).ok()?;
        let text = |tag| data.text(tag).unwrap_or_default();
        let name = format!("{} {}", text(tags::SERIES_NUMBER), text(tags::SERIES_DESCRIPTION));
        let name: String = name.trim().chars().take(SHOWN_LETTERS).collect();
        Some(Start {
            path: path.to_path_buf(),
            series: text(tags::SERIES),
            name: Texts::legible(name.as_bytes()).replace('\n', " "),
            layout,
            frames: frames(&data).ok()?,
            plane: FramePlane::of(&data, 0, 0),
        })
    }

    /// Returns whether both can be slices of one volume.
    fn is_like(&self, other: &Start) -> bool {
        self.layout.fits(&other.layout) && self.plane.is_parallel(&other.plane)
    }
}

/// Returns the series of the file `path`, or the only one of the folder `path`.
pub fn find(path: &Path, reading: &Reading) -> Result<FoundSeries, FormatError> {
    let alone = || FoundSeries {
        files: vec![path.to_path_buf()],
        planes: Vec::new(),
        named: None,
        notes: Vec::new(),
    };
    let is_folder = path.is_dir();
    let own = if is_folder { None } else { Start::read(path) };
    if !is_folder {
        match &own {
            Some(own) if own.frames == 1 && !own.series.is_empty() => {}
            Some(own) => return Ok(FoundSeries { planes: vec![own.plane.clone()], ..alone() }),
            // Reading the whole file reports the fault.
            None => return Ok(FoundSeries { planes: vec![nowhere()], ..alone() }),
        }
    }
    let folder = match path.parent() {
        _ if is_folder => path,
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut starts = starts(folder, reading)?;
    if let Some(own) = &own {
        starts.retain(|start| start.series == own.series);
    }
    let first = match own {
        // The named file decides which of the others belong to it.
        Some(own) => own,
        None => only(&starts)?,
    };
    if first.frames > 1 {
        let others = starts.len() - 1;
        let notes = (others > 0).then(|| format!("other files of the series left out: {others}"));
        let planes = vec![first.plane];
        let (files, notes) = (vec![first.path], notes.into_iter().collect());
        return Ok(FoundSeries { files, planes, named: None, notes });
    }
    let all = starts.len();
    starts.retain(|start| start.frames == 1 && start.is_like(&first));
    if starts.is_empty() {
        return Ok(FoundSeries { planes: vec![first.plane], ..alone() });
    }
    let mut notes = Vec::new();
    if starts.len() < all {
        notes.push(format!(
            "files of the series left out, of another size, type or direction: {}",
            all - starts.len()
        ));
    }
    let planes =
        starts.iter().enumerate().map(|(file, start)| FramePlane { file, ..start.plane.clone() });
    let planes = planes.collect();
    let named = starts.iter().position(|start| !is_folder && start.path == first.path);
    let files = starts.into_iter().map(|start| start.path).collect();
    Ok(FoundSeries { planes, files, named, notes })
}

fn nowhere() -> FramePlane {
    FramePlane { file: 0, frame: 0, number: 0.0, position: None, axes: None, phases: Vec::new() }
}

/// Reads the beginnings of the DICOM files of a folder.
fn starts(folder: &Path, reading: &Reading) -> Result<Vec<Start>, FormatError> {
    let files = entries(folder)?;
    let mut starts = Vec::new();
    reading.progress.begin("looking through the folder");
    for (i, path) in files.iter().enumerate() {
        if reading.progress.is_cancelled() {
            break;
        }
        starts.extend(Start::read(path));
        reading.progress.advance(i as f32 / files.len() as f32);
    }
    reading.progress.end();
    go_on(reading.progress)?;
    Ok(starts)
}

/// Returns the file of the only series that decides which others belong to it: one of the largest group of similar
/// files.
fn only(starts: &[Start]) -> Result<Start, FormatError> {
    let mut series: Vec<(&str, Vec<&Start>)> = Vec::new();
    for start in starts {
        match series.iter_mut().find(|(uid, _)| *uid == start.series) {
            Some((_, files)) => files.push(start),
            None => series.push((&start.series, vec![start])),
        }
    }
    let [(_, files)] = &series[..] else {
        if series.is_empty() {
            return Err(FormatError::Scan(
                "this folder holds no DICOM pictures; choose the folder that the files lie in themselves, or a file"
                    .to_string(),
            ));
        }
        let of = |(_, files): &(&str, Vec<&Start>)| {
            let file = files[0].path.file_name().unwrap_or_default().to_string_lossy();
            let name = if files[0].name.is_empty() { "unnamed" } else { &files[0].name };
            let file: String = file.chars().take(SHOWN_LETTERS).collect();
            format!("{name} ({} files, {})", files.len(), file.escape_debug())
        };
        let shown: Vec<String> = series.iter().take(SHOWN_SERIES).map(of).collect();
        let more = series.len().saturating_sub(SHOWN_SERIES);
        let more = if more > 0 { format!("; and {more} more") } else { String::new() };
        return Err(FormatError::Scan(format!(
            "this folder holds {} series; open a file of the one that you want: {}{more}",
            series.len(),
            shown.join("; ")
        )));
    };
    let alike = |start: &&&Start| files.iter().filter(|other| start.is_like(other)).count();
    let most = files.iter().take(MOST_KINDS).rev().max_by_key(alike);
    most.map(|start| (*start).clone()).ok_or(FormatError::Empty)
}
