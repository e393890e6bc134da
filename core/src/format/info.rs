//! Describes a file without converting it to a sculpture: size, spacing, sample type, histogram, and what opening it
//! would leave out.

use std::fmt;
use std::path::Path;

use glam::{UVec3, Vec3};

use super::import::VolumeView;
use super::options::{ExportForm, ImportOptions};
use super::scan::Reading;
use super::spec::{Format, Import};
use super::{
    FileMetadata, FormatError, Histogram, Samples, Signature, Texts, Volume, Volumes, content,
    import, mesh_in, open_volume, read_file, threshold, voxel, vsc,
};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;

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
    /// Statistics of the densities.
    pub densities: Option<Densities>,
    /// The note that this program left when it wrote the file.
    pub signature: Option<Signature>,
    /// Directions of the axes of a scan, in the patient or the world; `None` where the file does not state them.
    pub orientation: Option<String>,
    /// The channel and the time to which the rest refers.
    pub volumes: Volumes,
    /// Notes on what opening the file leaves out or interprets otherwise.
    pub notes: Vec<String>,
}

/// Statistics of a volume of densities.
#[derive(Clone, PartialEq, Debug)]
pub struct Densities {
    /// The frequency of each density.
    pub histogram: Histogram,
    /// The automatic threshold: densities of at least this exist by default.
    pub threshold: f64,
}

impl Densities {
    /// Computes the statistics of a volume of densities; `None` for one of colours.
    pub fn of(volume: &Volume) -> Option<Densities> {
        Densities::of_view(&VolumeView::from(volume), &()).ok().flatten()
    }

    /// Computes the statistics of a volume that may be in its files, which are read for it.
    fn of_view(
        volume: &VolumeView,
        progress: &dyn Progress,
    ) -> Result<Option<Densities>, FormatError> {
        let histogram = import::histogram(volume, progress)?;
        Ok(histogram.map(|histogram| {
            let threshold = threshold::automatic(&histogram);
            Densities { histogram, threshold }
        }))
    }
}

/// Describes a file, within the default limits. For raw files see [`info_with`].
pub fn info(path: &Path) -> Result<Info, FormatError> {
    info_with(path, &ImportOptions::default(), &Limits::default(), &())
}

/// Describes a file, with options: the layout of raw files, and the channel, time, region and resampling of volumes.
pub fn info_with(
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Info, FormatError> {
    let (format, disagreement) = content::format_of(path, options.raw.is_some())?;
    let mut info = info_as(format, path, options, limits, progress)?;
    info.notes.splice(0..0, disagreement);
    Ok(info)
}

/// Describes a file of a known format as [`info_with`] does.
fn info_as(
    format: Format,
    path: &Path,
    options: &ImportOptions,
    limits: &Limits,
    progress: &dyn Progress,
) -> Result<Info, FormatError> {
    if matches!(format.read, Import::Sculpture) {
        let file = read_file(path, limits, progress)?;
        let header = vsc::read_header(&file, limits)?;
        let vsc::VscHeader { dims, voxel_size, colour_depth, base, texts, .. } = header;
        let signature = Signature { form: ExportForm::Auto, colour_depth, base };
        return Ok(Info {
            kind: "VSC".to_string(),
            file_bytes: file.len() as u64,
            dims,
            voxel_size,
            samples: None,
            densities: None,
            signature: Some(signature),
            orientation: None,
            volumes: Volumes::default(),
            texts,
            notes: Vec::new(),
        });
    }
    let of_model = |kind, file_bytes, dims, voxel_size, notes| {
        let (samples, densities, signature, texts) = (None, None, None, Texts::default());
        let (orientation, volumes) = (None, Volumes::default());
        Info {
            kind,
            file_bytes,
            dims,
            voxel_size,
            samples,
            densities,
            signature,
            orientation,
            texts,
            volumes,
            notes,
        }
    };
    match &format.read {
        Import::Model(reader) => {
            let file = read_file(path, limits, progress)?;
            let model = (reader.read)(&file)?;
            let Contents { grid, .. } = voxel::turned(&*model, options, limits, progress)?;
            let (bytes, notes) = (file.len() as u64, model.notes());
            return Ok(of_model(model.kind(), bytes, grid.dims(), grid.voxel_size(), notes));
        }
        Import::Mesh(reader) => {
            let mesh = mesh_in::load(path, reader, limits, progress)?;
            let (frame, bytes) = (mesh.frame(options)?, std::fs::metadata(path)?.len());
            let kind = format!("{}, triangles: {}", mesh.kind, mesh.mesh.triangles.len());
            return Ok(of_model(kind, bytes, frame.dims, frame.voxel_size, mesh.notes));
        }
        Import::Sculpture | Import::Volume(_) | Import::Scan(_) => {}
    }
    let reading = Reading { path, options, limits, progress, in_layers: true };
    let (volume, source) = open_volume(format, &reading)?;
    let volume = import::VolumeView::of(&volume);
    let orientation = source.frame.describe();
    let FileMetadata { kind, file_bytes, volumes, notes, .. } = source;
    Ok(Info {
        kind,
        file_bytes,
        dims: volume.dims,
        voxel_size: volume.voxel_size,
        samples: Some(volume.samples),
        densities: Densities::of_view(&volume, progress)?,
        signature: import::trusted_signature(volume.texts, volume.samples),
        orientation,
        volumes,
        notes,
        texts: volume.texts.clone(),
    })
}

/// Writes one item per line; the lines of texts are indented.
impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (UVec3 { x, y, z }, size) = (self.dims, self.voxel_size);
        writeln!(f, "format: {}", self.kind)?;
        writeln!(f, "file: {} bytes", self.file_bytes)?;
        writeln!(f, "size: {x}x{y}x{z} voxels")?;
        writeln!(f, "voxel size: {} {} {}", size.x, size.y, size.z)?;
        if let Some(orientation) = &self.orientation {
            writeln!(f, "orientation: {orientation}")?;
        }
        for (what, taken) in self.volumes.several() {
            writeln!(f, "{what}s: {}, read: {}", taken.count, taken.number)?;
        }
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
