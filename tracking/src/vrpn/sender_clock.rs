//! Estimates the time of a sender's report on the host's clock. Networks and schedulers delay reports by varying times;
//! the sender's timestamps do not vary, but its clock differs from the host's. Takes timestamps and arrival times,
//! gives times on the host's clock.

use std::time::Duration;

/// Upper limit for the age of a report on arrival, seconds. A larger difference means that one of the clocks
/// jumped or runs at a wrong rate.
const MAX_DELAY_S: f64 = 0.05;
/// The offset may grow by this many seconds per second: more than clock drift, less than queueing delay.
const DRIFT: f64 = 1.0e-3;

/// The offset between a sender's clock and the host's: that of the least delayed report, with slow decay.
#[derive(Clone, Copy, Debug, Default)]
pub struct SenderClock {
    /// Host minus sender, in seconds, and the arrival time of that report.
    offset: Option<(f64, f64)>,
}

impl SenderClock {
    /// Returns the time of the report: at `arrival_s` or up to [`MAX_DELAY_S`] before. For reports without a timestamp
    /// it is the arrival.
    pub fn host_time_s(&mut self, sent: Option<Duration>, arrival_s: f64) -> f64 {
        let Some(sent) = sent else { return arrival_s };
        let sent_s = sent.as_secs_f64();
        let now = arrival_s - sent_s;
        let offset = match self.offset {
            Some((offset, at_s)) => {
                let drifted = offset + (arrival_s - at_s).max(0.0) * DRIFT;
                if now - drifted > MAX_DELAY_S { now } else { now.min(drifted) }
            }
            None => now,
        };
        self.offset = Some((offset, arrival_s));
        (sent_s + offset).clamp(arrival_s - MAX_DELAY_S, arrival_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn jitter_of_the_way_is_taken_out() {
        let mut clock = SenderClock::default();
        let mut worst: f64 = 0.0;
        for i in 0..1000u32 {
            let made_s = f64::from(i) * 0.01;
            let delay_s = 0.001 + f64::from(i * 7919 % 13) * 0.0015;
            let sent = Duration::from_micros(1_700_000_000_000_000 + u64::from(i) * 10_000);
            let guess = clock.host_time_s(Some(sent), made_s + delay_s);
            if i > 20 {
                worst = worst.max((guess - made_s - 0.001).abs());
            }
        }
        assert!(worst < 0.0005, "off by {worst} s after delays of up to 19 ms");
    }

    proptest! {
        #[test]
        fn never_later_than_arrival_nor_much_earlier(
            steps in prop::collection::vec((any::<u32>(), 0u32..1_000_000, 0.0..2.0f64), 1..50),
        ) {
            let mut clock = SenderClock::default();
            let mut arrival_s = 0.0;
            for (sec, usec, dt) in steps {
                arrival_s += dt;
                let sent = Duration::new(u64::from(sec), usec * 1000);
                let t = clock.host_time_s(Some(sent), arrival_s);
                prop_assert!(t <= arrival_s && t >= arrival_s - MAX_DELAY_S - 1e-9);
                prop_assert_eq!(clock.host_time_s(None, arrival_s), arrival_s);
            }
        }
    }
}
