//! The timing of a film: the turn of each frame, and parts of a film. Pure.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// The turn of each frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Timing {
    pub frames: u32,
    /// The turn of the first frame.
    pub turn_deg: f32,
    /// From the first frame to the one after the last: a whole turn repeats without a jump.
    pub spin_deg: f32,
}

impl Timing {
    /// Returns the turn of the sculpture in a frame, counted from 0.
    pub fn turn_rad(&self, frame: u32) -> f32 {
        let share = f64::from(frame) / f64::from(self.frames);
        let turn_deg = f64::from(self.turn_deg) + f64::from(self.spin_deg) * share;
        ((turn_deg % 360.0) as f32).to_radians()
    }

    pub fn spins(&self) -> bool {
        self.spin_deg != 0.0
    }
}

/// Frames of a film, counted from 1, both ends included: `A..B`, `A..`, `..B`, or one.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct FrameRange {
    first: Option<u32>,
    last: Option<u32>,
}

impl FrameRange {
    /// Returns its frames counted from 0, if a film of that length has all of them.
    pub fn within(&self, frames: u32) -> Option<Range<u32>> {
        let (first, last) = (self.first.unwrap_or(1), self.last.unwrap_or(frames));
        (1 <= first && first <= last && last <= frames).then(|| first - 1..last)
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<FrameRange, String> {
        let rule =
            || "write it as A..B, A.. or ..B: the first and the last frame, from 1".to_string();
        let number = |text: &str| match text.trim() {
            "" => Ok(None),
            text => text.parse().ok().filter(|frame| *frame >= 1).map(Some).ok_or_else(rule),
        };
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        let range = FrameRange { first: number(first)?, last: number(last)? };
        match range {
            FrameRange { first: None, last: None } => Err(rule()),
            FrameRange { first: Some(first), last: Some(last) } if first > last => Err(rule()),
            _ => Ok(range),
        }
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let number = |frame: Option<u32>| frame.map_or(String::new(), |frame| frame.to_string());
        write!(f, "{}..{}", number(self.first), number(self.last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_turn_closes_and_its_steps_are_equal() {
        let timing = Timing { frames: 8, turn_deg: 30.0, spin_deg: 360.0 };
        let degrees = |frame| timing.turn_rad(frame).to_degrees();
        for frame in 0..8 {
            let expected = (30.0 + 45.0 * frame as f32) % 360.0;
            assert!((degrees(frame) - expected).abs() < 1e-3, "{frame}: {}", degrees(frame));
        }
        assert_eq!(timing.turn_rad(8), timing.turn_rad(0), "the one after the last is the first");
        let back = Timing { spin_deg: -90.0, ..timing };
        assert!((back.turn_rad(4).to_degrees() + 15.0).abs() < 1e-3);
        let still = Timing { spin_deg: 0.0, ..timing };
        assert_eq!([0, 7].map(|frame| still.turn_rad(frame)), [30f32.to_radians(); 2]);
        assert!(timing.spins() && !still.spins());
    }

    #[test]
    fn ranges_include_both_ends_and_parts_make_up_the_whole() {
        let within = |text: &str, frames| text.parse::<FrameRange>().unwrap().within(frames);
        assert_eq!(FrameRange::default().within(5), Some(0..5));
        assert_eq!(within("2..4", 5), Some(1..4));
        assert_eq!(within("4..", 5), Some(3..5));
        assert_eq!(within("..1", 5), Some(0..1));
        assert_eq!(within("5", 5), Some(4..5));
        for outside in ["6..", "2..6", "6", "..6"] {
            assert_eq!(within(outside, 5), None, "{outside}");
        }
        for text in ["", "..", "0..3", "3..2", "a..b", "-1..2", "1..2..3", "1-2"] {
            let error = text.parse::<FrameRange>().unwrap_err();
            assert!(error.contains("A..B"), "{text}: {error}");
        }
        assert_eq!("3..".parse::<FrameRange>().unwrap().to_string(), "3..");
    }
}
