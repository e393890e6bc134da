//! Damaged and hostile files: each is accepted or refused as listed, with a readable message, without a panic and
//! without much memory.

use std::path::Path;

use sculpture_core::format::options::{ImportOptions, MeshSize};
use sculpture_core::format::{self, FormatError, Loaded};
use sculpture_core::refusal::{MemoryBudget, OverBudget};
use sculpture_core::sculpture::Limits;
use trials::shared_file;

fn load(path: &Path) -> Result<Loaded, FormatError> {
    format::load(path, &ImportOptions::default(), &Limits::default(), &())
}

/// Last endings of the files in the list that can be read.
const READ: [&str; 12] =
    ["pvm", "vox", "qb", "binvox", "obj", "stl", "ply", "nii", "gz", "nrrd", "nhdr", "vti"];

#[test]
fn bad_files_are_accepted_or_refused_as_listed() {
    // The memory of the whole process is measured.
    if !trials::alone() {
        return;
    }
    let manifest = shared_file("data/bad/MANIFEST.tsv");
    let folder = manifest.parent().unwrap().to_path_buf();
    let mut seen = 0;
    for line in std::fs::read_to_string(&manifest).unwrap().lines() {
        let fields: Vec<&str> = line.split('\t').collect();
        let [name, _, expected, reason] = fields[..] else { panic!("manifest line {line}") };
        let ending = name.rsplit('.').next().unwrap();
        if !READ.contains(&ending) {
            continue;
        }
        seen += 1;
        let result = load(&folder.join(name));
        match (expected, &result) {
            ("accept", Err(error)) => panic!("{name} ({reason}) was refused: {error}"),
            ("reject", Ok(_)) => panic!("{name} ({reason}) was accepted"),
            _ => {}
        }
        if let Err(error) = result {
            let message = error.to_string();
            assert!(message.len() >= 17 && message.len() < 300, "{name}: {message}");
            assert!(!message.chars().any(char::is_control), "{name}: {message:?}");
            trials::note!("{name}: {message}");
        }
    }
    assert!(seen >= 108, "only {seen} files");
    // The largest accepted one is a volume of 32 MiB; nothing may take much more.
    if let Some(peak) = trials::peak_mib() {
        assert!(peak < 250, "{peak} MiB");
    }
}

#[test]
fn the_memory_budget_is_checked_before_unpacking() {
    let path = shared_file("data/bad/dds_bomb_legal.pvm");
    let limits = Limits { grid_bytes: 1 << 20, ..Limits::default() };
    let error = format::load(&path, &ImportOptions::default(), &limits, &()).unwrap_err();
    assert!(matches!(error, FormatError::Grid(_)), "{error}");
    let limits = Limits { grid_bytes: 8 << 20, colour_bytes: 8 << 20, ..Limits::default() };
    let error = format::load(&path, &ImportOptions::default(), &limits, &()).unwrap_err();
    assert!(
        matches!(
            error,
            FormatError::OverBudget(OverBudget { budget: MemoryBudget::GridsAndColours, .. })
        ),
        "{error}"
    );
}

/// A small seeded random generator, so that failures are reproducible.
struct Dice(u64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) % end.max(1) as u64) as usize
    }
}

/// Damages a file in one of several ways.
fn damage(file: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for _ in 0..1 + dice.below(4) {
        if bytes.is_empty() {
            break;
        }
        // Headers are short, and the most sensitive part.
        let reach = if dice.below(2) == 0 { bytes.len().min(80) } else { bytes.len() };
        let at = dice.below(reach);
        match dice.below(6) {
            0 => bytes[at] ^= 1 << dice.below(8),
            1 => bytes[at] = dice.below(256) as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.splice(at..at, b"9999999999 -1e40 \n\0"[..dice.below(20)].to_vec())),
            4 => drop(bytes.drain(at..(at + 1 + dice.below(40)).min(reach))),
            _ => bytes[at..reach.min(at + 1 + dice.below(60))].fill([0, 255, b'0'][dice.below(3)]),
        }
    }
    bytes
}

#[test]
fn damaged_files_never_cause_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    // Small limits, so that large claims are refused rather than tried.
    let limits = Limits { grid_bytes: 1 << 20, colour_bytes: 8 << 20, ..Limits::default() };
    let mut dice = Dice(20261121);
    let mut outcomes = [0; 2];
    for name in [
        "pvm/Bucky.pvm",
        "derived/syn_pvm1_raw_comments.pvm",
        "derived/syn_pvm2_raw_u16_17x13x9.pvm",
        "derived/syn_pvm3_raw_u8_empty_strings.pvm",
        "derived/syn_pvm3_dds_u16_17x13x9_strings.pvm",
        "derived/syn_pvm1_dds_5comps.pvm",
        "derived/syn_dds_skip2_on_u8.pvm",
        "derived/syn_pvm1_dds_1x1x1.pvm",
        "voxel/vox_character.vox",
        "voxel/rgb.vox",
        "voxel/chr_knight.qb",
        "voxel/rgb.qb",
        "mesh/vengi_cube.obj",
        "mesh/vengi_ascii.stl",
        "mesh/vengi_cube.stl",
        "mesh/vengi_cube.ply",
        "mesh/nut.ply",
        "nifti/standard.nii.gz",
        "nifti/reoriented_anat_moved.nii",
        "nrrd/BallBinary30x30x30_gz.nrrd",
        "nrrd/test2d_ascii.nrrd",
    ] {
        let original = shared_file(&format!("data/{name}"));
        let file = std::fs::read(original).unwrap();
        let path = folder.path().join("damaged").with_extension(name.rsplit('.').next().unwrap());
        let rounds = if name.ends_with(".pvm") { 400 } else { 100 };
        for _ in 0..rounds {
            std::fs::write(&path, damage(&file, &mut dice)).unwrap();
            let options =
                ImportOptions { mesh_size: MeshSize::LongestVx(20), ..Default::default() };
            let result = format::load(&path, &options, &limits, &());
            outcomes[usize::from(result.is_ok())] += 1;
            if let Err(error) = result {
                assert!(!error.to_string().chars().any(char::is_control), "{error:?}");
            }
        }
    }
    // Both outcomes must be frequent, or the damage is too small or too large to test anything.
    assert!(outcomes.iter().all(|&n| n > 100), "{outcomes:?}");
}
