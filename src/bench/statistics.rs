//! Statistics of repeated measurements.

use std::time::Duration;

use serde::Serialize;

/// Times of some runs, in milliseconds.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Times {
    pub min_ms: f64,
    pub median_ms: f64,
    /// The 99th percentile (nearest rank).
    pub p99_ms: f64,
    pub runs: usize,
}

impl Times {
    /// Computes the times; `None` without runs.
    pub fn of(runs: &[Duration]) -> Option<Times> {
        let mut sorted: Vec<f64> = runs.iter().map(|run| run.as_secs_f64() * 1e3).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let rank = |share: f64| {
            let rank = (share * sorted.len() as f64).ceil() as usize;
            sorted.get(rank.max(1) - 1).copied()
        };
        Some(Times {
            min_ms: *sorted.first()?,
            median_ms: rank(0.5)?,
            p99_ms: rank(0.99)?,
            runs: sorted.len(),
        })
    }
}

/// Calls `f` once for warm-up and `runs` times for the returned times.
pub fn measure<E>(
    runs: usize,
    mut f: impl FnMut() -> Result<Duration, E>,
) -> Result<Option<Times>, E> {
    f()?;
    let times = (0..runs).map(|_| f()).collect::<Result<Vec<_>, E>>()?;
    Ok(Times::of(&times))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_the_nearest_run() {
        let ms = |n: u64| Duration::from_millis(n);
        let runs: Vec<Duration> = (1..=200).rev().map(ms).collect();
        let times = Times::of(&runs).unwrap();
        assert_eq!((times.min_ms, times.median_ms, times.p99_ms), (1.0, 100.0, 198.0));
        let one = Times::of(&[ms(7)]).unwrap();
        assert_eq!((one.min_ms, one.median_ms, one.p99_ms, one.runs), (7.0, 7.0, 7.0, 1));
        assert_eq!(Times::of(&[]), None);
    }
}
