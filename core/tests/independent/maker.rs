//! Random lines, such as make sense for a sculpture as it is; now and then one that does not.

use super::chance::Chance;
use super::deed::{Area, Axes, Colour, Deed, Mirror, Op, Ray};
use super::model::Model;
use super::solid::{Placed, Shape, Turn};

/// What must come up in a hundred scripts.
pub const VERBS: [&str; 22] = [
    "new", "begin", "end", "cancel", "add", "subtract", "recolour", "spray", "fill", "clear",
    "dye", "mark", "select", "limit", "symmetry", "copy", "cut", "paste", "move", "array", "undo",
    "redo",
];

pub struct Maker<'a> {
    pub chance: &'a mut Chance,
    pub model: &'a Model,
}

impl Maker<'_> {
    pub fn deed(&mut self, first: bool) -> Deed {
        if first || self.chance.one_in(60) {
            return self.new_sculpture();
        }
        match self.chance.below(66) {
            0..20 => self.solid(),
            20..24 => self.symmetry(),
            24..27 => Deed::Fill {
                area: self.area(),
                colour: (!self.chance.one_in(2)).then(|| self.colour()),
            },
            27 => Deed::Clear { area: self.area() },
            28..31 => Deed::Dye { area: self.area(), colour: self.colour() },
            31..35 => Deed::Mark {
                at: self.chance.three(|c| c.whole(-4, 14)),
                size: self.chance.three(|c| c.whole(1, 12)),
            },
            35..37 => Deed::Select { adds: !self.chance.one_in(3) },
            37 => match self.chance.below(3) {
                0 => Deed::Drop,
                1 => Deed::ClearSelection,
                _ => Deed::Limit(true),
            },
            38..40 => Deed::Limit(self.chance.one_in(3)),
            40..43 => Deed::Copy,
            43 => Deed::Cut,
            44..47 => Deed::Paste { at: self.chance.three(|c| c.whole(-6, 16)), axes: self.axes() },
            47..50 => Deed::Move { by: self.chance.three(|c| c.whole(-6, 6)), axes: self.axes() },
            50..53 => self.array(),
            53..56 => Deed::Brush { ray: self.ray(), colour: self.colour() },
            56..58 => Deed::Devour { ray: self.ray(), reach: self.chance.sixteenths(0.0, 4.0) },
            58..60 => Deed::Begin,
            60 if self.model.stroke_open() && self.chance.one_in(2) => Deed::Cancel,
            60..62 => Deed::End,
            62..64 => Deed::Undo(self.steps()),
            _ => Deed::Redo(self.steps()),
        }
    }

    fn steps(&mut self) -> Option<usize> {
        (!self.chance.one_in(8)).then(|| self.chance.whole(1, 3) as usize)
    }

    fn colour(&mut self) -> Colour {
        let few = [[255, 0, 0], [0, 90, 255], [0, 0, 0], [255, 255, 255]];
        if self.chance.one_in(2) {
            self.chance.of(&few)
        } else {
            self.chance.three(|c| c.below(256) as u8)
        }
    }

    fn area(&mut self) -> Area {
        // Rarely all of the grid, so that something is left to work on.
        self.chance.of(&[Area::Marker, Area::Selection, Area::Marker, Area::Selection, Area::Grid])
    }

    fn new_sculpture(&mut self) -> Deed {
        let dims = self.chance.three(|c| c.whole(1, 20) as usize);
        let dims = if self.chance.one_in(3) { [16; 3] } else { dims };
        let size = if self.chance.one_in(3) {
            self.chance.three(|c| c.sixteenths(0.5, 2.0))
        } else {
            [1.0; 3]
        };
        Deed::New {
            dims,
            size,
            bits: self.chance.of(&[0, 8, 16, 24, 24]),
            base: self.colour(),
            solid: self.chance.one_in(3),
        }
    }

    fn symmetry(&mut self) -> Deed {
        let mirror = |c: &mut Chance| c.of(&[Mirror::Off, Mirror::Even, Mirror::Odd]);
        Deed::Symmetry(if self.chance.one_in(4) {
            [Mirror::Off; 3]
        } else {
            self.chance.three(mirror)
        })
    }

    fn axes(&mut self) -> Axes {
        let to = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
        let to = self.chance.of(&to);
        to.map(|axis| (axis, self.chance.one_in(2)))
    }

    fn ray(&mut self) -> Ray {
        Ray {
            axis: self.chance.below(3) as usize,
            rising: self.chance.one_in(2),
            through: self.model.now().dims.map(|d| self.chance.whole(-1, d as i64)),
        }
    }

    fn turn(&mut self) -> Turn {
        match self.chance.below(6) {
            0 => Turn::Angles([0.0; 3]),
            1 => Turn::Angles(self.chance.three(|c| c.whole(-4, 4) as f64 * 90.0)),
            2 => Turn::Angles(self.chance.three(|c| c.whole(-4, 4) as f64 * 45.0)),
            3 => {
                let mut q = [0.0; 4];
                q[self.chance.below(4) as usize] = self.chance.of(&[1.0, -1.0, 2.0]);
                Turn::Quaternion(q)
            }
            4 => Turn::Angles(self.chance.three(|c| c.sixteenths(-180.0, 180.0))),
            _ => {
                let q = self.chance.three(|c| c.sixteenths(-2.0, 2.0));
                Turn::Quaternion([q[0], q[1], q[2], self.chance.sixteenths(0.25, 2.0)])
            }
        }
    }

    fn solid(&mut self) -> Deed {
        // Until no voxel's centre lies on the surface: there rounding decides.
        let placed = loop {
            let whole = self.chance.one_in(3);
            let length = |c: &mut Chance, from: f64, to: f64| match whole {
                true => c.whole(from.ceil() as i64, to as i64) as f64,
                false => c.sixteenths(from, to),
            };
            let half = self.chance.three(|c| length(c, 0.5, 9.0));
            let placed = Placed {
                shape: self.chance.of(&[Shape::Ellipsoid, Shape::Cuboid, Shape::Pyramid]),
                at: self.model.now().dims.map(|d| length(self.chance, -3.0, d as f64 + 3.0)),
                half: if self.chance.one_in(2) { [half[0]; 3] } else { half },
                turn: self.turn(),
            };
            if !self.doubtful(&placed) {
                break placed;
            }
        };
        let op = match self.chance.below(6) {
            0 => Op::Add(None),
            1 | 2 => Op::Add(Some(self.colour())),
            3 | 4 => Op::Subtract,
            _ => Op::Recolour(self.colour()),
        };
        Deed::Solid { op, placed }
    }

    fn doubtful(&self, placed: &Placed) -> bool {
        let sculpture = self.model.now();
        let solid = placed.ready(sculpture.size);
        sculpture.all().any(|v| {
            let images = self.model.images(v.map(|v| v as f64 + 0.5));
            images.iter().any(|p| solid.doubtful(*p))
        })
    }

    /// An array whose copies are as sure as what they copy; else nothing but a line that is.
    fn array(&mut self) -> Deed {
        let (count, step) = (self.chance.below(4) as usize, self.chance.three(|c| c.whole(-5, 5)));
        let array = Deed::Array { count, step };
        let sure = self.model.last_uses().iter().all(|used| match used {
            Deed::Solid { placed, .. } => (1..=count).all(|i| {
                let at = std::array::from_fn(|k| placed.at[k] + (step[k] * i as i64) as f64);
                !self.doubtful(&Placed { at, ..*placed })
            }),
            _ => true,
        });
        if sure { array } else { Deed::Copy }
    }
}
