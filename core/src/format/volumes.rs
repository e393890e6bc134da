//! Selects the volume to read from a file with several channels or times.
//!
//! Takes their number and the request; gives the numbers of those to read, counted from 1. Knows no file.

use super::FormatError;
use super::options::{ImportOptions, Ordinal};

/// The selected one of several.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ChosenVolume {
    /// Its number, counted from 1.
    pub number: u64,
    /// Number of available ones.
    pub count: u64,
}

impl Default for ChosenVolume {
    fn default() -> ChosenVolume {
        ChosenVolume { number: 1, count: 1 }
    }
}

impl ChosenVolume {
    /// Returns the requested one, or the one numbered `usual`.
    fn new(
        what: &'static str,
        asked: Option<Ordinal>,
        usual: u64,
        count: u64,
    ) -> Result<ChosenVolume, FormatError> {
        let number = asked.map_or(usual, |asked| asked.get().into());
        match number <= count || asked.is_none() {
            true => Ok(ChosenVolume { number, count }),
            false => Err(FormatError::NoSuchVolume { what, asked: number, count }),
        }
    }

    /// Returns the index, counted from 0.
    pub fn index(self) -> u64 {
        self.number - 1
    }
}

/// The channel and the time to read from a file. Phases and echoes of a series count as times, and so do volumes along
/// a fourth axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Volumes {
    /// The channel.
    pub channel: ChosenVolume,
    /// The time.
    pub time: ChosenVolume,
}

impl Volumes {
    /// Selects from so many: the requested ones, or the first.
    pub(super) fn of(
        options: &ImportOptions,
        channels: u64,
        times: u64,
    ) -> Result<Volumes, FormatError> {
        Volumes::or(options, [1, 1], [channels, times])
    }

    /// Selects from so many channels and times: the requested ones, or those numbered `usual`.
    pub(super) fn or(
        options: &ImportOptions,
        usual: [u64; 2],
        counts: [u64; 2],
    ) -> Result<Volumes, FormatError> {
        Ok(Volumes {
            channel: ChosenVolume::new("channel", options.channel, usual[0], counts[0])?,
            time: ChosenVolume::new("time", options.time, usual[1], counts[1])?,
        })
    }

    /// Returns the kinds with several members, by name, with those that are read.
    pub fn several(&self) -> impl Iterator<Item = (&'static str, ChosenVolume)> {
        [("channel", self.channel), ("time", self.time)]
            .into_iter()
            .filter(|(_, own)| own.count > 1)
    }
}
