//! Owns where a sculpture goes when the program cannot go on.

use std::path::PathBuf;

use crate::command::Command;
use crate::format::options::ExportForm;
use crate::session::{Session, SessionError};

/// Saves the sculpture where no other file is; gives the path.
pub fn save(session: &mut Session) -> Result<PathBuf, SessionError> {
    let name = session.path().and_then(|p| p.file_stem()).map(|n| n.to_string_lossy().into_owned());
    let name = name.unwrap_or_else(|| "sculpture".to_string());
    let folder = folder();
    if let Err(error) = std::fs::create_dir_all(&folder) {
        // Saving will fail with the same reason and name the path.
        tracing::warn!("cannot make {}: {error}", folder.display());
    }
    let candidate = |n: u32| match n {
        1 => folder.join(format!("{name}-recovered.pvm")),
        n => folder.join(format!("{name}-recovered-{n}.pvm")),
    };
    let path = (1..10_000).map(candidate).find(|p| !p.exists()).unwrap_or_else(|| candidate(1));
    session.execute(&Command::Save { path: path.clone(), form: ExportForm::Auto }, &())?;
    Ok(path)
}

/// The folder for state as the XDG base directory specification says, else the temporary one.
fn folder() -> PathBuf {
    let set = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    set("XDG_STATE_HOME")
        .or_else(|| set("HOME").map(|home| home.join(".local").join("state")))
        .map_or_else(std::env::temp_dir, |base| base.join("virtual-sculpture"))
}
