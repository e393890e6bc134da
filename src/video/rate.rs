//! Frame rates as exact fractions, so that long films do not drift.

use std::str::FromStr;
use std::time::Duration;

/// Frames per second, as a fraction. Between 0.01 and 1000.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Rate {
    frames: u32,
    seconds: u32,
}

impl Rate {
    /// The rate of films that do not state one.
    pub const DEFAULT: Rate = Rate { frames: 30, seconds: 1 };

    /// Returns the rate; `None` outside 0.01 to 1000 frames per second.
    pub fn new(frames: u32, seconds: u32) -> Option<Rate> {
        let (f, s) = (u64::from(frames), u64::from(seconds));
        (s > 0 && f * 100 >= s && f <= s * 1000).then_some(Rate { frames, seconds })
    }

    pub fn per_second(self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }

    /// Returns numerator and denominator of the frames per second.
    pub fn fraction(self) -> (u32, u32) {
        (self.frames, self.seconds)
    }

    /// Returns the time of frame number `index`, counted from 0.
    pub fn time_of(self, index: u64) -> Duration {
        let nanos =
            u128::from(index) * u128::from(self.seconds) * 1_000_000_000 / u128::from(self.frames);
        Duration::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX))
    }
}

impl FromStr for Rate {
    type Err = String;

    /// Parses `30`, `29.97` or `30000/1001`.
    fn from_str(text: &str) -> Result<Rate, String> {
        let rule = || format!("{text:?} is not a frame rate between 0.01 and 1000 per second");
        let rate = if let Some((frames, seconds)) = text.split_once('/') {
            frames.parse().ok().zip(seconds.parse().ok()).and_then(|(f, s)| Rate::new(f, s))
        } else {
            let value: f64 = text.parse().map_err(|_| rule())?;
            // Thousandths of a frame: exact for 29.97 and its like.
            let in_range = value.is_finite() && (0.0..=1000.0).contains(&value);
            in_range.then(|| (value * 1000.0).round() as u32).and_then(|f| Rate::new(f, 1000))
        };
        rate.ok_or_else(rule)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_and_counts_exactly() {
        let ntsc: Rate = "30000/1001".parse().unwrap();
        assert_eq!(ntsc.time_of(30000), Duration::from_secs(1001));
        assert_eq!("29.97".parse::<Rate>().unwrap().time_of(2997), Duration::from_secs(100));
        assert_eq!("25".parse::<Rate>().unwrap().per_second(), 25.0);
        for bad in ["", "0", "-3", "nan", "inf", "1001", "1/0", "0/0", "1/1000", "a", "3/-1"] {
            assert!(bad.parse::<Rate>().is_err(), "{bad}");
        }
        assert_eq!(Rate::new(1, u32::MAX), None);
        assert!(Rate::DEFAULT.time_of(u64::MAX) > Duration::from_secs(1 << 30));
    }
}
