//! Tests `convert` between any two formats: a small coloured shape in every readable format is converted to every
//! writable format, and the preserved properties are those in docs/formats.md. Also tests names that do not match the
//! content.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::format::options::{
    ExportForm, ExportOptions, ImportOptions, MeshSize, RawLayout,
};
use sculpture_core::format::{
    self, FormatError, Loaded, READ_ENDINGS, Samples, Texts, WRITE_ENDINGS,
};
use sculpture_core::mesh::MeshKind;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::orientation::Up;
use sculpture_core::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};
use tempfile::TempDir;
use trials::shared_file;

const DIMS: UVec3 = UVec3::new(8, 6, 5);
const VOXEL_MM: f32 = 0.5;
const RED: Rgb = Rgb([255, 0, 0]);
const BLUE: Rgb = Rgb([0, 0, 255]);

/// Returns whether a voxel exists: a block with a step, which looks different from all sides.
fn exists(v: UVec3) -> bool {
    v.cmplt(DIMS).all() && (v.y < 2 || v.x < 3 && (v.y < 4 || v.z < 2))
}

fn colour(v: UVec3) -> Rgb {
    if v.x < 4 { RED } else { BLUE }
}

fn all() -> impl Iterator<Item = UVec3> {
    (0..DIMS.element_product())
        .map(|i| UVec3::new(i % DIMS.x, i / DIMS.x % DIMS.y, i / DIMS.x / DIMS.y))
}

pub fn shape() -> Contents {
    let mut grid = Grid::new(DIMS, Vec3::splat(VOXEL_MM), 1 << 30).unwrap();
    all().filter(|v| exists(*v)).for_each(|v| grid.set(v.as_ivec3(), true));
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    for v in all().filter(|v| exists(*v)) {
        let mut mask = Brick::EMPTY;
        mask.set(v.x % 8, v.y % 8, v.z % 8, true);
        material.paint(v / 8, &mask, colour(v));
    }
    Contents::new(grid, material)
}

pub fn options(path: &Path) -> ImportOptions {
    let layout =
        RawLayout { dims: DIMS, samples: Samples::Rgba8, skip_bytes: 0, voxel_size: Vec3::ONE };
    let is_raw = path.extension().is_some_and(|ending| ending == "raw");
    ImportOptions {
        raw: is_raw.then_some(layout),
        mesh_size: MeshSize::LongestVx(8),
        ..Default::default()
    }
}

fn load(path: &Path) -> Result<Loaded, FormatError> {
    format::load(path, &options(path), &Limits::default(), &())
}

fn save(path: &Path, contents: &Contents) -> Result<Vec<String>, FormatError> {
    save_as(path, contents, ExportForm::Auto.into())
}

fn save_as(
    path: &Path,
    contents: &Contents,
    options: ExportOptions,
) -> Result<Vec<String>, FormatError> {
    let texts = Texts { description: b"a step".to_vec(), ..Texts::default() };
    format::save_with(path, contents, &options, texts, &Limits::default(), &())
}

/// Returns files with the shape in the formats that this program does not write.
fn foreign(folder: &TempDir) -> Vec<PathBuf> {
    let bytes: Vec<u8> = all().map(|v| if exists(v) { 255 } else { 0 }).collect();
    let rgb: Vec<u8> = all().flat_map(|v| if exists(v) { colour(v).0 } else { [0; 3] }).collect();
    let path = |name: &str| folder.path().join(name);
    let write = |name: &str, content: &[&[u8]]| {
        std::fs::write(path(name), content.concat()).unwrap();
        path(name)
    };
    let nrrd = "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 8 6 5\nkinds: RGB-color domain domain domain\n\
                encoding: raw\n";
    let detached = format!("{nrrd}data file: shape.img2\n\n");
    let vti = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\"><ImageData WholeExtent=\"0 7 0 5 0 4\" \
         Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 7 0 5 0 4\"><PointData><DataArray type=\"UInt8\" \
         Name=\"a\" format=\"ascii\">{}</DataArray></PointData></Piece></ImageData></VTKFile>",
        bytes.iter().map(u8::to_string).collect::<Vec<_>>().join(" ")
    );
    let mut nifti = vec![0u8; 352];
    nifti[..4].copy_from_slice(&348i32.to_le_bytes());
    for (i, size) in [3u16, 8, 6, 5, 1, 1, 1, 1].into_iter().enumerate() {
        nifti[40 + 2 * i..42 + 2 * i].copy_from_slice(&size.to_le_bytes());
    }
    (nifti[70], nifti[72]) = (2, 8);
    (0..4).for_each(|i| nifti[76 + 4 * i..80 + 4 * i].copy_from_slice(&1f32.to_le_bytes()));
    nifti[108..112].copy_from_slice(&352f32.to_le_bytes());
    nifti[344..348].copy_from_slice(b"n+1\0");
    let mut pair = nifti.clone();
    pair[108..112].fill(0);
    pair[344..348].copy_from_slice(b"ni1\0");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, &[nifti.clone(), bytes.clone()].concat()).unwrap();
    let packed_pair = [pair.clone(), bytes.clone()].map(|part| {
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut packed, &part).unwrap();
        packed.finish().unwrap()
    });
    let mha = "ObjectType = Image\nNDims = 3\nDimSize = 8 6 5\nElementType = MET_UCHAR\n\
               ElementSpacing = 1 1 1\nElementDataFile = ";
    let vtk = "# vtk DataFile Version 3.0\n\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 8 6 5\n\
               SPACING 1 1 1\nPOINT_DATA 240\nSCALARS a unsigned_char\nLOOKUP_TABLE default\n";
    let mut tiff = Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut tiff).unwrap();
    for page in bytes.chunks(48) {
        encoder.write_image::<tiff::encoder::colortype::Gray8>(8, 6, page).unwrap();
    }
    let tiff = tiff.into_inner();
    let mut picture = image::RgbaImage::new(64, 64);
    for v in all().filter(|v| exists(*v)) {
        let i = v.x + 16 * (v.y + 16 * v.z);
        let [r, g, b] = colour(v).0;
        picture.put_pixel(i % 64, i / 64, image::Rgba([r, g, b, 255]));
    }
    let mut png = Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let png = png.into_inner();
    let (one, zero) = (1u32.to_le_bytes(), [0u8; 4]);
    let layer = [one, zero, zero, zero, zero, zero].concat();
    let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
    // x is slowest, then z, then y.
    let order =
        (0..8).flat_map(|x| (0..5).flat_map(move |z| (0..6).map(move |y| UVec3::new(x, y, z))));
    let runs: Vec<u8> = order.flat_map(|v| [u8::from(exists(v)), 1]).collect();
    write("shape.img", &[&bytes]);
    write("shape.img2", &[&rgb]);
    write("packed.img.gz", &[&packed_pair[1]]);
    write("mhd.img", &[&bytes]);
    vec![
        write("shape.nii", &[&nifti, &bytes]),
        write("shape.nii.gz", &[&packed.finish().unwrap()]),
        write("shape.hdr", &[&pair[..348], &[0; 4]]),
        write("shape.nrrd", &[nrrd.as_bytes(), b"\n", &rgb]),
        write("shape.nhdr", &[detached.as_bytes()]),
        write("packed.hdr.gz", &[&packed_pair[0]]),
        write("shape.mha", &[mha.as_bytes(), b"LOCAL\n", &bytes]),
        write("shape.mhd", &[mha.as_bytes(), b"mhd.img\n"]),
        write("shape.vti", &[vti.as_bytes()]),
        write("shape.vtk", &[vtk.as_bytes(), &bytes]),
        write("shape.tif", &[&tiff]),
        write("shape.tiff", &[&tiff]),
        write("shape.dcm", &[&dicom(&bytes)]),
        write("shape.dicom", &[&dicom(&bytes)]),
        write(
            "shape.gox",
            &[
                b"GOX \x02\0\0\0BL16",
                &length(&png),
                &png,
                &zero,
                b"LAYR",
                &length(&layer),
                &layer,
                &zero,
            ],
        ),
        write("shape.binvox", &[b"#binvox 1\ndim 8 5 6\ntranslate 0 0 0\nscale 1\ndata\n", &runs]),
    ]
}

/// Returns a file of five frames.
fn dicom(bytes: &[u8]) -> Vec<u8> {
    let mut out =
        [&[0; 128][..], b"DICM", &[2, 0, 0x10, 0], b"UI", &[20, 0], b"1.2.840.10008.1.2.1\0"]
            .concat();
    let mut add = |element: u16, vr: &[u8; 2], value: &[u8]| {
        out.extend(
            [
                &[0x28, 0][..],
                &element.to_le_bytes(),
                vr,
                &(value.len() as u16).to_le_bytes(),
                value,
            ]
            .concat(),
        );
    };
    add(0x02, b"US", &[1, 0]);
    add(0x04, b"CS", b"MONOCHROME2 ");
    add(0x08, b"IS", b"5 ");
    for (element, value) in [(0x10, 6), (0x11, 8), (0x100, 8), (0x101, 8), (0x102, 7), (0x103, 0)] {
        add(element, b"US", &[value, 0]);
    }
    let length = (bytes.len() as u32).to_le_bytes();
    [&out, &[0xE0, 0x7F, 0x10, 0][..], b"OB", &[0; 2], &length, bytes].concat()
}

/// Returns a file with the shape in every format that can be read.
pub fn sources(folder: &TempDir) -> Vec<PathBuf> {
    let mut sources = foreign(folder);
    for ending in WRITE_ENDINGS.iter().filter(|ending| READ_ENDINGS.contains(ending)) {
        let path = folder.path().join("own").with_extension(ending);
        // The faces of the voxels themselves, so that no edge is rounded.
        let mut options = ExportOptions::default();
        if format::is_mesh(&path) {
            options.mesh.kind = MeshKind::Faces;
        }
        save_as(&path, &shape(), options).unwrap();
        sources.push(path);
    }
    sources.push(gltf(&folder.path().join("own.glb")));
    sources
}

/// Returns a `.glb` as a `.gltf`, with its buffer in a file beside it.
fn gltf(glb: &Path) -> PathBuf {
    let file = std::fs::read(glb).unwrap();
    let json_end = 20 + u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    std::fs::write(glb.with_extension("bin"), &file[json_end + 8..]).unwrap();
    let json = std::str::from_utf8(&file[20..json_end]).unwrap();
    let (before, buffers) = json.split_once("\"buffers\":[{").unwrap();
    let path = glb.with_extension("gltf");
    std::fs::write(&path, format!("{before}\"buffers\":[{{\"uri\":\"own.bin\",{buffers}")).unwrap();
    path
}

/// Returns the rows of the table of docs/formats.md that begins with that line, by the endings in their first column.
fn documented(heading: &str) -> Vec<(String, Vec<String>)> {
    let docs = include_str!("../../docs/formats.md");
    let rows = docs
        .split_once(heading)
        .unwrap()
        .1
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let mut table = Vec::new();
    for row in rows {
        let cells: Vec<String> =
            row.trim_matches('|').split('|').map(|cell| cell.trim().to_string()).collect();
        for ending in cells[0].split(", ") {
            table.push((ending.trim_matches(['`', '.']).to_string(), cells[1..].to_vec()));
        }
    }
    table
}

const READ_TABLE: &str = "| read | shape | colours | size of a voxel | up | texts |";
const WRITE_TABLE: &str = "| written | shape | colours | size of a voxel | up | texts |";

#[test]
fn every_format_that_is_read_becomes_every_one_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let sources = sources(&folder);
    let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    for ending in READ_ENDINGS {
        let is_of = |path: &PathBuf| name(path).split_once('.').unwrap().1 == ending;
        assert!(sources.iter().any(is_of), ".{ending} is not tested");
    }
    for source in &sources {
        let what = name(source);
        let loaded = load(source).unwrap_or_else(|error| panic!("{what}: {error}"));
        let count = loaded.contents.grid.opaque_count();
        assert_eq!(count, all().filter(|v| exists(*v)).count() as u64, "{what}");
        for ending in WRITE_ENDINGS {
            let target = folder.path().join("target").with_extension(ending);
            save(&target, &loaded.contents)
                .unwrap_or_else(|error| panic!("{what} to {ending}: {error}"));
            let again = load(&target).unwrap_or_else(|error| panic!("{what} to {ending}: {error}"));
            assert!(!again.notes.iter().any(|note| note.contains("is named")), "{:?}", again.notes);
            let is_mesh = format::is_mesh(&target);
            let expected = loaded.contents.grid.opaque_count();
            if !is_mesh && ending != "raw" {
                assert_eq!(again.contents.grid.opaque_count(), expected, "{what} to {ending}");
            } else if is_mesh {
                // A smooth surface rounds edges.
                let share = again.contents.grid.opaque_count() as f64 / expected as f64;
                assert!((0.5..1.5).contains(&share), "{what} to {ending}: {share}");
            }
        }
    }
}

#[test]
fn written_files_keep_what_the_table_says() {
    let folder = tempfile::tempdir().unwrap();
    let table = documented(WRITE_TABLE);
    let endings: Vec<&str> = table.iter().map(|(ending, _)| ending.as_str()).collect();
    assert_eq!(endings, WRITE_ENDINGS);
    for (ending, cells) in
        table.iter().filter(|(ending, _)| READ_ENDINGS.contains(&ending.as_str()))
    {
        let path = folder.path().join("shape").with_extension(ending);
        save(&path, &shape()).unwrap();
        let Loaded { contents, texts, assumed_up, .. } = load(&path).unwrap();
        let Contents { grid, .. } = &contents;
        let is_same = grid.dims() == DIMS && all().all(|v| grid.get(v.as_ivec3()) == exists(v));
        let says = |cell: usize, word: &str| cells[cell].starts_with(word);
        assert_eq!(is_same, says(0, "exact"), ".{ending}: shape");
        let near = |a: Rgb, b: Rgb| (0..3).all(|i| a.0[i].abs_diff(b.0[i]) < 60);
        let corner = |x: u32| contents.rgb(UVec3::new(x, 0, 0));
        if grid.get(IVec3::ZERO) {
            let is_coloured = near(corner(0), RED);
            assert_eq!(is_coloured, !says(1, "no"), ".{ending}: colours");
        }
        let is_sized = (grid.voxel_size() - VOXEL_MM).abs().max_element() < 1e-6;
        if !format::is_mesh(&path) {
            assert_eq!(is_sized, says(2, "yes"), ".{ending}: size");
        }
        assert_eq!(texts.description == b"a step", says(4, "yes"), ".{ending}: texts");
        let up = match cells[3].as_str() {
            "yes" => None,
            "z" => Some(Up::Z),
            "y" if ending == "glb" => None,
            _ => Some(Up::Y),
        };
        assert_eq!(assumed_up, up, ".{ending}: up");
    }
    let read = documented(READ_TABLE);
    let mut endings: Vec<&str> = read.iter().map(|(ending, _)| ending.as_str()).collect();
    for source in sources(&folder) {
        let name = source.file_name().unwrap().to_string_lossy().into_owned();
        let (_, cells) =
            read.iter().find(|(own, _)| name.split_once('.').unwrap().1 == own).unwrap();
        let is_asked = load(&source).unwrap().assumed_up.is_some();
        match cells[3].as_str() {
            "asked" => assert!(is_asked, "{name}"),
            "of the patient" => {}
            _ => assert!(!is_asked, "{name}"),
        }
    }
    let mut known = READ_ENDINGS.to_vec();
    endings.sort_unstable();
    known.sort_unstable();
    assert_eq!(endings, known);
}

#[test]
fn scans_and_models_keep_what_the_table_says() {
    let folder = tempfile::tempdir().unwrap();
    let table = documented(READ_TABLE);
    for path in foreign(&folder) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let ending = name.split_once('.').unwrap().1;
        let (_, cells) = table.iter().find(|(own, _)| own == ending).unwrap();
        let Loaded { contents, .. } = load(&path).unwrap();
        let voxels = || {
            contents.grid.nonempty_bricks().flat_map(|(at, brick)| {
                let mut all = Vec::new();
                brick.for_each(|local| {
                    all.push(
                        at * 8 + UVec3::from(sculpture_core::sculpture::brick::local_coords(local)),
                    )
                });
                all
            })
        };
        let has = |rgb: Rgb| voxels().any(|v| contents.rgb(v) == rgb);
        assert_eq!(has(RED) && has(BLUE), cells[1].starts_with("yes"), ".{ending}: colours");
    }
}

#[test]
fn the_content_decides_where_the_name_says_something_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let shape = shape();
    for ending in ["vsc", "pvm", "vox", "ply", "glb"] {
        let (own, other) = (path("own").with_extension(ending), path("other.nrrd"));
        save(&own, &shape).unwrap();
        std::fs::copy(&own, &other).unwrap();
        let [own, loaded] = [load(&own), load(&other)].map(|loaded| loaded.unwrap());
        assert_eq!(own.contents.grid.opaque_count(), loaded.contents.grid.opaque_count());
        let note = &loaded.notes[0];
        assert!(note.contains("named as an NRRD scan") && note.contains(ending), "{note}");
        assert_eq!(format::info(&other).unwrap().notes.first(), Some(note), "{ending}");
        let without = path("without");
        std::fs::rename(&other, &without).unwrap();
        assert!(format::can_be_read(&without));
        assert_eq!(load(&without).unwrap().notes, own.notes);
    }
    for ending in ["nii", "nii.gz"] {
        let named = path("scan.stl");
        let scan =
            foreign(&folder).into_iter().find(|file| file.ends_with(format!("shape.{ending}")));
        std::fs::rename(scan.unwrap(), &named).unwrap();
        assert!(load(&named).unwrap().notes[0].contains("holds a NIfTI scan"));
    }
    image::RgbImage::new(4, 4)
        .save_with_format(path("picture.stl"), image::ImageFormat::Png)
        .unwrap();
    let error = load(&path("picture.stl")).unwrap_err().to_string();
    assert!(error.contains("a PNG image"), "{error}");
    std::fs::write(path("pointer.nii.gz"), "version https://git-lfs.github.com/spec/v1\n").unwrap();
    let error = load(&path("pointer.nii.gz")).unwrap_err().to_string();
    assert!(error.contains("git lfs pull"), "{error}");
    assert!(
        !format::can_be_read(&path("picture.stl")) && !format::can_be_read(&path("missing.txt"))
    );
}

#[test]
fn real_files_are_what_their_names_say() {
    for name in [
        "nrrd/BallBinary30x30x30_gz.nrrd",
        "nifti/standard.nii.gz",
        "mesh/vengi_ascii.stl",
        "mesh/nut.ply",
        "voxel/rgb.vox",
    ] {
        let info = format::info(&shared_file(&format!("data/{name}"))).unwrap();
        assert!(
            !info.notes.iter().any(|note| note.contains("is named")),
            "{name}: {:?}",
            info.notes
        );
    }
}
