//! The harness of the integration tests: one binary per crate with `harness = false`, whose `main` is
//! [`main!`]. It collects all tests of its crate (`#[test]`, which is the attribute of this crate there) and
//! runs them with the usual arguments: filters, `--exact`, `--skip`, `--list`, `--test-threads`.
//!
//! Unlike with the built-in harness, a test may be skipped while it runs, because the machine lacks what it
//! needs: [`skip`] ends it, and it is counted as ignored, with the reason. Output is not captured, so tests
//! do not print, but use [`note!`].
//!
//! Knows nothing of the program.

mod again;
#[cfg(target_os = "linux")]
mod limiter;
mod memory;
mod shared;
mod slowest;

use std::cell::RefCell;
use std::collections::HashSet;
use std::panic::{catch_unwind, resume_unwind};
use std::path::Path;

use libtest_mimic::{Arguments, Completion, Failed, Trial};

pub use again::{alone, arguments, conclude, executable};
pub use inventory;
#[cfg(target_os = "linux")]
pub use limiter::Limiter;
pub use memory::{peak_mib, resident_mib};
pub use shared::shared_file;
pub use trials_macros::test;

/// A function with the attribute `#[test]`.
pub struct Test {
    /// Path of the function, including its crate.
    pub path: &'static str,
    pub file: &'static str,
    pub run: fn(),
}

inventory::collect!(Test);

/// The `main` function of a test binary.
#[macro_export]
macro_rules! main {
    () => {
        fn main() {
            $crate::run(file!(), env!("CARGO_MANIFEST_DIR"));
        }
    };
}

/// Prints with `--nocapture` or `--show-output`.
#[macro_export]
macro_rules! note {
    ($($text:tt)*) => {
        if $crate::is_verbose() {
            println!($($text)*);
        }
    };
}

/// The panic payload of a skipped test.
struct Skip(String);

thread_local! {
    /// The name of the test that this thread runs.
    static CURRENT: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Ends the running test, which is counted as ignored. Must be called on the thread of the test.
pub fn skip(reason: &str) -> ! {
    assert!(!current().is_empty(), "only the thread of a test can skip it: {reason}");
    // Unlike `panic!` this prints nothing.
    resume_unwind(Box::new(Skip(reason.to_owned())))
}

/// Skips the running test because the machine lacks something, unless the environment variable `required`
/// is set to anything but "" and "0"; then the test fails.
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

/// Runs the tests selected by the arguments and exits. `main` is the source file of the binary,
/// `crate_folder` that of its crate.
pub fn run(main: &str, crate_folder: &str) -> ! {
    let mut arguments = Arguments::from_args();
    if arguments.test_threads.is_none() {
        arguments.test_threads = Some(match std::env::var("RUST_TEST_THREADS") {
            Ok(text) => text.parse().expect("RUST_TEST_THREADS is a number"),
            Err(_) => usual_threads(),
        });
    }
    refuse_unused_files(&Path::new(crate_folder).join("tests"), main);
    let mut tests: Vec<&Test> = inventory::iter::<Test>().collect();
    tests.sort_by_key(|test| test.path);
    assert!(tests.windows(2).all(|two| two[0].path != two[1].path), "two tests have one name");
    let trials = tests.into_iter().map(trial).collect();
    print_names_of_panicking_tests();
    let conclusion = libtest_mimic::run(&arguments, trials);
    slowest::print();
    conclusion.exit()
}

/// Two tests a core: many of them start programs and wait for them.
fn usual_threads() -> usize {
    2 * std::thread::available_parallelism().map_or(1, usize::from)
}

fn trial(test: &'static Test) -> Trial {
    let name = test.path.split_once("::").map_or(test.path, |(_crate, name)| name);
    Trial::ignorable_test(name, move || {
        CURRENT.set(name.to_owned());
        let outcome = slowest::timed(name, || catch_unwind(test.run));
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

/// Names the panicking test in the output: the threads that run tests have no names.
fn print_names_of_panicking_tests() {
    let default_hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let test = current();
        if !test.is_empty() {
            eprint!("\ntest {test}:");
        }
        default_hook(info);
    }));
}

/// Panics if a source file below `folder` has tests of which none is registered, because the file is in no
/// module. Without the sources there is nothing to check. Folders with crates of their own are skipped.
fn refuse_unused_files(folder: &Path, main: &str) {
    let registered: HashSet<&str> = inventory::iter::<Test>().map(|test| test.file).collect();
    let is_registered = |path: &Path| registered.iter().any(|file| path.ends_with(file));
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
            // On systems other than Linux some modules are left out.
            if !cfg!(target_os = "linux") || path.extension().is_none_or(|end| end != "rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let has_tests = text.lines().any(|line| line.trim() == "#[test]");
            assert!(
                !has_tests || is_registered(&path),
                "{} has tests that would not run: it is no module of {main}",
                path.display()
            );
        }
    }
}
