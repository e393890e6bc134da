//! Runs the tests of a binary that need something of the machine. The harness of Rust knows only at
//! compile time what it ignores; here what lacks is found first, and the tests are counted as ignored,
//! with the reason.
//!
//! A binary with `harness = false` gives its tests as a list in `main`. A function that is missing in it
//! is never used, of which the compiler warns; a `#[test]` would vanish silently, and is an error.

use std::path::Path;

use libtest_mimic::{Arguments, Trial};

/// The tests of these names.
macro_rules! tests {
    ($($test:path),* $(,)?) => { vec![$((stringify!($test), $test as fn())),*] };
}

/// Tests that need the same, and what of it lacks.
pub type Group = (Option<String>, Vec<(&'static str, fn())>);

/// Runs the tests of all groups, or ignores them where something lacks; ends the process. `file` is the
/// `file!()` of `main`.
pub fn run(file: &str, groups: Vec<Group>) -> ! {
    refuse_attributes(Path::new(file).parent().unwrap());
    let mut trials = Vec::new();
    for (lacks, tests) in groups {
        if let Some(reason) = &lacks {
            println!("SKIPPED: {reason}");
        }
        for (name, test) in tests {
            let trial = Trial::test(name, move || {
                test();
                Ok(())
            });
            trials.push(match &lacks {
                Some(reason) => trial.with_kind(reason).with_ignored_flag(true),
                None => trial,
            });
        }
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit()
}

/// Where the sources are at hand, none of them may have a test that the list does not know.
fn refuse_attributes(folder: &Path) {
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let text = std::fs::read_to_string(file.path()).unwrap_or_default();
        let mut lines = text.lines().map(str::trim);
        let path = file.path();
        assert!(
            !lines.any(|line| line == "#[test]"),
            "{} has a #[test]: it would not run; name it in the list of main.rs instead",
            path.display()
        );
    }
}
