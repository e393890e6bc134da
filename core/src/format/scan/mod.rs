//! Reads scans of medicine and science: DICOM, NIfTI, NRRD, MetaImage, VTK image data of both kinds, and TIFF stacks.
//!
//! Takes a path; gives a volume with its voxel spacing, the directions of its axes in the patient or the world, and
//! notes on what was left out. Headers are checked against the limits before memory is allocated, and compressed voxels
//! are unpacked no further than the header requests. Knows no sculpture.

pub mod base64;
mod dicom;
mod frame;
mod meta;
mod nifti;
mod nrrd;
mod nrrd_header;
pub(super) mod numbers;
pub mod reading;
mod segments;
mod tiff;
mod unit;
pub(super) mod unpack;
mod vti;
mod vtk;

pub use self::frame::AxisFrame;
pub use self::reading::{Reading, Scan, ScanVolume};
use super::spec::Format;

/// The formats, as texts list them. DICOM comes first: its files may begin with anything, even like those of TIFF.
pub static FORMATS: &[Format] =
    &[&dicom::SPEC, &nifti::SPEC, &nrrd::SPEC, &meta::SPEC, &vti::SPEC, &vtk::SPEC, &tiff::SPEC];
