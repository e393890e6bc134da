//! File formats: bytes <-> volumes <-> the contents of a sculpture. Contains no policy: callers pass
//! options for what to read and write, and limits for memory.
//!
//! The entry points are [`load`], [`save`] and [`info()`]. Below them: `store` (disk), `budget` and `limits` (memory and
//! lengths that files may ask for), `vsc` (sculptures without loss), `history` (undo steps), `pvm` and `dds`, `raw`,
//! `scan` (volumes), `prepare` (region and cubic voxels),
//! `import` and `export` (volume <-> sculpture), `study` (a file before it is imported),
//! `content` (which format a file is of), `threshold`, `ramp`, `labels` and
//! `signature` (the meaning of voxels), `voxel` (models of other voxel
//! editors), `mesh_in` and `mesh_out` (meshes of and for other programs). Errors say what is wrong and what to do;
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
mod limits;
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

use glam::{UVec3, Vec3};

pub use self::content::needs_layout;
pub use self::error::FormatError;
pub use self::histogram::Histogram;
pub use self::info::{Densities, Info, info, info_with};
pub use self::mesh_out::{
    MeshSummary, is_mesh, save_mesh, save_mesh_again, usual_surface, usual_up,
};
use self::options::{Colouring, Existence, ExportForm, ExportOptions, ImportOptions};
pub use self::options::{MeshOptions, MeshUp};
pub use self::picture::{load_matcap, load_picture, load_picture_file, picture_of};
pub use self::scan::base64;
pub use self::signature::Signature;
pub use self::study::{
    Existing, Family, MeshStudy, ModelStudy, Outlook, Study, SurfaceVoxel, VolumeStudy, family,
    study,
};
pub use self::volume::{Samples, Texts, Volume};
pub use self::volumes::{Taken, Volumes};
use crate::progress::Progress;
use crate::sculpture::history::Contents;
use crate::sculpture::orient::Reorientation;
use crate::sculpture::orientation::{Orientation, Up};
use crate::sculpture::{Grid, Limits};

/// Extensions of the files that can be read.
pub const READ_ENDINGS: [&str; 27] = [
    "vsc", "pvm", "raw", "nii", "nii.gz", "hdr", "hdr.gz", "nrrd", "nhdr", "mha", "mhd", "vti",
    "vtk", "tif", "tiff", "dcm", "dicom", "vox", "qb", "gox", "binvox", "obj", "stl", "ply", "glb",
    "gltf", "3mf",
];
/// Extensions of the files that can be written.
pub const WRITE_ENDINGS: [&str; 10] =
    ["vsc", "pvm", "raw", "vox", "qb", "stl", "ply", "obj", "glb", "3mf"];

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Format {
    Vsc,
    Pvm,
    Raw,
    Scan(scan::Kind),
    Voxel(voxel::Kind),
    Mesh(mesh_in::Kind),
}

impl Format {
    fn of(path: &Path) -> Result<Format, FormatError> {
        let ending = path.extension().ok_or(FormatError::NoEnding)?.to_string_lossy();
        let is_of_scan = |(ending, _): &&(&str, scan::Kind)| has_ending(path, ending);
        if let Some((_, kind)) = scan::Kind::ENDINGS.iter().find(is_of_scan) {
            return Ok(Format::Scan(*kind));
        }
        match ending.to_ascii_lowercase().as_str() {
            "vsc" => Ok(Format::Vsc),
            "pvm" => Ok(Format::Pvm),
            "raw" => Ok(Format::Raw),
            "vox" => Ok(Format::Voxel(voxel::Kind::Vox)),
            "qb" => Ok(Format::Voxel(voxel::Kind::Qb)),
            "gox" => Ok(Format::Voxel(voxel::Kind::Gox)),
            "binvox" => Ok(Format::Voxel(voxel::Kind::Binvox)),
            "obj" => Ok(Format::Mesh(mesh_in::Kind::Obj)),
            "stl" => Ok(Format::Mesh(mesh_in::Kind::Stl)),
            "ply" => Ok(Format::Mesh(mesh_in::Kind::Ply)),
            "3mf" => Ok(Format::Mesh(mesh_in::Kind::ThreeMf)),
            "glb" | "gltf" => Ok(Format::Mesh(mesh_in::Kind::Glb)),
            _ => Err(FormatError::UnknownEnding(format!(".{ending}"))),
        }
    }
}

/// Whether the name of a file ends in a dot and `ending`, in capitals or not.
fn has_ending(path: &Path, ending: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    name.strip_suffix(ending).is_some_and(|rest| rest.ends_with('.') && rest.len() > 1)
}

/// Whether a file of that name may be one that can be read: it has one of [`READ_ENDINGS`], or none, or a number, as many
/// DICOM files have. Looks at the name alone.
pub fn may_be_read(path: &Path) -> bool {
    let is_number = |ending: &OsStr| ending.as_encoded_bytes().iter().all(u8::is_ascii_digit);
    Format::of(path).is_ok() || path.extension().is_none_or(is_number)
}

/// Whether a file or folder can be read, by its name and, where that says nothing, by its content; or may be once it is
/// described ([`needs_layout`]).
pub fn can_be_read(path: &Path) -> bool {
    content::format_of(path, false).is_ok() || needs_layout(path)
}

/// Whether a file of that name stores a sculpture without loss, unlike a volume for other programs.
pub fn is_sculpture(path: &Path) -> bool {
    matches!(Format::of(path), Ok(Format::Vsc))
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
    /// The axis that was taken for the one that points up; none where the file says so itself.
    pub assumed_up: Option<Up>,
    /// Notes on what was left out of the file or interpreted otherwise, for the user.
    pub notes: Vec<String>,
}

impl Loaded {
    /// A sculpture from a file that holds no volume and says which way is up.
    fn model(contents: Contents, texts: Texts, notes: Vec<String>) -> Loaded {
        Loaded { contents, samples: None, texts, assumed_up: None, notes }
    }
}

/// Reads a sculpture. Meanwhile the file and its volume together may take as much memory as the limits
/// for the grid and the colours allow.
pub fn load(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, FormatError> {
    let (format, disagreement) = content::format_of(path, options.raw.is_some())?;
    let mut loaded = load_as(format, path, options, limits, progress)?;
    let of_itself = matches!(format, Format::Vsc | Format::Scan(_) | Format::Mesh(_));
    let unused = options.upright.filter(|_| of_itself && loaded.assumed_up.is_none()).map(|up| {
        format!("the file says itself which way is up, so `{up}` was left out; turn the sculpture once it is open")
    });
    loaded.notes.splice(0..0, told(path, disagreement.into_iter().chain(unused).collect()));
    Ok(loaded)
}

/// [`load`], of a format.
fn load_as(
    format: Format,
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, FormatError> {
    match format {
        Format::Vsc => {
            let file = read_file(path, limits, progress)?;
            let (contents, texts) = vsc::read(&file, limits, progress)?;
            return Ok(Loaded::model(contents, texts, Vec::new()));
        }
        Format::Voxel(kind) => {
            let file = read_file(path, limits, progress)?;
            let model = voxel::read(kind, &file)?;
            let mut contents = voxel::turned(&*model, options, limits, progress)?;
            contents.surface = kind.surface();
            return Ok(Loaded::model(contents, Texts::default(), told(path, model.notes())));
        }
        Format::Mesh(kind) => {
            let mesh = mesh_in::load(path, kind, limits, progress)?;
            let (contents, notes) = mesh.into_contents(options, limits, progress)?;
            let assumed_up = (!kind.knows_up()).then(|| kind.up(options));
            let loaded = Loaded::model(contents, Texts::default(), told(path, notes));
            return Ok(Loaded { assumed_up, ..loaded });
        }
        Format::Pvm | Format::Raw | Format::Scan(_) => {}
    }
    let (volume, source) = open_volume(format, path, options, limits, progress)?;
    let options = &source.adapted(options, volume.samples);
    let signature = import::trusted_signature(&volume);
    let mut contents = import::to_contents(&volume, signature, options, limits, progress)?;
    let Volume { samples, texts, data, .. } = volume;
    drop(data);
    let knows_up = signature.is_some() || source.frame.knows_up();
    let assumed_up = (!knows_up).then(|| options.upright.unwrap_or_default());
    let turn = source.frame.orientation().then(assumed_up.unwrap_or_default().turned_upright());
    if turn != Orientation::UPRIGHT {
        contents = Reorientation::new(&contents, turn).run(limits, progress)?;
    }
    let notes = told(path, source.notes);
    Ok(Loaded { contents, samples: Some(samples), texts, assumed_up, notes })
}

/// The bytes of a .vsc file with a sculpture and its texts.
pub fn write_sculpture(contents: &Contents, texts: &Texts) -> Result<Vec<u8>, FormatError> {
    vsc::write(contents, texts, &())
}

/// Reads what [`write_sculpture`] has written, within `limits`.
pub fn read_sculpture(file: &[u8], limits: &Limits) -> Result<(Contents, Texts), FormatError> {
    vsc::read(file, limits, &())
}

/// Reads a .vsc file in memory as [`load`] reads one on the disk.
pub fn read_embedded(
    file: &[u8],
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Loaded, FormatError> {
    let (contents, texts) = vsc::read(file, limits, progress)?;
    Ok(Loaded::model(contents, texts, Vec::new()))
}

/// Notes for the person, which are also logged.
fn told(path: &Path, notes: Vec<String>) -> Vec<String> {
    notes.iter().for_each(|note| tracing::warn!("{}: {note}", path.display()));
    notes
}

/// Reads the voxels of a file unconverted but for the region and the cubic voxels that are asked for, within the same
/// limits as [`load`].
pub fn load_volume(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Volume, FormatError> {
    let (format, _) = content::format_of(path, options.raw.is_some())?;
    open_volume(format, path, options, limits, progress).map(|(volume, _)| volume)
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

/// [`save`], with all options, and with texts in formats that store them. Returns what the person should know of what
/// was written, such as colours that the format has no room for. A mesh is made within `limits`.
pub fn save_with(
    path: &Path,
    contents: &Contents,
    options: &ExportOptions,
    texts: Texts,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Vec<String>, FormatError> {
    let ExportOptions { form, mesh } = *options;
    if is_mesh(path) {
        if form != ExportForm::Auto {
            return Err(FormatError::FormOfMesh(form));
        }
        let summary = save_mesh(path, contents, &mesh, limits, progress)?;
        return Ok(vec![summary.to_string()]);
    }
    if mesh != MeshOptions::default() {
        return Err(FormatError::NotAMeshFile);
    }
    let volume = |texts| {
        progress.begin("making the volume");
        let volume = export::to_volume(contents, form, texts);
        progress.end();
        go_on(progress)?;
        volume
    };
    let not_written = |error| {
        FormatError::NotWritten(match error {
            FormatError::UnknownEnding(ending) => format!("`{ending}` is not the extension"),
            _ => "the file name has no extension".into(),
        })
    };
    let bytes = match Format::of(path).map_err(not_written)? {
        Format::Vsc if form != ExportForm::Auto => return Err(FormatError::FormOfVsc(form)),
        Format::Vsc => vsc::write(contents, &texts, progress)?,
        Format::Mesh(_) | Format::Scan(_) => return Err(FormatError::ReadOnly),
        Format::Voxel(_) if form != ExportForm::Auto => return Err(FormatError::FormOfModel(form)),
        Format::Voxel(kind) => {
            let write = match kind {
                voxel::Kind::Vox => voxel::write_vox,
                voxel::Kind::Qb => voxel::write_qb,
                voxel::Kind::Gox | voxel::Kind::Binvox => return Err(FormatError::ReadOnly),
            };
            let mut out = BufWriter::new(store::AtomicFile::create(path)?);
            let notes = write(contents, &mut out, progress)?;
            go_on(progress)?;
            let file = out.into_inner().map_err(std::io::IntoInnerError::into_error)?;
            file.finish()?;
            return Ok(told(path, notes));
        }
        Format::Pvm => pvm::write(volume(texts)?, progress)?,
        Format::Raw => volume(texts)?.data,
    };
    // The last moment to cancel.
    go_on(progress)?;
    progress.begin("writing");
    let written = store::write_with(path, &bytes, progress);
    progress.end();
    written?;
    Ok(Vec::new())
}

/// An error if the work has been cancelled.
fn go_on(progress: &dyn Progress) -> Result<(), FormatError> {
    if progress.is_cancelled() { Err(FormatError::Cancelled) } else { Ok(()) }
}

/// Bytes that a file and its volume together may take.
fn budget_bytes(limits: &Limits) -> u64 {
    limits.grid_bytes.saturating_add(limits.colour_bytes)
}

fn read_file(
    path: &Path,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Vec<u8>, FormatError> {
    store::read(path, budget_bytes(limits), |_| Ok(()), progress)
}

/// Metadata of a file: all that is known of it besides its voxels.
#[derive(Default)]
struct Source {
    kind: String,
    file_bytes: u64,
    /// How the axes of the file lie.
    frame: scan::Frame,
    /// Whether the file says that its numbers are labels.
    is_label: bool,
    /// Which of several volumes was read.
    volumes: Volumes,
    notes: Vec<String>,
}

impl Source {
    /// The options, with what the file says where they leave it open.
    fn adapted(&self, options: &ImportOptions, samples: Samples) -> ImportOptions {
        let colouring = match options.colouring {
            // Segments have colours of their own.
            Colouring::Auto | Colouring::Labels if self.is_label && !samples.is_density() => {
                Colouring::Auto
            }
            Colouring::Auto if self.is_label => Colouring::Labels,
            chosen => chosen,
        };
        ImportOptions { colouring, ..*options }
    }
}

/// The voxels of a file, in the region and of the size that are asked for.
fn open_volume(
    format: Format,
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<(Volume, Source), FormatError> {
    let (volume, source) = read_volume(format, path, options, limits, progress)?;
    let is_packed =
        import::trusted_signature(&volume).is_some_and(|s| s.form == ExportForm::Packed);
    let is_label = is_packed || source.is_label;
    let volume = prepare::prepare(volume, options, is_label, budget_bytes(limits), progress)?;
    Ok((volume, source))
}

fn read_volume(
    format: Format,
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<(Volume, Source), FormatError> {
    let budget = budget_bytes(limits);
    let check_grid = |dims: UVec3, voxel_size: Vec3| -> Result<(), FormatError> {
        let (dims, voxel_size) = prepare::prepared(dims, voxel_size, options)?;
        Ok(Grid::check(dims, voxel_size, limits.grid_bytes)?)
    };
    match format {
        Format::Vsc | Format::Voxel(_) | Format::Mesh(_) => {
            let loaded = load_as(format, path, options, limits, progress)?;
            let volume = export::to_volume(&loaded.contents, ExportForm::Auto, loaded.texts)?;
            let file_bytes = std::fs::metadata(path)?.len();
            Ok((volume, Source { kind: "sculpture".to_string(), file_bytes, ..Source::default() }))
        }
        Format::Scan(kind) => {
            let (scan, file_bytes) = scan::load(path, kind, options, limits, progress)?;
            let scan::Scan { volume, frame, kind, is_label, volumes, mut notes } = scan;
            let is_open =
                options.colouring == Colouring::Auto && options.existence == Existence::Auto;
            if is_open && !is_label && labels::look_like_labels(&volume) {
                notes.push(
                    "it holds few whole numbers, as labels are: the colouring `labels` gives each a colour of its own"
                        .to_string(),
                );
            }
            Ok((volume, Source { kind, file_bytes, frame, is_label, volumes, notes }))
        }
        Format::Pvm => {
            let volumes = Volumes::of(options, 1, 1)?;
            let file = store::read(path, budget, |_| Ok(()), progress)?;
            let file_bytes = file.len() as u64;
            let admit = |header: &pvm::Header| check_grid(header.dims, header.voxel_size);
            let (volume, origin) = pvm::read(file, &admit, budget - file_bytes, progress)?;
            let version = match origin.header.version {
                1 => String::new(),
                n => n.to_string(),
            };
            let kind = match origin.packing {
                Some(packing) => format!("PVM{version}, packed as {packing}"),
                None => format!("PVM{version}, not packed"),
            };
            Ok((volume, Source { kind, file_bytes, volumes, ..Source::default() }))
        }
        Format::Raw => {
            let volumes = Volumes::of(options, 1, 1)?;
            let layout = options.raw.ok_or(FormatError::NoRawLayout)?;
            let admit = |len| {
                check_grid(layout.dims, layout.voxel_size)?;
                raw::check_length(&layout, len)
            };
            let file = store::read(path, budget, admit, progress)?;
            let file_bytes = file.len() as u64;
            let kind = "raw".to_string();
            let source = Source { kind, file_bytes, volumes, ..Source::default() };
            Ok((raw::read(file, &layout)?, source))
        }
    }
}
