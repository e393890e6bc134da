//! File formats: bytes <-> volumes <-> the contents of a sculpture. Contains no policy: callers pass options for
//! reading and writing, and limits for memory.
//!
//! The entry points are [`load`], [`save`] and [`info()`]. Below them: `store` (disk), `budget` and `limits` (memory
//! and lengths that files may request), `vsc` (sculptures without loss), `history` (undo steps), `pvm` and `dds`,
//! `raw`, `scan` (volumes), `prepare` (region and cubic voxels), `spec` and `list` (the description of each format),
//! `import` and `export` (volume <-> sculpture), `study` (a file before it is imported), `content` (detection of the
//! format), `threshold`, `ramp`, `labels` and `signature` (the meaning of voxels), `voxel` (models of other voxel
//! editors), `mesh_in` and `mesh_out` (meshes from and for other programs). Errors state the problem and the remedy;
//! callers add the name of the file.

mod budget;
mod bytes;
mod content;
mod dds;
mod error;
mod export;
mod histogram;
pub mod history;
mod import;
mod info;
mod labels;
mod layered;
mod limits;
mod list;
mod mesh_in;
mod mesh_out;
pub mod options;
mod picture;
mod prepare;
mod pvm;
mod ramp;
mod raw;
mod scan;
mod signature;
mod spec;
pub mod store;
mod study;
mod threshold;
mod volume;
mod volumes;
mod voxel;
mod vsc;

use std::ffi::OsStr;
use std::io::BufWriter;
use std::path::Path;

use self::budget::budget_bytes;
pub use self::content::needs_layout;
pub use self::error::FormatError;
use self::error::go_on;
pub use self::histogram::Histogram;
pub use self::info::{Densities, Info, info, info_with};
pub use self::list::{
    READ_ENDINGS, WRITE_ENDINGS, exports, is_mesh, is_raw, is_volume, mesh_traits,
    meshes_of_points_text, meshes_read_with_up_text, meshes_with_up_text, models_of_cubes_text,
    written_text,
};
pub use self::mesh_out::MeshTraits;
pub use self::mesh_out::save::{MeshSummary, save_mesh, save_mesh_again, usual_surface};
use self::options::{Colouring, Existence, ExportForm, ExportOptions, ImportOptions};
pub use self::options::{MeshOptions, MeshUp};
pub use self::picture::{load_matcap, load_picture, load_picture_file, picture_of};
pub use self::scan::base64;
use self::scan::{Reading, Scan, ScanVolume};
pub use self::signature::Signature;
use self::spec::{Export, Format, Import};
pub use self::study::{
    Existing, Family, MeshStudy, ModelStudy, Outlook, Study, SurfaceVoxel, VolumeStudy, family,
    study,
};
pub use self::volume::{Samples, Texts, Volume};
pub use self::volumes::{ChosenVolume, Volumes};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;
use crate::sculpture::orient::Reorientation;
use crate::sculpture::orientation::{Orientation, Up};

/// Returns whether a file may be readable by its name alone: it ends in one of [`READ_ENDINGS`], has no ending, or ends
/// in a number, as many DICOM files do.
pub fn may_be_read(path: &Path) -> bool {
    let is_number = |ending: &OsStr| ending.as_encoded_bytes().iter().all(u8::is_ascii_digit);
    list::named(path).is_ok() || path.extension().is_none_or(is_number)
}

/// Returns whether a file or folder can be read, by its name and, where that is not conclusive, by its content; or may
/// be once it is described ([`needs_layout`]).
pub fn can_be_read(path: &Path) -> bool {
    content::format_of(path, false).is_ok() || needs_layout(path)
}

/// Returns whether a file of that name stores a sculpture without loss, unlike a volume for other programs.
pub fn is_sculpture(path: &Path) -> bool {
    list::named(path).is_ok_and(|format| matches!(format.read, Import::Sculpture))
}

/// A sculpture from a file.
#[derive(Debug)]
pub struct Loaded {
    /// Bits and colours.
    pub contents: Contents,
    /// Sample type of a volume. None for a .vsc file.
    pub samples: Option<Samples>,
    /// Texts of the file, for [`save_with`].
    pub texts: Texts,
    /// The axis that was assumed to point up; `None` where the file states it.
    pub assumed_up: Option<Up>,
    /// Notes on what was left out of the file or interpreted otherwise, for the user.
    pub notes: Vec<String>,
}

impl Loaded {
    /// Returns a sculpture from a file that holds no volume and states its up axis.
    fn model(contents: Contents, texts: Texts, notes: Vec<String>) -> Loaded {
        Loaded { contents, samples: None, texts, assumed_up: None, notes }
    }
}

/// Reads a sculpture. During reading, the file and its volume together may take as much memory as the limits for the
/// grid and the colours allow.
pub fn load(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, FormatError> {
    let (format, disagreement) = content::format_of(path, options.raw.is_some())?;
    let mut loaded = load_as(format, path, options, limits, progress)?;
    let of_itself = matches!(format.read, Import::Sculpture | Import::Scan(_) | Import::Mesh(_));
    let unused = options.upright.filter(|_| of_itself && loaded.assumed_up.is_none()).map(|up| {
        format!("the file says itself which way is up, so `{up}` was left out; turn the sculpture once it is open")
    });
    loaded.notes.splice(0..0, told(path, disagreement.into_iter().chain(unused).collect()));
    Ok(loaded)
}

/// Reads a file of a known format as [`load`] does.
fn load_as(
    format: Format,
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, FormatError> {
    match &format.read {
        Import::Sculpture => {
            let file = read_file(path, limits, progress)?;
            let (contents, texts) = vsc::read(&file, limits, progress)?;
            return Ok(Loaded::model(contents, texts, Vec::new()));
        }
        Import::Model(reader) => {
            let file = read_file(path, limits, progress)?;
            let model = (reader.read)(&file)?;
            let mut contents = voxel::turned(&*model, options, limits, progress)?;
            contents.surface = reader.surface;
            return Ok(Loaded::model(contents, Texts::default(), told(path, model.notes())));
        }
        Import::Mesh(reader) => {
            let mesh = mesh_in::load(path, reader, limits, progress)?;
            let (contents, notes) = mesh.into_contents(options, limits, progress)?;
            let assumed_up = (!reader.knows_up).then(|| reader.up(options));
            let loaded = Loaded::model(contents, Texts::default(), told(path, notes));
            return Ok(Loaded { assumed_up, ..loaded });
        }
        Import::Volume(_) | Import::Scan(_) => {}
    }
    let reading = Reading { path, options, limits, progress, in_layers: true };
    let (volume, source) = open_volume(format, &reading)?;
    let view = import::VolumeView::of(&volume);
    let (samples, texts) = (view.samples, view.texts.clone());
    let options = &source.adapted(options, samples);
    let signature = import::trusted_signature(&texts, samples);
    let mut contents = import::to_contents(view, signature, options, limits, progress)?;
    drop(volume);
    let knows_up = signature.is_some() || source.frame.knows_up();
    let assumed_up = (!knows_up).then(|| options.upright.unwrap_or_default());
    let turn = source.frame.orientation().then(assumed_up.unwrap_or_default().turned_upright());
    if turn != Orientation::UPRIGHT {
        contents = Reorientation::new(&contents, turn).run(limits, progress)?;
    }
    let notes = told(path, source.notes);
    Ok(Loaded { contents, samples: Some(samples), texts, assumed_up, notes })
}

/// Returns the bytes of a .vsc file with a sculpture and its texts.
pub fn write_sculpture(contents: &Contents, texts: &Texts) -> Result<Vec<u8>, FormatError> {
    vsc::write(contents, texts, &())
}

/// Reads the output of [`write_sculpture`], within `limits`.
pub fn read_sculpture(file: &[u8], limits: &Limits) -> Result<(Contents, Texts), FormatError> {
    vsc::read(file, limits, &())
}

/// Reads a .vsc file in memory as [`load`] reads one on disk.
pub(crate) fn read_embedded(
    file: &[u8],
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, FormatError> {
    let (contents, texts) = vsc::read(file, limits, progress)?;
    Ok(Loaded::model(contents, texts, Vec::new()))
}

/// Logs notes for the user and returns them.
fn told(path: &Path, notes: Vec<String>) -> Vec<String> {
    notes.iter().for_each(|note| tracing::warn!("{}: {note}", path.display()));
    notes
}

/// Reads the voxels of a file without conversion, except for the requested region and cubic voxels, within the same
/// limits as [`load`].
pub fn load_volume(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Volume, FormatError> {
    let (format, _) = content::format_of(path, options.raw.is_some())?;
    let reading = Reading { path, options, limits, progress, in_layers: false };
    let (volume, _) = open_volume(format, &reading)?;
    volume.held(budget_bytes(limits), progress)
}

/// Writes a sculpture, atomically: an existing file is replaced when the new one is complete. See [`save_with`].
pub fn save(
    path: &Path,
    contents: &Contents,
    form: ExportForm,
    progress: &dyn Progress,
) -> Result<(), FormatError> {
    save_with(path, contents, &form.into(), Texts::default(), &Limits::default(), progress)?;
    Ok(())
}

/// Saves as [`save`] does, with all options, and with texts in formats that store them. Returns notes for the user on
/// the written file, such as colours that the format cannot store. A mesh is made within `limits`.
pub fn save_with(
    path: &Path,
    contents: &Contents,
    options: &ExportOptions,
    texts: Texts,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Vec<String>, FormatError> {
    let ExportOptions { form, mesh } = *options;
    let export = list::written(path).and_then(|format| format.write.as_ref());
    let is_mesh = matches!(export, Some(Export::Mesh(_)));
    if !is_mesh && mesh != MeshOptions::default() {
        return Err(list::not_a_mesh());
    }
    let export = export.ok_or_else(|| list::not_written(path))?;
    if form != ExportForm::Auto && !matches!(export, Export::Volume(_)) {
        return Err(list::no_forms(export, form));
    }
    let bytes = match export {
        Export::Mesh(_) => {
            let summary = save_mesh(path, contents, &mesh, limits, progress)?;
            return Ok(vec![summary.to_string()]);
        }
        Export::Sculpture => vsc::write(contents, &texts, progress)?,
        Export::Model(write) => {
            let mut out = BufWriter::new(store::AtomicFile::create(path)?);
            let notes = write(contents, &mut out, progress)?;
            go_on(progress)?;
            let file = out.into_inner().map_err(std::io::IntoInnerError::into_error)?;
            file.finish()?;
            return Ok(told(path, notes));
        }
        Export::Volume(write) => {
            progress.begin("making the volume");
            let volume = export::to_volume(contents, form, texts);
            progress.end();
            go_on(progress)?;
            write(volume?, progress)?
        }
    };
    // The last opportunity to cancel.
    go_on(progress)?;
    progress.begin("writing");
    let written = store::write_with(path, &bytes, progress);
    progress.end();
    written?;
    Ok(Vec::new())
}

fn read_file(
    path: &Path,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Vec<u8>, FormatError> {
    store::read(path, budget_bytes(limits), |_| Ok(()), progress)
}

/// Metadata of a file: everything known about it besides its voxels.
#[derive(Default)]
struct FileMetadata {
    kind: String,
    file_bytes: u64,
    /// Directions of the file's axes.
    frame: scan::AxisFrame,
    /// Whether the file declares its numbers as labels.
    is_label: bool,
    /// Which of several volumes was read.
    volumes: Volumes,
    notes: Vec<String>,
}

impl FileMetadata {
    /// Returns the options, completed from the file where they leave it open.
    fn adapted(&self, options: &ImportOptions, samples: Samples) -> ImportOptions {
        let colouring = match options.colouring {
            // Segments have their own colours.
            Colouring::Auto | Colouring::Labels if self.is_label && !samples.is_density() => {
                Colouring::Auto
            }
            Colouring::Auto if self.is_label => Colouring::Labels,
            chosen => chosen,
        };
        ImportOptions { colouring, ..*options }
    }
}

/// Returns the voxels of a file, in the requested region and size.
fn open_volume(
    format: Format,
    reading: &Reading,
) -> Result<(ScanVolume, FileMetadata), FormatError> {
    let (volume, source) = read_volume(format, reading)?;
    let view = import::VolumeView::of(&volume);
    let signature = import::trusted_signature(view.texts, view.samples);
    let is_packed = signature.is_some_and(|s| s.form == ExportForm::Packed);
    let is_label = is_packed || source.is_label;
    let (options, budget) = (reading.options, budget_bytes(reading.limits));
    let volume = prepare::prepare_scan(volume, options, is_label, budget, reading.progress)?;
    Ok((volume, source))
}

fn read_volume(
    format: Format,
    reading: &Reading,
) -> Result<(ScanVolume, FileMetadata), FormatError> {
    let Reading { path, options, limits, progress, .. } = *reading;
    let is_scan = matches!(format.read, Import::Scan(_));
    match &format.read {
        Import::Sculpture | Import::Model(_) | Import::Mesh(_) => {
            let loaded = load_as(format, path, options, limits, progress)?;
            let volume = export::to_volume(&loaded.contents, ExportForm::Auto, loaded.texts)?;
            let file_bytes = std::fs::metadata(path)?.len();
            Ok((
                volume.into(),
                FileMetadata {
                    kind: "sculpture".to_string(),
                    file_bytes,
                    ..FileMetadata::default()
                },
            ))
        }
        Import::Volume(read) | Import::Scan(read) => {
            let (scan, file_bytes) = read(reading)?;
            let Scan { volume, frame, kind, is_label, volumes, mut notes } = scan;
            let is_open =
                options.colouring == Colouring::Auto && options.existence == Existence::Auto;
            let looks_like_labels = match &volume {
                ScanVolume::Held(volume) if is_scan && is_open && !is_label => {
                    labels::look_like_labels(volume)
                }
                _ => false,
            };
            if looks_like_labels {
                notes.push(
                    "it holds few whole numbers, as labels are: the colouring `labels` gives each a colour of its own"
                        .to_string(),
                );
            }
            Ok((volume, FileMetadata { kind, file_bytes, frame, is_label, volumes, notes }))
        }
    }
}
