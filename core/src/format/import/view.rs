//! A volume to be imported: in memory, or in its files.

use glam::{UVec3, Vec3};

use crate::format::FormatError;
use crate::format::layered::{LayeredVolume, Portions};
use crate::format::scan::ScanVolume;
use crate::format::volume::{Samples, Texts, Volume};
use crate::progress::Progress;

/// A volume to be imported.
#[derive(Clone, Copy)]
pub struct VolumeView<'a> {
    pub dims: UVec3,
    pub voxel_size: Vec3,
    pub samples: Samples,
    pub texts: &'a Texts,
    pub voxels: Voxels<'a>,
}

/// The place of its voxels.
#[derive(Clone, Copy)]
pub enum Voxels<'a> {
    /// All of them.
    Held(&'a [u8]),
    Layered(&'a LayeredVolume),
}

impl<'a> From<&'a Volume> for VolumeView<'a> {
    fn from(volume: &'a Volume) -> VolumeView<'a> {
        let Volume { dims, voxel_size, samples, data, texts } = volume;
        let (dims, voxel_size, samples) = (*dims, *voxel_size, *samples);
        VolumeView { dims, voxel_size, samples, texts, voxels: Voxels::Held(data) }
    }
}

impl<'a> VolumeView<'a> {
    pub fn of(volume: &'a ScanVolume) -> VolumeView<'a> {
        match volume {
            ScanVolume::Held(volume) => volume.into(),
            ScanVolume::Layered(volume) => VolumeView {
                dims: volume.dims,
                voxel_size: volume.voxel_size,
                samples: volume.samples,
                texts: &volume.texts,
                voxels: Voxels::Layered(volume),
            },
        }
    }

    /// Calls `f` with all voxels in order, portion by portion.
    pub fn for_each<const B: usize>(
        &self,
        progress: &dyn Progress,
        f: &mut dyn FnMut(&[[u8; B]]),
    ) -> Result<(), FormatError> {
        match self.voxels {
            Voxels::Held(data) => {
                f(data.as_chunks().0);
                Ok(())
            }
            Voxels::Layered(volume) => {
                progress.begin("reading the voxels");
                let read = volume.for_each(Portions::Any, progress, &mut |_, data| {
                    f(data.as_chunks().0);
                    Ok(())
                });
                progress.end();
                read
            }
        }
    }
}
