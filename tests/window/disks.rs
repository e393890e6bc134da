//! Disks that are full or write-protected, and a window that is closed while it writes: nothing is lost, no half file is
//! left, and the reason is said.
//!
//! The disks are small file systems in memory, which only the superuser may mount: without that right the tests are
//! skipped, or fail with `VS_REQUIRE_MOUNT=1`.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use virtual_sculpture::config::Config;
use virtual_sculpture::session::Session;

use super::program::{Program, SETTINGS};
use super::{LEFT, display, ready, screenshot};

/// A disk of its own; gone on drop.
struct Disk {
    folder: PathBuf,
}

impl Disk {
    /// Mounts an empty one of `kib` KiB at `folder`, which is made.
    fn new(folder: PathBuf, kib: u32) -> Disk {
        std::fs::create_dir(&folder).unwrap();
        if let Err(error) = mount(&[&format!("size={kib}k")], &folder) {
            trials::lacks("VS_REQUIRE_MOUNT", &format!("no disk can be mounted: {error}"));
        }
        Disk { folder }
    }

    fn protect(&self) {
        mount(&["remount", "ro"], &self.folder).unwrap();
    }

    /// Takes all room that is left; returns the file that has it.
    fn fill(&self) -> PathBuf {
        let path = self.folder.join("filler");
        let mut file = std::fs::File::create(&path).unwrap();
        while file.write(&[7; 512]).is_ok_and(|written| written > 0) {}
        path
    }

    fn names(&self) -> BTreeSet<String> {
        let entries = std::fs::read_dir(&self.folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        // Also where the program still runs, after a test that has failed.
        let _ = Command::new("umount").arg("--lazy").arg(&self.folder).status();
    }
}

fn mount(options: &[&str], folder: &Path) -> Result<(), String> {
    let mut command = Command::new("mount");
    command.args(["-t", "tmpfs", "-o", &options.join(","), "none"]).arg(folder);
    let output = command.output().map_err(|error| error.to_string())?;
    let why = String::from_utf8_lossy(&output.stderr).trim().to_string();
    output.status.success().then_some(()).ok_or(why)
}

/// A block in the file `owl.vsc` of the disk; the bytes of the file.
fn write_owl(disk: &Disk) -> Vec<u8> {
    let mut config = Config::default();
    config.new.dims = [96; 3];
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let path = disk.folder.join("owl.vsc");
    session.execute(&format!("save {path:?}").parse().unwrap(), &()).unwrap();
    std::fs::read(path).unwrap()
}

/// Types a command into the palette and runs it.
fn command(program: &Program, line: &str) {
    program.key(&["Control_L", "p"]);
    // Its field has the focus with the next picture: until then letters are keys.
    program.settle();
    for letter in line.chars() {
        match letter {
            ' ' => program.key(&["space"]),
            '=' => program.key(&["equal"]),
            ',' => program.key(&["comma"]),
            '"' => program.key(&["Shift_L", "apostrophe"]),
            letter => program.key(&[&letter.to_string()]),
        }
    }
    program.settle();
    program.key(&["Return"]);
}

/// Waits until a failure is said of a file.
fn expect_failure(program: &Program, file: &str, why: &str) {
    let is_said = |line: &str| {
        (line.contains(" WARN ") || line.contains(" ERROR "))
            && line.contains(file)
            && line.contains(why)
    };
    program
        .until(&format!("the failure of {file} is said"), || program.output().lines().any(is_said));
}

#[test]
fn on_a_full_disk_nothing_is_lost_and_nothing_half_written() {
    let display = display();
    let home = tempfile::tempdir().unwrap().keep();
    let disk = Disk::new(home.join("full"), 600);
    let owl = write_owl(&disk);
    let path = disk.folder.join("owl.vsc");
    let program = ready(Program::start_in(&display, home, &["full/owl.vsc"], SETTINGS));
    program.drag(LEFT, &[[560, 400], [600, 400], [640, 400]]);
    program.settle();
    let filler = disk.fill();
    let names = disk.names();

    program.key(&["Control_L", "s"]);
    expect_failure(&program, "owl.vsc", "no space is left");
    screenshot(&program, "full-disk-1-save");
    command(&program, "save \"full/owl.stl\"");
    expect_failure(&program, "owl.stl", "no space is left");
    command(&program, "save \"full/owl.vox\"");
    expect_failure(&program, "owl.vox", "no space is left");
    program.key(&["F12"]);
    expect_failure(&program, "owl-1.png", "no space is left");
    screenshot(&program, "full-disk-2-picture");
    assert_eq!(disk.names(), names);
    assert_eq!(std::fs::read(&path).unwrap(), owl);

    std::fs::remove_file(filler).unwrap();
    program.key(&["Control_L", "s"]);
    program.until("it is saved", || std::fs::read(&path).unwrap() != owl);
    program.settle();
    screenshot(&program, "full-disk-3-saved");
    program.close();
    let (status, output) = program.wait();
    assert!(status.success(), "{output}");
    assert_eq!(disk.names(), BTreeSet::from(["owl.vsc".to_string()]));
}

#[test]
fn on_a_write_protected_disk_work_goes_on_and_is_saved_elsewhere() {
    let display = display();
    let home = tempfile::tempdir().unwrap().keep();
    let disk = Disk::new(home.join("protected"), 600);
    let owl = write_owl(&disk);
    disk.protect();
    let arguments = ["protected/owl.vsc"];
    let program = ready(Program::start_in(&display, home.clone(), &arguments, SETTINGS));
    program.drag(LEFT, &[[560, 400], [600, 400], [640, 400]]);
    program.settle();
    program.key(&["Control_L", "s"]);
    expect_failure(&program, "owl.vsc", "the disk is write-protected");
    screenshot(&program, "protected-disk-1");
    assert_eq!(disk.names(), BTreeSet::from(["owl.vsc".to_string()]));
    assert_eq!(std::fs::read(disk.folder.join("owl.vsc")).unwrap(), owl);
    command(&program, "save \"owl.vsc\"");
    program.until("it is saved", || home.join("owl.vsc").exists());
    program.settle();
    program.close();
    let (status, output) = program.wait();
    assert!(status.success(), "{output}");
}

/// Whether a file is a picture to its end.
fn is_whole(path: &Path) -> bool {
    std::fs::read(path).is_ok_and(|bytes| bytes.ends_with(b"IEND\xAE\x42\x60\x82"))
}

/// A film and a final picture are given up; what is unsaved is asked about.
#[test]
fn a_window_that_is_closed_while_pictures_are_made_leaves_no_half_file() {
    let display = display();
    for (name, keys) in [("film", &["Alt_L", "F12"]), ("final", &["Shift_L", "F12"])] {
        let home = tempfile::tempdir().unwrap().keep();
        let program = ready(Program::start_in(&display, home.clone(), &[], SETTINGS));
        program.drag(LEFT, &[[560, 400], [600, 400], [640, 400]]);
        program.settle();
        program.key(keys);
        program.settle();
        let dialog = program.display().picture();
        program.key(&["Return"]);
        program.until("it is made", || program.display().picture().differing(&dialog) > 20_000);
        program.close();
        program.settle();
        screenshot(&program, &format!("closed-while-{name}"));
        program.leave_without_saving();
        let left: BTreeSet<_> = std::fs::read_dir(&home)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            // A fast machine may have finished it.
            .filter(|name| !name.starts_with('.') && !is_whole(&home.join(name)))
            .collect();
        assert_eq!(left, BTreeSet::from(["config.toml".to_string(), "stderr.txt".to_string()]));
    }
}
