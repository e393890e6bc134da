//! `run -`: commands from standard input, each answered by one line of JSON on standard output, so that another program
//! can drive this one through a pipe.
//!
//! Takes a session and lines of the script language; gives one [`PipeAnswer`] per line, including empty lines and
//! comments. A failed command changes nothing, and the next one is read; an overlong line is refused likewise. Does not
//! know the driver.

use std::io::{BufRead, Read};
use std::path::Path;

use serde::Serialize;

use super::{JobError, RunJob};
use crate::command::{Command, CommandClass};
use crate::progress::Progress;
use crate::remedy::told;
use crate::session::Session;
use crate::terminal::{self, OutputError};

/// The script that stands for standard input.
pub const STANDARD_INPUT: &str = "-";

/// Longest line read, in bytes: more than a stroke of hours. A longer one is no script.
const LONGEST_LINE: u64 = 64 << 20;

/// The answer to a line.
#[derive(Debug, Serialize)]
struct PipeAnswer<'a> {
    /// The line of standard input, counted from 1.
    line: usize,
    ok: bool,
    /// The reason for refusing the command.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    /// Number of steps undone or redone.
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<u32>,
    /// Size of the sculpture in voxels.
    dims: [u32; 3],
    /// Number of existing voxels.
    voxels: u64,
    /// The file of the sculpture.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<&'a Path>,
    /// Whether there are changes that are not in that file.
    modified: bool,
}

/// Returns whether the job reads its commands from standard input.
pub fn reads_input(job: &RunJob) -> bool {
    job.script == Path::new(STANDARD_INPUT)
}

/// Executes the lines of standard input until it ends. Returns the number of refused ones. After an error, the lines
/// executed before stay done.
pub fn converse(session: &mut Session, progress: &dyn Progress) -> Result<usize, JobError> {
    answer_lines(session, std::io::stdin().lock(), progress, &mut |answer| {
        terminal::print_result(answer)
    })
}

fn answer_lines(
    session: &mut Session,
    mut input: impl BufRead,
    progress: &dyn Progress,
    answer: &mut dyn FnMut(&str) -> Result<(), OutputError>,
) -> Result<usize, JobError> {
    let (mut line, mut refused, mut bytes) = (0, 0, Vec::new());
    loop {
        bytes.clear();
        let read = input.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut bytes);
        let read = read.map_err(JobError::Input)?;
        if read == 0 {
            return Ok(refused);
        }
        line += 1;
        let is_too_long = read as u64 == LONGEST_LINE && !bytes.ends_with(b"\n");
        let done = if is_too_long {
            // The rest of the line is not kept.
            bytes = Vec::new();
            input.skip_until(b'\n').map_err(JobError::Input)?;
            Err(format!(
                "the line is longer than the {} MiB that a command may have; split it",
                LONGEST_LINE >> 20
            ))
        } else {
            execute(session, &bytes, line == 1, progress)
        };
        let (steps, error) = match done {
            Ok(steps) => (steps, None),
            Err(error) => (None, Some(error)),
        };
        refused += usize::from(error.is_some());
        let grid = session.document().grid();
        let said = PipeAnswer {
            line,
            ok: error.is_none(),
            error,
            steps,
            dims: grid.dims().to_array(),
            voxels: grid.opaque_count(),
            file: session.path(),
            modified: session.modified(),
        };
        // A change is in the journal before the answer reports it.
        session.wait_for_journal();
        // Only paths that are not Unicode cannot be represented in JSON.
        let said = serde_json::to_string(&said)
            .or_else(|_| serde_json::to_string(&PipeAnswer { file: None, ..said }))
            .map_err(|error| JobError::Input(error.into()))?;
        answer(&said).map_err(|error| match error {
            OutputError::ReaderGone => JobError::Unheard(line),
            error => JobError::Output(error),
        })?;
    }
}

/// Executes one line. Returns the number of steps undone or redone, or the error.
fn execute(
    session: &mut Session,
    line: &[u8],
    first: bool,
    progress: &dyn Progress,
) -> Result<Option<u32>, String> {
    let text = str::from_utf8(line).map_err(|_| "the line is not UTF-8 text".to_owned())?;
    let text = if first { text.strip_prefix('\u{feff}').unwrap_or(text) } else { text }.trim();
    if text.is_empty() || text.starts_with('#') {
        return Ok(None);
    }
    let command: Command = text.parse().map_err(|error| format!("{error}"))?;
    let applied = session.execute(&command, progress).map_err(|error| told(&error))?;
    let travels = command.class() == CommandClass::Travel;
    Ok(travels.then_some(applied.steps))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::NewSculpture;
    use crate::document::Limits;
    use crate::sculpture::{ColourDepth, Rgb};

    fn session() -> Session {
        let new = NewSculpture {
            dims: glam::UVec3::new(16, 8, 4),
            voxel_size: glam::Vec3::ONE,
            colour_depth: ColourDepth::Bits24,
            base: Rgb::STONE,
            solid: true,
            room_vx: 0,
            grows: false,
        };
        Session::new(&new, Limits::default()).unwrap()
    }

    fn answers(input: impl BufRead) -> (Vec<serde_json::Value>, Result<usize, JobError>) {
        let mut session = session();
        let mut lines = Vec::new();
        let ended = answer_lines(&mut session, input, &(), &mut |line| {
            assert!(!line.contains('\n'));
            lines.push(serde_json::from_str(line).unwrap());
            Ok(())
        });
        (lines, ended)
    }

    #[test]
    fn each_line_has_one_answer_and_a_refused_one_changes_nothing() {
        let input = "\u{feff}# begins\r\n\nsubtract cuboid at=4,4,2 half=4\nfrobnicate\nend\n\
                     undo 3\nundo\nredo\nopen \"missing.vsc\"\nclear";
        let (lines, ended) = answers(input.as_bytes());
        assert_eq!(ended.unwrap(), 3, "{lines:#?}");
        let numbers: Vec<u64> = lines.iter().map(|l| l["line"].as_u64().unwrap()).collect();
        assert_eq!(numbers, (1..=10).collect::<Vec<u64>>());
        let voxels: Vec<u64> = lines.iter().map(|l| l["voxels"].as_u64().unwrap()).collect();
        assert_eq!(voxels, [512, 512, 256, 256, 256, 512, 512, 256, 256, 0]);
        let ok: Vec<bool> = lines.iter().map(|l| l["ok"].as_bool().unwrap()).collect();
        assert_eq!(ok, [true, true, true, false, false, true, true, true, false, true]);
        assert!(lines.iter().all(|l| l["ok"] == l["error"].is_null()));
        assert!(lines[8]["error"].as_str().unwrap().contains("missing.vsc"));
        let steps = [5, 6, 7, 9].map(|i| lines[i]["steps"].as_u64());
        assert_eq!(steps, [Some(1), Some(0), Some(1), None]);
        assert_eq!(lines[2]["dims"], serde_json::json!([16, 8, 4]));
        assert_eq!(lines[0]["modified"], lines[1]["modified"]);
        assert_eq!(lines[2]["modified"], true);
    }

    #[test]
    fn bytes_that_are_no_text_are_answered() {
        let (lines, ended) = answers(&b"\xff\xfe\x00\nclear\n"[..]);
        assert_eq!((ended.unwrap(), lines.len()), (1, 2));
        assert!(lines[0]["error"].as_str().unwrap().contains("UTF-8"));
        assert_eq!(lines[1]["voxels"], 0);
        assert!(answers(&b""[..]).0.is_empty());
    }

    #[test]
    fn a_reader_that_is_gone_ends_the_work() {
        let mut session = session();
        let input = &b"fill all\nclear\n"[..];
        let ended = answer_lines(&mut session, input, &(), &mut |_| Err(OutputError::ReaderGone));
        assert!(matches!(ended, Err(JobError::Unheard(1))));
        assert_eq!(session.document().grid().opaque_count(), 512, "the second line is not read");
    }

    #[test]
    fn a_line_that_is_too_long_is_refused_and_the_next_one_is_answered() {
        for beyond in [0, 1, LONGEST_LINE / 2] {
            let long = std::io::repeat(b'x').take(LONGEST_LINE + beyond);
            let input = std::io::BufReader::new(long.chain(&b"\nclear\n"[..]));
            let (lines, ended) = answers(input);
            assert_eq!((ended.unwrap(), lines.len()), (1, 2), "{beyond}");
            assert!(lines[0]["error"].as_str().unwrap().contains("64 MiB"));
            assert_eq!((&lines[1]["line"], &lines[1]["voxels"]), (&2.into(), &0.into()));
        }
        // Also if the input ends within it.
        let long = std::io::BufReader::new(std::io::repeat(b'x').take(2 * LONGEST_LINE));
        let (lines, ended) = answers(long);
        assert_eq!((ended.unwrap(), lines.len()), (1, 1));
    }
}
