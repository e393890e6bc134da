//! File formats: bytes <-> volumes <-> the contents of a sculpture. Contains no policy: callers pass
//! options for what to read and write, and limits for memory.
//!
//! The entry points are [`load`], [`save`] and [`info`]. Below them: `store` (disk), `vsc` (sculptures
//! without loss), `pvm` and `dds`, `raw` (volumes), `import` and `export` (volume <-> sculpture),
//! `threshold`, `ramp` and `signature` (the meaning of voxels), `voxel` (models of other voxel editors), `mesh_in` and
//! `mesh_out` (meshes of and for other programs). Errors say what is wrong and what to do;
//! callers add the name of the file.

mod bytes;
mod dds;
mod error;
mod export;
mod histogram;
mod import;
mod mesh_in;
mod mesh_out;
pub mod options;
mod picture;
mod pvm;
mod ramp;
mod raw;
mod signature;
pub mod store;
mod threshold;
mod volume;
mod voxel;
mod vsc;

use std::fmt;
use std::io::BufWriter;
use std::path::Path;

use glam::{UVec3, Vec3};

pub use self::error::FormatError;
pub use self::histogram::Histogram;
pub use self::mesh_out::{MeshOptions, MeshSummary, MeshUp, is_mesh, save_mesh};
use self::options::{ExportForm, ImportOptions};
pub use self::picture::{load_matcap, load_picture};
pub use self::signature::Signature;
pub use self::volume::{Samples, Texts, Volume};
use crate::progress::Progress;
use crate::sculpture::history::Contents;
use crate::sculpture::orient::Reorientation;
use crate::sculpture::orientation::Up;
use crate::sculpture::{Grid, Limits};

/// Extensions of the files that can be read.
pub const READ_ENDINGS: [&str; 11] =
    ["vsc", "pvm", "raw", "vox", "qb", "gox", "binvox", "obj", "stl", "ply", "glb"];
/// Extensions of the files that can be written.
pub const WRITE_ENDINGS: [&str; 10] =
    ["vsc", "pvm", "raw", "vox", "qb", "stl", "ply", "obj", "glb", "3mf"];

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Format {
    Vsc,
    Pvm,
    Raw,
    Voxel(voxel::Kind),
    Mesh(mesh_in::Kind),
}

impl Format {
    fn of(path: &Path) -> Result<Format, FormatError> {
        let ending = path.extension().ok_or(FormatError::NoEnding)?.to_string_lossy();
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
            "glb" => Ok(Format::Mesh(mesh_in::Kind::Glb)),
            _ => Err(FormatError::UnknownEnding(format!(".{ending}"))),
        }
    }
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
    /// Texts of the file, for [`save_with_texts`].
    pub texts: Texts,
    /// The axis that was taken for the one that points up; none where the file says so itself.
    pub assumed_up: Option<Up>,
    /// What of the file was left out or taken otherwise, for the person to know.
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
    match Format::of(path)? {
        Format::Vsc => {
            let file = read_file(path, limits, progress)?;
            let (contents, texts) = vsc::read(&file, limits, progress)?;
            return Ok(Loaded::model(contents, texts, Vec::new()));
        }
        Format::Voxel(kind) => {
            let file = read_file(path, limits, progress)?;
            let model = voxel::read(kind, &file)?;
            let contents = voxel::to_contents(&*model, options, limits, progress)?;
            return Ok(Loaded::model(contents, Texts::default(), told(path, model.notes())));
        }
        Format::Mesh(kind) => {
            let mesh = mesh_in::load(path, kind, limits, progress)?;
            let (contents, notes) = mesh.into_contents(options, limits, progress)?;
            let assumed_up = (!kind.knows_up()).then(|| kind.up(options));
            let loaded = Loaded::model(contents, Texts::default(), told(path, notes));
            return Ok(Loaded { assumed_up, ..loaded });
        }
        Format::Pvm | Format::Raw => {}
    }
    let (volume, _) = read_volume(path, options, limits, progress)?;
    let signature = import::trusted_signature(&volume);
    let mut contents = import::to_contents(&volume, signature, options, limits, progress)?;
    let Volume { samples, texts, data, .. } = volume;
    drop(data);
    let assumed_up = signature.is_none().then(|| options.upright.unwrap_or_default());
    if let Some(up) = assumed_up.filter(|up| *up != Up::default()) {
        let turn = up.turned_upright();
        contents = Reorientation::new(&contents, turn).run(limits, progress)?;
    }
    Ok(Loaded { contents, samples: Some(samples), texts, assumed_up, notes: Vec::new() })
}

/// Notes for the person, which are also logged.
fn told(path: &Path, notes: Vec<String>) -> Vec<String> {
    notes.iter().for_each(|note| tracing::warn!("{}: {note}", path.display()));
    notes
}

/// Reads the voxels of a file unconverted, within the same limits as [`load`].
pub fn load_volume(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Volume, FormatError> {
    read_volume(path, options, limits, progress).map(|(volume, _)| volume)
}

/// Writes a sculpture, atomically: an existing file is replaced when the new one is complete. A mesh is written with
/// the default options; see [`save_mesh`].
pub fn save(
    path: &Path,
    contents: &Contents,
    form: ExportForm,
    progress: &dyn Progress,
) -> Result<(), FormatError> {
    save_with_texts(path, contents, form, Texts::default(), progress)
}

/// [`save`], with texts in formats that store them.
pub fn save_with_texts(
    path: &Path,
    contents: &Contents,
    form: ExportForm,
    texts: Texts,
    progress: &dyn Progress,
) -> Result<(), FormatError> {
    if is_mesh(path) {
        if form != ExportForm::Auto {
            return Err(FormatError::FormOfMesh(form));
        }
        let (options, limits) = (MeshOptions::default(), Limits::default());
        return save_mesh(path, contents, &options, &limits, progress).map(|_| ());
    }
    let volume = |texts| {
        progress.begin("making the volume");
        let volume = export::to_volume(contents, form, texts);
        progress.end();
        go_on(progress)?;
        volume
    };
    let bytes = match Format::of(path)? {
        Format::Vsc if form != ExportForm::Auto => return Err(FormatError::FormOfVsc(form)),
        Format::Vsc => vsc::write(contents, &texts, progress)?,
        Format::Mesh(_) => return Err(FormatError::ReadOnly),
        Format::Voxel(_) if form != ExportForm::Auto => return Err(FormatError::FormOfModel(form)),
        Format::Voxel(kind) => {
            let write = match kind {
                voxel::Kind::Vox => voxel::write_vox,
                voxel::Kind::Qb => voxel::write_qb,
                voxel::Kind::Gox | voxel::Kind::Binvox => return Err(FormatError::ReadOnly),
            };
            let mut out = BufWriter::new(store::AtomicFile::create(path)?);
            write(contents, &mut out, progress)?;
            go_on(progress)?;
            let file = out.into_inner().map_err(std::io::IntoInnerError::into_error)?;
            return Ok(file.finish()?);
        }
        Format::Pvm => pvm::write(volume(texts)?, progress)?,
        Format::Raw => volume(texts)?.data,
    };
    // The last moment to cancel.
    go_on(progress)?;
    progress.begin("writing");
    let written = store::write_with(path, &bytes, progress);
    progress.end();
    Ok(written?)
}

/// An error if the work has been cancelled.
fn go_on(progress: &dyn Progress) -> Result<(), FormatError> {
    if progress.is_cancelled() { Err(FormatError::Cancelled) } else { Ok(()) }
}

/// A description of a file, found without converting it to a sculpture.
#[derive(Clone, PartialEq, Debug)]
pub struct Info {
    /// Format and packing, such as `PVM3, packed as DDS v3d`.
    pub kind: String,
    /// Length of the file.
    pub file_bytes: u64,
    /// Size in voxels.
    pub dims: UVec3,
    /// Edge lengths of a voxel.
    pub voxel_size: Vec3,
    /// Sample type of a volume. None for a .vsc file.
    pub samples: Option<Samples>,
    /// The texts stored with the volume.
    pub texts: Texts,
    /// Of densities.
    pub densities: Option<Densities>,
    /// What this program noted when it wrote the file.
    pub signature: Option<Signature>,
    /// What opening the file leaves out or takes otherwise.
    pub notes: Vec<String>,
}

/// Statistics of a volume of densities.
#[derive(Clone, PartialEq, Debug)]
pub struct Densities {
    /// How often each density occurs.
    pub histogram: Histogram,
    /// The automatic threshold: densities from this on exist by default.
    pub threshold: f64,
}

/// Describes a file, within the default limits. For raw files see [`info_with`].
pub fn info(path: &Path) -> Result<Info, FormatError> {
    info_with(path, &ImportOptions::default(), &Limits::default(), &())
}

/// Describes a file, with options for raw files.
pub fn info_with(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Info, FormatError> {
    if Format::of(path)? == Format::Vsc {
        let file = read_file(path, limits, progress)?;
        let header = vsc::read_header(&file, limits)?;
        let vsc::Header { dims, voxel_size, colour_depth, base, texts, .. } = header;
        let signature = Signature { form: ExportForm::Auto, colour_depth, base };
        return Ok(Info {
            kind: "VSC".to_string(),
            file_bytes: file.len() as u64,
            dims,
            voxel_size,
            samples: None,
            densities: None,
            signature: Some(signature),
            texts,
            notes: Vec::new(),
        });
    }
    let of_model = |kind, file_bytes, dims, voxel_size, notes| {
        let (samples, densities, signature, texts) = (None, None, None, Texts::default());
        Info { kind, file_bytes, dims, voxel_size, samples, densities, signature, texts, notes }
    };
    match Format::of(path)? {
        Format::Voxel(kind) => {
            let file = read_file(path, limits, progress)?;
            let model = voxel::read(kind, &file)?;
            let Contents { grid, .. } = voxel::to_contents(&*model, options, limits, progress)?;
            let (bytes, notes) = (file.len() as u64, model.notes());
            return Ok(of_model(model.kind(), bytes, grid.dims(), grid.voxel_size(), notes));
        }
        Format::Mesh(kind) => {
            let mesh = mesh_in::load(path, kind, limits, progress)?;
            let (frame, bytes) = (mesh.frame(options)?, std::fs::metadata(path)?.len());
            let kind = format!("{}, triangles: {}", mesh.kind, mesh.mesh.triangles.len());
            return Ok(of_model(kind, bytes, frame.dims, frame.voxel_size, mesh.notes));
        }
        Format::Vsc | Format::Pvm | Format::Raw => {}
    }
    let (volume, source) = read_volume(path, options, limits, progress)?;
    let densities = import::histogram(&volume).map(|histogram| {
        let threshold = threshold::automatic(&histogram);
        Densities { histogram, threshold }
    });
    Ok(Info {
        kind: source.kind,
        file_bytes: source.file_bytes,
        dims: volume.dims,
        voxel_size: volume.voxel_size,
        samples: Some(volume.samples),
        densities,
        signature: import::trusted_signature(&volume),
        notes: Vec::new(),
        texts: volume.texts,
    })
}

/// One item per line; the lines of texts are indented.
impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (UVec3 { x, y, z }, size) = (self.dims, self.voxel_size);
        writeln!(f, "format: {}", self.kind)?;
        writeln!(f, "file: {} bytes", self.file_bytes)?;
        writeln!(f, "size: {x}x{y}x{z} voxels")?;
        writeln!(f, "voxel size: {} {} {}", size.x, size.y, size.z)?;
        match self.samples {
            Some(samples) => write!(f, "voxels: {samples}, {} bytes each", samples.bytes())?,
            None => write!(f, "voxels: as in a sculpture")?,
        }
        if let Some(Densities { histogram, threshold }) = &self.densities {
            write!(f, "\ndensities: {} to {}", histogram.min, histogram.max)?;
            let below = histogram.count_below(*threshold);
            let all: u64 = histogram.bins.iter().sum();
            let share = 100.0 * (all - below) as f64 / all.max(1) as f64;
            write!(f, "\nautomatic threshold: {threshold} ({share:.1} % of the voxels)")?;
        }
        if let Some(signature) = &self.signature {
            let bits = signature.colour_depth.bits();
            write!(f, "\nsculpture: {bits} bits of colour, base {}", signature.base)?;
        }
        for note in &self.notes {
            write!(f, "\nnote: {note}")?;
        }
        for (name, text) in self.texts.named() {
            if !text.is_empty() {
                let legible = Texts::legible(text);
                write!(f, "\n{name}: {}", legible.trim_end().replace('\n', "\n  "))?;
            }
        }
        Ok(())
    }
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

struct Source {
    kind: String,
    file_bytes: u64,
}

fn read_volume(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<(Volume, Source), FormatError> {
    let budget = budget_bytes(limits);
    let check_grid = |dims, voxel_size| Grid::check(dims, voxel_size, limits.grid_bytes);
    match Format::of(path)? {
        Format::Vsc | Format::Voxel(_) | Format::Mesh(_) => {
            let loaded = load(path, options, limits, progress)?;
            let volume = export::to_volume(&loaded.contents, ExportForm::Auto, loaded.texts)?;
            let file_bytes = std::fs::metadata(path)?.len();
            Ok((volume, Source { kind: "sculpture".to_string(), file_bytes }))
        }
        Format::Pvm => {
            let file = store::read(path, budget, |_| Ok(()), progress)?;
            let file_bytes = file.len() as u64;
            let admit = |header: &pvm::Header| Ok(check_grid(header.dims, header.voxel_size)?);
            let (volume, origin) = pvm::read(file, &admit, budget - file_bytes, progress)?;
            let version = match origin.header.version {
                1 => String::new(),
                n => n.to_string(),
            };
            let kind = match origin.packing {
                Some(packing) => format!("PVM{version}, packed as {packing}"),
                None => format!("PVM{version}, not packed"),
            };
            Ok((volume, Source { kind, file_bytes }))
        }
        Format::Raw => {
            let layout = options.raw.ok_or(FormatError::NoRawLayout)?;
            let admit = |len| {
                check_grid(layout.dims, layout.voxel_size)?;
                raw::check_length(&layout, len)
            };
            let file = store::read(path, budget, admit, progress)?;
            let file_bytes = file.len() as u64;
            Ok((raw::read(file, &layout)?, Source { kind: "raw".to_string(), file_bytes }))
        }
    }
}
