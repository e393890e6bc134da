//! A device whose storage buffers may be no larger than the parts of a sculpture need: what does not fit is drawn in
//! another way, and said.

use std::path::Path;

use super::{command, folder, picture, succeed};
use crate::faults::Faults;
use crate::gpu::fixture::need_device;

/// A ball large enough that its voxels cover several pixels each.
const SCRIPT: &str = "new dims=64,64,64 colour=0 fill=empty\nadd ellipsoid at=32,32,32 half=26\n";

/// A picture by a mode that shades on the device, where storage buffers have at most so many bytes; and what was said.
fn render(folder: &Path, bytes: Option<u64>, more: &[&str]) -> (image::RgbImage, String) {
    let arguments =
        ["render", "ball.vsc", "--out", "a.png", "--size", "240x240", "--mode", "march-gpu"];
    let mut command = command(folder, &[&arguments, more].concat());
    let faults = Faults::new(folder, &mut command);
    faults.set(&bytes.map_or_else(String::new, |bytes| format!("storage 0 {bytes}")));
    let output = command.output().expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    (picture(folder.join("a.png")), said)
}

#[test]
fn a_surface_beyond_the_limit_of_a_device_is_drawn_as_voxels_and_normals_by_another_mode() {
    need_device();
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("ball.sculpt"), SCRIPT).unwrap();
    succeed(path, &["run", "ball.sculpt", "--out", "ball.vsc"]);
    let (smooth, said) = render(path, None, &[]);
    assert!(!said.contains("maxStorageBufferRange"), "{said}");
    let (voxels, _) = render(path, None, &["--voxels"]);
    assert_ne!(smooth, voxels);
    // Some 300 bricks have surface: 512 bytes each of the smooth surface, less than 384 of normals.
    let (limited, said) = render(path, Some(80 << 10), &[]);
    let why =
        "voxels are shown instead of the smooth surface: the smooth surface of the sculpture needs";
    assert!(said.contains(why) && said.contains("maxStorageBufferRange of 81920"), "{said}");
    assert!(limited == voxels);
    // No room for normals either.
    let (other, said) = render(path, Some(40 << 10), &[]);
    assert!(said.contains("maxStorageBufferRange of 40960"), "{said}");
    assert_eq!(other.dimensions(), (240, 240));
}
