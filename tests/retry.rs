//! `tests/retry.sh` and `tests/flaky.sh`, fed with the output of a test command that is a script of its own: what
//! fails once is reported and forgiven, what fails twice, crashes or does not compile is not.

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

/// A unit test and a test of `tests/trials` fail, whose failure shows that of a test within it.
const TWO_FAILURES: &str = r"   Compiling statue v0.1.0
     Running unittests src/lib.rs (target/debug/deps/statue-0123)

running 2 tests
test clay::dries ... FAILED
test clay::is_wet ... ok

failures:

---- clay::dries stdout ----
it is wet

failures:
    clay::dries

test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.06s

error: test failed, to rerun pass `-p statue --lib`
     Running tests/main.rs (target/debug/deps/statue_tests-4567)

running 3 tests

test hand::holds:
thread '<unnamed>' panicked at tests/hand.rs:5:38:
test hand::holds ... FAILED
test hand::lets_go ... FAILED
test hand::waves ... ok

failures:

---- hand::holds ----
the test in a process of its own:

failures:

---- hand::slips ----
it slips

failures:
    hand::slips

test result: FAILED. 0 passed; 1 failed

---- hand::lets_go ----
it holds


failures:
    hand::holds
    hand::lets_go

test result: FAILED. 1 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.10s

error: test failed, to rerun pass `-p statue --test statue_tests`
error: 2 targets failed:
    `-p statue --lib`
    `-p statue --test statue_tests`
";
const CRASH: &str = r"     Running tests/main.rs (target/debug/deps/statue_tests-4567)

running 3 tests
test hand::holds ... FAILED
error: test failed, to rerun pass `-p statue --test statue_tests`

Caused by:
  process didn't exit successfully: `target/debug/deps/statue_tests-4567` (signal: 6, SIGABRT: process abort signal)
error: 1 target failed:
    `-p statue --test statue_tests`
";
const NO_BUILD: &str =
    "error[E0425]: cannot find value `clay` in this scope\nerror: could not compile `statue`\n";

/// A test command whose first run prints `first` and fails. Runs with a test's name pass unless it is among `failing`.
fn command(folder: &Path, first: &str, failing: &[&str]) -> std::path::PathBuf {
    std::fs::write(folder.join("first"), first).unwrap();
    let failing = failing.join("|");
    let script = format!(
        "#!/bin/bash\n\
         here=$(dirname \"$0\")\n\
         echo \"$*\" >>\"$here/calls\"\n\
         case \"$*\" in\n\
         *--exact*) [[ ! \"$*\" =~ ^.*\\ ({failing})$ ]] || {{ echo 'test result: FAILED. 0 passed'; exit 101; }}\n\
         echo 'test result: ok. 0 passed'; echo 'test result: ok. 1 passed' ;;\n\
         *) cat \"$here/first\"; exit 101 ;;\n\
         esac\n"
    );
    let path = folder.join("command");
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

fn script(name: &str) -> Command {
    let mut bash = Command::new("bash");
    bash.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name));
    bash
}

/// The run, its report, and the arguments of the test command.
fn retry(first: &str, failing: &[&str]) -> (Output, String, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let command = command(folder.path(), first, failing);
    let report = folder.path().join("report");
    let output = script("retry.sh").arg(&report).arg(command).output().unwrap();
    let calls = std::fs::read_to_string(folder.path().join("calls")).unwrap();
    let calls = calls.lines().map(str::to_owned).collect();
    (output, std::fs::read_to_string(report).unwrap(), calls)
}

#[test]
fn a_test_that_passes_alone_is_reported_with_its_first_failure_and_forgiven() {
    let (output, report, calls) = retry(TWO_FAILURES, &["nothing"]);
    assert!(output.status.success(), "{output:?}");
    let again = [
        "",
        "--lib -- --exact clay::dries",
        "--test statue_tests -- --exact hand::holds",
        "--test statue_tests -- --exact hand::lets_go",
    ];
    assert_eq!(calls, again);
    assert_eq!(report.matches("FLAKY").count(), 3, "{report}");
    let flaky = |name: &str| report.split("FLAKY ").find(|text| text.contains(name)).unwrap();
    assert!(flaky("clay::dries:").contains("it is wet"), "{report}");
    // The whole failure, with that of the process within, and no other.
    assert!(flaky("hand::holds:").contains("it slips"), "{report}");
    assert!(!flaky("hand::holds:").contains("it holds"), "{report}");
    assert!(flaky("hand::lets_go:").contains("it holds"), "{report}");
}

#[test]
fn a_test_that_fails_again_fails_the_run() {
    let (output, report, calls) = retry(TWO_FAILURES, &["hand::holds"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(calls.len(), 4);
    assert_eq!(report.matches("FLAKY").count(), 2, "{report}");
    assert!(!report.contains("FLAKY --test statue_tests hand::holds"), "{report}");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("hand::holds: FAILED again"), "{said}");
}

#[test]
fn crashes_failed_builds_and_many_failures_are_not_run_again() {
    let many: String = (0..21).map(|i| format!("    clay::{i}\n")).collect();
    let many = format!(
        "failures:\n{many}\ntest result: FAILED. 0 passed\n\
         error: test failed, to rerun pass `--lib`\n"
    );
    for first in [CRASH, NO_BUILD, &many] {
        let (output, report, calls) = retry(first, &["nothing"]);
        assert!(!output.status.success(), "{first}");
        assert_eq!((report.as_str(), calls.len()), ("", 1), "{first}");
    }
}

#[test]
fn tests_that_ever_failed_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let tests = folder.path().join("tests");
    std::fs::create_dir(&tests).unwrap();
    for name in ["flaky.sh", "failed.awk"] {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
        std::fs::copy(from, tests.join(name)).unwrap();
    }
    let command = command(folder.path(), TWO_FAILURES, &["nothing"]);
    let output = Command::new("bash")
        .arg(tests.join("flaky.sh"))
        .args(["2", "--workspace"])
        .env("VS_TEST_COMMAND", command)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("2 --test statue_tests\thand::lets_go"), "{said}");
    let calls = std::fs::read_to_string(folder.path().join("calls")).unwrap();
    assert_eq!(calls, "--workspace\n--workspace\n");
}
