//! Storage of the tables of openness ([`crate::shade::occlusion`]) of bricks with surface voxels.
//!
//! A table is kept in a cache line of its own, by the brick's linear index, so that a shader reads one line for all
//! voxels of a brick. What is freed is used again.

use crate::shade::occlusion::Table;

/// The entry of a brick without a table.
const NONE: u32 = u32::MAX;

/// A table in a cache line.
#[repr(align(64))]
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Line(Table);

/// The tables of one grid.
#[derive(Debug, Default)]
pub struct KeptOpenness {
    /// The place of each brick's table.
    places: Vec<u32>,
    lines: Vec<Line>,
    free: Vec<u32>,
}

impl KeptOpenness {
    /// Forgets all tables; for a grid of so many bricks.
    pub fn clear(&mut self, bricks: usize) {
        *self = KeptOpenness { places: vec![NONE; bricks], ..KeptOpenness::default() };
    }

    /// The table of a brick, if it has one.
    #[inline(always)]
    pub fn table(&self, brick: usize) -> Option<&Table> {
        let place = *self.places.get(brick)?;
        self.lines.get(place as usize).map(|line| &line.0)
    }

    /// Keeps the table of a brick, or forgets it.
    pub fn store(&mut self, brick: usize, table: Option<&Table>) {
        let place = &mut self.places[brick];
        match table {
            Some(table) => {
                if *place == NONE {
                    *place = self.free.pop().unwrap_or(self.lines.len() as u32);
                }
                match self.lines.get_mut(*place as usize) {
                    Some(line) => line.0 = *table,
                    None => self.lines.push(Line(*table)),
                }
            }
            None if *place != NONE => self.free.push(std::mem::replace(place, NONE)),
            None => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::Random;

    #[test]
    fn every_brick_has_the_table_that_was_stored_last_and_freed_memory_is_used_again() {
        let mut random = Random(6);
        let mut kept = KeptOpenness::default();
        kept.clear(20);
        let mut expected = [None; 20];
        for _ in 0..2000 {
            let brick = random.next_u64() as usize % 20;
            let value = random.next_u64();
            let table = (value & 3 != 0).then_some([[[(value >> 8) as u16; 3]; 3]; 3]);
            kept.store(brick, table.as_ref());
            expected[brick] = table;
            for (brick, table) in expected.iter().enumerate() {
                assert_eq!(kept.table(brick), table.as_ref());
            }
        }
        assert!(kept.lines.len() <= 20);
        kept.clear(7);
        assert!((0..20).all(|brick| kept.table(brick).is_none()));
    }
}
