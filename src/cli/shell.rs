//! Descriptions of the command line for a shell and for `man`: completions and manual pages.

use clap::Command;
use clap_complete::Shell;

use crate::terminal::{self, OutputError};

/// Prints a script that completes the arguments of the program in `shell`.
pub fn completions(shell: Shell, mut command: Command) -> Result<(), OutputError> {
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, name, &mut script);
    terminal::print_result(String::from_utf8_lossy(&script).trim_end())
}

/// Prints the manual page of the program, or of one of its jobs, in roff. Returns false if there is no such job.
pub fn manual(command: Command, job: Option<&str>) -> Result<bool, OutputError> {
    let mut command = command;
    // Names jobs after the program, and gives them its options.
    command.build();
    let page = match job {
        None => command,
        Some(job) => match command.find_subcommand(job) {
            Some(found) => found.clone(),
            None => return Ok(false),
        },
    };
    let mut roff = Vec::new();
    // A vector accepts any write.
    clap_mangen::Man::new(page).render(&mut roff).map_err(OutputError::Output)?;
    terminal::print_result(String::from_utf8_lossy(&roff).trim_end())?;
    Ok(true)
}
