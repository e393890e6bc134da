//! Random numbers that are the same for the same seed (SplitMix64, S. Vigna).

pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ z >> 31
    }

    /// Returns a number from 0 to `end` - 1.
    pub fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// Returns a number from `from` to `to`, inclusive.
    pub fn whole(&mut self, from: i64, to: i64) -> i64 {
        from + self.below((to - from + 1) as u64) as i64
    }

    /// Returns a multiple of 1/16 from `from` to `to`, which text and `f32` represent exactly.
    pub fn sixteenths(&mut self, from: f64, to: f64) -> f64 {
        self.whole((from * 16.0) as i64, (to * 16.0) as i64) as f64 / 16.0
    }

    pub fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    pub fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as u64) as usize]
    }

    pub fn three<T>(&mut self, mut one: impl FnMut(&mut Random) -> T) -> [T; 3] {
        [one(self), one(self), one(self)]
    }
}
