//! The least value of a function of time from 0 to 1. A solid sweeps the points whose least distance outside of it,
//! along the displacement, is at most 0.

/// A point this deep inside needs no closer examination.
const DEEP: f64 = -0.05;
/// Each round narrows the interval to 0.62 of its length.
const ROUNDS: usize = 40;
/// Pieces of a displacement, in each of which a torus comes nearest at most once.
const PIECES: usize = 200;

/// Returns the least value of a convex function.
pub fn least_of_convex(f: &impl Fn(f64) -> f64) -> f64 {
    least_between(f, 0.0, 1.0)
}

/// Returns the least value of any function that is convex, around its minimum, between neighbouring sample times.
pub fn least(f: &impl Fn(f64) -> f64) -> f64 {
    let time = |i: usize| i as f64 / PIECES as f64;
    let values: Vec<f64> = (0..=PIECES).map(|i| f(time(i))).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    if least < DEEP {
        return least;
    }
    let around = |i: usize| (i.saturating_sub(1), (i + 1).min(PIECES));
    let dips = (0..=PIECES).filter(|&i| {
        let (before, after) = around(i);
        values[i] <= values[before] && values[i] <= values[after]
    });
    let of_dip = |i| least_between(f, time(around(i).0), time(around(i).1));
    dips.map(of_dip).fold(least, f64::min)
}

/// Returns the least value of a convex function between two times, by golden-section search.
fn least_between(f: &impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    let share = (5f64.sqrt() - 1.0) / 2.0;
    let inner = |from: f64, to: f64| [to - share * (to - from), from + share * (to - from)];
    let mut least = f(from).min(f(to));
    let [a, b] = inner(from, to);
    let (mut a, mut b) = ((a, f(a)), (b, f(b)));
    for _ in 0..ROUNDS {
        least = least.min(a.1).min(b.1);
        if least < DEEP {
            break;
        }
        if a.1 < b.1 {
            (to, b) = (b.0, a);
            let time = inner(from, to)[0];
            a = (time, f(time));
        } else {
            (from, a) = (a.0, b);
            let time = inner(from, to)[1];
            b = (time, f(time));
        }
    }
    least
}
