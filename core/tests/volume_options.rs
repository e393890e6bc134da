//! Options for reading volumes: two thresholds, regions, cubic voxels, the largest piece, filled holes, labels.

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::format::options::{
    Colouring, Cubic, Existence, ExportForm, ImportOptions, ScanRegion,
};
use sculpture_core::format::{self, FormatError, Samples};
use sculpture_core::progress::ProgressReport;
use sculpture_core::refusal::{MemoryBudget, OverBudget};
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{Grid, Limits, Rgb};

/// A raw file of `dims` voxels with the densities of `of`, and the options to read it.
struct Scan {
    folder: tempfile::TempDir,
    options: ImportOptions,
}

impl Scan {
    fn new(layout: &str, of: impl Fn(UVec3) -> f32) -> Scan {
        let raw: format::options::RawLayout = layout.parse().unwrap();
        let UVec3 { x: width, y: height, .. } = raw.dims;
        let voxel = |i: u32| UVec3::new(i % width, i / width % height, i / width / height);
        let bytes = (0..raw.dims.element_product()).flat_map(|i| {
            let v = of(voxel(i));
            match raw.samples {
                Samples::U8 => vec![v as u8],
                Samples::U16Le => (v as u16).to_le_bytes().to_vec(),
                Samples::U16Be => (v as u16).to_be_bytes().to_vec(),
                Samples::I16Le => (v as i16).to_le_bytes().to_vec(),
                Samples::I16Be => (v as i16).to_be_bytes().to_vec(),
                Samples::F32Le => v.to_le_bytes().to_vec(),
                Samples::F32Be => v.to_be_bytes().to_vec(),
                _ => vec![v as u8, 100, 0],
            }
        });
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scan.raw"), bytes.collect::<Vec<u8>>()).unwrap();
        Scan { folder, options: ImportOptions { raw: Some(raw), ..ImportOptions::default() } }
    }

    fn load(&self, change: impl Fn(&mut ImportOptions)) -> Result<Contents, FormatError> {
        let mut options = self.options;
        change(&mut options);
        let path = self.folder.path().join("scan.raw");
        format::load(&path, &options, &Limits::default(), &()).map(|loaded| loaded.contents)
    }

    fn volume(&self, cubic: Cubic, region: Option<&str>) -> format::Volume {
        let region = region.map(|text| text.parse().unwrap());
        let options = ImportOptions { cubic, region, ..self.options };
        let path = self.folder.path().join("scan.raw");
        format::load_volume(&path, &options, &Limits::default(), &()).unwrap()
    }
}

fn all(grid: &Grid) -> impl Iterator<Item = IVec3> {
    (0..grid.dims().element_product()).map(|index| grid.voxel_coords(index).as_ivec3())
}

#[test]
fn two_thresholds_are_both_included() {
    for samples in ["u8", "u16be", "i16le", "f32le", "rgb8"] {
        let scan = Scan::new(&format!("200x1x1:{samples}"), |v| v.x as f32);
        let within = |least, most| {
            let range = Existence::Range(least, most);
            scan.load(|options| options.existence = range).unwrap().grid.opaque_count()
        };
        // Colours count by their greatest channel, which is 100 or more here.
        let least = if samples == "rgb8" { 0 } else { 50 };
        assert_eq!(within(50.0, 120.0), 121 - least, "{samples}");
        assert_eq!(within(49.5, 119.99), 120 - least, "{samples}");
        assert_eq!(within(300.0, 400.0), 0, "{samples}");
    }
    // Thresholds that no f32 can hold exactly.
    let scan = Scan::new("3x1x1:f32le", |v| [0.1f32, 0.3, f32::INFINITY][v.x as usize]);
    let within = |least, most| {
        let range = Existence::Range(least, most);
        scan.load(|options| options.existence = range).unwrap().grid.opaque_count()
    };
    let [low, high] = [0.1f32, 0.3].map(f64::from);
    assert_eq!(within(low, high), 2);
    assert_eq!(within(low + 1e-12, high), 1);
    assert_eq!(within(low, high - 1e-12), 1);
    let colours = scan.load(|options| {
        options.existence = Existence::Range(low, high);
        options.colouring = Colouring::Grey;
    });
    let densest = colours.unwrap().colour(IVec3::X);
    assert_eq!(densest, Some(Rgb::new(255, 255, 255)), "the ramp ends at the upper threshold");
}

#[test]
fn a_region_is_cut_out_of_the_file() {
    let value = |v: UVec3| (v.x + 10 * v.y + 50 * v.z) as f32;
    let scan = Scan::new("7x5x4:u16le:size=1,2,3", value);
    let whole = scan.volume(Cubic::No, None);
    for region in ["0,0,0..6,4,3", "2,1,1..4,4,2", "6,4,3..6,4,3", "0,2,0..6,2,3"] {
        let ScanRegion { low, high } = region.parse().unwrap();
        let cut = scan.volume(Cubic::No, Some(region));
        assert_eq!(cut.dims, high - low + 1, "{region}");
        assert_eq!((cut.voxel_size, cut.samples), (whole.voxel_size, whole.samples));
        assert_eq!(cut.data.len() as u32, cut.dims.element_product() * 2, "{region}");
        for i in 0..cut.dims.element_product() {
            let v = UVec3::new(
                i % cut.dims.x,
                i / cut.dims.x % cut.dims.y,
                i / cut.dims.x / cut.dims.y,
            );
            assert_eq!(cut.density(v), Some(value(v + low)), "{region} {v}");
        }
    }
    let (size, densities) = whole.slice(1, 2).unwrap();
    assert_eq!((size.x, size.y), (7, 4));
    assert_eq!(densities[(3 * 7 + 5) as usize], value(UVec3::new(5, 2, 3)));
    assert_eq!(whole.slice(0, 7), None);
    for beyond in ["0,0,0..7,4,3", "9,9,9..9,9,9"] {
        let error = scan.load(|options| options.region = beyond.parse().ok()).unwrap_err();
        let message = error.to_string();
        assert!(message.contains("7x5x4") && message.contains(beyond), "{message}");
    }
    // Too long an axis for a grid, but not for a region.
    let long = Scan::new("9000x1x1:u8", |v| if v.x == 8990 { 9.0 } else { 0.0 });
    assert!(matches!(long.load(|_| {}), Err(FormatError::Grid(_))));
    let part = long.load(|options| options.region = "8900,0,0..8999,0,0".parse().ok()).unwrap();
    assert!(part.grid.get(IVec3::new(90, 0, 0)) && part.grid.opaque_count() == 1);
}

#[test]
fn cubic_voxels_keep_places_and_densities() {
    for samples in ["u8", "u16le", "u16be", "i16le", "i16be", "f32le", "f32be"] {
        // Linear along all axes, so that interpolation yields exact densities.
        let value = |p: Vec3| 10.0 + 2.0 * p.x + 3.0 * p.y + 4.0 * p.z;
        let size = Vec3::new(1.0, 2.0, 4.0);
        let layout = format!("8x6x5:{samples}:size=1,2,4");
        let scan = Scan::new(&layout, |v| value((v.as_vec3() + 0.5) * size));
        let fine = scan.volume(Cubic::Finest, None);
        assert_eq!(fine.dims, UVec3::new(8, 12, 20), "{samples}");
        assert_eq!(fine.voxel_size, Vec3::ONE);
        for z in 2..18 {
            for y in 1..11 {
                let v = UVec3::new(3, y, z);
                let expected = value(v.as_vec3() + 0.5);
                let found = fine.density(v).unwrap();
                assert!((found - expected).abs() <= 1.01, "{samples} {v}: {found} {expected}");
            }
        }
        // The outermost layers continue.
        assert_eq!(fine.density(UVec3::new(0, 5, 0)), fine.density(UVec3::new(0, 5, 1)));
        let coarse = scan.volume(Cubic::EdgeMm(4.0), None);
        assert_eq!((coarse.dims, coarse.voxel_size), (UVec3::new(2, 3, 5), Vec3::splat(4.0)));
        let expected = value(Vec3::new(2.0, 6.0, 10.0));
        let found = coarse.density(UVec3::new(0, 1, 2)).unwrap();
        assert!((found - expected).abs() <= 1.01, "{samples}: {found} {expected}");
        let part = scan.volume(Cubic::Finest, Some("0,0,1..7,5,1"));
        assert_eq!(part.dims, UVec3::new(8, 12, 4));
    }
    // Voxels that are already cubes stay unchanged, whatever other edges are requested.
    let cubes = Scan::new("4x4x4:i16le:size=0.5,0.5,0.5", |v| -(v.x as f32));
    for cubic in [Cubic::Finest, Cubic::EdgeMm(0.5)] {
        assert_eq!(cubes.volume(cubic, None), cubes.volume(Cubic::No, None));
    }
    assert_eq!(cubes.volume(Cubic::EdgeMm(0.25), None).density(UVec3::splat(7)), Some(-3.0));
    let huge = cubes.load(|options| options.cubic = Cubic::EdgeMm(1e-9)).unwrap_err();
    assert!(matches!(huge, FormatError::Grid(_)), "{huge}");
}

#[test]
fn labels_and_colours_are_not_mixed() {
    let label = |v: UVec3| if v.z == 1 { 7.0 } else { f32::from(v.x.is_multiple_of(2)) * 3.0 };
    let scan = Scan::new("6x4x3:u8:size=1,1,3", label);
    let cubes = |options: &mut ImportOptions| {
        options.cubic = Cubic::Finest;
        options.colouring = Colouring::Labels;
    };
    let contents = scan.load(cubes).unwrap();
    assert_eq!(contents.grid.dims(), UVec3::new(6, 4, 9));
    let at = |x, z| contents.colour(IVec3::new(x, 2, z));
    let (three, seven) = (at(0, 0).unwrap(), at(0, 4).unwrap());
    assert_ne!(three, seven);
    for x in 0..6 {
        for z in 0..9 {
            let expected = match (z / 3, x % 2) {
                (1, _) => Some(seven),
                (_, 0) => Some(three),
                _ => None,
            };
            assert_eq!(at(x, z), expected, "{x} {z}");
        }
    }
    let only = scan.load(|options| {
        cubes(options);
        options.existence = Existence::Range(5.0, 9.0);
    });
    assert_eq!(only.unwrap().grid.opaque_count(), 6 * 4 * 3);
    let rgb = Scan::new("6x4x3:rgb8:size=1,1,3", label);
    let contents = rgb.load(|options| options.cubic = Cubic::Finest).unwrap();
    assert_eq!(contents.colour(IVec3::new(1, 0, 5)), Some(Rgb::new(7, 100, 0)));
    let error = rgb.load(|options| options.colouring = Colouring::Labels).unwrap_err();
    assert!(error.to_string().contains("labels"), "{error}");
}

#[test]
fn the_largest_piece_alone_and_without_holes() {
    // A hollow ball, brighter on one side, with a ball in it and specks around it.
    let density = |v: UVec3| {
        let r = (v.as_vec3() - 12.0).length();
        match r {
            _ if v.max_element() == 24 => 90.0,
            _ if (4.0..9.0).contains(&r) => 100.0 + v.x as f32,
            _ if r < 2.0 => 255.0,
            _ => 20.0,
        }
    };
    let scan = Scan::new("26x26x26:u8", density);
    let read = |largest_piece, fill_holes| {
        scan.load(|options| {
            options.existence = Existence::Threshold(80.0);
            options.colouring = Colouring::Grey;
            (options.largest_piece, options.fill_holes) = (largest_piece, fill_holes);
        })
        .unwrap()
    };
    let ball = |v: IVec3, from: f32, to: f32| {
        (from..to).contains(&(v.as_vec3() - 12.0).length()) && v.max_element() != 24
    };
    let (as_is, ball_alone) = (read(false, false), read(true, true));
    for v in all(&ball_alone.grid) {
        assert_eq!(ball_alone.grid.get(v), ball(v, 0.0, 9.0), "{v}");
        if ball(v, 4.0, 9.0) {
            assert_eq!(ball_alone.colour(v), as_is.colour(v));
        } else if ball(v, 2.0, 4.0) {
            assert_eq!(ball_alone.colour(v), Some(Rgb::STONE), "a filled hole");
        }
    }
    let hollow = read(true, false);
    assert!(all(&hollow.grid).all(|v| hollow.grid.get(v) == ball(v, 4.0, 9.0)));
    let filled = read(false, true);
    assert!(filled.grid.get(IVec3::new(24, 0, 0)) && filled.grid.get(IVec3::new(15, 12, 12)));
}

#[test]
fn resampling_is_bounded_and_can_be_cancelled() {
    let scan = Scan::new("40x40x4:u8:size=1,1,8", |v| v.x as f32);
    let path = scan.folder.path().join("scan.raw");
    let options = ImportOptions { cubic: Cubic::Finest, ..scan.options };
    let limits = Limits { grid_bytes: 20_000, colour_bytes: 10_000, ..Limits::default() };
    let error = format::load_volume(&path, &options, &limits, &()).unwrap_err();
    assert!(
        matches!(
            error,
            FormatError::OverBudget(OverBudget { budget: MemoryBudget::GridsAndColours, .. })
        ),
        "{error}"
    );
    let report = ProgressReport::default();
    report.cancel();
    let error = format::load_volume(&path, &options, &Limits::default(), &report).unwrap_err();
    assert!(matches!(error, FormatError::Cancelled), "{error}");
    // A file written by this program is recognised as such after resampling.
    let contents = scan.load(|options| options.existence = Existence::Threshold(20.0)).unwrap();
    let pvm = scan.folder.path().join("own.pvm");
    format::save(&pvm, &contents, ExportForm::Auto, &()).unwrap();
    let options = ImportOptions { cubic: Cubic::Finest, ..ImportOptions::default() };
    let again = format::load(&pvm, &options, &Limits::default(), &()).unwrap().contents;
    assert_eq!(again.grid.dims(), UVec3::new(40, 40, 32));
    assert_eq!(again.grid.opaque_count(), 8 * contents.grid.opaque_count());
}
