//! The scene of a MagicaVoxel file: a graph of transforms, groups and shapes, followed from its root to the list of all
//! placed models.
//!
//! Children may be shared, so that a small file can name very many objects, or itself: depth and number are bounded.

use std::collections::{HashMap, HashSet};

use glam::I64Vec3;

use crate::format::FormatError;

/// Greatest nesting of groups that is followed.
const MOST_DEPTH: usize = 200;
/// Greatest number of objects, groups and transforms that are visited.
const MOST_VISITS: u32 = 1 << 20;

/// One of the 48 axis-aligned orientations: row i of the matrix holds `sign[i]` in column `axis[i]`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Turn {
    axis: [usize; 3],
    sign: [i64; 3],
}

impl Turn {
    const NONE: Turn = Turn { axis: [0, 1, 2], sign: [1; 3] };

    /// Parses the decimal text of the rotation byte: two bits each for the columns of the first two rows, then the
    /// signs of all three.
    pub fn parse(text: Option<&[u8]>) -> Option<Turn> {
        let Some(text) = text else { return Some(Turn::NONE) };
        let byte: u8 = std::str::from_utf8(text).ok()?.parse().ok()?;
        let (first, second) = (usize::from(byte & 3), usize::from(byte >> 2 & 3));
        if first > 2 || second > 2 || first == second {
            return None;
        }
        let sign = [4, 5, 6].map(|bit| if byte >> bit & 1 != 0 { -1 } else { 1 });
        Some(Turn { axis: [first, second, 3 - first - second], sign })
    }

    fn apply(&self, v: I64Vec3) -> I64Vec3 {
        I64Vec3::from_array([0, 1, 2].map(|row| self.sign[row] * v[self.axis[row]]))
    }

    /// Composes: first `inner`, then `self`.
    fn of(&self, inner: &Turn) -> Turn {
        Turn {
            axis: self.axis.map(|row| inner.axis[row]),
            sign: [0, 1, 2].map(|row| self.sign[row] * inner.sign[self.axis[row]]),
        }
    }
}

/// A node of the graph.
#[derive(Debug)]
pub enum Node {
    Transform {
        child: i32,
        layer: i32,
        is_hidden: bool,
        turn: Turn,
        shift: I64Vec3,
        has_frames: bool,
    },
    Group {
        children: Vec<i32>,
    },
    Shape {
        part: usize,
        has_frames: bool,
    },
}

/// A model placed in the scene.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index of the model.
    pub part: usize,
    turn: Turn,
    shift: I64Vec3,
}

impl Instance {
    /// Returns a model of a file without a scene.
    pub fn alone(part: usize) -> Instance {
        Instance { part, turn: Turn::NONE, shift: I64Vec3::ZERO }
    }

    /// Returns the position of the voxel `v` of a model of `size`. A model rotates about its centre, rounded down to a
    /// voxel corner; computed with the doubled coordinates of the voxel's centre, which are whole.
    pub fn place(&self, v: I64Vec3, size: I64Vec3) -> I64Vec3 {
        let doubled = self.turn.apply(2 * (v - size / 2) + 1) + 2 * self.shift;
        (doubled - 1) / 2
    }
}

/// All models of a scene.
#[derive(Debug, Default)]
pub struct PlacedModels {
    pub instances: Vec<Instance>,
    /// Number of nodes left out because they, or their layers, are hidden.
    pub hidden: usize,
    /// Whether anything is animated.
    pub has_frames: bool,
}

struct Walker<'a> {
    nodes: &'a HashMap<i32, Node>,
    hidden_layers: &'a HashSet<i32>,
    parts: usize,
    path: Vec<i32>,
    visits: u32,
    placed: PlacedModels,
}

/// Follows the graph from `root`; there are `parts` models.
pub fn place(
    nodes: &HashMap<i32, Node>,
    root: i32,
    hidden_layers: &HashSet<i32>,
    parts: usize,
) -> Result<PlacedModels, FormatError> {
    let (path, placed) = (Vec::new(), PlacedModels::default());
    let mut walker = Walker { nodes, hidden_layers, parts, path, visits: 0, placed };
    walker.visit(root, Turn::NONE, I64Vec3::ZERO)?;
    Ok(walker.placed)
}

impl Walker<'_> {
    fn visit(&mut self, id: i32, turn: Turn, shift: I64Vec3) -> Result<(), FormatError> {
        let fault = |what: &str| FormatError::Malformed {
            place: format!("node {id} of the scene"),
            what: what.to_string(),
        };
        let node = self.nodes.get(&id).ok_or_else(|| fault("it is named, but not there"))?;
        self.visits += 1;
        if self.visits > MOST_VISITS {
            return Err(fault("more than a million objects, most of them copies"));
        }
        if self.path.contains(&id) {
            return Err(fault("it is part of itself"));
        }
        if self.path.len() >= MOST_DEPTH {
            return Err(fault("groups are nested too deeply"));
        }
        self.path.push(id);
        match node {
            Node::Transform { child, layer, is_hidden, turn: own, shift: step, has_frames } => {
                self.placed.has_frames |= has_frames;
                if *is_hidden || self.hidden_layers.contains(layer) {
                    self.placed.hidden += 1;
                } else {
                    self.visit(*child, turn.of(own), turn.apply(*step) + shift)?;
                }
            }
            Node::Group { children } => {
                for &child in children {
                    self.visit(child, turn, shift)?;
                }
            }
            Node::Shape { part, has_frames } => {
                self.placed.has_frames |= has_frames;
                if *part >= self.parts {
                    let there = self.parts;
                    return Err(fault(&format!("it names model {part}, but there are {there}")));
                }
                self.placed.instances.push(Instance { part: *part, turn, shift });
            }
        }
        self.path.pop();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_compose_as_their_matrices_do() {
        let all = || (0..128u8).filter_map(|byte| Turn::parse(Some(byte.to_string().as_bytes())));
        assert_eq!(all().count(), 48);
        assert_eq!(Turn::parse(Some(b"4")), Some(Turn::NONE));
        let v = I64Vec3::new(3, 5, 7);
        for (a, b) in all().flat_map(|a| all().map(move |b| (a, b))) {
            assert_eq!(a.of(&b).apply(v), a.apply(b.apply(v)));
        }
        for wrong in ["3", "0", "5", "", "x", "300"] {
            assert_eq!(Turn::parse(Some(wrong.as_bytes())), None, "{wrong}");
        }
    }

    #[test]
    fn models_turn_about_their_middle() {
        // A quarter turn about z of a model 4 x 2: its centre stays in place.
        let turn = Turn { axis: [1, 0, 2], sign: [-1, 1, 1] };
        let instance = Instance { part: 0, turn, shift: I64Vec3::new(10, 20, 0) };
        let size = I64Vec3::new(4, 2, 1);
        let corners = [I64Vec3::ZERO, size - 1].map(|v| instance.place(v, size));
        assert_eq!(corners, [I64Vec3::new(10, 18, 0), I64Vec3::new(9, 21, 0)]);
    }
}
