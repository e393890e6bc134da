//! The 48 orientations of a box along the axes (quarter turns and mirrorings), and which of them turns a
//! given axis upright.
//!
//! Maps sizes and voxel coordinates; holds no voxels.

use std::fmt;
use std::str::FromStr;

use glam::{IVec3, UVec3};

/// The destination of the x, y and z axes of a box: for each the axis (0 to 2) and whether it is reversed.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Orientation {
    to: [usize; 3],
    reversed: [bool; 3],
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Orientation {
    /// The original orientation: no axis exchanged or reversed.
    pub const UPRIGHT: Orientation = Orientation { to: [0, 1, 2], reversed: [false; 3] };

    /// Returns all 48, [`Orientation::UPRIGHT`] first.
    pub fn all() -> impl Iterator<Item = Orientation> {
        const ORDERS: [[usize; 3]; 6] =
            [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
        ORDERS.into_iter().flat_map(|to| {
            (0..8).map(move |signs| {
                let reversed = [0, 1, 2].map(|axis| signs >> axis & 1 != 0);
                Orientation { to, reversed }
            })
        })
    }

    /// Returns a quarter turn about an axis (0 to 2), anticlockwise as seen against the axis.
    pub fn quarter_turn(axis: usize) -> Orientation {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut turn = Orientation::UPRIGHT;
        turn.to[u] = v;
        turn.to[v] = u;
        turn.reversed[v] = true;
        turn
    }

    /// Returns the mirroring of one axis (0 to 2).
    pub fn mirroring(axis: usize) -> Orientation {
        let mut mirror = Orientation::UPRIGHT;
        mirror.reversed[axis] = true;
        mirror
    }

    /// Composes two orientations: first `self`, then `next`.
    pub fn then(self, next: Orientation) -> Orientation {
        Orientation {
            to: self.to.map(|axis| next.to[axis]),
            reversed: [0, 1, 2].map(|i| self.reversed[i] ^ next.reversed[self.to[i]]),
        }
    }

    /// Returns the inverse: `self.then(self.inverse())` is upright.
    pub fn inverse(self) -> Orientation {
        let mut inverse = Orientation::UPRIGHT;
        for axis in 0..3 {
            inverse.to[self.to[axis]] = axis;
            inverse.reversed[self.to[axis]] = self.reversed[axis];
        }
        inverse
    }

    /// Returns whether an axis (0 to 2), before it is moved, is reversed.
    pub(crate) fn reverses(self, axis: usize) -> bool {
        self.reversed[axis]
    }

    /// Permutes per-axis values with the axes. Ignores reversal.
    pub fn permuted<T: Copy>(self, values: [T; 3]) -> [T; 3] {
        let mut out = values;
        (0..3).for_each(|axis| out[self.to[axis]] = values[axis]);
        out
    }

    /// Returns the size of a box of `size` in this orientation.
    pub fn size(self, size: UVec3) -> UVec3 {
        self.permuted(size.to_array()).into()
    }

    /// Returns the voxel of a box of `size` that is moved to `v`, both counted from the lower corner.
    #[inline]
    pub fn source(self, v: IVec3, size: UVec3) -> IVec3 {
        let mut out = IVec3::ZERO;
        for i in 0..3 {
            let at = v[self.to[i]];
            out[i] = if self.reversed[i] { size[i] as i32 - 1 - at } else { at };
        }
        out
    }

    /// Returns the destination of the voxel `v` of a box of `size`; the inverse of [`Orientation::source`].
    #[inline]
    pub fn destination(self, v: IVec3, size: UVec3) -> IVec3 {
        self.inverse().source(v, self.size(size))
    }
}

/// The axis of a volume that points up. Sculptures stand with y up.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Up {
    /// x.
    X,
    /// -x.
    MinusX,
    /// y, so nothing need be rotated.
    #[default]
    Y,
    /// -y.
    MinusY,
    /// z.
    Z,
    /// -z.
    MinusZ,
}

impl Up {
    /// All of them with their text forms.
    pub const NAMED: [(Up, &'static str); 6] = [
        (Up::Y, "y"),
        (Up::Z, "z"),
        (Up::MinusZ, "-z"),
        (Up::MinusY, "-y"),
        (Up::X, "x"),
        (Up::MinusX, "-x"),
    ];

    /// Returns the rotation that maps this axis to the y axis. Where that leaves a choice, the side that faces the
    /// viewer (z) keeps facing the viewer.
    pub fn turned_upright(self) -> Orientation {
        let (to, reversed) = match self {
            Up::Y => ([0, 1, 2], [false, false, false]),
            Up::MinusY => ([0, 1, 2], [true, true, false]),
            Up::Z => ([0, 2, 1], [false, true, false]),
            Up::MinusZ => ([0, 2, 1], [false, false, true]),
            Up::X => ([1, 0, 2], [false, true, false]),
            Up::MinusX => ([1, 0, 2], [true, false, false]),
        };
        Orientation { to, reversed }
    }
}

impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Up::NAMED.iter().find(|(up, _)| up == self);
        f.write_str(name.map_or("", |(_, name)| name))
    }
}

/// Reads an axis with or without sign, such as `z`, `+z` or `-z`.
impl FromStr for Up {
    type Err = String;

    fn from_str(text: &str) -> Result<Up, String> {
        let unsigned = text.strip_prefix('+').unwrap_or(text);
        let known = Up::NAMED.iter().find(|(_, name)| *name == unsigned);
        known
            .filter(|_| !text.starts_with("+-"))
            .map(|(up, _)| *up)
            .ok_or_else(|| "must be the axis that points up: x, y, z, -x, -y or -z".to_string())
    }
}

impl Default for Orientation {
    fn default() -> Self {
        Orientation::UPRIGHT
    }
}

/// Writes the destinations of x, y and z: `x,y,z` is upright, `-x,y,z` is mirrored, `y,-x,z` is rotated.
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

    #[test]
    fn there_are_48_and_each_reads_back() {
        let all: HashSet<_> = Orientation::all().collect();
        assert_eq!(all.len(), 48);
        assert_eq!(Orientation::all().next(), Some(Orientation::UPRIGHT));
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
        // Anticlockwise about z: voxels along x move to y.
        let size = UVec3::new(4, 1, 1);
        let turn = Orientation::quarter_turn(2);
        assert_eq!(turn.size(size), UVec3::new(1, 4, 1));
        assert_eq!(turn.source(IVec3::new(0, 3, 0), size), IVec3::new(3, 0, 0));
    }

    #[test]
    fn composition_is_one_after_the_other() {
        let size = UVec3::new(2, 3, 5);
        for a in Orientation::all() {
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

    #[test]
    fn the_inverse_leads_back() {
        let size = UVec3::new(2, 3, 5);
        for orientation in Orientation::all() {
            let inverse = orientation.inverse();
            assert_eq!(orientation.then(inverse), Orientation::UPRIGHT);
            assert_eq!(inverse.then(orientation), Orientation::UPRIGHT);
            let v = IVec3::new(1, 0, 3);
            let there = orientation.destination(v, size);
            assert_eq!(orientation.source(there, size), v);
        }
    }

    #[test]
    fn each_axis_can_be_turned_upright_without_mirroring() {
        let size = UVec3::splat(9);
        for (up, name) in Up::NAMED {
            assert_eq!((name.parse(), up.to_string()), (Ok(up), name.to_string()));
            let turn = up.turned_upright();
            let axis =
                |from: IVec3| turn.destination(IVec3::splat(4) + from, size) - IVec3::splat(4);
            let direction = match up {
                Up::X => IVec3::X,
                Up::MinusX => IVec3::NEG_X,
                Up::Y => IVec3::Y,
                Up::MinusY => IVec3::NEG_Y,
                Up::Z => IVec3::Z,
                Up::MinusZ => IVec3::NEG_Z,
            };
            assert_eq!(axis(direction), IVec3::Y, "{name}");
            let [x, y, z] = [IVec3::X, IVec3::Y, IVec3::Z].map(axis);
            assert_eq!(x.cross(y), z, "{name}: a rotation");
        }
        assert_eq!("+z".parse(), Ok(Up::Z));
        for wrong in ["", "w", "+-z", "--z", "zz", "up"] {
            assert!(wrong.parse::<Up>().is_err(), "{wrong}");
        }
    }
}
