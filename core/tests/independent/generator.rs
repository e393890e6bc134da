//! Generates random statements, most of which make sense for the sculpture as it is.

use super::model::Model;
use super::random::Random;
use super::solid::{Placed, Shape, Turn};
use super::statement::{Area, Axes, Colour, Mirror, Op, Ray, Statement};

/// The verbs that must occur in a hundred scripts.
pub const VERBS: [&str; 23] = [
    "new", "begin", "end", "cancel", "add", "subtract", "recolour", "spray", "fill", "clear",
    "dye", "mark", "select", "limit", "symmetry", "copy", "cut", "paste", "move", "array",
    "orient", "undo", "redo",
];

pub struct Generator<'a> {
    pub random: &'a mut Random,
    pub model: &'a Model,
}

impl Generator<'_> {
    pub fn statement(&mut self, first: bool) -> Statement {
        if first || self.random.one_in(60) {
            return self.new_sculpture();
        }
        match self.random.below(68) {
            0..20 => self.solid(),
            20..24 => self.symmetry(),
            24..27 => Statement::Fill {
                area: self.area(),
                colour: (!self.random.one_in(2)).then(|| self.colour()),
            },
            27 => Statement::Clear { area: self.area() },
            28..31 => Statement::Dye { area: self.area(), colour: self.colour() },
            31..35 => Statement::Mark {
                at: self.random.three(|c| c.whole(-4, 14)),
                size: self.random.three(|c| c.whole(1, 12)),
            },
            35..37 => Statement::Select { adds: !self.random.one_in(3) },
            37 => match self.random.below(3) {
                0 => Statement::Drop,
                1 => Statement::ClearSelection,
                _ => Statement::Limit(true),
            },
            38..40 => Statement::Limit(self.random.one_in(3)),
            40..43 => Statement::Copy,
            43 => Statement::Cut,
            44..47 => {
                Statement::Paste { at: self.random.three(|c| c.whole(-6, 16)), axes: self.axes() }
            }
            47..50 => {
                Statement::Move { by: self.random.three(|c| c.whole(-6, 6)), axes: self.axes() }
            }
            50..53 => self.array(),
            53..56 => Statement::Brush { ray: self.ray(), colour: self.colour() },
            56..58 => {
                Statement::Devour { ray: self.ray(), reach: self.random.sixteenths(0.0, 4.0) }
            }
            58..60 => Statement::Begin,
            60 if self.model.stroke_open() && self.random.one_in(2) => Statement::Cancel,
            60..62 => Statement::End,
            62..64 => Statement::Undo(self.steps()),
            64..66 => Statement::Redo(self.steps()),
            _ => Statement::Orient(self.axes()),
        }
    }

    fn steps(&mut self) -> Option<usize> {
        (!self.random.one_in(8)).then(|| self.random.whole(1, 3) as usize)
    }

    fn colour(&mut self) -> Colour {
        let few = [[255, 0, 0], [0, 90, 255], [0, 0, 0], [255, 255, 255]];
        if self.random.one_in(2) {
            self.random.of(&few)
        } else {
            self.random.three(|c| c.below(256) as u8)
        }
    }

    fn area(&mut self) -> Area {
        // Rarely all of the grid, so that something is left to work on.
        self.random.of(&[Area::Marker, Area::Selection, Area::Marker, Area::Selection, Area::Grid])
    }

    fn new_sculpture(&mut self) -> Statement {
        let dims = self.random.three(|c| c.whole(1, 20) as usize);
        let dims = if self.random.one_in(3) { [16; 3] } else { dims };
        let size = if self.random.one_in(3) {
            self.random.three(|c| c.sixteenths(0.5, 2.0))
        } else {
            [1.0; 3]
        };
        Statement::New {
            dims,
            size,
            bits: self.random.of(&[0, 8, 16, 24, 24]),
            base: self.colour(),
            solid: self.random.one_in(3),
        }
    }

    fn symmetry(&mut self) -> Statement {
        let mirror = |c: &mut Random| c.of(&[Mirror::Off, Mirror::Even, Mirror::Odd]);
        Statement::Symmetry(if self.random.one_in(4) {
            [Mirror::Off; 3]
        } else {
            self.random.three(mirror)
        })
    }

    fn axes(&mut self) -> Axes {
        let to = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
        let to = self.random.of(&to);
        to.map(|axis| (axis, self.random.one_in(2)))
    }

    fn ray(&mut self) -> Ray {
        Ray {
            axis: self.random.below(3) as usize,
            rising: self.random.one_in(2),
            through: self.model.now().dims.map(|d| self.random.whole(-1, d as i64)),
        }
    }

    fn turn(&mut self) -> Turn {
        match self.random.below(6) {
            0 => Turn::Angles([0.0; 3]),
            1 => Turn::Angles(self.random.three(|c| c.whole(-4, 4) as f64 * 90.0)),
            2 => Turn::Angles(self.random.three(|c| c.whole(-4, 4) as f64 * 45.0)),
            3 => {
                let mut q = [0.0; 4];
                q[self.random.below(4) as usize] = self.random.of(&[1.0, -1.0, 2.0]);
                Turn::Quaternion(q)
            }
            4 => Turn::Angles(self.random.three(|c| c.sixteenths(-180.0, 180.0))),
            _ => {
                let q = self.random.three(|c| c.sixteenths(-2.0, 2.0));
                Turn::Quaternion([q[0], q[1], q[2], self.random.sixteenths(0.25, 2.0)])
            }
        }
    }

    fn solid(&mut self) -> Statement {
        // Until no voxel's centre lies on the surface: there rounding decides.
        let placed = loop {
            let whole = self.random.one_in(3);
            let length = |c: &mut Random, from: f64, to: f64| match whole {
                true => c.whole(from.ceil() as i64, to as i64) as f64,
                false => c.sixteenths(from, to),
            };
            let half = self.random.three(|c| length(c, 0.5, 9.0));
            let placed = Placed {
                shape: self.random.of(&Shape::ALL),
                at: self.model.now().dims.map(|d| length(self.random, -3.0, d as f64 + 3.0)),
                half: if self.random.one_in(2) { [half[0]; 3] } else { half },
                turn: self.turn(),
            };
            if !self.doubtful(&placed) {
                break placed;
            }
        };
        let op = match self.random.below(6) {
            0 => Op::Add(None),
            1 | 2 => Op::Add(Some(self.colour())),
            3 | 4 => Op::Subtract,
            _ => Op::Recolour(self.colour()),
        };
        Statement::Solid { op, placed }
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
    fn array(&mut self) -> Statement {
        let (count, step) = (self.random.below(4) as usize, self.random.three(|c| c.whole(-5, 5)));
        let array = Statement::Array { count, step };
        let sure = self.model.last_uses().iter().all(|used| match used {
            Statement::Solid { placed, .. } => (1..=count).all(|i| {
                let at = std::array::from_fn(|k| placed.at[k] + (step[k] * i as i64) as f64);
                !self.doubtful(&Placed { at, ..*placed })
            }),
            _ => true,
        });
        if sure { array } else { Statement::Copy }
    }
}
