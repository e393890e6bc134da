//! Slices of a series at the same positions: several times, phases of a heart, echoes or kinds of picture. One of them
//! is selected before slices are stacked, so that no volume mixes several.
//!
//! Takes planes with their positions along the normal, in order; gives those of one phase: the requested one, that of
//! the named file, or the first. Where nothing in the files distinguishes them, the order of their numbers does.

use std::collections::BTreeMap;

use super::super::reading::Reading;
use super::plane::{FramePlane, SAME_PLACE_MM};
use crate::format::{FormatError, Volumes};

/// A plane with its position along the normal.
type PlacedPlane = (f64, FramePlane);

/// Returns the planes of one phase (the requested one, that of the file `named` or the first), with its number and the
/// number of phases.
pub fn one_of(
    placed: Vec<PlacedPlane>,
    named: Option<usize>,
    reading: &Reading,
) -> Result<(Volumes, Vec<PlacedPlane>), FormatError> {
    // The position number of each plane.
    let mut places: Vec<usize> = Vec::with_capacity(placed.len());
    for (i, (at, _)) in placed.iter().enumerate() {
        let is_new = i > 0 && at - placed[i - 1].0 >= SAME_PLACE_MM;
        places.push(places.last().map_or(0, |last| last + usize::from(is_new)));
    }
    let count = places.last().map_or(0, |last| last + 1);
    if count == placed.len() || count < 2 {
        return Ok((reading.volumes(1)?, placed));
    }
    let groups = told_apart(&placed, &places, count).unwrap_or_else(|| in_turn(&placed, &places));
    // Single slices that were taken twice are no phases.
    let phases: Vec<usize> =
        (0..groups.len()).filter(|group| 2 * groups[*group].len() > count).collect();
    let is_named = |group: &usize| groups[*group].iter().any(|i| Some(placed[*i].1.file) == named);
    let first = phases.first().copied().unwrap_or(0);
    let usual = (0..groups.len()).find(is_named).unwrap_or(first);
    let number = phases.iter().position(|group| *group == usual).map_or(1, |at| at as u64 + 1);
    let counts = [1, phases.len().max(1) as u64];
    let volumes = Volumes::or(reading.options, [1, number], counts)?;
    let asked = reading.options.time.map(|_| volumes.time.index() as usize);
    let group = asked.map_or(usual, |at| phases.get(at).copied().unwrap_or(first));
    let chosen = groups.get(group).cloned().unwrap_or_default();
    let mut is_chosen = vec![false; placed.len()];
    chosen.into_iter().for_each(|i| is_chosen[i] = true);
    let kept = placed.into_iter().zip(is_chosen).filter_map(|(own, is)| is.then_some(own));
    Ok((volumes, kept.collect()))
}

/// Groups planes into phases by one or two of the values in their files, such that no phase has two planes at a
/// position, and one of them has all positions.
fn told_apart(placed: &[PlacedPlane], places: &[usize], count: usize) -> Option<Vec<Vec<usize>>> {
    let keys = placed.first().map_or(0, |(_, plane)| plane.phases.len());
    let pairs = (0..keys).flat_map(|a| (a + 1..keys).map(move |b| (a, b)));
    for (a, b) in (0..keys).map(|key| (key, key)).chain(pairs) {
        let mut groups: BTreeMap<[SortKey; 2], Vec<usize>> = BTreeMap::new();
        for (i, (_, plane)) in placed.iter().enumerate() {
            let value = |key: usize| SortKey::of(plane.phases.get(key).map_or("", String::as_str));
            groups.entry([value(a), value(b)]).or_default().push(i);
        }
        let is_single =
            |own: &Vec<usize>| own.windows(2).all(|pair| places[pair[0]] != places[pair[1]]);
        let is_whole = |own: &Vec<usize>| own.len() == count;
        if groups.len() > 1 && groups.values().all(is_single) && groups.values().any(is_whole) {
            // Complete phases come first, in the order of their values.
            let mut groups: Vec<Vec<usize>> = groups.into_values().collect();
            groups.sort_by_key(|own| !is_whole(own));
            return Some(groups);
        }
    }
    None
}

/// Groups the first planes of all positions by their numbers, then the second ones, and so on.
fn in_turn(placed: &[PlacedPlane], places: &[usize]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut rank = 0;
    for i in 0..placed.len() {
        rank = if i > 0 && places[i] == places[i - 1] { rank + 1 } else { 0 };
        if groups.len() <= rank {
            groups.push(Vec::new());
        }
        groups[rank].push(i);
    }
    groups
}

/// A value that is sorted as a number where possible.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum SortKey {
    /// The bits, mapped to the order of the numbers.
    Number(u64),
    Text(String),
}

impl SortKey {
    fn of(text: &str) -> SortKey {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                let bits = number.to_bits();
                SortKey::Number(if number.is_sign_negative() { !bits } else { bits | 1 << 63 })
            }
            _ => SortKey::Text(text.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::format::options::{ImportOptions, Ordinal};
    use crate::sculpture::Limits;

    fn plane(file: usize, phase: &str) -> FramePlane {
        let phases = vec![phase.to_string()];
        FramePlane { file, frame: 0, number: 0.0, position: None, axes: None, phases }
    }

    /// Returns the files selected from planes with these positions and phases, with the number of the phase and the
    /// number of phases.
    fn of_time(
        all: &[(f64, &str)],
        named: Option<usize>,
        time: Option<u32>,
    ) -> Result<([u64; 2], Vec<usize>), String> {
        let time = time.and_then(Ordinal::new);
        let options = ImportOptions { time, ..ImportOptions::default() };
        let limits = Limits::default();
        let (path, options, limits, progress) = (Path::new(""), &options, &limits, &());
        let reading = Reading { path, options, limits, progress, in_layers: false };
        let all = all.iter().enumerate().map(|(file, (at, phase))| (*at, plane(file, phase)));
        let mut all: Vec<PlacedPlane> = all.collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (volumes, kept) = one_of(all, named, &reading).map_err(|error| error.to_string())?;
        let files = kept.into_iter().map(|(_, plane)| plane.file).collect();
        Ok(([volumes.time.number, volumes.time.count], files))
    }

    fn taken(all: &[(f64, &str)], named: Option<usize>) -> (u64, Vec<usize>) {
        let ([_, count], files) = of_time(all, named, None).unwrap();
        (count, files)
    }

    #[test]
    fn one_phase_is_taken_whole() {
        let all = [(0.0, "10"), (0.0, "2"), (1.0, "10"), (1.0, "2"), (2.0, "2"), (2.0, "10")];
        // 2 is less than 10.
        assert_eq!(taken(&all, None), (2, vec![1, 3, 4]));
        assert_eq!(taken(&all, Some(2)), (2, vec![0, 2, 5]));
        // A requested time takes precedence over the named file.
        assert_eq!(of_time(&all, None, Some(2)), Ok(([2, 2], vec![0, 2, 5])));
        assert_eq!(of_time(&all, Some(2), Some(1)), Ok(([1, 2], vec![1, 3, 4])));
        assert_eq!(of_time(&all, Some(2), None), Ok(([2, 2], vec![0, 2, 5])));
        assert!(of_time(&all, None, Some(3)).unwrap_err().contains("from 1 to 2"));
        assert!(of_time(&all[..1], None, Some(2)).unwrap_err().contains("only one"));
        // Nothing distinguishes them.
        let same = all.map(|(at, _)| (at, "1"));
        assert_eq!(taken(&same, None), (2, vec![0, 2, 4]));
        // A slice that was taken twice is no phase.
        assert_eq!(
            taken(&[(0.0, "1"), (1.0, "1"), (1.0, "1"), (2.0, "1")], None),
            (1, vec![0, 1, 3])
        );
        // Slices each with a value of its own.
        let own = [(0.0, "1"), (1.0, "2"), (2.0, "3")];
        assert_eq!(taken(&own, None), (1, vec![0, 1, 2]));
    }
}
