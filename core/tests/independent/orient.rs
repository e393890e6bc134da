//! Orients the model: each axis goes where its name says, from the other end if it is reversed.

use std::rc::Rc;

use super::model::{Box3, Model, Past, Sculpture};
use super::statement::Axes;

pub fn inverse(axes: &Axes) -> Axes {
    let mut back = *axes;
    for (i, &(axis, reversed)) in axes.iter().enumerate() {
        back[axis] = (i, reversed);
    }
    back
}

impl Box3 {
    /// Returns the same box in a grid of `dims` voxels that was oriented.
    fn oriented(&self, dims: [usize; 3], axes: &Axes) -> Box3 {
        let mut oriented = Box3::default();
        for (i, &(axis, reversed)) in axes.iter().enumerate() {
            let (min, max) = (self.min[i], self.max[i]);
            let end = dims[i] as i64;
            (oriented.min[axis], oriented.max[axis]) =
                if reversed { (end - max, end - min) } else { (min, max) };
        }
        oriented
    }
}

impl Sculpture {
    fn oriented(&self, axes: &Axes) -> Sculpture {
        let mut oriented = self.clone();
        for (i, &(axis, _)) in axes.iter().enumerate() {
            oriented.dims[axis] = self.dims[i];
            oriented.size[axis] = self.size[i];
        }
        for (v, (voxel, masked)) in self.all().zip(self.voxels.iter().zip(&self.masked)) {
            let voxel_box = Box3 { min: v, max: v.map(|v| v + 1) };
            let place = oriented.place(voxel_box.oriented(self.dims, axes).min).unwrap();
            oriented.voxels[place] = *voxel;
            oriented.masked[place] = *masked;
        }
        oriented
    }
}

impl Model {
    /// Orients the whole sculpture, as a step of its own unless nothing changes.
    pub fn orient(&mut self, axes: &Axes) {
        if *axes == [(0, false), (1, false), (2, false)] {
            return;
        }
        let before = self.now.clone();
        self.put_oriented(Rc::new(before.oriented(axes)), axes);
        self.undo.push(Past { sculpture: before, axes: Some(inverse(axes)) });
        self.redo.clear();
    }

    /// Replaces the sculpture by the oriented one; marker, selection and mirror planes follow.
    pub fn put_oriented(&mut self, oriented: Rc<Sculpture>, axes: &Axes) {
        let dims = self.now.dims;
        self.marker = self.marker.oriented(dims, axes);
        self.boxes.iter_mut().for_each(|(b, _)| *b = b.oriented(dims, axes));
        self.symmetry = self.symmetry.oriented(dims, axes);
        self.now = oriented;
        self.last_uses.clear();
    }
}
