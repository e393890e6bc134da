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
use crate::sculpture::GridError;
use crate::session::SessionError;
use crate::tools::pieces::PiecesError;
use crate::tools::repair::RepairError;
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

impl Remedy for GridError {
    fn remedy(&self) -> &'static str {
        match self {
            GridError::Memory { .. } => " or raise memory.grid_mib in the settings",
            _ => "",
        }
    }
}

impl Remedy for PiecesError {
    fn remedy(&self) -> &'static str {
        match self {
            PiecesError::Memory { .. } => ", or raise memory.grid_mib in the settings",
            _ => "",
        }
    }
}

impl Remedy for RepairError {
    fn remedy(&self) -> &'static str {
        match self {
            RepairError::Memory { .. } => "; raise memory.grid_mib in the settings",
            RepairError::Pieces(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for CheckError {
    fn remedy(&self) -> &'static str {
        match self {
            CheckError::Repair(error) => error.remedy(),
            CheckError::Grid(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for MeshError {
    fn remedy(&self) -> &'static str {
        match self {
            MeshError::Memory { .. } | MeshError::SimplifyMemory { .. } => {
                ", or raise memory.grid_mib or memory.colour_mib in the settings"
            }
            MeshError::Grid(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for VoxeliseError {
    fn remedy(&self) -> &'static str {
        match self {
            VoxeliseError::Memory { .. } => {
                ", or raise memory.grid_mib or memory.colour_mib in the settings"
            }
            VoxeliseError::Grid(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for FormatError {
    fn remedy(&self) -> &'static str {
        match self {
            FormatError::Memory { .. } => {
                "; raise memory.grid_mib or memory.colour_mib in the settings"
            }
            FormatError::ColourMemory { .. } => ", or raise memory.colour_mib in the settings",
            FormatError::UnknownEnding { .. } | FormatError::NoScanHeader => ", given with `--raw`",
            FormatError::NotDensities { .. } => " (`--colouring`)",
            FormatError::FixedUp { .. } => " (`--up`)",
            FormatError::TooLargeForMesh(_) | FormatError::TooLargeForGlb(_) => {
                "; `--triangles` limits them"
            }
            FormatError::Grid(error) => error.remedy(),
            FormatError::Mesh(error) => error.remedy(),
            FormatError::Pieces(error) => error.remedy(),
            FormatError::Voxelise(error) => error.remedy(),
            _ => "",
        }
    }
}

impl Remedy for CommandError {
    fn remedy(&self) -> &'static str {
        match self {
            CommandError::ColourMemory { .. } => "; raise memory.colour_mib in the settings",
            CommandError::Irreversible { .. } => {
                ", or raise memory.history_mib or memory.history_disk_gib in the settings"
            }
            CommandError::Grid(error) => error.remedy(),
            CommandError::Repair(error) => error.remedy(),
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

    use glam::UVec3;

    use super::*;
    use crate::format::MeshUp;
    use crate::headless::JobError;

    fn grid() -> GridError {
        GridError::Memory { dims: UVec3::splat(1024), needed_mib: 144, budget_mib: 64 }
    }

    /// Checks that only the program names settings, at the end of the message, at any depth of the error.
    #[test]
    fn a_limit_of_memory_names_its_setting() {
        let (needed_mib, budget_mib) = (2, 1);
        let (all, path) = ("memory.grid_mib or memory.colour_mib", PathBuf::from("a.stl"));
        let formats = [
            (FormatError::Memory { needed_mib, budget_mib }, all),
            (FormatError::ColourMemory { needed_mib, budget_mib }, "memory.colour_mib"),
            (FormatError::Grid(grid()), "memory.grid_mib"),
            (FormatError::Mesh(MeshError::Memory { needed_mib, budget_mib }), all),
            (
                FormatError::Mesh(MeshError::SimplifyMemory {
                    triangles: 9,
                    needed_mib,
                    budget_mib,
                }),
                all,
            ),
            (FormatError::Voxelise(VoxeliseError::Memory { needed_mib, budget_mib }), all),
            (
                FormatError::Pieces(PiecesError::Memory { needed_mib, budget_mib }),
                "memory.grid_mib",
            ),
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
            (CommandError::ColourMemory { needed_mib, budget_mib }, "memory.colour_mib"),
            (CommandError::Irreversible { step, needed_mib: 2, budget_mib: 1 }, history),
            (CommandError::Grid(grid()), "memory.grid_mib"),
            (
                CommandError::Repair(RepairError::Memory { needed_mib, budget_mib }),
                "memory.grid_mib",
            ),
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
    fn what_an_argument_lifts_names_it() {
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
