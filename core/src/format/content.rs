//! Which format a file is of: by its name and, where that says nothing, by its first bytes.

use std::path::Path;

use super::{Format, FormatError, scan};

/// The format of a file that is to be read, or of a folder with the slices of a scan.
pub fn format_of(path: &Path) -> Result<Format, FormatError> {
    let by_name = if path.is_dir() { Err(FormatError::NotAFile) } else { Format::of(path) };
    by_name.or_else(|error| match scan::has_dicom(path) {
        true => Ok(Format::Scan(scan::Kind::Dicom)),
        false => Err(error),
    })
}
