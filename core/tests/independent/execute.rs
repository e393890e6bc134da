//! Executes statements on the model.

use std::rc::Rc;

use super::model::{Box3, Model, Sculpture};
use super::statement::{Area, Axes, Op, Ray, Statement};

impl Model {
    /// Executes a statement. Returns false if it must be refused.
    pub fn execute(&mut self, statement: &Statement) -> bool {
        let colours = self.now.bits != 0;
        match statement {
            Statement::New { .. }
            | Statement::Begin
            | Statement::Array { .. }
            | Statement::Orient(_)
                if self.stroke_open() =>
            {
                false
            }
            Statement::New { dims, size, bits, base, solid } => {
                let mut new = Sculpture {
                    dims: *dims,
                    size: *size,
                    bits: *bits,
                    base: *base,
                    voxels: vec![],
                    masked: vec![false; dims.iter().product()],
                };
                new.base = new.kept(*base);
                new.voxels = vec![solid.then_some(new.base); dims.iter().product()];
                let before = self.now.clone();
                self.begin_with(new);
                self.step(before, true);
                true
            }
            Statement::Begin => {
                self.stroke = Some((self.now.clone(), false));
                true
            }
            Statement::End => self.end(),
            Statement::Cancel => match self.stroke.take() {
                Some((before, _)) => {
                    self.now = before;
                    self.uses.clear();
                    true
                }
                None => false,
            },
            Statement::Solid { op: Op::Recolour(_), .. }
            | Statement::Dye { .. }
            | Statement::Brush { .. }
                if !colours =>
            {
                false
            }
            Statement::Solid { op, placed } => {
                let (sculpture, covered) = (self.now.clone(), self.covered(placed));
                self.op(*op, |v| sculpture.place(v).is_some_and(|place| covered[place]));
                self.used(statement);
                true
            }
            Statement::Brush { ray, colour } => {
                let met = self.sure(ray);
                self.op(Op::Recolour(*colour), |v| met.contains(&v));
                self.used(statement);
                true
            }
            Statement::Devour { ray, reach } => {
                let (sculpture, near) = (self.now.clone(), self.near(ray, *reach));
                self.op(Op::Subtract, |v| sculpture.place(v).is_some_and(|place| near[place]));
                self.used(statement);
                true
            }
            Statement::Protect { adds, ray, reach } => {
                self.cover_with_mask(*adds, self.near(ray, *reach));
                self.used(statement);
                true
            }
            Statement::Mask(change) => self.change_mask(change),
            Statement::Fill { area, colour } => self.area(*area, Op::Add(*colour)),
            Statement::Clear { area } => self.area(*area, Op::Subtract),
            Statement::Dye { area, colour } => self.area(*area, Op::Recolour(*colour)),
            Statement::Mark { at, size } => {
                self.marker = Box3 { min: *at, max: std::array::from_fn(|i| at[i] + size[i]) };
                true
            }
            Statement::Select { adds } => {
                self.boxes.push((self.marker, *adds));
                true
            }
            Statement::Drop => self.boxes.pop().is_some(),
            Statement::ClearSelection => {
                self.boxes.clear();
                true
            }
            Statement::Limit(on) => {
                self.limit = *on;
                true
            }
            Statement::Symmetry(symmetry) if symmetry.image_count() > 64 => false,
            Statement::Symmetry(symmetry) => {
                self.symmetry = *symmetry;
                true
            }
            Statement::Copy => match self.copy(false) {
                Some((copied, _)) => {
                    self.copied = Some(copied);
                    true
                }
                None => false,
            },
            Statement::Cut => {
                let Some((copied, _)) = self.copy(true) else { return false };
                self.copied = Some(copied);
                self.area(Area::Marker, Op::Subtract)
            }
            Statement::Paste { at, axes } => {
                let Some(copied) = &self.copied else { return false };
                self.put(self.with(copied, *at, axes));
                self.used(statement);
                true
            }
            Statement::Move { by, axes } => self.carry(*by, axes),
            Statement::Array { count, step } => self.array(*count, *step),
            Statement::Orient(axes) => {
                self.orient(axes);
                true
            }
            Statement::Undo(steps) => self.travel(*steps, true),
            Statement::Redo(steps) => self.travel(*steps, false),
        }
    }

    fn area(&mut self, area: Area, op: Op) -> bool {
        if area == Area::Selection && self.boxes.is_empty() {
            return false;
        }
        let sculpture = self.now.clone();
        let covered: Vec<bool> = sculpture.all().map(|v| self.is_in(area, v)).collect();
        self.op(op, |v| sculpture.place(v).is_some_and(|place| covered[place]));
        true
    }

    /// Returns the voxel that each image of a ray meets. Scripts have only rays for which this is certain.
    fn sure(&self, ray: &Ray) -> Vec<[i64; 3]> {
        self.met(ray).expect("a ray of which it is sure what it meets")
    }

    /// Returns for each voxel whether it is within `reach` voxels of one that an image of the ray meets.
    fn near(&self, ray: &Ray, reach: f64) -> Vec<bool> {
        let met = self.sure(ray);
        let distance = |a: [i64; 3], b: [i64; 3]| {
            (0..3).map(|i| ((a[i] - b[i]) as f64).powi(2)).sum::<f64>().sqrt()
        };
        self.now.all().map(|v| met.iter().any(|m| distance(*m, v) <= reach)).collect()
    }

    /// Rotates the marked voxels about their centre, and moves them; the marker follows.
    fn carry(&mut self, by: [i64; 3], axes: &Axes) -> bool {
        let Some((copied, from)) = self.copy(true) else { return false };
        let mut turned = [0; 3];
        (0..3).for_each(|i| turned[axes[i].0] = copied.size[i]);
        let at: [i64; 3] =
            std::array::from_fn(|i| from[i] + by[i] + (copied.size[i] - turned[i]) / 2);
        let before = self.now.clone();
        let mut without = (*before).clone();
        for (v, _) in &copied.voxels {
            let place = without.place(std::array::from_fn(|i| v[i] + from[i]));
            without.voxels[place.unwrap()] = None;
        }
        self.now = Rc::new(without);
        self.now = Rc::new(self.with(&copied, at, axes));
        self.marker = Box3 { min: at, max: std::array::from_fn(|i| at[i] + turned[i]) };
        self.step(before, true);
        true
    }

    fn array(&mut self, count: usize, step: [i64; 3]) -> bool {
        if self.last_uses.is_empty() || count == 0 {
            return false;
        }
        let uses = self.last_uses.clone();
        self.stroke = Some((self.now.clone(), false));
        for i in 1..=count as i64 {
            for used in &uses {
                assert!(self.execute(&used.shifted(step.map(|s| s * i))));
            }
        }
        self.end();
        self.last_uses.splice(0..0, uses);
        true
    }
}

impl Statement {
    /// Returns the same use of a tool, moved by `by` voxels.
    fn shifted(&self, by: [i64; 3]) -> Statement {
        let mut statement = self.clone();
        match &mut statement {
            Statement::Solid { placed, .. } => *placed = placed.shifted(by),
            Statement::Paste { at, .. } => (0..3).for_each(|i| at[i] += by[i]),
            Statement::Brush { ray, .. }
            | Statement::Devour { ray, .. }
            | Statement::Protect { ray, .. } => {
                *ray = ray.shifted(by);
            }
            _ => unreachable!("no use of a tool"),
        }
        statement
    }
}
