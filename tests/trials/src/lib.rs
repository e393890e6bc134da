//! The harness of the integration tests: one binary per crate with `harness = false`, whose `main` is
//! [`main!`]. It knows all tests of its crate (`#[test]`, which means the attribute of this crate there) and
//! runs them with the arguments that people know: filters, `--exact`, `--skip`, `--list`, `--test-threads`.
//!
//! Other than in the built-in harness a test may find out, while it runs, that the machine lacks what it
//! needs: [`skip`] ends it, and it is counted as ignored, with the reason. Output is not captured, so that
//! tests do not print, but [`note!`].
//!
//! Knows nothing of the program.

mod again;
mod shared;

use std::cell::RefCell;
use std::collections::HashSet;
use std::panic::{catch_unwind, resume_unwind};
use std::path::Path;

use libtest_mimic::{Arguments, Completion, Failed, Trial};

pub use again::{alone, arguments, conclude, executable};
pub use inventory;
pub use shared::shared_file;
pub use trials_macros::test;

/// A function with the attribute `#[test]`.
pub struct Test {
    /// Of the function, with that of its crate.
    pub path: &'static str,
    pub file: &'static str,
    pub run: fn(),
}

inventory::collect!(Test);

/// The `main` of a binary of tests.
#[macro_export]
macro_rules! main {
    () => {
        fn main() {
            $crate::run(file!(), env!("CARGO_MANIFEST_DIR"));
        }
    };
}

/// Prints where `--nocapture` asks for it.
#[macro_export]
macro_rules! note {
    ($($text:tt)*) => {
        if $crate::is_verbose() {
            println!($($text)*);
        }
    };
}

/// What the panic of a skipped test carries.
struct Skip(String);

thread_local! {
    /// The name of the test that this thread runs.
    static CURRENT: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Ends the running test; it is counted as ignored. To be called by the thread that runs the test.
pub fn skip(reason: &str) -> ! {
    assert!(!current().is_empty(), "only the thread of a test can skip it: {reason}");
    // Not a panic: nothing is printed.
    resume_unwind(Box::new(Skip(reason.to_owned())))
}

/// Skips the running test because of what the machine lacks, unless the environment variable `required` is
/// set to anything but "" and "0"; then the test fails.
pub fn lacks(required: &str, reason: &str) -> ! {
    let is_required = std::env::var_os(required)
        .is_some_and(|value| !["", "0"].contains(&value.to_string_lossy().as_ref()));
    assert!(!is_required, "{required} is set, but {reason}");
    skip(reason)
}

/// The name of the running test.
pub fn current() -> String {
    CURRENT.with_borrow(Clone::clone)
}

/// Whether the tests were started with `--nocapture` or `--show-output`.
pub fn is_verbose() -> bool {
    std::env::args().any(|argument| ["--nocapture", "--show-output"].contains(&argument.as_str()))
}

/// Runs the tests as the arguments say and ends the process. `main` is the source file of the binary,
/// `crate_folder` that of its crate.
pub fn run(main: &str, crate_folder: &str) -> ! {
    let mut arguments = Arguments::from_args();
    if arguments.test_threads.is_none()
        && let Ok(text) = std::env::var("RUST_TEST_THREADS")
    {
        arguments.test_threads = Some(text.parse().expect("RUST_TEST_THREADS is a number"));
    }
    refuse_lost_files(&Path::new(crate_folder).join("tests"), main);
    let mut tests: Vec<&Test> = inventory::iter::<Test>().collect();
    tests.sort_by_key(|test| test.path);
    assert!(tests.windows(2).all(|two| two[0].path != two[1].path), "two tests have one name");
    let trials = tests.into_iter().map(trial).collect();
    print_names_of_panicking_tests();
    libtest_mimic::run(&arguments, trials).exit()
}

fn trial(test: &'static Test) -> Trial {
    let name = test.path.split_once("::").map_or(test.path, |(_crate, name)| name);
    Trial::ignorable_test(name, move || {
        CURRENT.set(name.to_owned());
        let outcome = catch_unwind(test.run);
        CURRENT.set(String::new());
        let panic = match outcome {
            Ok(()) => return Ok(Completion::Completed),
            Err(panic) => panic,
        };
        match panic.downcast::<Skip>() {
            Ok(skip) if again::within() => {
                eprintln!("{}", skip.0);
                std::process::exit(again::SKIPPED)
            }
            Ok(skip) => Ok(Completion::ignored_with(skip.0)),
            Err(panic) => Err(failure(&*panic)),
        }
    })
}

fn failure(panic: &(dyn std::any::Any + Send)) -> Failed {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "panicked".to_owned()).into()
}

/// The threads that run tests have no names.
fn print_names_of_panicking_tests() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let test = current();
        if !test.is_empty() {
            eprint!("\ntest {test}:");
        }
        usual(info);
    }));
}

/// Panics if a source file below `folder` has tests of which none is known: it is in no module. Where the
/// sources are not at hand, there is nothing to compare. Folders that are crates of their own are left out.
fn refuse_lost_files(folder: &Path, main: &str) {
    let known: HashSet<&str> = inventory::iter::<Test>().map(|test| test.file).collect();
    let is_known = |path: &Path| known.iter().any(|file| path.ends_with(file));
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                if !path.join("Cargo.toml").exists() {
                    folders.push(path);
                }
                continue;
            }
            // On other systems than Linux some modules are left out.
            if !cfg!(target_os = "linux") || path.extension().is_none_or(|end| end != "rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let has_tests = text.lines().any(|line| line.trim() == "#[test]");
            assert!(
                !has_tests || is_known(&path),
                "{} has tests that would not run: it is no module of {main}",
                path.display()
            );
        }
    }
}
