//! Tests volumes whose up axis is not y: the import option turns them upright as they are read, including colours and
//! voxel sizes, but not files that specify their orientation.

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::format::options::{Existence, ExportForm, ImportOptions};
use sculpture_core::format::{self, FormatError};
use sculpture_core::refusal::{MemoryBudget, OverBudget};
use sculpture_core::sculpture::Limits;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::orientation::Up;

fn load(path: &std::path::Path, options: &ImportOptions) -> Result<Contents, FormatError> {
    format::load(path, options, &Limits::default(), &()).map(|loaded| loaded.contents)
}

/// Writes 9 x 4 x 6 voxels, each with a colour of its own; voxels of 1 x 2 x 3.
fn coloured_raw(folder: &std::path::Path) -> (std::path::PathBuf, ImportOptions) {
    let path = folder.join("scan.raw");
    let voxels =
        (0..6u8).flat_map(|z| (0..4u8).flat_map(move |y| (0..9u8).map(move |x| [x, y, z])));
    let bytes: Vec<u8> = voxels.flat_map(|[x, y, z]| [20 + x, 60 + y, 90 + z, 255]).collect();
    std::fs::write(&path, bytes).unwrap();
    let raw = Some("9x4x6:rgba8:size=1,2,3".parse().unwrap());
    (path, ImportOptions { raw, ..ImportOptions::default() })
}

#[test]
fn the_given_axis_points_up_afterwards() {
    let folder = tempfile::tempdir().unwrap();
    let (path, options) = coloured_raw(folder.path());
    let lying = load(&path, &options).unwrap();
    for (upright, _) in Up::NAMED {
        let standing = load(&path, &ImportOptions { upright: Some(upright), ..options }).unwrap();
        let turn = upright.turned_upright();
        assert_eq!(standing.grid.dims(), turn.size(UVec3::new(9, 4, 6)), "{upright}");
        let size = Vec3::from(turn.permuted([1.0, 2.0, 3.0]));
        assert_eq!(standing.grid.voxel_size(), size, "{upright}");
        for index in 0..9 * 4 * 6 {
            let v = lying.grid.voxel_coords(index);
            let there = turn.destination(v.as_ivec3(), lying.grid.dims());
            assert_eq!(standing.colour(there), lying.colour(v.as_ivec3()), "{upright} {v}");
        }
    }
    // The slice of the highest z, which is blue, is the top row with z up, the bottom with -z.
    let blue = |upright, y| {
        let contents = load(&path, &ImportOptions { upright: Some(upright), ..options }).unwrap();
        contents.colour(IVec3::new(4, y, 2)).unwrap().0[2]
    };
    assert_eq!((blue(Up::Z, 5), blue(Up::Z, 0)), (95, 90));
    assert_eq!((blue(Up::MinusZ, 5), blue(Up::MinusZ, 0)), (90, 95));
}

#[test]
fn files_with_an_orientation_stay_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let (path, options) = coloured_raw(folder.path());
    let contents = load(&path, &options).unwrap();
    let upright = ImportOptions { upright: Some(Up::Z), ..ImportOptions::default() };
    for (name, form) in [
        ("own.vsc", ExportForm::Auto),
        ("own.pvm", ExportForm::Rgba),
        ("densities.pvm", ExportForm::Densities),
        ("packed.pvm", ExportForm::Packed),
    ] {
        let own = folder.path().join(name);
        format::save(&own, &contents, form, &()).unwrap();
        assert_eq!(load(&own, &upright).unwrap().grid, contents.grid, "{name}");
    }
    // A PVM volume of another program has none.
    let other = folder.path().join("other.pvm");
    let mut bytes = b"PVM2\n9 4 6\n1 2 3\n1\n".to_vec();
    bytes.extend((0..9 * 4 * 6).map(|i| if i / (9 * 4) < 2 { 200 } else { 0 }));
    std::fs::write(&other, bytes).unwrap();
    let threshold = Existence::Threshold(100.0);
    let options = ImportOptions { existence: threshold, ..upright };
    let standing = load(&other, &options).unwrap().grid;
    assert_eq!(standing.dims(), UVec3::new(9, 6, 4));
    assert_eq!(standing.voxel_size(), Vec3::new(1.0, 3.0, 2.0));
    assert_eq!(standing.opaque_bounds(), Some((UVec3::ZERO, UVec3::new(9, 2, 4))));
}

#[test]
fn turning_a_volume_respects_the_memory_limit_of_colours() {
    // The middle of three bricks along y is coloured; reversed, its voxels lie in two.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.raw");
    let voxels = (0..8).flat_map(|_| (0..20).flat_map(|y| (0..8).map(move |_| y)));
    let voxel = |y| if (8..16).contains(&y) { [9, 99, y, 255] } else { [0; 4] };
    std::fs::write(&path, voxels.flat_map(voxel).collect::<Vec<u8>>()).unwrap();
    let raw = Some("8x20x8:rgba8".parse().unwrap());
    let turned = |upright, limits: &Limits| {
        let options = ImportOptions { raw, upright: Some(upright), ..ImportOptions::default() };
        format::load(&path, &options, limits, &()).map(|loaded| loaded.contents.material)
    };
    let lying = turned(Up::Y, &Limits::default()).unwrap();
    let standing = turned(Up::Z, &Limits::default()).unwrap();
    assert_eq!((lying.page_count(), standing.page_count()), (1, 2));
    let tight = |colour_bytes| Limits { colour_bytes, ..Limits::default() };
    assert!(turned(Up::Z, &tight(standing.heap_bytes())).is_ok());
    let tight = tight(standing.heap_bytes() - 1);
    assert!(matches!(
        turned(Up::Z, &tight),
        Err(FormatError::OverBudget(OverBudget { budget: MemoryBudget::Colours, .. }))
    ));
    assert!(turned(Up::MinusZ, &tight).is_ok(), "y is not reversed");
}
