//! The 48 orientations of a box along the axes: quarter turns and mirrorings.

use std::fmt;
use std::str::FromStr;

use glam::{IVec3, UVec3};

/// Where the x, y and z axes of a box go: for each the axis (0 to 2) and whether it is reversed.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Orientation {
    to: [usize; 3],
    reversed: [bool; 3],
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Orientation {
    /// As it was copied: no axis exchanged or reversed.
    pub const UPRIGHT: Orientation = Orientation { to: [0, 1, 2], reversed: [false; 3] };

    /// A quarter turn about an axis (0 to 2), anticlockwise as seen against the axis.
    pub fn quarter_turn(axis: usize) -> Orientation {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn = Orientation::UPRIGHT;
        turn.to[u] = v;
        turn.to[v] = u;
        turn.reversed[v] = true;
        turn
    }

    /// The mirroring of one axis (0 to 2).
    pub fn mirroring(axis: usize) -> Orientation {
        let mut mirror = Orientation::UPRIGHT;
        mirror.reversed[axis] = true;
        mirror
    }

    /// First `self`, then `next`.
    pub fn then(self, next: Orientation) -> Orientation {
        Orientation {
            to: self.to.map(|axis| next.to[axis]),
            reversed: [0, 1, 2].map(|i| self.reversed[i] ^ next.reversed[self.to[i]]),
        }
    }

    /// The size of a box of `size` in this orientation.
    pub fn size(self, size: UVec3) -> UVec3 {
        let mut out = UVec3::ZERO;
        (0..3).for_each(|i| out[self.to[i]] = size[i]);
        out
    }

    /// The voxel of a box of `size` that comes to lie at `v`, both counted from the lower corner.
    #[inline]
    pub fn source(self, v: IVec3, size: UVec3) -> IVec3 {
        let mut out = IVec3::ZERO;
        for i in 0..3 {
            let at = v[self.to[i]];
            out[i] = if self.reversed[i] { size[i] as i32 - 1 - at } else { at };
        }
        out
    }
}

impl Default for Orientation {
    fn default() -> Self {
        Orientation::UPRIGHT
    }
}

/// Where x, y and z go: `x,y,z` is upright, `-x,y,z` is mirrored, `y,-x,z` is turned.
impl fmt::Display for Orientation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axes = [0, 1, 2]
            .map(|i| format!("{}{}", if self.reversed[i] { "-" } else { "" }, AXES[self.to[i]]));
        f.write_str(&axes.join(","))
    }
}

impl FromStr for Orientation {
    type Err = String;

    fn from_str(text: &str) -> Result<Orientation, String> {
        let wrong = || "must be the three axes in some order, such as x,-z,y".to_string();
        let mut parts = text.split(',').map(str::trim);
        let mut orientation = Orientation::UPRIGHT;
        let mut taken = [false; 3];
        for i in 0..3 {
            let part = parts.next().ok_or_else(wrong)?;
            let name = part.strip_prefix('-').unwrap_or(part);
            let axis = AXES.iter().position(|axis| *axis == name).ok_or_else(wrong)?;
            if std::mem::replace(&mut taken[axis], true) {
                return Err(wrong());
            }
            orientation.to[i] = axis;
            orientation.reversed[i] = name.len() < part.len();
        }
        if parts.next().is_some() { Err(wrong()) } else { Ok(orientation) }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn all() -> HashSet<Orientation> {
        let steps: Vec<_> = (0..3)
            .flat_map(|axis| [Orientation::quarter_turn(axis), Orientation::mirroring(axis)])
            .collect();
        let mut all = HashSet::from([Orientation::UPRIGHT]);
        loop {
            let more: HashSet<_> =
                all.iter().flat_map(|a| steps.iter().map(|s| a.then(*s))).collect();
            let before = all.len();
            all.extend(more);
            if all.len() == before {
                return all;
            }
        }
    }

    #[test]
    fn there_are_48_and_each_reads_back() {
        let all = all();
        assert_eq!(all.len(), 48);
        for orientation in &all {
            assert_eq!(orientation.to_string().parse(), Ok(*orientation));
        }
        for wrong in ["", "x,y", "x,y,y", "x,y,z,x", "a,b,c", "--x,y,z"] {
            assert!(wrong.parse::<Orientation>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn four_quarter_turns_and_two_mirrorings_are_none() {
        for axis in 0..3 {
            let turn = Orientation::quarter_turn(axis);
            assert_eq!(turn.then(turn).then(turn).then(turn), Orientation::UPRIGHT);
            assert_ne!(turn.then(turn), Orientation::UPRIGHT);
            let mirror = Orientation::mirroring(axis);
            assert_eq!(mirror.then(mirror), Orientation::UPRIGHT);
        }
        // Anticlockwise about z: what lay along x lies along y.
        let size = UVec3::new(4, 1, 1);
        let turn = Orientation::quarter_turn(2);
        assert_eq!(turn.size(size), UVec3::new(1, 4, 1));
        assert_eq!(turn.source(IVec3::new(0, 3, 0), size), IVec3::new(3, 0, 0));
    }

    #[test]
    fn composition_is_one_after_the_other() {
        let size = UVec3::new(2, 3, 5);
        for a in all() {
            for axis in 0..3 {
                let b = Orientation::quarter_turn(axis).then(Orientation::mirroring(0));
                let both = a.then(b);
                let turned = both.size(size);
                assert_eq!(turned, b.size(a.size(size)));
                for i in 0..30 {
                    let v = UVec3::new(
                        i % turned.x,
                        i / turned.x % turned.y,
                        i / (turned.x * turned.y),
                    );
                    let v = v.as_ivec3();
                    assert_eq!(both.source(v, size), a.source(b.source(v, a.size(size)), size));
                }
            }
        }
    }
}
