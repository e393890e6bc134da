//! Generates random statements, most of which make sense for the present sculpture.

use super::model::Model;
use super::random::Random;
use super::solid::{Placed, Shape, Turn};
use super::statement::{Area, Axes, Colour, MaskChange, MaskWhat, Op, Ray, Statement};
use super::symmetry::{Mirror, Plane, Radial, Symmetry};

/// The verbs that must occur in a hundred scripts.
pub const VERBS: [&str; 24] = [
    "new", "begin", "end", "cancel", "add", "subtract", "recolour", "spray", "fill", "clear",
    "dye", "mark", "select", "limit", "symmetry", "mask", "copy", "cut", "paste", "move", "array",
    "orient", "undo", "redo",
];

/// The forms that must occur in them, too.
pub const FORMS: [&str; 14] = [
    " to=",
    " plane=",
    " radial=",
    "spray mask",
    "spray unmask",
    "mask clear",
    "mask invert",
    "mask grow",
    "mask shrink",
    "mask add marker",
    "mask add selection",
    "mask add ellipsoid",
    "mask add colour",
    "mask subtract torus",
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
        match self.random.below(82) {
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
            53..60 => self.spray(),
            60..62 => Statement::Begin,
            62 if self.model.stroke_open() && self.random.one_in(2) => Statement::Cancel,
            62..64 => Statement::End,
            64..66 => Statement::Undo(self.steps()),
            66..68 => Statement::Redo(self.steps()),
            68..80 => Statement::Mask(self.mask()),
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
        // Rarely the whole grid, so that something is left to work on.
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
        if self.random.one_in(4) {
            return Statement::Symmetry(Symmetry::OFF);
        }
        let mirror = |c: &mut Random| c.of(&[Mirror::Off, Mirror::Even, Mirror::Odd]);
        let mirrors = match self.random.one_in(3) {
            true => [Mirror::Off; 3],
            false => self.random.three(mirror),
        };
        let plane = self.random.one_in(3).then(|| {
            let (at, normal) = self.line();
            Plane { at, normal }
        });
        let radial = self.random.one_in(3).then(|| {
            let (about, axis) = self.line();
            // Rarely so many that there are too many images.
            let many = if self.random.one_in(8) { 40 } else { 6 };
            let count = if self.random.one_in(2) { 2 } else { self.random.whole(2, many) as u32 };
            Radial { count, about, axis }
        });
        Statement::Symmetry(Symmetry { mirrors, plane, radial })
    }

    /// Returns a point and a direction: often along the grid, through the middle of a voxel or its border.
    fn line(&mut self) -> ([f64; 3], [f64; 3]) {
        let dims = self.model.now().dims;
        if self.random.one_in(3) {
            let direction = self.random.three(|c| c.sixteenths(-2.0, 2.0));
            let direction = if direction == [0.0; 3] { [1.0, 1.0, 0.0] } else { direction };
            return (dims.map(|d| self.random.sixteenths(-2.0, d as f64 + 2.0)), direction);
        }
        let mut direction = [0.0; 3];
        direction[self.random.below(3) as usize] = self.random.of(&[1.0, -1.0, 0.5]);
        (dims.map(|d| self.random.whole(-2, 2 * d as i64 + 2) as f64 / 2.0), direction)
    }

    fn axes(&mut self) -> Axes {
        let to = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
        let to = self.random.of(&to);
        to.map(|axis| (axis, self.random.one_in(2)))
    }

    /// Returns the use of a ray for which it is certain what its images meet; `copy` if eight attempts find none.
    fn spray(&mut self) -> Statement {
        for _ in 0..8 {
            let ray = Ray {
                axis: self.random.below(3) as usize,
                rising: self.random.one_in(2),
                through: self.model.now().dims.map(|d| self.random.whole(-1, d as i64)),
            };
            if self.model.met(&ray).is_none() {
                continue;
            }
            let reach = self.random.sixteenths(0.0, 4.0);
            return match self.random.below(7) {
                0..3 => Statement::Brush { ray, colour: self.colour() },
                3..5 => Statement::Devour { ray, reach },
                _ => Statement::Protect { adds: !self.random.one_in(3), ray, reach },
            };
        }
        Statement::Copy
    }

    fn mask(&mut self) -> MaskChange {
        let by = |c: &mut Random| if c.one_in(20) { 0 } else { c.whole(1, 3) as usize };
        let adds = !self.random.one_in(3);
        match self.random.below(12) {
            0 => MaskChange::Clear,
            1 => MaskChange::Invert,
            2 => MaskChange::Grow(by(self.random)),
            3 => MaskChange::Shrink(by(self.random)),
            4..7 => {
                // The whole grid is more often freed than protected.
                let area = self.area();
                MaskChange::Put { adds: adds && area != Area::Grid, what: MaskWhat::Area(area) }
            }
            7..10 => MaskChange::Put { adds, what: MaskWhat::Solid(self.placed()) },
            _ => {
                let tolerance = if self.random.one_in(2) { 0.0 } else { 0.25 };
                // Often an existing voxel.
                let voxels = &self.model.now().voxels;
                let place = self.random.below(voxels.len() as u64) as usize;
                let colour = voxels[place].unwrap_or_else(|| self.colour());
                MaskChange::Put { adds, what: MaskWhat::Colour { colour, tolerance } }
            }
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
        let placed = self.placed();
        let op = match self.random.below(6) {
            0 => Op::Add(None),
            1 | 2 => Op::Add(Some(self.colour())),
            3 | 4 => Op::Subtract,
            _ => Op::Recolour(self.colour()),
        };
        Statement::Solid { op, placed }
    }

    /// Returns a solid, possibly moving, on whose surface no voxel's centre lies, since rounding decides there.
    fn placed(&mut self) -> Placed {
        // A moving solid needs many evaluations for each voxel.
        let few = self.model.now().voxels.len() * self.model.images().len() <= 4000;
        let moves = few && self.random.one_in(5);
        loop {
            let whole = self.random.one_in(3);
            let length = |c: &mut Random, from: f64, to: f64| match whole {
                true => c.whole(from.ceil() as i64, to as i64) as f64,
                false => c.sixteenths(from, to),
            };
            // A moving solid is small compared with its displacement.
            let most = if moves { 4.0 } else { 9.0 };
            let half = self.random.three(|c| length(c, 0.5, most));
            let dims = self.model.now().dims;
            let [at, end] = [0, 1].map(|_| dims.map(|d| length(self.random, -3.0, d as f64 + 3.0)));
            let along = self.random.of(&[[true; 3], [true; 3], [false, true, false], [false; 3]]);
            let to = std::array::from_fn(|i| if along[i] { end[i] } else { at[i] });
            let placed = Placed {
                shape: self.random.of(&Shape::ALL),
                at,
                half: if self.random.one_in(2) { [half[0]; 3] } else { half },
                turn: self.turn(),
                to: moves.then_some(to),
            };
            if !self.doubtful(&placed) {
                return placed;
            }
        }
    }

    fn doubtful(&self, placed: &Placed) -> bool {
        let sculpture = self.model.now();
        let (solid, images) = (placed.ready(sculpture.size), self.model.images());
        sculpture.all().any(|v| {
            let centre = v.map(|v| v as f64 + 0.5);
            images.iter().any(|image| solid.doubtful(image.origin(centre)))
        })
    }

    /// Returns an array whose copies are as certain as the original; otherwise `copy`.
    fn array(&mut self) -> Statement {
        let (count, step) = (self.random.below(4) as usize, self.random.three(|c| c.whole(-5, 5)));
        let array = Statement::Array { count, step };
        let sure = self.model.last_uses().iter().all(|used| match used {
            Statement::Solid { placed, .. } => {
                (1..=count).all(|i| !self.doubtful(&placed.shifted(step.map(|s| s * i as i64))))
            }
            Statement::Brush { ray, .. }
            | Statement::Devour { ray, .. }
            | Statement::Protect { ray, .. } => {
                (1..=count).all(|i| self.model.is_clear(&ray.shifted(step.map(|s| s * i as i64))))
            }
            _ => true,
        });
        if sure { array } else { Statement::Copy }
    }
}
