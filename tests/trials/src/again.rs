//! Runs a test in a process of its own: for tests that measure or limit their whole process, or need another
//! network or other libraries. Takes the command to run; its outcome becomes that of the test.

use std::path::PathBuf;
use std::process::Command;

/// Set in a process that runs a single test for another process.
const WITHIN: &str = "VS_TRIALS_AGAIN";
/// The exit status of such a process whose test was skipped; the reason is the last line of its stderr.
pub(crate) const SKIPPED: i32 = 77;

pub(crate) fn within() -> bool {
    std::env::var_os(WITHIN).is_some()
}

/// Runs the running test in a process of its own. True in there, where the test continues; false outside,
/// when it has finished.
pub fn alone() -> bool {
    if within() {
        return true;
    }
    conclude(Command::new(executable()).args(arguments()));
    false
}

/// The path of this test binary. Skips the running test where the process is a dynamic loader that has
/// loaded the binary.
pub fn executable() -> PathBuf {
    let own = std::env::current_exe().expect("the path of this binary");
    let named = std::env::args_os().next().map(PathBuf::from).expect("a first argument");
    if own.file_name() != named.file_name() {
        crate::skip(&format!("{} has loaded the tests and cannot start them again", own.display()));
    }
    own
}

/// Arguments to [`executable`] that run only the running test.
pub fn arguments() -> [String; 4] {
    ["--exact".into(), crate::current(), "--nocapture".into(), "--test-threads=1".into()]
}

/// Runs a command that ends with [`executable`] and [`arguments`]; its outcome becomes that of the running
/// test.
pub fn conclude(command: &mut Command) {
    let output = command.env(WITHIN, "1").output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let out = String::from_utf8_lossy(&output.stdout);
    let err = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(SKIPPED) {
        crate::skip(err.lines().next_back().unwrap_or_default());
    }
    assert!(output.status.success(), "{command:?}: {}\n{out}\n{err}", output.status);
    assert!(out.contains("1 passed"), "{command:?} has run no test:\n{out}\n{err}");
    crate::note!("{out}{err}");
}
