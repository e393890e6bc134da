//! The mask: voxels, existing or not, that no command changes.

use super::model::Model;
use super::statement::{Area, MaskChange, MaskWhat};

/// How many of the 26 neighbours of a voxel must be protected for it to become protected when the mask grows:
/// alternately.
const NEEDED: [usize; 2] = [1, 4];

/// Protected voxels in a box that extends beyond the grid.
struct Wide {
    /// The distance by which it extends beyond the grid.
    beyond: i64,
    size: [i64; 3],
    bits: Vec<bool>,
}

impl Wide {
    fn get(&self, v: [i64; 3]) -> bool {
        let v = v.map(|c| c + self.beyond);
        let inside = (0..3).all(|i| 0 <= v[i] && v[i] < self.size[i]);
        inside && self.bits[(v[0] + self.size[0] * (v[1] + self.size[1] * v[2])) as usize]
    }

    /// Returns how many of the 26 voxels around `v` are `protected`.
    fn around(&self, v: [i64; 3], protected: bool) -> usize {
        let offsets = (0..27).filter(|i| *i != 13).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]);
        let others = offsets.map(|o| std::array::from_fn(|i| v[i] + o[i]));
        others.filter(|other| self.get(*other) == protected).count()
    }

    fn voxels(&self) -> impl Iterator<Item = [i64; 3]> + use<> {
        let ([x, y, z], beyond) = (self.size, self.beyond);
        (0..x * y * z).map(move |i| [i % x, i / x % y, i / x / y].map(|c| c - beyond))
    }

    fn changed(self, new: impl Fn(&Wide, [i64; 3]) -> bool) -> Wide {
        let bits = self.voxels().map(|v| new(&self, v)).collect();
        Wide { bits, ..self }
    }
}

impl Model {
    pub fn change_mask(&mut self, change: &MaskChange) -> bool {
        match change {
            MaskChange::Clear => self.mask_by(|_, _| false),
            MaskChange::Invert => self.mask_by(|_, is| !is),
            MaskChange::Grow(by) | MaskChange::Shrink(by) if !(1..=64).contains(by) => {
                return false;
            }
            MaskChange::Grow(by) => {
                let grown = (0..*by).fold(self.wide(*by as i64, false), |wide, round| {
                    let needed = NEEDED[round % 2];
                    wide.changed(|wide, v| wide.get(v) || wide.around(v, true) >= needed)
                });
                self.mask_by(|v, _| grown.get(v));
            }
            // The free region grows; the last round first. The border of the grid is no outline.
            MaskChange::Shrink(by) => {
                let dims = self.now.dims;
                let within = move |v: [i64; 3]| (0..3).all(|i| 0 <= v[i] && v[i] < dims[i] as i64);
                let shrunk = (0..*by).rev().fold(self.wide(1, true), |wide, round| {
                    let needed = NEEDED[round % 2];
                    wide.changed(|wide, v| {
                        wide.get(v) && !(within(v) && wide.around(v, false) >= needed)
                    })
                });
                self.mask_by(|v, _| shrunk.get(v));
            }
            MaskChange::Put { adds, what } => return self.put_in_mask(*adds, what),
        }
        true
    }

    fn put_in_mask(&mut self, adds: bool, what: &MaskWhat) -> bool {
        match what {
            MaskWhat::Area(Area::Selection) if self.boxes.is_empty() => return false,
            MaskWhat::Area(area) => {
                let covered = self.now.all().map(|v| self.is_in(*area, v)).collect();
                self.cover_with_mask(adds, covered);
            }
            MaskWhat::Solid(placed) => {
                let covered = self.covered(placed);
                self.cover_with_mask(adds, covered);
            }
            MaskWhat::Colour { .. } if self.now.bits == 0 => return false,
            MaskWhat::Colour { colour, tolerance } => {
                let near = |other: &[u8; 3]| {
                    (0..3).all(|i| f64::from(colour[i].abs_diff(other[i])) <= tolerance * 255.0)
                };
                let covered =
                    self.now.voxels.iter().map(|v| v.as_ref().is_some_and(near)).collect();
                self.cover_with_mask(adds, covered);
            }
        }
        true
    }

    /// Adds voxels to the mask, or removes them: those for which `covered` holds, in the order of voxels.
    pub fn cover_with_mask(&mut self, adds: bool, covered: Vec<bool>) {
        let sculpture = self.now.clone();
        let covers = |v| sculpture.place(v).is_some_and(|place| covered[place]);
        self.mask_by(|v, is| if covers(v) { adds } else { is });
    }

    /// Protects each voxel for which `protects` holds, given whether it is protected; only within the limit.
    fn mask_by(&mut self, protects: impl Fn([i64; 3], bool) -> bool) {
        let before = self.now.clone();
        let mut after = (*before).clone();
        for (v, masked) in before.all().zip(&mut after.masked) {
            if self.is_within_limit(v) {
                *masked = protects(v, *masked);
            }
        }
        self.put(after);
    }

    /// Returns the mask in a box that extends beyond the grid, with `outside` there.
    fn wide(&self, beyond: i64, outside: bool) -> Wide {
        let size = self.now.dims.map(|d| d as i64 + 2 * beyond);
        let wide = Wide { beyond, size, bits: vec![] };
        let masked = |v| self.now.place(v).map_or(outside, |place| self.now.masked[place]);
        Wide { bits: wide.voxels().map(masked).collect(), ..wide }
    }
}
