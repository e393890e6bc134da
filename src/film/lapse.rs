//! A time lapse of a script or of the steps of a session: the commands executed before each frame.
//!
//! Time is counted in *steps*, the commands with a visible effect, so that a film does not stand still while a script
//! only moves its marker. Everything before the first step belongs to the beginning, including a new or opened
//! sculpture. `save` is skipped: a film writes no other file.

use std::path::{Path, PathBuf};

use crate::command::{Command, CommandClass};
use crate::headless::{self, JobError};

/// The commands and the ends of steps.
#[derive(Debug)]
pub struct Lapse {
    /// The path of the script, for messages.
    pub path: PathBuf,
    /// The commands with their lines.
    pub commands: Vec<(usize, Command)>,
    /// The number of commands at the beginning, and after each step.
    ends: Vec<usize>,
}

impl Lapse {
    pub fn read(path: &Path) -> Result<Lapse, JobError> {
        let text = headless::read_script(path)?;
        Ok(Lapse::new(path, headless::script_commands(&text, path)?))
    }

    /// Returns the steps of a session that can undo so many: back to the first, then forward one by one.
    pub fn of_steps(undos: usize) -> Lapse {
        let back = Command::Undo { steps: Some(u32::try_from(undos).unwrap_or(u32::MAX)) };
        let forward = Command::Redo { steps: Some(1) };
        let commands = std::iter::once(back).chain(std::iter::repeat_n(forward, undos));
        Lapse {
            path: PathBuf::new(),
            commands: commands.map(|command| (0, command)).collect(),
            ends: (1..=undos + 1).collect(),
        }
    }

    fn new(path: &Path, mut commands: Vec<(usize, Command)>) -> Lapse {
        commands.retain(|(_, command)| !matches!(command, Command::Save { .. }));
        let mut ends = vec![0];
        for (i, (_, command)) in commands.iter().enumerate() {
            let begins = command.class() == CommandClass::Replace;
            if begins && ends.len() == 1 {
                ends[0] = i + 1;
            } else if is_step(command) {
                ends.push(i + 1);
            }
        }
        if let Some(last) = ends.last_mut() {
            *last = commands.len();
        }
        Lapse { path: path.to_path_buf(), commands, ends }
    }

    /// Returns the files read by its commands.
    pub fn inputs(&self) -> impl Iterator<Item = &Path> {
        self.commands.iter().filter_map(|(_, command)| match command {
            Command::Open { path, .. } => Some(path.as_path()),
            other => other.picture(),
        })
    }

    /// Returns the number of commands executed before a frame, counted from 0, of `frames`: the first shows the
    /// beginning, the last one everything.
    pub fn commands_at(&self, frame: u32, frames: u32) -> usize {
        let (steps, last) = (self.ends.len() as u64 - 1, u64::from(frames) - 1);
        let step = match last {
            0 => steps,
            last => (2 * u64::from(frame) * steps + last) / (2 * last),
        };
        self.ends[step as usize]
    }
}

/// Returns whether a command has a visible effect.
fn is_step(command: &Command) -> bool {
    match command.class() {
        CommandClass::Replace
        | CommandClass::Tool
        | CommandClass::Area
        | CommandClass::Arrange
        | CommandClass::Whole
        | CommandClass::Orient
        | CommandClass::Canvas
        | CommandClass::Travel => true,
        CommandClass::Stroke => *command == Command::Cancel,
        // The pose of a film is that of its last frame.
        CommandClass::Setting | CommandClass::File | CommandClass::Mask | CommandClass::Copy => {
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lapse(text: &str) -> Lapse {
        let path = Path::new("s.sculpt");
        Lapse::new(path, headless::script_commands(text, path).unwrap())
    }

    const BALL: &str = "add ellipsoid at=4,4,4 half=2\n";

    #[test]
    fn the_first_frame_shows_the_beginning_and_the_last_all() {
        let text = format!(
            "new dims=8,8,8\nmark at=0,0,0 size=2,2,2\nbegin\n{BALL}{BALL}end\ncopy\n{BALL}copy\n"
        );
        let lapse = lapse(&text);
        let shown = |frames| (0..frames).map(|f| lapse.commands_at(f, frames)).collect::<Vec<_>>();
        // Three steps end after 4, 5 and 8 commands; the last includes the trailing ones.
        assert_eq!(shown(4), [1, 4, 5, 9]);
        assert_eq!(shown(2), [1, 9]);
        assert_eq!(shown(1), [9], "a film of one frame shows the end");
        assert_eq!(shown(7), [1, 4, 4, 5, 5, 9, 9]);
    }

    #[test]
    fn the_steps_of_a_session_begin_with_all_undone() {
        let lapse = Lapse::of_steps(3);
        let text: Vec<String> =
            lapse.commands.iter().map(|(_, command)| command.to_string()).collect();
        assert_eq!(text, ["undo 3", "redo 1", "redo 1", "redo 1"]);
        assert_eq!([0, 1, 2, 3].map(|frame| lapse.commands_at(frame, 4)), [1, 2, 3, 4]);
        assert_eq!(lapse.commands_at(0, 1), 4, "a film of one frame shows the end");
    }

    #[test]
    fn many_steps_are_spread_evenly() {
        let lapse = lapse(&format!("new dims=8,8,8\n{}", BALL.repeat(1000)));
        let shown: Vec<usize> = (0..11).map(|frame| lapse.commands_at(frame, 11)).collect();
        let expected: Vec<usize> = (0..11).map(|frame| 1 + 100 * frame).collect();
        assert_eq!(shown, expected);
    }

    #[test]
    fn scripts_without_steps_stand_still_and_saves_are_left_out() {
        let quiet = lapse("new dims=8,8,8\nsave \"a.vsc\"\ncopy\n");
        assert_eq!(quiet.commands.len(), 2);
        assert_eq!([0, 1, 2].map(|frame| quiet.commands_at(frame, 3)), [2; 3]);
        assert_eq!(lapse("").commands_at(5, 10), 0);
        let reads =
            lapse("open \"a.vsc\"\ntexture \"b.png\" cuboid at=4,4,4 half=1\nsave \"c.vsc\"\n");
        assert_eq!(reads.inputs().collect::<Vec<_>>(), [Path::new("a.vsc"), Path::new("b.png")]);
    }
}
