//! The simplest possible document: a colour or none for each voxel, copied for every undo step. It is the reference for
//! the real one.

use std::rc::Rc;

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::command::{Area, Command, NewSculpture};
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::orientation::Orientation;
use sculpture_core::sculpture::{ColourDepth, Rgb};

/// A sculpture: the colour of each voxel that exists, x fastest, then y, then z.
#[derive(Clone, PartialEq, Debug)]
pub struct Voxels {
    pub dims: UVec3,
    pub voxel_size: Vec3,
    pub depth: ColourDepth,
    pub base: Rgb,
    pub colours: Vec<Option<Rgb>>,
}

/// Counts of changed voxels, and of undone or redone steps.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Done {
    pub added: u64,
    pub removed: u64,
    pub recoloured: u64,
    pub steps: u32,
}

pub struct Model {
    pub now: Rc<Voxels>,
    pub undo: Vec<Rc<Voxels>>,
    pub redo: Vec<Rc<Voxels>>,
    /// State at the beginning of the open stroke, and whether it has changed anything.
    stroke: Option<(Rc<Voxels>, bool)>,
}

impl Voxels {
    pub fn new(new: &NewSculpture) -> Voxels {
        let base = new.colour_depth.quantise(new.base);
        Voxels {
            dims: new.dims,
            voxel_size: new.voxel_size,
            depth: new.colour_depth,
            base,
            colours: vec![new.solid.then_some(base); new.dims.element_product() as usize],
        }
    }

    pub fn all(&self) -> impl Iterator<Item = IVec3> + use<> {
        let UVec3 { x, y, z } = self.dims;
        let row = move |y, z| (0..x as i32).map(move |x| IVec3::new(x, y, z));
        (0..z as i32).flat_map(move |z| (0..y as i32).flat_map(move |y| row(y, z)))
    }

    /// Returns the same voxels in another orientation.
    pub fn oriented(&self, orientation: Orientation) -> Voxels {
        let voxel_size = orientation.permuted(self.voxel_size.to_array()).into();
        let dims = orientation.size(self.dims);
        let mut turned = Voxels { dims, voxel_size, ..self.clone() };
        let index =
            |v: IVec3, dims: UVec3| (v.x + dims.x as i32 * (v.y + dims.y as i32 * v.z)) as usize;
        for v in self.all() {
            let there = orientation.destination(v, self.dims);
            turned.colours[index(there, dims)] = self.colours[index(v, self.dims)];
        }
        turned
    }

    pub fn edit(&mut self, op: EditOp, covers: impl Fn(IVec3) -> bool) -> Done {
        let mut done = Done::default();
        // Without colour depth, all voxels have the base colour.
        let stored = |colour| match self.depth {
            ColourDepth::None => self.base,
            depth => depth.quantise(colour),
        };
        for (v, old) in self.all().zip(self.colours.clone()).filter(|&(v, _)| covers(v)) {
            let new = match (op, old) {
                (EditOp::Add(colour), None) => Some(stored(colour.unwrap_or(self.base))),
                (EditOp::Recolour(colour), Some(_)) => Some(stored(colour)),
                (EditOp::Subtract, _) => None,
                _ => old,
            };
            done.added += u64::from(old.is_none() && new.is_some());
            done.removed += u64::from(old.is_some() && new.is_none());
            done.recoloured += u64::from(old.is_some() && new.is_some() && old != new);
            self.colours[(v.x + self.dims.x as i32 * (v.y + self.dims.y as i32 * v.z)) as usize] =
                new;
        }
        done
    }
}

impl Model {
    pub fn new(new: &NewSculpture) -> Model {
        let now = Rc::new(Voxels::new(new));
        Model { now, undo: Vec::new(), redo: Vec::new(), stroke: None }
    }

    pub fn stroke_open(&self) -> bool {
        self.stroke.is_some()
    }

    fn push(&mut self, before: Rc<Voxels>) {
        self.undo.push(before);
        self.redo.clear();
    }

    fn edit(&mut self, op: EditOp, covers: impl Fn(IVec3) -> bool) -> Done {
        let before = self.now.clone();
        let mut after = (*before).clone();
        let done = after.edit(op, covers);
        self.now = Rc::new(after);
        let changed = done != Done::default();
        match &mut self.stroke {
            Some((_, any)) => *any |= changed,
            None if changed => self.push(before),
            None => {}
        }
        done
    }

    /// Executes a command. Returns `None` if it must be refused.
    pub fn apply(&mut self, command: &Command) -> Option<Done> {
        let open = self.stroke_open();
        Some(match command {
            Command::Begin { .. } if !open => {
                self.stroke = Some((self.now.clone(), false));
                Done::default()
            }
            Command::End => {
                let (before, changed) = self.stroke.take()?;
                if changed {
                    self.push(before);
                }
                Done::default()
            }
            Command::Cancel => {
                self.now = self.stroke.take()?.0;
                Done::default()
            }
            Command::New(new) if !open => {
                let before = std::mem::replace(&mut self.now, Rc::new(Voxels::new(new)));
                self.push(before);
                Done::default()
            }
            Command::Undo { steps } if !open => {
                let limit = steps.unwrap_or(u32::MAX);
                Done {
                    steps: travel(&mut self.now, &mut self.undo, &mut self.redo, limit),
                    ..Done::default()
                }
            }
            Command::Redo { steps } if !open => {
                let limit = steps.unwrap_or(u32::MAX);
                Done {
                    steps: travel(&mut self.now, &mut self.redo, &mut self.undo, limit),
                    ..Done::default()
                }
            }
            Command::Construct { op: EditOp::Recolour(_), .. }
                if self.now.depth == ColourDepth::None =>
            {
                return None;
            }
            Command::Construct { op, primitive, to_vx } => {
                let placed = primitive.swept_in_grid(*to_vx, self.now.voxel_size);
                self.edit(*op, |v| placed.contains_voxel(v))
            }
            Command::Fill { area: Area::Grid, colour } => self.edit(EditOp::Add(*colour), |_| true),
            Command::Clear { area: Area::Grid } => self.edit(EditOp::Subtract, |_| true),
            Command::Orient(Orientation::UPRIGHT) if !open => Done::default(),
            Command::Orient(orientation) if !open => {
                let after = Rc::new(self.now.oriented(*orientation));
                let before = std::mem::replace(&mut self.now, after);
                self.push(before);
                Done::default()
            }
            Command::Place(_) => Done::default(),
            _ => return None,
        })
    }
}

fn travel(
    now: &mut Rc<Voxels>,
    from: &mut Vec<Rc<Voxels>>,
    to: &mut Vec<Rc<Voxels>>,
    limit: u32,
) -> u32 {
    let mut steps = 0;
    while steps < limit
        && let Some(next) = from.pop()
    {
        to.push(std::mem::replace(now, next));
        steps += 1;
    }
    steps
}
