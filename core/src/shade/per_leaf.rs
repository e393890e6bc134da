//! A value for each leaf of 8^3 bricks of a grid, most of which are one of a few common values: those take 4 bytes.
//!
//! [`PerBrick`] is such a list of the numbers of all bricks. Leaves are numbered x first, then y, then z, and bricks
//! leaf by leaf in the order of a brick's voxels, so that shaders find them without divisions. Knows no grid and not what
//! the values mean.

use glam::UVec3;

use crate::sculpture::brick::{local_coords, local_index};

/// See the module text.
#[derive(Debug)]
pub(super) struct PerLeaf<T> {
    /// Size in bricks, and in leaves.
    brick_dims: UVec3,
    leaf_dims: UVec3,
    /// The place in `values` of each leaf's value.
    places: Vec<u32>,
    /// The common values, then those that belong to one leaf each.
    values: Vec<T>,
    common: u32,
    /// Places of values that belong to no leaf any more.
    free: Vec<u32>,
}

/// A number for each brick.
pub(super) type PerBrick = PerLeaf<[u32; 512]>;

impl<T: Clone> PerLeaf<T> {
    /// Returns the list for a sculpture of so many bricks, all of whose leaves have the first of the common values.
    pub fn new(brick_dims: UVec3, common: &[T]) -> PerLeaf<T> {
        let leaf_dims = brick_dims.map(|edge| edge.div_ceil(8));
        PerLeaf {
            brick_dims,
            leaf_dims,
            places: vec![0; leaf_dims.as_u64vec3().element_product() as usize],
            values: common.to_vec(),
            common: common.len() as u32,
            free: Vec::new(),
        }
    }

    /// Returns the size in bricks.
    pub fn brick_dims(&self) -> UVec3 {
        self.brick_dims
    }

    /// Returns the size in leaves.
    pub fn leaf_dims(&self) -> UVec3 {
        self.leaf_dims
    }

    /// Returns the memory in use, in bytes.
    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.places) + size_of_val(&*self.values) + size_of_val(&*self.free)
    }

    /// Returns the memory of the values, without that of free ones, in bytes.
    pub fn value_bytes(&self) -> usize {
        (self.values.len() - self.free.len()) * size_of::<T>()
    }

    /// Returns the number of the leaf at `leaf`.
    #[inline(always)]
    pub fn number(&self, leaf: UVec3) -> u32 {
        leaf.x + self.leaf_dims.x * (leaf.y + self.leaf_dims.y * leaf.z)
    }

    /// Returns the coordinates of the leaf of a number.
    pub fn leaf(&self, number: u32) -> UVec3 {
        let UVec3 { x, y, .. } = self.leaf_dims;
        UVec3::new(number % x, number / x % y, number / (x * y))
    }

    /// Returns the value of the leaf of a number; `None` if there is no such leaf.
    #[inline(always)]
    pub fn get(&self, number: u32) -> Option<&T> {
        self.values.get(*self.places.get(number as usize)? as usize)
    }

    /// Returns the index of the common value of the leaf of a number; `None` if it has its own.
    pub fn common_index(&self, number: u32) -> Option<u32> {
        let place = self.places[number as usize];
        (place < self.common).then_some(place)
    }

    /// Gives the leaf of a number the common value of an index. The memory of its own value is free for others.
    pub fn set_common(&mut self, number: u32, index: u32) {
        debug_assert!(index < self.common);
        let place = std::mem::replace(&mut self.places[number as usize], index);
        if place >= self.common {
            self.free.push(place);
        }
    }

    /// Returns the value of the leaf of a number, for changing it: from now on it is its own.
    pub fn own(&mut self, number: u32) -> &mut T {
        let mut place = self.places[number as usize];
        if place < self.common {
            let value = self.values[place as usize].clone();
            place = match self.free.pop() {
                Some(free) => {
                    self.values[free as usize] = value;
                    free
                }
                None => {
                    self.values.push(value);
                    self.values.len() as u32 - 1
                }
            };
            self.places[number as usize] = place;
        }
        &mut self.values[place as usize]
    }
}

impl PerBrick {
    /// Returns the entry of a brick: 512 times the number of its leaf, and its index in the leaf.
    #[inline(always)]
    pub fn entry(&self, b: UVec3) -> u32 {
        self.number(b >> 3) << 9 | local_index(b.x & 7, b.y & 7, b.z & 7)
    }

    /// Returns the number at an entry; `None` if there is no such leaf.
    #[inline(always)]
    pub fn at_entry(&self, entry: u32) -> Option<u32> {
        Some(self.get(entry >> 9)?[(entry & 511) as usize])
    }

    /// Returns the number of the brick at `b`, for changing it.
    pub fn own_at(&mut self, b: UVec3) -> &mut u32 {
        let entry = self.entry(b);
        &mut self.own(entry >> 9)[(entry & 511) as usize]
    }

    /// Calls `f` with each brick of the leaves that have values of their own, and its number.
    pub fn for_each_own(&self, mut f: impl FnMut(UVec3, u32)) {
        for number in (0..self.places.len() as u32).filter(|n| self.common_index(*n).is_none()) {
            let leaf = self.leaf(number);
            for (index, value) in (0..).zip(self.get(number).into_iter().flatten()) {
                let b = leaf * 8 + UVec3::from(local_coords(index));
                if b.cmplt(self.brick_dims).all() {
                    f(b, *value);
                }
            }
        }
    }
}
