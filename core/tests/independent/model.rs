//! A sculpture as the manual describes it: an array of voxels, copied for every undo step.

use std::rc::Rc;

use super::orient::inverse;
use super::solid::Placed;
use super::statement::{Area, Axes, Colour, Op, Statement};
use super::symmetry::{Image, Symmetry};

#[derive(Clone, PartialEq, Debug)]
pub struct Sculpture {
    pub dims: [usize; 3],
    /// Edge lengths of a voxel.
    pub size: [f64; 3],
    /// Bits per colour.
    pub bits: u32,
    pub base: Colour,
    /// The colour of each voxel that exists, x fastest, then y, then z.
    pub voxels: Vec<Option<Colour>>,
    /// The protected voxels.
    pub masked: Vec<bool>,
}

/// A half-open box.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Box3 {
    pub min: [i64; 3],
    pub max: [i64; 3],
}

impl Box3 {
    pub fn contains(&self, v: [i64; 3]) -> bool {
        (0..3).all(|i| self.min[i] <= v[i] && v[i] < self.max[i])
    }
}

/// A sculpture that undo or redo leads to.
pub struct Past {
    pub sculpture: Rc<Sculpture>,
    /// The orientation that leads from the present sculpture to it, if there is one.
    pub axes: Option<Axes>,
}

/// A copy: its size, and the colours of the voxels in it.
pub struct Copied {
    pub size: [i64; 3],
    pub voxels: Vec<([i64; 3], Colour)>,
}

pub struct Model {
    pub now: Rc<Sculpture>,
    pub undo: Vec<Past>,
    pub redo: Vec<Past>,
    /// The sculpture before the open stroke, and whether the stroke has changed anything.
    pub stroke: Option<(Rc<Sculpture>, bool)>,
    pub marker: Box3,
    pub boxes: Vec<(Box3, bool)>,
    pub limit: bool,
    pub symmetry: Symmetry,
    pub copied: Option<Copied>,
    pub uses: Vec<Statement>,
    pub last_uses: Vec<Statement>,
}

/// Returns the level of `bits` bits nearest to a channel of 8, expanded to 8 bits again.
fn rounded(channel: u8, bits: u32) -> u8 {
    let most = f64::from((1u32 << bits) - 1);
    ((f64::from(channel) / 255.0 * most).round() / most * 255.0).round() as u8
}

impl Sculpture {
    /// Returns a colour as it is stored.
    pub fn kept(&self, [r, g, b]: Colour) -> Colour {
        let bits = match self.bits {
            0 => return self.base,
            8 => [2, 4, 2],
            16 => [4, 7, 5],
            _ => [8, 8, 8],
        };
        [rounded(r, bits[0]), rounded(g, bits[1]), rounded(b, bits[2])]
    }

    pub fn place(&self, v: [i64; 3]) -> Option<usize> {
        let inside = (0..3).all(|i| 0 <= v[i] && v[i] < self.dims[i] as i64);
        let [x, y, z] = v.map(|v| v as usize);
        inside.then(|| x + self.dims[0] * (y + self.dims[1] * z))
    }

    pub fn get(&self, v: [i64; 3]) -> Option<Colour> {
        self.place(v).and_then(|place| self.voxels[place])
    }

    pub fn all(&self) -> impl Iterator<Item = [i64; 3]> + use<> {
        let [x, y, z] = self.dims.map(|d| d as i64);
        (0..z).flat_map(move |k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])))
    }
}

impl Model {
    /// Returns a model with a single voxel of stone colour, without colour depth.
    pub fn new() -> Model {
        let base = [0xc8, 0xbe, 0xaa];
        let voxel = Sculpture {
            dims: [1; 3],
            size: [1.0; 3],
            bits: 0,
            base,
            voxels: vec![Some(base)],
            masked: vec![false],
        };
        Model {
            now: Rc::new(voxel),
            undo: Vec::new(),
            redo: Vec::new(),
            stroke: None,
            marker: Box3 { min: [0; 3], max: [1; 3] },
            boxes: Vec::new(),
            limit: false,
            symmetry: Symmetry::OFF,
            copied: None,
            uses: Vec::new(),
            last_uses: Vec::new(),
        }
    }

    /// Returns the statements that an array repeats.
    pub fn last_uses(&self) -> &[Statement] {
        &self.last_uses
    }

    pub fn now(&self) -> &Sculpture {
        &self.now
    }

    pub fn stroke_open(&self) -> bool {
        self.stroke.is_some()
    }

    /// Returns the images of a tool, itself included.
    pub fn images(&self) -> Vec<Image> {
        self.symmetry.images(self.now.dims, self.now.size)
    }

    /// Returns for each voxel whether a solid or an image of it holds its centre.
    pub fn covered(&self, placed: &Placed) -> Vec<bool> {
        let (solid, images) = (placed.ready(self.now.size), self.images());
        let centres = self.now.all().map(|v| v.map(|v| v as f64 + 0.5));
        let holds = |centre| images.iter().any(|i| solid.beyond(i.origin(centre)) <= 0.0);
        centres.map(holds).collect()
    }

    pub fn is_in(&self, area: Area, v: [i64; 3]) -> bool {
        match area {
            Area::Grid => true,
            Area::Marker => self.marker.contains(v),
            Area::Selection => self.selected(v),
        }
    }

    fn selected(&self, v: [i64; 3]) -> bool {
        self.boxes.iter().rev().find(|(b, _)| b.contains(v)).is_some_and(|(_, adds)| *adds)
    }

    pub fn is_within_limit(&self, v: [i64; 3]) -> bool {
        !self.limit || self.boxes.is_empty() || self.selected(v)
    }

    fn may_change(&self, v: [i64; 3]) -> bool {
        let masked = self.now.place(v).is_some_and(|place| self.now.masked[place]);
        !masked && self.is_within_limit(v)
    }

    pub fn begin_with(&mut self, sculpture: Sculpture) {
        if sculpture.dims != self.now.dims {
            let half = sculpture.dims.map(|d| ((d / 2) as i64).max(1));
            let min = std::array::from_fn(|i| (sculpture.dims[i] as i64 - half[i]) / 2);
            let max = std::array::from_fn(|i| min[i] + half[i]);
            self.marker = Box3 { min, max };
            self.boxes.clear();
            self.limit = false;
        }
        self.now = Rc::new(sculpture);
        self.last_uses.clear();
    }

    /// Applies `change` to each voxel that tools may change. A step of its own unless a stroke is open.
    fn change(&mut self, change: impl Fn([i64; 3], Option<Colour>) -> Option<Colour>) {
        let before = self.now.clone();
        let mut after = (*before).clone();
        for (v, voxel) in before.all().zip(&mut after.voxels) {
            if self.may_change(v) {
                *voxel = change(v, *voxel).map(|colour| before.kept(colour));
            }
        }
        let changed = after != *before;
        self.now = Rc::new(after);
        self.step(before, changed);
    }

    pub fn step(&mut self, before: Rc<Sculpture>, changed: bool) {
        match &mut self.stroke {
            Some((_, any)) => *any |= changed,
            None if changed => {
                self.undo.push(Past { sculpture: before, axes: None });
                self.redo.clear();
            }
            None => {}
        }
    }

    pub fn op(&mut self, op: Op, covers: impl Fn([i64; 3]) -> bool) {
        let base = self.now.base;
        self.change(|v, voxel| match op {
            _ if !covers(v) => voxel,
            Op::Add(colour) => voxel.or(Some(colour.unwrap_or(base))),
            Op::Subtract => None,
            Op::Recolour(colour) => voxel.map(|_| colour),
        });
    }

    /// Returns the marked voxels; without protected ones if the copy removes them (`leaves`).
    pub fn copy(&self, leaves: bool) -> Option<(Copied, [i64; 3])> {
        let from = self.marker.min.map(|v| v.max(0));
        let end: [i64; 3] =
            std::array::from_fn(|i| self.marker.max[i].min(self.now.dims[i] as i64));
        let size: [i64; 3] = std::array::from_fn(|i| end[i] - from[i]);
        let mut voxels = Vec::new();
        let may = |v| if leaves { self.may_change(v) } else { self.is_within_limit(v) };
        for v in self.now.all().filter(|v| self.marker.contains(*v) && may(*v)) {
            if let Some(colour) = self.now.get(v) {
                voxels.push((std::array::from_fn(|i| v[i] - from[i]), colour));
            }
        }
        (!voxels.is_empty()).then_some((Copied { size, voxels }, from))
    }

    /// Returns the sculpture with a copy pasted.
    pub fn with(&self, copied: &Copied, at: [i64; 3], axes: &Axes) -> Sculpture {
        let mut after = (*self.now).clone();
        for (v, colour) in &copied.voxels {
            let mut to = at;
            for (i, &(axis, reversed)) in axes.iter().enumerate() {
                to[axis] += if reversed { copied.size[i] - 1 - v[i] } else { v[i] };
            }
            if let Some(place) = after.place(to).filter(|_| self.may_change(to)) {
                after.voxels[place] = Some(after.kept(*colour));
            }
        }
        after
    }

    pub fn put(&mut self, after: Sculpture) {
        let before = std::mem::replace(&mut self.now, Rc::new(after));
        let changed = before != self.now;
        self.step(before, changed);
    }

    pub fn travel(&mut self, steps: Option<usize>, back: bool) -> bool {
        if self.stroke_open() {
            return false;
        }
        self.last_uses.clear();
        let mut left = steps.unwrap_or(usize::MAX);
        while left > 0 {
            let from = if back { &mut self.undo } else { &mut self.redo };
            let Some(next) = from.pop() else { break };
            let sculpture = self.now.clone();
            match &next.axes {
                Some(axes) => self.put_oriented(next.sculpture, axes),
                None => self.begin_with((*next.sculpture).clone()),
            }
            let last = Past { sculpture, axes: next.axes.as_ref().map(inverse) };
            if back {
                self.redo.push(last)
            } else {
                self.undo.push(last)
            }
            left -= 1;
        }
        true
    }

    pub fn used(&mut self, statement: &Statement) {
        match self.stroke {
            None => self.last_uses = vec![statement.clone()],
            Some(_) => self.uses.push(statement.clone()),
        }
    }

    pub fn end(&mut self) -> bool {
        let Some((before, changed)) = self.stroke.take() else { return false };
        self.step(before, changed);
        if !self.uses.is_empty() {
            self.last_uses = std::mem::take(&mut self.uses);
        }
        true
    }
}
