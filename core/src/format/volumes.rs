//! Which volume of a file with several channels or times is read.
//!
//! Takes how many there are and what was asked for; gives the numbers of those that are read, counted from 1. Knows no file.

use super::FormatError;
use super::options::{ImportOptions, Ordinal};

/// One of several.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Taken {
    /// Which one, counted from 1.
    pub number: u64,
    /// How many there are.
    pub count: u64,
}

impl Default for Taken {
    fn default() -> Taken {
        Taken { number: 1, count: 1 }
    }
}

impl Taken {
    /// Returns the one that was asked for, or the one of the number `usual`.
    fn new(
        what: &'static str,
        asked: Option<Ordinal>,
        usual: u64,
        count: u64,
    ) -> Result<Taken, FormatError> {
        let number = asked.map_or(usual, |asked| asked.get().into());
        match number <= count || asked.is_none() {
            true => Ok(Taken { number, count }),
            false => Err(FormatError::NoSuchVolume { what, asked: number, count }),
        }
    }

    /// Counted from 0.
    pub fn index(self) -> u64 {
        self.number - 1
    }
}

/// The channel and the time that are read of a file. Phases and echoes of a series count as times, and so do volumes along a
/// fourth axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Volumes {
    /// Which channel.
    pub channel: Taken,
    /// Which time.
    pub time: Taken,
}

impl Volumes {
    /// Of a file that has so many: what was asked for, or the first.
    pub(super) fn of(
        options: &ImportOptions,
        channels: u64,
        times: u64,
    ) -> Result<Volumes, FormatError> {
        Volumes::or(options, [1, 1], [channels, times])
    }

    /// Of a file that has so many channels and times: what was asked for, or those of the numbers `usual`.
    pub(super) fn or(
        options: &ImportOptions,
        usual: [u64; 2],
        counts: [u64; 2],
    ) -> Result<Volumes, FormatError> {
        Ok(Volumes {
            channel: Taken::new("channel", options.channel, usual[0], counts[0])?,
            time: Taken::new("time", options.time, usual[1], counts[1])?,
        })
    }

    /// Returns the kinds of which there are several, by their names, with those that are read.
    pub fn several(&self) -> impl Iterator<Item = (&'static str, Taken)> {
        [("channel", self.channel), ("time", self.time)]
            .into_iter()
            .filter(|(_, own)| own.count > 1)
    }
}
