//! Raw volumes: voxels without a header. Bytes and a layout given by the user <-> [`Volume`].

use glam::UVec3;

use super::layered::{LayeredVolume, PartPacking, StoredNumbers, StoredVoxels, VoxelPart};
use super::options::RawLayout;
use super::scan::numbers::Number;
use super::scan::reading::{Reading, Scan};
use super::spec::{Export, FormatSpec, Import};
use super::volume::{Texts, Volume};
use super::{FormatError, budget_bytes, store};

pub static SPEC: FormatSpec = FormatSpec {
    write: Some(Export::Volume(|volume, _| Ok(volume.data))),
    exported_as: Some("Raw voxels"),
    ..FormatSpec::new("raw voxels", &["raw"], Import::Volume(open))
};

/// Returns the size of a raw file of `layout` in bytes, unless it overflows.
fn file_bytes(layout: &RawLayout) -> Option<u64> {
    let UVec3 { x, y, z } = layout.dims;
    [y, z, layout.samples.bytes()]
        .iter()
        .try_fold(u64::from(x), |n, &factor| n.checked_mul(u64::from(factor)))?
        .checked_add(layout.skip_bytes)
}

/// Checks that a file of `found` bytes matches `layout`.
fn check_length(layout: &RawLayout, found: u64) -> Result<(), FormatError> {
    let expected = file_bytes(layout).unwrap_or(u64::MAX);
    if expected == found {
        return Ok(());
    }
    Err(FormatError::RawLength { layout: layout.to_string(), expected, found })
}

/// Reads the file at a path, with the given layout.
fn open(reading: &Reading) -> Result<(Scan, u64), FormatError> {
    let volumes = reading.volumes(1)?;
    let layout = reading.options.raw.ok_or(FormatError::NoRawLayout)?;
    if let Some((number, is_big)) = Number::of(layout.samples)
        && reading.is_large(number.volume_bytes(layout.dims))
    {
        let path = reading.path.to_path_buf();
        let length = store::open(&path)?.metadata()?.len();
        reading.admit(layout.dims, layout.voxel_size)?;
        check_length(&layout, length)?;
        let (packing, begin) = (PartPacking::Plain, layout.skip_bytes);
        let part = VoxelPart { path, packing, packed_at: 0, begin, bytes: length - begin };
        let stored = StoredVoxels {
            parts: vec![part],
            skip: 0,
            numbers: StoredNumbers { number, is_big, scale: [1.0, 0.0] },
        };
        let RawLayout { dims, voxel_size, .. } = layout;
        let volume = LayeredVolume::new(stored, dims, voxel_size, Vec::new(), reading.progress)?;
        return Ok((Scan::bare(volume.into(), "raw".to_string(), volumes), length));
    }
    let admit = |length| {
        reading.admit(layout.dims, layout.voxel_size)?;
        check_length(&layout, length)
    };
    let file = store::read(reading.path, budget_bytes(reading.limits), admit, reading.progress)?;
    let file_bytes = file.len() as u64;
    Ok((Scan::bare(read(file, &layout)?.into(), "raw".to_string(), volumes), file_bytes))
}

/// Reads a raw file.
fn read(mut file: Vec<u8>, layout: &RawLayout) -> Result<Volume, FormatError> {
    check_length(layout, file.len() as u64)?;
    file.drain(..layout.skip_bytes as usize);
    Ok(Volume {
        dims: layout.dims,
        voxel_size: layout.voxel_size,
        samples: layout.samples,
        data: file,
        texts: Texts::default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_size_names_both_sizes() {
        let layout: RawLayout = "3x2x2:u16be:skip=5".parse().unwrap();
        let volume = read((0..29).collect(), &layout).unwrap();
        assert_eq!(volume.data, (5..29).collect::<Vec<u8>>());
        let message = read(vec![0; 28], &layout).unwrap_err().to_string();
        assert!(message.contains("29 bytes") && message.contains("has 28"), "{message}");
        let huge = RawLayout { dims: UVec3::splat(u32::MAX), ..layout };
        assert!(read(vec![0; 29], &huge).is_err());
    }
}
