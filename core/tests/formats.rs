//! Tests file formats through the public interface: real volumes decode to known bytes and become sensible sculptures,
//! and written files read back.

use std::path::{Path, PathBuf};

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::format::options::{Colouring, Existence, ExportForm, ImportOptions, RawLayout};
use sculpture_core::format::{self, FormatError, Loaded, Samples, Texts};
use sculpture_core::refusal::MemoryBudget;
use sculpture_core::sculpture::brick::local_index;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};
use sha2::{Digest, Sha256};
use trials::shared_file;

const ROOM: u64 = 1 << 30;

fn load(path: &Path, options: &ImportOptions) -> Result<Loaded, FormatError> {
    format::load(path, options, &Limits::default(), &())
}

fn load_plainly(path: &Path) -> Contents {
    load(path, &ImportOptions::default()).unwrap().contents
}

fn shared_volume(name: &str) -> PathBuf {
    shared_file(&format!("data/{name}"))
}

#[test]
fn every_volume_decodes_to_the_bytes_of_the_original_program() {
    let list = shared_volume("expected.json");
    let expected: serde_json::Value =
        serde_json::from_slice(&std::fs::read(list).unwrap()).unwrap();
    let expected = expected.as_object().unwrap();
    assert!(expected.len() >= 26, "the list is short: {}", expected.len());
    for (name, facts) in expected {
        let path = shared_volume(name);
        let (options, limits) = (ImportOptions::default(), Limits::default());
        let volume = format::load_volume(&path, &options, &limits, &()).unwrap();
        let sha: String = Sha256::digest(&volume.data).iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(sha, facts["sha256"].as_str().unwrap(), "{name}");

        let numbers = |key: &str| -> Vec<f64> {
            facts[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
        };
        assert_eq!(volume.dims.as_dvec3().to_array()[..], numbers("dims"), "{name}");
        let spacing: Vec<f32> = numbers("spacing").iter().map(|&v| v as f32).collect();
        assert_eq!(volume.voxel_size.to_array()[..], spacing, "{name}");
        let components = facts["components"].as_u64().unwrap() as u32;
        assert_eq!(volume.samples, Samples::of_components(components), "{name}");
        let texts = facts["strings"].as_array().unwrap();
        for ((which, text), expected) in volume.texts.named().into_iter().zip(texts) {
            assert_eq!(Texts::legible(text), expected.as_str().unwrap_or(""), "{name} {which}");
        }

        let info = format::info(&path).unwrap();
        let version = match facts["version"].as_u64().unwrap() {
            1 => "PVM".to_string(),
            n => format!("PVM{n}"),
        };
        let packing = match facts["dds"].as_str() {
            Some(kind) => format!("packed as DDS {kind}"),
            None => "not packed".to_string(),
        };
        assert_eq!(info.kind, format!("{version}, {packing}"), "{name}");
        if let Some(densities) = info.densities {
            let histogram = densities.histogram;
            assert_eq!(f64::from(histogram.min), facts["min"].as_f64().unwrap(), "{name}");
            assert_eq!(f64::from(histogram.max), facts["max"].as_f64().unwrap(), "{name}");
            let voxels = (volume.data.len() / components as usize) as u64;
            let zeros = if histogram.min > 0.0 { 0 } else { histogram.bins[0] };
            assert_eq!(voxels - zeros, facts["nonzero_samples"].as_u64().unwrap(), "{name}");
        }
    }
}

/// Returns the share of the voxels that exist, of those in one connected body, and of the border voxels.
fn body(contents: &Contents) -> (f64, f64, f64) {
    let grid = &contents.grid;
    let dims = grid.dims();
    let voxels = dims.as_u64vec3().element_product() as usize;
    let mut seen = vec![false; voxels];
    let mut largest = 0;
    for start in 0..voxels {
        let at = grid.voxel_coords(start as u32).as_ivec3();
        if seen[start] || !grid.get(at) {
            continue;
        }
        seen[start] = true;
        let (mut open, mut size) = (vec![at], 0u64);
        while let Some(v) = open.pop() {
            size += 1;
            for step in [IVec3::X, IVec3::Y, IVec3::Z].into_iter().flat_map(|s| [s, -s]) {
                let next = v + step;
                if grid.get(next) {
                    let index = grid.voxel_index(next.as_uvec3()) as usize;
                    if !std::mem::replace(&mut seen[index], true) {
                        open.push(next);
                    }
                }
            }
        }
        largest = largest.max(size);
    }
    let corners: Vec<bool> = (0..8)
        .map(|i| UVec3::new(i & 1, i >> 1 & 1, i >> 2) * (dims - 1))
        .map(|corner| grid.get(corner.as_ivec3()))
        .collect();
    let opaque = grid.opaque_count() as f64;
    (opaque / voxels as f64, largest as f64 / opaque, corners.iter().filter(|c| **c).count() as f64)
}

#[test]
fn the_automatic_threshold_finds_the_body() {
    // Not noise: nearly all voxels are connected, and the air of the scan is empty. The head rest of the skull scan and
    // the tubes of the other are separate bodies.
    for (name, share, together) in [
        ("derived/VisMale_128x256x256_u8.pvm", 0.38..0.46, 0.97),
        ("derived/CraniumCT_128x128x108_u16.pvm", 0.30..0.36, 0.88),
        ("pvm/Daisy.pvm", 0.09..0.099, 0.99),
        ("pvm/DTI-B0.pvm", 0.18..0.24, 0.95),
        ("derived/teapot128_u8.pvm", 0.035..0.045, 0.99),
    ] {
        let path = shared_volume(name);
        let contents = load_plainly(&path);
        let (existing, largest, corners) = body(&contents);
        assert!(share.contains(&existing), "{name}: {existing} exists");
        assert!(largest > together, "{name}: {largest} is connected");
        assert!(corners <= 2.0, "{name}: {corners} corners of the grid are not empty");
    }
}

#[test]
fn the_options_choose_threshold_and_colours() {
    let path = shared_volume("derived/CraniumCT_128x128x108_u16.pvm");
    let bone = ImportOptions {
        existence: Existence::Threshold(1300.0),
        colouring: Colouring::Tissue,
        colour_depth: Some(ColourDepth::Bits16),
        ..ImportOptions::default()
    };
    let loaded = load(&path, &bone).unwrap();
    let Contents { grid, material, .. } = &loaded.contents;
    let volume =
        format::load_volume(&path, &ImportOptions::default(), &Limits::default(), &()).unwrap();
    let dense = volume.data.chunks(2).filter(|v| u16::from_be_bytes([v[0], v[1]]) >= 1300);
    assert_eq!(grid.opaque_count(), dense.count() as u64);
    assert_eq!(material.depth(), ColourDepth::Bits16);
    assert_eq!(grid.voxel_size(), Vec3::new(1.91406, 1.91406, 1.5));
    assert_eq!(material.page_count(), grid.nonempty_bricks().count());

    let plain = ImportOptions { colouring: Colouring::None, ..bone };
    let contents = load(&path, &plain).unwrap().contents;
    assert_eq!((contents.material.heap_bytes(), &contents.grid), (0, grid));
    let packed = ImportOptions { colouring: Colouring::Packed, ..bone };
    assert!(matches!(load(&path, &packed), Err(FormatError::ThresholdOfPacked)));
}

#[test]
fn colour_volumes_keep_their_colours() {
    for name in
        ["derived/frog_rgba_125x118x68.pvm", "derived/spot96_rgba.pvm", "derived/spot96_rgb.pvm"]
    {
        let path = shared_volume(name);
        let volume =
            format::load_volume(&path, &ImportOptions::default(), &Limits::default(), &()).unwrap();
        let Contents { grid, material, .. } = load_plainly(&path);
        assert_eq!(material.depth(), ColourDepth::Bits24);
        let bytes = volume.samples.bytes() as usize;
        for (i, voxel) in volume.data.chunks(bytes).enumerate() {
            let at = grid.voxel_coords(i as u32);
            let exists = match voxel {
                [_, _, _, alpha] => *alpha >= 128,
                rgb => rgb.iter().any(|c| *c > 0),
            };
            assert_eq!(grid.get(at.as_ivec3()), exists, "{name} {at}");
            if exists {
                let rgb = Rgb::new(voxel[0], voxel[1], voxel[2]);
                assert_eq!(colour_at(&material, at), rgb, "{name} {at}");
            }
        }
        let tissue = ImportOptions { colouring: Colouring::Tissue, ..ImportOptions::default() };
        let error = load(&path, &tissue).unwrap_err().to_string();
        assert!(error.contains("tissue") && error.contains("rgb"), "{error}");
    }
}

fn colour_at(material: &Material, v: UVec3) -> Rgb {
    material.rgb(v / 8, local_index(v.x & 7, v.y & 7, v.z & 7))
}

#[test]
fn memory_is_checked_before_it_is_allocated() {
    let path = shared_volume("derived/VisMale_128x256x256_u8.pvm");
    let small_grid = Limits { grid_bytes: 1 << 20, ..Limits::default() };
    let error = format::load(&path, &ImportOptions::default(), &small_grid, &()).unwrap_err();
    assert!(matches!(error, FormatError::Grid(_)), "{error}");
    assert!(error.to_string().contains("allowed for grids"), "{error}");
    let few_colours = Limits { colour_bytes: 2 << 20, ..Limits::default() };
    let grey = ImportOptions { colouring: Colouring::Grey, ..ImportOptions::default() };
    let error = format::load(&path, &grey, &few_colours, &()).unwrap_err();
    let FormatError::OverBudget(over) = error else { panic!("{error}") };
    assert_eq!((over.budget, over.budget_mib), (MemoryBudget::Colours, 2));
    // The same limits suffice for a sculpture of one colour.
    let plain = ImportOptions { colouring: Colouring::None, ..ImportOptions::default() };
    format::load(&path, &plain, &few_colours, &()).unwrap();
}

#[test]
fn densities_have_the_base_colour_unless_grey_is_requested() {
    for name in ["derived/VisMale_128x256x256_u8.pvm", "derived/CraniumCT_128x128x108_u16.pvm"] {
        let path = shared_volume(name);
        let Contents { grid, material, .. } = load_plainly(&path);
        assert_eq!((material.page_count(), material.depth()), (0, ColourDepth::Bits24), "{name}");
        let grey = ImportOptions { colouring: Colouring::Grey, ..ImportOptions::default() };
        let shades = load(&path, &grey).unwrap().contents;
        assert_eq!(shades.grid, grid, "{name}");
        assert!(shades.material.page_count() > 0, "{name}");
    }
}

prop_compose! {
    /// Returns a sculpture of random boxes, as after loading: voxels that do not exist have the base colour, and pages
    /// exist only where they are needed.
    fn sculptures()(
        dims in prop::array::uniform3(1u32..30),
        size in prop_oneof![
            Just(Vec3::ONE),
            prop::array::uniform3(1e-3f32..1e3).prop_map(Vec3::from),
        ],
        depth in prop::sample::select(&ColourDepth::ALL[..]),
        base: [u8; 3],
        boxes in prop::collection::vec(
            (prop::array::uniform3(0u32..30), prop::array::uniform3(1u32..20),
             prop_oneof![Just([0; 3]), any::<[u8; 3]>()], 0u32..4), 0..8),
    ) -> Contents {
        let dims = UVec3::from(dims);
        let mut grid = Grid::new(dims, size, ROOM).unwrap();
        let mut material = Material::for_grid(&grid, depth, Rgb(base));
        for (corner, extent, colour, kind) in boxes {
            let end = (UVec3::from(corner) + UVec3::from(extent)).min(dims);
            for z in corner[2]..end.z { for y in corner[1]..end.y { for x in corner[0]..end.x {
                let v = UVec3::new(x, y, z);
                let mut one = Brick::EMPTY;
                one.set(x & 7, y & 7, z & 7, true);
                // Kind 0 removes, 1 adds uniformly, the others add with a pattern.
                let shift = if kind > 1 { (x * kind) as u8 } else { 0 };
                let colour = colour.map(|c: u8| c.wrapping_add(shift));
                grid.set(v.as_ivec3(), kind > 0);
                if kind > 0 { material.paint(v / 8, &one, Rgb(colour)); }
            } } }
        }
        canonical(&Contents::new(grid, material))
    }
}

/// Returns the same sculpture without anything invisible.
fn canonical(contents: &Contents) -> Contents {
    let Contents { grid, material, .. } = contents;
    let mut visible = Material::for_grid(grid, material.depth(), material.base());
    for (b, brick) in grid.nonempty_bricks() {
        let index = grid.brick_index(b);
        let b = grid.brick_coords(index);
        let differs = |local| material.rgb(b, local) != material.base();
        let mut any = false;
        brick.for_each(|local| any |= differs(local));
        if any {
            visible.paint_each(b, brick, |local| material.rgb(b, local));
        }
    }
    Contents::new(grid.clone(), visible)
}

fn round_trip(contents: &Contents, form: ExportForm) -> Contents {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sculpture.pvm");
    format::save(&path, contents, form, &()).unwrap();
    load_plainly(&path)
}

proptest! {
    #[test]
    fn a_saved_sculpture_loads_identical(contents in sculptures()) {
        prop_assert_eq!(&round_trip(&contents, ExportForm::Auto), &contents);
        prop_assert_eq!(&round_trip(&contents, ExportForm::Rgba), &contents);
    }

    #[test]
    fn packed_colours_load_identical_but_for_black(contents in sculptures()) {
        prop_assume!(contents.material.depth() != ColourDepth::None);
        let back = round_trip(&contents, ExportForm::Packed);
        prop_assert_eq!(&back.grid, &contents.grid);
        prop_assert_eq!(back.material.depth(), contents.material.depth());
        let black = Rgb::new(0, 0, 0);
        let instead = match contents.material.depth() {
            ColourDepth::Bits8 => Rgb::new(0, 17, 0),
            ColourDepth::Bits16 => Rgb::new(0, 2, 0),
            _ => Rgb::new(0, 0, 1),
        };
        for (b, brick) in contents.grid.nonempty_bricks() {
            let index = contents.grid.brick_index(b);
            brick.for_each(|local| {
                let was = contents.material.rgb(contents.grid.brick_coords(index), local);
                let is = back.material.rgb(back.grid.brick_coords(index), local);
                assert_eq!(is, if was == black { instead } else { was });
            });
        }
    }

    #[test]
    fn densities_for_other_programs_are_zero_or_full(contents in sculptures()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sculpture.pvm");
        format::save(&path, &contents, ExportForm::Densities, &()).unwrap();
        let (options, limits) = (ImportOptions::default(), Limits::default());
        let volume = format::load_volume(&path, &options, &limits, &()).unwrap();
        prop_assert_eq!(volume.samples, Samples::U8);
        for (i, &density) in volume.data.iter().enumerate() {
            let exists = contents.grid.get(contents.grid.voxel_coords(i as u32).as_ivec3());
            prop_assert_eq!(density, if exists { 255 } else { 0 });
        }
        let back = load_plainly(&path);
        prop_assert_eq!(&back.grid, &contents.grid);
        prop_assert_eq!(back.material.base(), contents.material.base());
    }

    #[test]
    fn raw_files_hold_the_same_voxels(contents in sculptures()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("Sculpture.RAW");
        format::save(&path, &contents, ExportForm::Rgba, &()).unwrap();
        let layout = RawLayout {
            dims: contents.grid.dims(),
            samples: Samples::Rgba8,
            skip_bytes: 0,
            voxel_size: contents.grid.voxel_size(),
        };
        let options = ImportOptions { raw: Some(layout), ..ImportOptions::default() };
        let back = load(&path, &options).unwrap().contents;
        prop_assert_eq!(&back.grid, &contents.grid);
        for (b, brick) in contents.grid.nonempty_bricks() {
            let index = contents.grid.brick_index(b);
            brick.for_each(|local| assert_eq!(
                back.material.rgb(back.grid.brick_coords(index), local),
                contents.material.rgb(contents.grid.brick_coords(index), local)
            ));
        }
    }
}

#[test]
fn all_raw_types_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ramp.raw");
    // A ramp from -60 to 60 along x if the type is signed, else from 0 to 120.
    let ramp = |signed: bool| (0..=120).map(move |i| if signed { i - 60 } else { i });
    let write = |bytes: Vec<u8>| std::fs::write(&path, bytes).unwrap();
    for (samples, _) in Samples::NAMED {
        let signed =
            matches!(samples, Samples::I16Le | Samples::I16Be | Samples::F32Le | Samples::F32Be);
        write(
            std::iter::repeat_n(0xEE, 3)
                .chain(ramp(signed).flat_map(|v: i32| match samples {
                    Samples::U8 => vec![v as u8],
                    Samples::U16Le => (v as u16).to_le_bytes().to_vec(),
                    Samples::U16Be => (v as u16).to_be_bytes().to_vec(),
                    Samples::I16Le => (v as i16).to_le_bytes().to_vec(),
                    Samples::I16Be => (v as i16).to_be_bytes().to_vec(),
                    Samples::F32Le => (v as f32).to_le_bytes().to_vec(),
                    Samples::F32Be => (v as f32).to_be_bytes().to_vec(),
                    Samples::Rgb8 => vec![0, v as u8, 0],
                    _ => vec![9, 9, 9, v as u8],
                }))
                .collect(),
        );
        let raw = format!("121x1x1:{samples}:skip=3:size=1,1,2").parse().unwrap();
        let threshold = if signed { 10.5 } else { 70.5 };
        let options = ImportOptions {
            existence: Existence::Threshold(threshold),
            raw: Some(raw),
            ..ImportOptions::default()
        };
        let grid = load(&path, &options).unwrap().contents.grid;
        assert_eq!(grid.voxel_size().z, 2.0);
        for x in 0..121 {
            assert_eq!(grid.get(IVec3::new(x, 0, 0)), x > 70, "{samples} {x}");
        }
        let longer = format!("122x1x1:{samples}:skip=3").parse().unwrap();
        let error = load(&path, &ImportOptions { raw: Some(longer), ..options }).unwrap_err();
        let (expected, found) = (3 + 122 * samples.bytes(), 3 + 121 * samples.bytes());
        let message = error.to_string();
        assert!(
            message.contains(&format!("{expected} bytes"))
                && message.contains(&format!("has {found}")),
            "{message}"
        );
    }
    let nan = [f32::NAN, 1.0, f32::INFINITY, f32::NEG_INFINITY, 2.0, 9.0];
    write(nan.into_iter().flat_map(f32::to_le_bytes).collect());
    let options = ImportOptions {
        raw: Some("6x1x1:f32le".parse().unwrap()),
        existence: Existence::Threshold(2.0),
        ..ImportOptions::default()
    };
    let grid = load(&path, &options).unwrap().contents.grid;
    let exists: Vec<bool> = (0..6).map(|x| grid.get(IVec3::new(x, 0, 0))).collect();
    assert_eq!(exists, [false, false, true, false, true, true]);
}

#[test]
fn file_extensions_choose_the_format_or_are_explained() {
    let grid = Grid::new(UVec3::ONE, Vec3::ONE, ROOM).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::None, Rgb::STONE);
    let contents = Contents::new(grid, material);
    let folder = tempfile::tempdir().unwrap();
    for (name, part) in [("a.kv6", "`.kv6`"), ("a", "no extension")] {
        let path = folder.path().join(name);
        for error in [
            format::save(&path, &contents, ExportForm::Auto, &()).unwrap_err(),
            load(&path, &ImportOptions::default()).unwrap_err(),
        ] {
            let message = error.to_string();
            assert!(message.contains(part) && message.contains(".pvm"), "{message}");
        }
        assert!(!path.exists());
    }
    let raw = folder.path().join("a.raw");
    format::save(&raw, &contents, ExportForm::Auto, &()).unwrap();
    let message = load(&raw, &ImportOptions::default()).unwrap_err().to_string();
    assert!(message.contains("u16le"), "{message}");
    let packed = format::save(&raw, &contents, ExportForm::Packed, &()).unwrap_err();
    assert!(matches!(packed, FormatError::NoColours));
    let missing = load(&folder.path().join("none.pvm"), &ImportOptions::default()).unwrap_err();
    assert!(missing.to_string().contains("No such file"), "{missing}");
}

#[test]
fn texts_travel_with_the_sculpture() {
    let path = shared_volume("pvm/Neghip.pvm");
    let loaded = load(&path, &ImportOptions::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy.pvm");
    let (plain, texts) = (ExportForm::Auto.into(), loaded.texts.clone());
    format::save_with(&copy, &loaded.contents, &plain, texts, &Limits::default(), &()).unwrap();
    let again = load(&copy, &ImportOptions::default()).unwrap();
    assert_eq!(again.contents, loaded.contents);
    assert_eq!(again.texts.description, loaded.texts.description);
    assert_eq!(again.texts.comment, loaded.texts.comment);
    let parameter = Texts::legible(&again.texts.parameter);
    assert!(parameter.starts_with("virtual-sculpture 1 "), "{parameter}");
    assert!(parameter.ends_with(&Texts::legible(&loaded.texts.parameter)), "{parameter}");
    let info = format::info(&copy).unwrap().to_string();
    assert!(info.contains("description: Neghip") && info.contains("24 bits of colour"), "{info}");
}

#[test]
fn a_parameter_line_that_does_not_match_is_ignored() {
    let path = shared_volume("pvm/Bucky.pvm");
    let foreign = load(&path, &ImportOptions::default()).unwrap();
    // The densities of another program, with a line that claims packed colours of 16 bits.
    let volume =
        format::load_volume(&path, &ImportOptions::default(), &Limits::default(), &()).unwrap();
    let header = b"PVM3\n32 32 32\n1 1 1\n1\n";
    let texts = b"\0\0virtual-sculpture 1 form=packed colour_bits=16 base=#000000\0\0";
    let folder = tempfile::tempdir().unwrap();
    let forged = folder.path().join("forged.pvm");
    std::fs::write(&forged, [&header[..], &volume.data, texts].concat()).unwrap();
    assert_eq!(load_plainly(&forged), foreign.contents);
}
