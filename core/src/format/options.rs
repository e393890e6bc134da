//! Options for reading and writing files. Each has a text form, for scripts and for command lines.
//!
//! Knows no file and no grid.

use std::fmt;
use std::str::FromStr;

use glam::{UVec3, Vec3};

mod scan;

pub use scan::{Cubic, Existence, Ordinal, ScanRegion};

use super::volume::Samples;
use crate::mesh::MeshKind;
use crate::sculpture::ColourDepth;
use crate::sculpture::orientation::Up;
pub use crate::voxelise::{Fill as MeshFill, MeshSize};

/// The source of the colours of a volume's voxels.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Colouring {
    /// As the file was written by this program. Otherwise colours as they are, and densities in the base colour, to be
    /// painted: shades of grey would show as stripes wherever the surface crosses them.
    #[default]
    Auto,
    /// No colours.
    None,
    /// Densities as grey: the brighter, the denser.
    Grey,
    /// Densities as the colours of a body: skin, flesh, bone.
    Tissue,
    /// Whole numbers as labels: each has its own colour, and 0 is an empty voxel.
    Labels,
    /// 1, 2 or 3 bytes per voxel are a sculpture's own packed colours of 8, 16 or 24 bits (16 bits with the high byte
    /// first); 0 is an empty voxel.
    Packed,
}

impl Colouring {
    /// All values with their names in the text form.
    pub const NAMED: [(Colouring, &'static str); 6] = [
        (Colouring::Auto, "auto"),
        (Colouring::None, "none"),
        (Colouring::Grey, "grey"),
        (Colouring::Tissue, "tissue"),
        (Colouring::Labels, "labels"),
        (Colouring::Packed, "packed"),
    ];
}

/// The layout of a raw file, which has no header.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RawLayout {
    /// Size in voxels.
    pub dims: UVec3,
    /// Type of a voxel's value.
    pub samples: Samples,
    /// Bytes before the first voxel.
    pub skip_bytes: u64,
    /// Edge lengths of a voxel.
    pub voxel_size: Vec3,
}

/// Options of the conversion of a file to a sculpture.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ImportOptions {
    /// The rule by which voxels exist.
    pub existence: Existence,
    /// The source of their colours.
    pub colouring: Colouring,
    /// Colour bits of the sculpture; `None`: as the file was written by this program, as the packed colours have, or
    /// 24.
    pub colour_depth: Option<ColourDepth>,
    /// The axis that points up; `None`: the usual one of the format. Ignored, with a note, for files that define it:
    /// sculptures, glTF, scans with the patient's axes. Volumes written by this program keep their orientation.
    pub upright: Option<Up>,
    /// Layout of a raw file; ignored for other files.
    pub raw: Option<RawLayout>,
    /// The channel to read from a file with several; `None`: the first.
    pub channel: Option<Ordinal>,
    /// The time, phase or volume along a fourth axis to read from a file with several; `None`: that of the DICOM file
    /// that was named, else the first.
    pub time: Option<Ordinal>,
    /// The part of a volume to read; `None`: all of it.
    pub region: Option<ScanRegion>,
    /// Whether a volume is resampled to cubic voxels: densities linearly, before thresholds apply; labels and colours
    /// from the nearest voxel.
    pub cubic: Cubic,
    /// Whether only the largest face-connected piece of a volume is kept.
    pub largest_piece: bool,
    /// Whether cavities of a volume, which do not reach the grid's border, become solid in the base colour.
    pub fill_holes: bool,
    /// The size of a mesh, or, if given, the edge of a voxel of a voxel model.
    pub mesh_size: MeshSize,
    /// Whether a mesh becomes solid.
    pub mesh_fill: MeshFill,
}

/// The form in which a volume stores a sculpture.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ExportForm {
    /// [`ExportForm::Densities`] without colours, else [`ExportForm::Rgba`].
    #[default]
    Auto,
    /// A byte per voxel: 255 where it exists, else 0. Colours are lost.
    Densities,
    /// Red, green, blue and opacity, a byte each.
    Rgba,
    /// The packed colours as they are stored, 1 to 3 bytes per voxel, 0 where it is empty. An existing voxel whose
    /// packed colour is 0 (black) gets the nearest other colour.
    Packed,
}

/// The axis that points up in a file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshUp {
    /// As in the sculpture.
    Y,
    /// As on a printer's bed.
    Z,
}

impl MeshUp {
    /// All values with their names in the text form.
    pub const NAMED: [(MeshUp, &'static str); 2] = [(MeshUp::Y, "y"), (MeshUp::Z, "z")];
}

/// Options of the conversion of a sculpture to a mesh file.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct MeshOptions {
    /// The kind of surface.
    pub kind: MeshKind,
    /// Whether only the vertices are written, in formats that can hold them alone.
    pub points_only: bool,
    /// The axis that points up; `None` for the usual one of the format.
    pub up: Option<MeshUp>,
    /// Length of a voxel along x in millimetres; `None` for the sculpture's voxel size.
    pub voxel_mm: Option<f32>,
    /// Greatest number of triangles, as far as the surface's topology allows; `None` for no limit.
    pub triangles: Option<u64>,
}

/// Options of writing a sculpture. Each format uses some of them, and refuses those that it cannot satisfy.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ExportOptions {
    /// The form of a volume.
    pub form: ExportForm,
    /// The options of a mesh.
    pub mesh: MeshOptions,
}

impl From<ExportForm> for ExportOptions {
    fn from(form: ExportForm) -> ExportOptions {
        ExportOptions { form, ..ExportOptions::default() }
    }
}

impl ExportForm {
    /// All values with their names in the text form.
    pub const NAMED: [(ExportForm, &'static str); 4] = [
        (ExportForm::Auto, "auto"),
        (ExportForm::Densities, "densities"),
        (ExportForm::Rgba, "rgba"),
        (ExportForm::Packed, "packed"),
    ];
}

/// Implements the text form of an option: `Display` and `FromStr`.
macro_rules! named_text_form {
    ($kind:ty, $what:literal) => {
        impl fmt::Display for $kind {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let name = <$kind>::NAMED.iter().find(|(choice, _)| choice == self);
                f.write_str(name.map_or("", |(_, name)| name))
            }
        }

        impl FromStr for $kind {
            type Err = String;

            fn from_str(text: &str) -> Result<$kind, String> {
                let known = <$kind>::NAMED.iter().find(|(_, name)| *name == text);
                known.map(|(choice, _)| *choice).ok_or_else(|| {
                    let names = <$kind>::NAMED.map(|(_, name)| name).join(", ");
                    format!("`{text}` is not {}; use one of {names}", $what)
                })
            }
        }
    };
}

named_text_form!(Colouring, "a colouring");
named_text_form!(ExportForm, "a form to save in");
named_text_form!(MeshFill, "a filling");
named_text_form!(MeshKind, "a surface of a mesh");
named_text_form!(MeshUp, "an axis that points up in a mesh");

/// Writes `128x256x256:u16le`, with `:skip=BYTES` and `:size=SX,SY,SZ` where they matter.
impl fmt::Display for RawLayout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let UVec3 { x, y, z } = self.dims;
        write!(f, "{x}x{y}x{z}:{}", self.samples)?;
        if self.skip_bytes > 0 {
            write!(f, ":skip={}", self.skip_bytes)?;
        }
        if self.voxel_size != Vec3::ONE {
            let Vec3 { x, y, z } = self.voxel_size;
            write!(f, ":size={x},{y},{z}")?;
        }
        Ok(())
    }
}

impl FromStr for RawLayout {
    type Err = String;

    fn from_str(text: &str) -> Result<RawLayout, String> {
        let mut parts = text.split(':');
        let dims = parts.next().and_then(|p| three(p, 'x')).filter(|d| !d.contains(&0));
        let dims = dims.ok_or_else(|| {
            format!("`{text}` must begin with the size in voxels, such as 128x128x64")
        })?;
        let samples = parts.next().ok_or_else(|| {
            format!("`{text}` must continue with the voxel type, such as :u8 or :u16le")
        })?;
        let mut layout = RawLayout {
            dims: dims.into(),
            samples: samples.parse()?,
            skip_bytes: 0,
            voxel_size: Vec3::ONE,
        };
        for part in parts {
            let positive = |v: &[f32; 3]| v.iter().all(|n| n.is_finite() && *n > 0.0);
            match part.split_once('=') {
                Some(("skip", n)) => {
                    let rule = format!("`{part}` must give a number of bytes, such as skip=352");
                    layout.skip_bytes = n.parse().map_err(|_| rule)?;
                }
                Some(("size", n)) => {
                    let size = three(n, ',').filter(positive).ok_or_else(|| {
                        format!("`{part}` must give three lengths above 0, such as size=1,1,2.5")
                    })?;
                    layout.voxel_size = size.into();
                }
                _ => return Err(format!("`{part}` is not one of skip=BYTES, size=SX,SY,SZ")),
            }
        }
        Ok(layout)
    }
}

fn three<T: FromStr>(text: &str, separator: char) -> Option<[T; 3]> {
    let numbers = text.split(separator).map(|n| n.trim().parse().ok());
    numbers.collect::<Option<Vec<T>>>()?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_forms_round_trip() {
        for text in [
            "128x256x256:u8",
            "1x2x3:f32be:skip=352",
            "4096x1x7:rgba8:skip=1:size=0.5,1,2.25",
            "4x5x6:i16le:size=1,1,0.1",
        ] {
            assert_eq!(text.parse::<RawLayout>().map(|l| l.to_string()), Ok(text.to_string()));
        }
        for (colouring, name) in Colouring::NAMED {
            assert_eq!((name.parse(), colouring.to_string()), (Ok(colouring), name.to_string()));
        }
        for (fill, name) in MeshFill::NAMED {
            assert_eq!((name.parse(), fill.to_string()), (Ok(fill), name.to_string()));
        }
        for (form, name) in ExportForm::NAMED {
            assert_eq!((name.parse(), form.to_string()), (Ok(form), name.to_string()));
        }
    }

    #[test]
    fn nonsense_is_explained() {
        for (text, part) in [
            ("128x256", "size in voxels"),
            ("0x1x1:u8", "size in voxels"),
            ("1x1x1", "the voxel type"),
            ("1x1x1:u64", "u16le"),
            ("1x1x1:u8:skip=-1", "skip=352"),
            ("1x1x1:u8:size=1,1", "three lengths"),
            ("1x1x1:u8:size=1,1,nan", "three lengths"),
            ("1x1x1:u8:colour", "skip=BYTES"),
        ] {
            let error = text.parse::<RawLayout>().unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
        assert!("gray".parse::<Colouring>().unwrap_err().contains("tissue"));
    }
}
