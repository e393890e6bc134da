//! Names the program's setting or flag that lifts a refusal of the core.
//!
//! Takes errors of the core, which know neither; gives the end of their message. Knows no interface: all parts show
//! errors through [`told`].

use std::fmt::Display;

use crate::document::CommandError;
use crate::format::FormatError;
use crate::mesh::MeshError;
use crate::persist::journal::JournalError;
use crate::print_check::CheckError;
use crate::refusal::{MemoryBudget, OverBudget};
use crate::sculpture::GridError;
use crate::session::SessionError;
use crate::voxelise::VoxeliseError;

/// Returns the message of an error, with the setting or flag that lifts it.
pub fn told(error: &(impl Remedy + ?Sized)) -> String {
    format!("{error}{}", error.remedy())
}

/// An error of the core, for which the program may have a setting or flag.
pub trait Remedy: Display {
    /// Returns the continuation of the message; empty if the message is complete. The message of an error that wraps
    /// another one ends with that of the other.
    fn remedy(&self) -> &'static str;
}

impl<E: Remedy> Remedy for Box<E> {
    fn remedy(&self) -> &'static str {
        (**self).remedy()
    }
}

impl Remedy for OverBudget {
    fn remedy(&self) -> &'static str {
        // Goes on where the message ends: after another way out, or alone.
        match (self.budget, self.advice.is_some()) {
            (MemoryBudget::Grids, true) => ", or raise memory.grid_mib in the settings",
            (MemoryBudget::Grids, false) => "; raise memory.grid_mib in the settings",
            (MemoryBudget::Colours, true) => ", or raise memory.colour_mib in the settings",
            (MemoryBudget::Colours, false) => "; raise memory.colour_mib in the settings",
            (MemoryBudget::GridsAndColours, true) => {
                ", or raise memory.grid_mib or memory.colour_mib in the settings"
            }
            (MemoryBudget::GridsAndColours, false) => {
                "; raise memory.grid_mib or memory.colour_mib in the settings"
            }
        }
    }
}

impl Remedy for GridError {
    fn remedy(&self) -> &'static str {
        match self {
            GridError::OverBudget(over) => over.remedy(),
            _ => "",
        }
    }
}

impl Remedy for CheckError {
    fn remedy(&self) -> &'static str {
        match self {
            CheckError::OverBudget(over) => over.remedy(),
            CheckError::Grid(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for MeshError {
    fn remedy(&self) -> &'static str {
        match self {
            MeshError::OverBudget(over) => over.remedy(),
            MeshError::Grid(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for VoxeliseError {
    fn remedy(&self) -> &'static str {
        match self {
            VoxeliseError::OverBudget(over) => over.remedy(),
            VoxeliseError::Grid(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for FormatError {
    fn remedy(&self) -> &'static str {
        match self {
            FormatError::OverBudget(over) => over.remedy(),
            FormatError::UnknownEnding { .. } | FormatError::NoScanHeader => ", given with `--raw`",
            FormatError::NotDensities { .. } => " (`--colouring`)",
            FormatError::FixedUp { .. } => " (`--up`)",
            FormatError::TooLargeForMesh(_) | FormatError::TooLargeForGlb(_) => {
                "; `--triangles` limits them"
            }
            FormatError::Grid(error) => error.remedy(),
            FormatError::Mesh(error) => error.remedy(),
            FormatError::Voxelise(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for CommandError {
    fn remedy(&self) -> &'static str {
        match self {
            CommandError::OverBudget(over) => over.remedy(),
            CommandError::Irreversible { .. } => {
                ", or raise memory.history_mib or memory.history_disk_gib in the settings"
            }
            CommandError::Grid(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for SessionError {
    fn remedy(&self) -> &'static str {
        match self {
            SessionError::Command(error) => error.remedy(),
            SessionError::Open { error, .. }
            | SessionError::Save { error, .. }
            | SessionError::Picture { error, .. } => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for JournalError {
    fn remedy(&self) -> &'static str {
        match self {
            JournalError::Checkpoint(error) => error.remedy(),
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::format::MeshUp;
    use crate::headless::JobError;
    use crate::tools::pieces::PiecesError;
    use crate::tools::repair::RepairError;

    fn over(budget: MemoryBudget) -> OverBudget {
        OverBudget::new("this needs", 2 << 20, budget, 1 << 20)
    }

    /// Checks that only the program names settings, at the end of the message, at any depth of the error.
    #[test]
    fn a_limit_of_memory_names_its_setting() {
        use MemoryBudget::{Colours, Grids, GridsAndColours};
        let (all, path) = ("memory.grid_mib or memory.colour_mib", PathBuf::from("a.stl"));
        let advised = over(GridsAndColours).advise("choose fewer voxels");
        let formats = [
            (FormatError::OverBudget(over(GridsAndColours)), all),
            (FormatError::OverBudget(over(Colours)), "memory.colour_mib"),
            (FormatError::Grid(over(Grids).into()), "memory.grid_mib"),
            (FormatError::Mesh(over(GridsAndColours).into()), all),
            (FormatError::Mesh(advised.clone().into()), all),
            (FormatError::Voxelise(advised.into()), all),
            (FormatError::from(PiecesError::from(over(Grids).advise("wait"))), "memory.grid_mib"),
        ];
        for (error, setting) in formats {
            let error = SessionError::Open { path: path.clone(), error };
            assert!(!error.to_string().contains("memory."), "{error}");
            let said = JobError::from(error).to_string();
            assert!(said.ends_with(&format!("raise {setting} in the settings")), "{said}");
        }
        let history = "memory.history_mib or memory.history_disk_gib";
        let step = "carve".to_string();
        let commands = [
            (CommandError::OverBudget(over(Colours)), "memory.colour_mib"),
            (CommandError::Irreversible { step, needed_mib: 2, budget_mib: 1 }, history),
            (
                CommandError::Grid(over(Grids).advise("choose a smaller grid").into()),
                "memory.grid_mib",
            ),
            (CommandError::from(RepairError::from(over(Grids))), "memory.grid_mib"),
        ];
        for (error, setting) in commands {
            let error = SessionError::from(error);
            assert!(!error.to_string().contains("memory."), "{error}");
            let (line, command) = (3, "cut".to_string());
            let said = JobError::Command { path: path.clone(), line, command, error: error.into() };
            let said = said.to_string();
            assert!(said.ends_with(&format!("raise {setting} in the settings")), "{said}");
        }
    }

    #[test]
    fn a_setting_goes_on_after_another_way_out() {
        let alone = told(&over(MemoryBudget::Grids));
        assert!(alone.ends_with("for grids; raise memory.grid_mib in the settings"), "{alone}");
        let advised = told(&over(MemoryBudget::Grids).advise("carve less"));
        let end = "carve less, or raise memory.grid_mib in the settings";
        assert!(advised.ends_with(end), "{advised}");
    }

    #[test]
    fn a_limit_that_an_argument_lifts_names_it() {
        let cases = [
            (
                FormatError::UnknownEnding {
                    ending: ".xyz".to_string(),
                    known: ".vsc".to_string(),
                },
                "--raw",
            ),
            (FormatError::NoScanHeader, "--raw"),
            (FormatError::FixedUp { extension: "glb", up: MeshUp::Y }, "--up"),
            (FormatError::TooLargeForMesh(1 << 33), "--triangles"),
            (FormatError::TooLargeForGlb(1 << 33), "--triangles"),
        ];
        for (error, flag) in cases {
            assert!(!error.to_string().contains("--"), "{error}");
            assert!(told(&error).contains(flag), "{}", told(&error));
        }
        assert_eq!(told(&FormatError::Empty), FormatError::Empty.to_string());
    }
}
