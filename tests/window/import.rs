//! The import dialog in the window: a scan chosen in the file dialog is shown, its threshold dragged, and
//! opened; so is a voxel model, which is turned.

use std::path::Path;

use glam::{UVec3, Vec3};
use virtual_sculpture::format;
use virtual_sculpture::format::options::ExportForm;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{Brick, ColourDepth, Grid, Limits, Material, Rgb};

use super::display::Picture;
use super::program::{Program, SETTINGS};
use super::{LEFT, display_of, ready, screenshot};

/// A ball of density 120 with a core of 220 in a haze, in voxels that are two millimetres high.
fn scan(path: &Path) {
    let mut file = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 64 64 32\nencoding: raw\n\
        space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,2)\n\n"
        .to_vec();
    file.extend((0..64 * 64 * 32).map(|i| {
        let (x, y, z) = (i % 64 - 32, i / 64 % 64 - 36, 2 * (i / 4096) - 32);
        let noise = (i * 37 % 41) as u8;
        match x * x + y * y + z * z {
            ..100 => 200 + noise,
            100..500 => 110 + noise,
            _ => noise,
        }
    }));
    std::fs::write(path, file).unwrap();
}

/// Pixels of the colour of voxels that would exist.
fn clay(picture: &Picture) -> usize {
    let is_clay = |rgb: &[u8; 3]| {
        let [r, g, b] = rgb.map(u32::from);
        r > 90 && 3 * r > 4 * g && 4 * g > 5 * b
    };
    picture.pixels().iter().filter(|rgb| is_clay(rgb)).count()
}

#[test]
fn a_scan_from_the_file_dialog_is_shown_and_opened() {
    for (theme, size) in [("dark", [1280, 800]), ("light", [800, 600])] {
        let display = display_of(size);
        let folder = tempfile::tempdir().unwrap().keep();
        let scans = folder.join("scans");
        std::fs::create_dir(&scans).unwrap();
        scan(&scans.join("ball.nrrd"));
        let state = folder.join(".local/state/virtual-sculpture");
        std::fs::create_dir_all(&state).unwrap();
        std::fs::write(state.join("state.toml"), format!("folder = {scans:?}\n")).unwrap();
        let window = format!("[window]\ntheme = \"{theme}\"\nsize = {size:?}\n");
        let settings = SETTINGS.replace("[window]\n", &window);
        let program = ready(Program::start_in(&display, folder, &[], &settings));
        let before = screenshot(&program, &format!("import-{theme}-0"));
        program.key(&["Control_L", "o"]);
        screenshot(&program, &format!("import-{theme}-1-files"));
        program.key(&["Down"]);
        program.settle();
        program.key(&["Return"]);
        program.until("the slices are shown", || {
            clay(&program.display().picture()) > clay(&before) + 2000
        });
        let shown = screenshot(&program, &format!("import-{theme}-2-shown"));
        // The upper threshold is dragged over the core.
        let [width, height] = size.map(|side| side as i16);
        let (x, y) = (width / 3, height / 2 + 70);
        program.drag(LEFT, &[[x, y], [x + 40, y], [x + 60, y]]);
        let dragged = screenshot(&program, &format!("import-{theme}-3-dragged"));
        assert!(clay(&dragged) + 300 < clay(&shown), "less exists");
        program.key(&["Return"]);
        program.until("it is opened", || {
            program.output().contains("ball.nrrd") || {
                program.display().picture().differing(&dragged) > 50_000
            }
        });
        let opened = screenshot(&program, &format!("import-{theme}-4-opened"));
        assert!(opened.differing(&before) > 5000);
        program.close();
        program.expect_clean_exit();
    }
}

/// A cone of grass, earth and a red top.
fn model(path: &Path) {
    let dims = UVec3::new(48, 40, 48);
    let limits = Limits::default();
    let mut grid = Grid::new(dims, Vec3::ONE, limits.grid_bytes).unwrap();
    let colours =
        [Rgb::new(0x5a, 0x40, 0x2a), Rgb::new(0x4c, 0xa0, 0x3c), Rgb::new(0xd0, 0x30, 0x28)];
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, colours[0]);
    for i in 0..dims.element_product() {
        let at = grid.voxel_coords(i);
        let from_axis = at.as_vec3().with_y(0.0).distance(Vec3::new(23.5, 0.0, 23.5));
        if from_axis < 23.0 - at.y as f32 / 2.0 {
            grid.set(at.as_ivec3(), true);
            let mut voxel = Brick::EMPTY;
            voxel.set(at.x % 8, at.y % 8, at.z % 8, true);
            let colour = colours[(at.y / 14).min(2) as usize];
            material.paint(at / 8, &voxel, colour);
        }
    }
    let contents = Contents::new(grid, material);
    format::save(path, &contents, ExportForm::Auto, &()).unwrap();
}

#[test]
fn a_voxel_model_from_the_file_dialog_is_shown_turned_and_opened() {
    let size = [1280, 800];
    let display = display_of(size);
    let folder = tempfile::tempdir().unwrap().keep();
    let models = folder.join("models");
    std::fs::create_dir(&models).unwrap();
    model(&models.join("hill.vox"));
    let state = folder.join(".local/state/virtual-sculpture");
    std::fs::create_dir_all(&state).unwrap();
    std::fs::write(state.join("state.toml"), format!("folder = {models:?}\n")).unwrap();
    let window = format!("[window]\ntheme = \"dark\"\nsize = {size:?}\n");
    let settings = SETTINGS.replace("[window]\n", &window);
    let program = ready(Program::start_in(&display, folder, &[], &settings));
    let green = |picture: &Picture| {
        let is_green = |rgb: &[u8; 3]| {
            let [r, g, b] = rgb.map(u32::from);
            g > 60 && 2 * g > 3 * r && 2 * g > 3 * b
        };
        picture.pixels().iter().filter(|rgb| is_green(rgb)).count()
    };
    let before = screenshot(&program, "import-model-0");
    program.key(&["Control_L", "o"]);
    program.settle();
    program.key(&["Down"]);
    program.settle();
    program.key(&["Return"]);
    program.until("the model is shown", || {
        green(&program.display().picture()) > green(&before) + 2000
    });
    let shown = screenshot(&program, "import-model-1-shown");
    let (x, y) = (480, 400);
    program.drag(LEFT, &[[x, y], [x + 60, y + 20], [x + 110, y + 40]]);
    let turned = screenshot(&program, "import-model-2-turned");
    assert!(turned.differing(&shown) > 2000);
    program.key(&["Return"]);
    program.until("it is opened", || program.display().picture().differing(&turned) > 50_000);
    let opened = screenshot(&program, "import-model-3-opened");
    assert!(green(&opened) > green(&before) + 2000);
    program.close();
    program.expect_clean_exit();
}
