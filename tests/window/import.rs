//! The import dialog in the window: a scan chosen in the file dialog is shown, its threshold dragged, and opened.

use std::path::Path;

use super::display::Picture;
use super::program::{Program, SETTINGS};
use super::{LEFT, display_of, ready, shot};

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
        let before = shot(&program, &format!("import-{theme}-0"));
        program.key(&["Control_L", "o"]);
        shot(&program, &format!("import-{theme}-1-files"));
        program.key(&["Down"]);
        program.settle();
        program.key(&["Return"]);
        program.until("the slices are shown", || {
            clay(&program.display().picture()) > clay(&before) + 2000
        });
        let shown = shot(&program, &format!("import-{theme}-2-shown"));
        // The upper threshold is dragged over the core.
        let [width, height] = size.map(|side| side as i16);
        let (x, y) = (width / 3, height / 2 + 70);
        program.drag(LEFT, &[[x, y], [x + 40, y], [x + 60, y]]);
        let dragged = shot(&program, &format!("import-{theme}-3-dragged"));
        assert!(clay(&dragged) + 300 < clay(&shown), "less exists");
        program.key(&["Return"]);
        program.until("it is opened", || {
            program.output().contains("ball.nrrd") || {
                program.display().picture().differing(&dragged) > 50_000
            }
        });
        let opened = shot(&program, &format!("import-{theme}-4-opened"));
        assert!(opened.differing(&before) > 5000);
        program.close();
        program.expect_clean_exit();
    }
}
