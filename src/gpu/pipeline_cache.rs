//! The driver's pipeline cache, kept from one start of the program to the next: a file in a cache folder for each
//! device and driver.
//!
//! Takes a folder; returns a `VkPipelineCache`. The cache only saves time: the program starts without it if the file is
//! unusable.

use std::hash::Hasher;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use ash::vk;

use super::error::{During, Result};

/// The largest file that is read or written.
const MOST_BYTES: u64 = 64 << 20;
/// Drivers without any data return only the header that Vulkan prescribes.
const VULKAN_HEADER_BYTES: usize = 32;
const MAGIC: &[u8; 8] = b"VSpipes1";
/// Magic, length and checksum, little-endian.
const HEADER_BYTES: usize = 24;

/// The cache of a device.
pub(super) struct PipelineCache {
    handle: vk::PipelineCache,
    /// The file, if there is one.
    path: Option<PathBuf>,
    /// Checksum of the data read from it.
    read: Option<u64>,
}

impl PipelineCache {
    /// Reads the file in `folder` for the device with these properties. Without a folder, reads and writes nothing.
    pub fn new(
        device: &ash::Device,
        properties: &vk::PhysicalDeviceProperties,
        folder: Option<&Path>,
    ) -> Result<PipelineCache> {
        let path = folder.map(|folder| folder.join(file_name(properties)));
        let kept = path.as_deref().and_then(read);
        let make = |data: &[u8]| {
            let info = vk::PipelineCacheCreateInfo::default().initial_data(data);
            // SAFETY: the info is complete; the checksum shows that the data are those of a driver
            // of this name and version, and drivers check their own header.
            unsafe { device.create_pipeline_cache(&info, None) }
        };
        let data = kept.as_deref().unwrap_or_default();
        let made = make(data).or_else(|error| match data {
            [] => Err(error),
            _ => make(&[]),
        });
        let handle = made.during("create the cache of pipelines")?;
        Ok(PipelineCache { handle, path, read: kept.as_deref().map(checksum) })
    }

    pub fn handle(&self) -> vk::PipelineCache {
        self.handle
    }

    /// Writes the driver's data if they have changed, and destroys the cache.
    pub fn end(self, device: &ash::Device) {
        if let Some(path) = &self.path {
            // SAFETY: the cache is of this device and lives.
            match unsafe { device.get_pipeline_cache_data(self.handle) } {
                Ok(data) if Some(checksum(&data)) == self.read => {}
                Ok(data) if data.len() <= VULKAN_HEADER_BYTES => {}
                Ok(data) => match write(path, &data) {
                    Ok(()) => tracing::debug!("{} bytes of pipelines kept", data.len()),
                    Err(error) => tracing::debug!("cannot write {}: {error}", path.display()),
                },
                Err(error) => tracing::debug!("the driver gives no pipelines to keep: {error}"),
            }
        }
        // SAFETY: no pipeline is being created any more.
        unsafe { device.destroy_pipeline_cache(self.handle, None) };
    }
}

/// Returns the file's name: different for each driver, driver version and device.
fn file_name(of: &vk::PhysicalDeviceProperties) -> String {
    let uuid: String = of.pipeline_cache_uuid.iter().map(|byte| format!("{byte:02x}")).collect();
    let (vendor, device, driver) = (of.vendor_id, of.device_id, of.driver_version);
    format!("pipelines-{vendor:08x}-{device:08x}-{driver:08x}-{uuid}.bin")
}

fn checksum(data: &[u8]) -> u64 {
    let mut hasher = std::hash::DefaultHasher::new();
    hasher.write(data);
    hasher.finish()
}

/// Returns the contents of an undamaged file.
fn read(path: &Path) -> Option<Vec<u8>> {
    let mut file = match std::fs::File::open(path) {
        Ok(file) => file.take(MOST_BYTES + HEADER_BYTES as u64),
        Err(_) => return None,
    };
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).ok()?;
    let undamaged = unwrap(&bytes).map(<[u8]>::to_vec);
    if undamaged.is_none() {
        tracing::debug!("{} is damaged and left out", path.display());
    }
    undamaged
}

/// Returns the data behind an undamaged header.
fn unwrap(bytes: &[u8]) -> Option<&[u8]> {
    let (header, data) = bytes.split_at_checked(HEADER_BYTES)?;
    header_of(data).eq(header).then_some(data)
}

fn header_of(data: &[u8]) -> [u8; HEADER_BYTES] {
    let mut header = [0; HEADER_BYTES];
    header[..8].copy_from_slice(MAGIC);
    header[8..16].copy_from_slice(&(data.len() as u64).to_le_bytes());
    header[16..].copy_from_slice(&checksum(data).to_le_bytes());
    header
}

/// Writes to a temporary name and renames, so that no other start reads a partial file.
fn write(path: &Path, data: &[u8]) -> std::io::Result<()> {
    let Some(folder) = path.parent().filter(|_| data.len() as u64 <= MOST_BYTES) else {
        return Ok(());
    };
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(&header_of(data))?;
    file.write_all(data)?;
    file.persist(path).map_err(|error| error.error).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_cache_is_read_and_a_damaged_one_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deeper").join("pipelines.bin");
        assert_eq!(read(&path), None, "nothing there");
        let data: Vec<u8> = (0..1000_u32).map(|i| (i * i) as u8).collect();
        write(&path, &data).unwrap();
        assert_eq!(read(&path).as_ref(), Some(&data));
        let whole = std::fs::read(&path).unwrap();
        for length in [0, 1, HEADER_BYTES - 1, HEADER_BYTES, whole.len() - 1] {
            std::fs::write(&path, &whole[..length]).unwrap();
            assert_eq!(read(&path), None, "cut to {length} bytes");
        }
        for at in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[at] ^= 0x10;
            assert_eq!(unwrap(&damaged), None, "byte {at} is another");
        }
        std::fs::remove_file(&path).unwrap();
        std::fs::create_dir(&path).unwrap();
        assert_eq!(read(&path), None, "a folder of that name");
        assert!(write(&path, &data).is_err());
        let left = std::fs::read_dir(path.parent().unwrap()).unwrap().count();
        assert_eq!(left, 1, "no temporary file is left");
    }

    #[test]
    fn another_driver_has_another_file() {
        let mut of = vk::PhysicalDeviceProperties { vendor_id: 0x10de, ..Default::default() };
        let first = file_name(&of);
        of.driver_version = 1;
        let second = file_name(&of);
        of.pipeline_cache_uuid[15] = 7;
        let names = [first, second, file_name(&of)];
        assert!(names[0] != names[1] && names[1] != names[2] && names[0] != names[2]);
        assert!(names.iter().all(|name| name.bytes().all(|b| b.is_ascii_graphic() && b != b'/')));
    }
}
