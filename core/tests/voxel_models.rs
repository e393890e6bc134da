//! Files of other voxel editors through the public interface: real ones have the expected contents, and written ones
//! read back.

use std::path::Path;

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::format::options::{Colouring, ExportForm, ImportOptions};
use sculpture_core::format::{self, FormatError, Loaded};
use sculpture_core::scenes;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{ColourDepth, Grid, Limits, Material, Rgb};
use trials::shared_file;

fn load_with(path: &Path, options: &ImportOptions) -> Result<Loaded, FormatError> {
    format::load(path, options, &Limits::default(), &())
}

fn load(path: &Path) -> Contents {
    load_with(path, &ImportOptions::default()).unwrap_or_else(|e| panic!("{path:?}: {e}")).contents
}

fn shared(name: &str) -> Contents {
    load(&shared_file(&format!("data/{name}")))
}

fn voxels(contents: &Contents) -> Vec<(UVec3, Rgb)> {
    let mut voxels = Vec::new();
    for (at, brick) in contents.grid.nonempty_bricks() {
        brick.for_each(|local| {
            let v = at * 8 + UVec3::from(sculpture_core::sculpture::brick::local_coords(local));
            voxels.push((v, contents.rgb(v)));
        });
    }
    voxels
}

/// Returns the voxels of colours, counted from the lowest corner of the box around them.
fn from_corner(contents: &Contents) -> Vec<(UVec3, Rgb)> {
    let (low, _) = contents.grid.opaque_bounds().unwrap();
    let mut all: Vec<_> = voxels(contents).into_iter().map(|(v, rgb)| (v - low, rgb)).collect();
    all.sort_unstable_by_key(|(v, _)| v.to_array());
    all
}

fn contents_of(dims: UVec3, depth: ColourDepth, voxels: &[(IVec3, Rgb)]) -> Contents {
    let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
    voxels.iter().for_each(|(v, _)| grid.set(*v, true));
    let mut material = Material::for_grid(&grid, depth, Rgb::STONE);
    for (v, rgb) in voxels {
        let mut mask = sculpture_core::sculpture::Brick::EMPTY;
        let local = v.as_uvec3() % 8;
        mask.set(local.x, local.y, local.z, true);
        material.paint(v.as_uvec3() / 8, &mask, *rgb);
    }
    Contents::new(grid, material)
}

/// Asserts that the grids and the colour of each voxel are the same.
fn assert_same(found: &Contents, expected: &Contents) {
    assert_eq!(found.grid, expected.grid);
    assert_eq!(voxels(found), voxels(expected));
}

#[test]
fn real_models_hold_what_they_should() {
    for (name, dims, count) in [
        ("8ontop.vox", None, None),
        ("animation.0.99.7.1.vox", Some([40, 40, 40]), Some(9911)),
        ("crabby.vox", None, Some(100)),
        ("cubictest.vox", Some([144, 23, 135]), Some(73)),
        ("dotvox_axes.vox", None, None),
        ("dotvox_placeholder.vox", Some([2, 2, 2]), Some(4)),
        ("dotvox_placeholder-with-materials.vox", Some([2, 2, 2]), Some(4)),
        ("magicavoxel.vox", Some([20, 20, 21]), Some(398)),
        ("rgb.vox", Some([32, 32, 32]), Some(99)),
        ("robo.vox", None, Some(186 + 63 + 1042)),
        ("slab6_vox_test.vox", Some([39, 43, 13]), None),
        ("splitobjects.vox", Some([40, 40, 40]), Some(17208)),
        ("vox_character.vox", None, None),
        ("chr_knight.qb", None, None),
        ("qubicle.qb", None, None),
        ("rgb.qb", Some([32, 32, 32]), Some(99)),
        ("robo.qb", None, Some(186 + 63 + 1042)),
        ("test.binvox", Some([128, 128, 128]), None),
    ] {
        let contents = shared(&format!("voxel/{name}"));
        let found = contents.grid.opaque_count();
        assert!(found > 0, "{name}");
        assert!(dims.is_none_or(|d| contents.grid.dims() == UVec3::from(d)), "{name}");
        assert!(count.is_none_or(|n| n == found), "{name}: {found}");
        let info = format::info(&shared_file(&format!("data/voxel/{name}"))).unwrap();
        assert_eq!(info.dims, contents.grid.dims(), "{name}");
        trials::note!("{name}: {} {} {found}", info.kind, info.dims);
    }
    let error = load_with(&shared_file("data/voxel/dotvox_not_a.vox"), &Default::default());
    assert!(error.unwrap_err().to_string().contains("MagicaVoxel"));
}

/// Volumes with the same voxel indices as the models: z of the file becomes y, and y points away from the viewer.
#[test]
fn models_equal_the_volumes_made_of_the_same_thing() {
    for (model, volume) in [
        ("derived/frog_125x118x68.vox", "derived/frog_rgba_125x118x68.pvm"),
        ("derived/spot96.vox", "derived/spot96_rgba.pvm"),
    ] {
        let (model, volume) = (shared(model), shared(volume));
        let dims = volume.grid.dims();
        assert_eq!(model.grid.dims(), UVec3::new(dims.x, dims.z, dims.y));
        let turned = |v: UVec3| UVec3::new(v.x, v.z, dims.y - 1 - v.y);
        let mut expected: Vec<_> = voxels(&volume).into_iter().map(|(v, _)| turned(v)).collect();
        let mut found: Vec<_> = voxels(&model).into_iter().map(|(v, _)| v).collect();
        expected.sort_unstable_by_key(|v| v.to_array());
        found.sort_unstable_by_key(|v| v.to_array());
        assert!(found == expected);
    }
}

#[test]
fn one_thing_in_two_formats_is_the_same() {
    assert_eq!(
        from_corner(&shared("voxel/rgb.vox")).len(),
        from_corner(&shared("voxel/rgb.qb")).len()
    );
    let folder = tempfile::tempdir().unwrap();
    let original = shared("voxel/vox_character.vox");
    for ending in ["vox", "qb", "vsc"] {
        let path = folder.path().join("a").with_extension(ending);
        format::save(&path, &original, ExportForm::Auto, &()).unwrap();
        assert_same(&load(&path), &original);
    }
}

#[test]
fn large_grids_are_split_and_put_together_again() {
    let folder = tempfile::tempdir().unwrap();
    let dims = UVec3::new(517, 261, 300);
    let colour = |i: i32| Rgb::new((i * 13) as u8, (i * 7) as u8, 5);
    let places =
        [[0, 3, 4], [255, 0, 0], [256, 9, 299], [516, 260, 299], [300, 258, 43], [300, 258, 44]];
    let voxels: Vec<_> = (1..).zip(places).map(|(i, v)| (IVec3::from(v), colour(i))).collect();
    let contents = contents_of(dims, ColourDepth::Bits24, &voxels);
    for name in ["a.vox", "a.qb"] {
        let path = folder.path().join(name);
        format::save(&path, &contents, ExportForm::Auto, &()).unwrap();
        assert_same(&load(&path), &contents);
    }
    let info = format::info(&folder.path().join("a.vox")).unwrap();
    assert!(info.kind.contains("models: 4"), "{}", info.kind);
    // Without voxels, the size is kept, too.
    let empty = contents_of(dims, ColourDepth::None, &[]);
    let path = folder.path().join("empty.vox");
    format::save(&path, &empty, ExportForm::Auto, &()).unwrap();
    assert_eq!(load(&path).grid, empty.grid);
}

#[test]
fn many_colours_become_255_that_are_close() {
    let folder = tempfile::tempdir().unwrap();
    let voxels: Vec<_> = (0..4096)
        .map(|i| {
            (
                IVec3::new(i % 16, i / 16 % 16, i / 256),
                Rgb([i % 16, i / 16 % 16, i / 256].map(|v| (v * 17) as u8)),
            )
        })
        .collect();
    let contents = contents_of(UVec3::splat(16), ColourDepth::Bits24, &voxels);
    let path = folder.path().join("many.vox");
    let write = |path: &Path, contents: &Contents| {
        let (plain, limits) = (ExportForm::Auto.into(), Limits::default());
        format::save_with(path, contents, &plain, Default::default(), &limits, &()).unwrap()
    };
    let told = write(&path, &contents);
    assert_eq!(told, ["4096 colours were reduced to the 255 that .vox has room for"]);
    let found = load(&path);
    assert_eq!(found.grid, contents.grid);
    let mut used: Vec<_> = voxels.iter().map(|(v, _)| found.rgb(v.as_uvec3()).0).collect();
    let error = voxels.iter().map(|(v, rgb)| {
        let found = found.rgb(v.as_uvec3());
        (0..3).map(|c| (f64::from(rgb.0[c]) - f64::from(found.0[c])).abs()).sum::<f64>()
    });
    let mean = error.sum::<f64>() / 3.0 / voxels.len() as f64;
    used.sort_unstable();
    used.dedup();
    assert!(used.len() > 200 && used.len() <= 255 && mean < 14.0, "{} {mean}", used.len());
    // Colours that have been reduced once are exact from then on.
    let again = folder.path().join("again.vox");
    assert!(write(&again, &found).is_empty());
    assert_same(&load(&again), &found);
}

#[test]
fn colours_follow_the_options() {
    let path = shared_file("data/voxel/vox_character.vox");
    let options = ImportOptions { colouring: Colouring::None, ..ImportOptions::default() };
    let plain = load_with(&path, &options).unwrap().contents;
    assert_eq!(plain.material.depth(), ColourDepth::None);
    let depth = Some(ColourDepth::Bits8);
    let options = ImportOptions { colour_depth: depth, ..ImportOptions::default() };
    let coarse = load_with(&path, &options).unwrap().contents;
    for (v, rgb) in voxels(&load(&path)) {
        assert_eq!(coarse.rgb(v), ColourDepth::Bits8.quantise(rgb));
    }
    let options = ImportOptions { colouring: Colouring::Grey, ..ImportOptions::default() };
    assert!(load_with(&path, &options).is_err());
    let limits = Limits { colour_bytes: 100, ..Limits::default() };
    let error = format::load(&path, &ImportOptions::default(), &limits, &()).unwrap_err();
    assert!(matches!(error, FormatError::OverBudget(_)), "{error}");
}

#[test]
fn other_forms_and_formats_are_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let grid = scenes::cheese(16, 3, 1).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::None, Rgb::STONE);
    let contents = Contents::new(grid, material);
    let save = |name: &str, form| format::save(&folder.path().join(name), &contents, form, &());
    assert!(matches!(save("a.vox", ExportForm::Rgba), Err(FormatError::FormOfModel { .. })));
    assert!(matches!(save("a.gox", ExportForm::Auto), Err(FormatError::ReadOnly(_))));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Returns a chunk of a Goxel file.
fn gox_chunk(id: &[u8; 4], content: &[u8]) -> Vec<u8> {
    [&id[..], &(content.len() as u32).to_le_bytes(), content, &[0; 4]].concat()
}

fn png(pixels: image::RgbaImage) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    pixels.write_to(&mut file, image::ImageFormat::Png).unwrap();
    file.into_inner()
}

#[test]
fn goxel_blocks_stand_where_layers_say() {
    let words = |words: &[i32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    let mut pixels = image::RgbaImage::new(64, 64);
    // Voxels (1, 2, 3) and (15, 15, 15) of the block; one too faint.
    for (v, colour) in
        [([1, 2, 3], [9, 8, 7, 255]), ([15, 15, 15], [1, 2, 3, 128]), ([4, 4, 4], [5, 5, 5, 90])]
    {
        let i: u32 = v[0] + 16 * v[1] + 256 * v[2];
        pixels.put_pixel(i % 64, i / 64, image::Rgba(colour));
    }
    let visible = |on: u8| [&words(&[7])[..], b"visible", &words(&[1]), &[on]].concat();
    let layer = |at: [i32; 3], on| {
        [words(&[1, 0, at[0], at[1], at[2], 0]), visible(on), words(&[0])].concat()
    };
    let file = [
        b"GOX \x02\0\0\0".to_vec(),
        gox_chunk(b"IMG ", &words(&[0])),
        gox_chunk(b"BL16", &png(pixels)),
        gox_chunk(b"LAYR", &layer([0, 0, 0], 1)),
        gox_chunk(b"LAYR", &layer([-16, 0, 0], 1)),
        gox_chunk(b"LAYR", &layer([160, 0, 0], 0)),
    ]
    .concat();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gox");
    std::fs::write(&path, &file).unwrap();
    let loaded = load_with(&path, &ImportOptions::default()).unwrap();
    assert!(loaded.notes.iter().any(|note| note.contains("1 hidden")), "{:?}", loaded.notes);
    // z becomes y, and y points away from the viewer.
    let (a, b) = (Rgb::new(9, 8, 7), Rgb::new(1, 2, 3));
    let expected = [([0, 0, 13], a), ([14, 12, 0], b), ([16, 0, 13], a), ([30, 12, 0], b)];
    let expected: Vec<_> = expected.map(|(v, rgb)| (UVec3::from(v), rgb)).into();
    assert_eq!(from_corner(&loaded.contents), expected);
    for end in 0..file.len() - 1 {
        std::fs::write(&path, &file[..end]).unwrap();
        if let Err(error) = load_with(&path, &ImportOptions::default()) {
            assert!(error.to_string().len() > 15, "{end}: {error}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// Converts our sculpture to another program's format and back.
    #[test]
    fn written_models_read_back_the_same(
        dims in prop::array::uniform3(1u32..40),
        voxels in prop::collection::vec((prop::array::uniform3(any::<prop::sample::Index>()), 0u8..=254), 0..300),
        depth in prop::sample::select(vec![ColourDepth::None, ColourDepth::Bits8, ColourDepth::Bits16, ColourDepth::Bits24]),
        ending in prop::sample::select(vec!["vox", "qb"]),
    ) {
        let dims = UVec3::from(dims);
        let place = |at: [prop::sample::Index; 3]| IVec3::from_array(std::array::from_fn(|i| at[i].index(dims[i] as usize) as i32));
        let colour = |i: u8| Rgb::new(i, i.wrapping_mul(91), i.wrapping_mul(53));
        let voxels: Vec<_> = voxels.into_iter().map(|(at, c)| (place(at), colour(c))).collect();
        let contents = contents_of(dims, depth, &voxels);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a").with_extension(ending);
        format::save(&path, &contents, ExportForm::Auto, &()).unwrap();
        assert_same(&load(&path), &contents);
    }
}
