//! The sections of the model: memory limits in MiB, the journal, the histories of saved files, and the initial
//! sculpture of a session.
//!
//! The model has types of its own for these ([`Limits`], [`NewSculpture`]); these are their text form.

use glam::{UVec3, Vec3};
use serde::{Deserialize, Deserializer, de};

use crate::command::NewSculpture;
use crate::document::Limits;
use crate::folders;
use crate::options::{self, InvalidOption, require, require_in};
use crate::persist::saved_history::SavedHistoryOptions;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::{ColourDepth, Grid, Rgb};

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MemoryOptions {
    pub grid_mib: u64,
    pub colour_mib: u64,
    pub history_mib: u64,
    pub history_disk_gib: u64,
}

impl Default for MemoryOptions {
    fn default() -> Self {
        MemoryOptions { grid_mib: 1024, colour_mib: 4096, history_mib: 1024, history_disk_gib: 16 }
    }
}

impl MemoryOptions {
    pub(super) fn check(&self) -> Result<(), InvalidOption> {
        let mib = |key, value| require_in(1..=1 << 24, key, value, "must be 1 to 16777216 MiB");
        mib("grid_mib", self.grid_mib)?;
        mib("colour_mib", self.colour_mib)?;
        mib("history_mib", self.history_mib)?;
        let (key, value) = ("history_disk_gib", self.history_disk_gib);
        require_in(0..=1 << 14, key, value, "must be 0 (none) to 16384 GiB")
    }

    pub(super) fn limits(&self) -> Limits {
        Limits {
            grid_bytes: self.grid_mib << 20,
            colour_bytes: self.colour_mib << 20,
            history_bytes: (self.history_mib << 20) as usize,
            history_disk_bytes: self.history_disk_gib << 30,
        }
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct JournalSettings {
    pub keep: bool,
    pub max_mib: u64,
}

impl Default for JournalSettings {
    fn default() -> Self {
        JournalSettings { keep: true, max_mib: 1024 }
    }
}

impl JournalSettings {
    pub(super) fn check(&self) -> Result<(), InvalidOption> {
        require_in(1..=1 << 24, "max_mib", self.max_mib, "must be 1 to 16777216 MiB")
    }

    /// Returns the size at which a new journal is begun.
    pub fn max_bytes(&self) -> u64 {
        self.max_mib << 20
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SavedHistorySettings {
    pub keep: bool,
    pub max_mib: u64,
}

impl Default for SavedHistorySettings {
    fn default() -> Self {
        SavedHistorySettings { keep: true, max_mib: 512 }
    }
}

impl SavedHistorySettings {
    pub(super) fn check(&self) -> Result<(), InvalidOption> {
        require_in(1..=1 << 24, "max_mib", self.max_mib, "must be 1 to 16777216 MiB")
    }

    /// Returns the options of histories by these settings, in the folder for state.
    pub fn options(&self) -> SavedHistoryOptions {
        SavedHistoryOptions::new(&folders::saved_history_folder(), self.max_mib << 20)
    }
}

#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AutosaveSettings {
    /// Longest time of unsaved changes of a sculpture with a file; 0: until the person saves.
    pub minutes: u32,
}

impl AutosaveSettings {
    pub(super) fn check(&self) -> Result<(), InvalidOption> {
        require_in(0..=1440, "minutes", self.minutes, "must be 0 (off) to 1440")
    }
}

#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NewOptions {
    pub dims: [u32; 3],
    #[serde(deserialize_with = "colour_bits")]
    pub colour_bits: ColourDepth,
    #[serde(deserialize_with = "options::from_text")]
    pub base: Rgb,
    pub room: u32,
    pub grow: bool,
}

impl Default for NewOptions {
    fn default() -> Self {
        NewOptions {
            dims: [256; 3],
            colour_bits: ColourDepth::Bits24,
            base: crate::command::text::DEFAULT_BASE,
            room: 0,
            grow: true,
        }
    }
}

impl NewOptions {
    pub(super) fn check(&self) -> Result<(), InvalidOption> {
        require(
            Grid::check_size(self.dims.into(), Vec3::ONE).is_ok(),
            "dims",
            format_args!("{:?}", self.dims),
            "must be 1 to 8192 voxels per axis",
        )?;
        let room = UVec3::splat(self.room.min(MAX_AXIS_VX) * 2);
        require(
            Grid::check_size(UVec3::from(self.dims) + room, Vec3::ONE).is_ok(),
            "room",
            self.room,
            "leaves more than 8192 voxels per axis",
        )
    }

    /// Returns a solid block.
    pub(super) fn sculpture(&self) -> NewSculpture {
        NewSculpture {
            dims: self.dims.into(),
            voxel_size: Vec3::ONE,
            colour_depth: self.colour_bits,
            base: self.base,
            solid: true,
            room_vx: self.room,
            grows: self.grow,
        }
    }
}

fn colour_bits<'de, D: Deserializer<'de>>(from: D) -> Result<ColourDepth, D::Error> {
    let bits = u32::deserialize(from)?;
    ColourDepth::from_bits(bits)
        .ok_or_else(|| de::Error::custom(format!("{bits} must be 0, 8, 16 or 24")))
}
