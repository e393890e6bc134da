//! A hash of a sculpture: the same for the same voxels and colours, whatever machine, number of threads or order of
//! edits produced them.
//!
//! SHA-256 (NIST FIPS 180-4), over size, colour depth and base colour, then over the hashes of runs of 4096 bricks, so
//! that all threads share the work. Of runs that are uniform, only one of each kind is hashed. A brick contributes its
//! eight words, and its page of colours if it has one: two sculptures that look alike but are painted differently have
//! different hashes.

use std::fmt;
use std::io::{ErrorKind, Read};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::brick::Brick;
use super::contents::{Contents, SurfaceKind};
use super::grid::{BrickSpans, Grid};
use super::material::{MAX_PAGE_BYTES, Material, PackedColour, PageView};

/// Number of bricks in a run.
const RUN_BRICKS: usize = 4096;

/// A hash of 256 bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Digest(pub [u8; 32]);

impl Digest {
    /// Returns the digest of bytes.
    pub fn of_bytes(bytes: &[u8]) -> Digest {
        let mut hasher = Sha256::new();
        hasher.update(bytes);
        hasher.finish()
    }

    /// Returns the digest of all bytes of a reader.
    pub(crate) fn of_reader(mut reader: impl Read) -> std::io::Result<Digest> {
        let mut hasher = Sha256::new();
        let mut portion = vec![0; 1 << 18];
        loop {
            match reader.read(&mut portion) {
                Ok(0) => return Ok(hasher.finish()),
                Ok(length) => hasher.update(&portion[..length]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Returns the digest of a sculpture.
    pub fn of(contents: &Contents) -> Digest {
        let Contents { grid, material, mask, surface, frame } = contents;
        let mut hasher = Sha256::new();
        hasher.update(b"virtual-sculpture 1");
        grid.dims().to_array().iter().for_each(|edge| hasher.update(&edge.to_le_bytes()));
        let edges = grid.voxel_size().to_array();
        edges.iter().for_each(|edge| hasher.update(&edge.to_bits().to_le_bytes()));
        hasher.update(&[material.depth().bits() as u8]);
        hasher.update(&material.base().0);
        let uniform_runs = Mutex::default();
        let runs: Vec<Digest> = (0..grid.brick_count())
            .into_par_iter()
            .step_by(RUN_BRICKS)
            .map(|first| of_run(grid, material, first, &uniform_runs))
            .collect();
        runs.iter().for_each(|run| hasher.update(&run.0));
        if let Some(mask) = mask {
            hasher.update(&Digest::of(&Contents::of_bits((**mask).clone())).0);
        }
        // Nothing for the usual kind, so that older digests remain valid.
        match surface {
            SurfaceKind::Smooth => {}
            SurfaceKind::Cubes => hasher.update(&[4]),
        }
        if !contents.canvas().is_plain() {
            hasher.update(&[5, u8::from(frame.grows)]);
            frame.origin.to_array().iter().for_each(|at| hasher.update(&at.to_le_bytes()));
            frame.home.to_array().iter().for_each(|edge| hasher.update(&edge.to_le_bytes()));
        }
        hasher.finish()
    }
}

/// Bricks that follow each other and contribute the same bytes.
#[derive(Clone, Copy, PartialEq)]
struct Alike<'a> {
    brick: &'a Brick,
    page: Option<PageView<'a>>,
    count: usize,
}

/// The digests of whole runs of bricks that are all empty or all full, and of one colour or unpainted.
type UniformRuns = Mutex<FxHashMap<(bool, Option<PackedColour>), Digest>>;

/// Returns the digest of the run of bricks that begins at a linear index.
fn of_run(grid: &Grid, material: &Material, first: usize, uniform: &UniformRuns) -> Digest {
    let (mut hasher, reader) = (Sha256::new(), material.reader());
    let has_pages = material.page_count() > 0;
    let mut pending: Option<Alike> = None;
    for span in BrickSpans::new(grid, first, RUN_BRICKS) {
        let end = span.first.x + span.len;
        let mut b = span.first;
        while b.x < end {
            let (page, page_end) = if has_pages { reader.span(b) } else { (None, end) };
            let count = page_end.min(end) - b.x;
            let next = Alike { brick: span.brick, page, count: count as usize };
            match &mut pending {
                Some(pending) if pending.is_continued_by(&next) => pending.count += next.count,
                _ => {
                    if let Some(pending) = pending.replace(next) {
                        pending.add_to(&mut hasher);
                    }
                }
            }
            b.x += count;
        }
    }
    let Some(pending) = pending else { return hasher.finish() };
    let colour = pending.page.map(|page| page.packed());
    let key = (pending.brick.is_full(), colour.flatten());
    let is_known_kind = pending.count == RUN_BRICKS && colour != Some(None);
    // A brick that the border of the grid cuts contributes its bits.
    let is_uniform = is_known_kind && (key.0 || pending.brick.is_empty());
    let known = || uniform.lock().unwrap_or_else(PoisonError::into_inner);
    if is_uniform && let Some(digest) = known().get(&key) {
        return *digest;
    }
    pending.add_to(&mut hasher);
    let digest = hasher.finish();
    if is_uniform {
        known().insert(key, digest);
    }
    digest
}

impl Alike<'_> {
    /// Returns whether other bricks contribute the same bytes and follow these.
    fn is_continued_by(&self, next: &Alike) -> bool {
        let is_same = match (self.page, next.page) {
            (None, None) => true,
            (Some(a), Some(b)) => a.packed().is_some() && a.packed() == b.packed(),
            _ => false,
        };
        is_same && self.brick == next.brick
    }

    fn add_to(&self, hasher: &mut Sha256) {
        let kind = match (self.brick.is_empty(), self.brick.is_full()) {
            (true, _) => 0,
            (_, true) => 1,
            _ => 2,
        };
        if kind < 2 && self.page.is_none() {
            let bytes = [kind; 64];
            let mut left = self.count;
            while left > 0 {
                let some = left.min(bytes.len());
                hasher.update(&bytes[..some]);
                left -= some;
            }
            return;
        }
        let mut buffer = [0; MAX_PAGE_BYTES];
        for _ in 0..self.count {
            hasher.update(&[kind]);
            if kind == 2 {
                self.brick.words.iter().for_each(|word| hasher.update(&word.to_le_bytes()));
            }
            if let Some(page) = &self.page {
                hasher.update(&[3]);
                hasher.update(page.write_to(&mut buffer));
            }
        }
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The hash function of FIPS 180-4, section 6.2.
struct Sha256 {
    state: [u32; 8],
    block: [u8; 64],
    bytes: u64,
}

/// The first 32 bits of the fractional parts of the cube roots of the first 64 primes (section 4.2.2).
#[rustfmt::skip]
const ROUNDS: [u32; 64] = [
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2,
];

impl Sha256 {
    fn new() -> Sha256 {
        let state = [
            0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab,
            0x5be0cd19,
        ];
        Sha256 { state, block: [0; 64], bytes: 0 }
    }

    fn update(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let at = (self.bytes % 64) as usize;
            let count = bytes.len().min(64 - at);
            self.block[at..at + count].copy_from_slice(&bytes[..count]);
            self.bytes += count as u64;
            bytes = &bytes[count..];
            if at + count == 64 {
                self.compress();
            }
        }
    }

    fn finish(mut self) -> Digest {
        let bits = self.bytes * 8;
        self.update(&[0x80]);
        while self.bytes % 64 != 56 {
            self.update(&[0]);
        }
        self.update(&bits.to_be_bytes());
        let mut digest = [0; 32];
        for (out, word) in digest.as_chunks_mut::<4>().0.iter_mut().zip(self.state) {
            *out = word.to_be_bytes();
        }
        Digest(digest)
    }

    fn compress(&mut self) {
        let mut w = [0u32; 64];
        for (word, bytes) in w.iter_mut().zip(self.block.as_chunks::<4>().0) {
            *word = u32::from_be_bytes(*bytes);
        }
        for t in 16..64 {
            let s0 = w[t - 15].rotate_right(7) ^ w[t - 15].rotate_right(18) ^ (w[t - 15] >> 3);
            let s1 = w[t - 2].rotate_right(17) ^ w[t - 2].rotate_right(19) ^ (w[t - 2] >> 10);
            w[t] = w[t - 16].wrapping_add(s0).wrapping_add(w[t - 7]).wrapping_add(s1);
        }
        let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = self.state;
        for t in 0..64 {
            let s1 = e.rotate_right(6) ^ e.rotate_right(11) ^ e.rotate_right(25);
            let choice = (e & f) ^ (!e & g);
            let t1 = h.wrapping_add(s1).wrapping_add(choice).wrapping_add(ROUNDS[t]);
            let t1 = t1.wrapping_add(w[t]);
            let s0 = a.rotate_right(2) ^ a.rotate_right(13) ^ a.rotate_right(22);
            let majority = (a & b) ^ (a & c) ^ (b & c);
            let t2 = s0.wrapping_add(majority);
            (h, g, f, e) = (g, f, e, d.wrapping_add(t1));
            (d, c, b, a) = (c, b, a, t1.wrapping_add(t2));
        }
        for (state, word) in self.state.iter_mut().zip([a, b, c, d, e, f, g, h]) {
            *state = state.wrapping_add(word);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};
    use proptest::prelude::*;
    use sha2::Digest as _;

    use super::*;
    use crate::sculpture::{ColourDepth, Rgb};

    #[test]
    fn bytes_have_the_hash_of_the_standard() {
        let bytes: Vec<u8> = (0..400u32).map(|i| (i * 7) as u8).collect();
        for length in (0..200).chain([400]) {
            let expected: [u8; 32] = sha2::Sha256::digest(&bytes[..length]).into();
            assert_eq!(Digest::of_bytes(&bytes[..length]).0, expected, "{length}");
        }
    }

    #[test]
    fn every_voxel_and_colour_counts() {
        let mut grid = Grid::new(UVec3::new(300, 170, 9), Vec3::ONE, 1 << 30).unwrap();
        grid.fill_bricks(|b| if b.x % 3 == 0 { Brick::FULL } else { Brick::below([3, 8, 2]) });
        let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
        let contents = Contents::new(grid, material);
        let first = Digest::of(&contents);
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(one.install(|| Digest::of(&contents)), first, "whatever the number of threads");
        let mut others = vec![first];
        let mut changed = contents.clone();
        changed.grid.set_brick(40, Brick::EMPTY);
        others.push(Digest::of(&changed));
        let mut changed = contents.clone();
        changed.material.paint(UVec3::new(17, 17, 1), &Brick::FULL, Rgb::new(1, 2, 3));
        others.push(Digest::of(&changed));
        let mut changed = contents.clone();
        changed.material =
            Material::for_grid(&contents.grid, ColourDepth::Bits24, Rgb::new(0, 0, 1));
        others.push(Digest::of(&changed));
        others.push(Digest::of(&Contents { surface: SurfaceKind::Cubes, ..contents.clone() }));
        let differing: std::collections::HashSet<_> = others.iter().collect();
        assert_eq!(differing.len(), 5);
    }

    /// Returns the digest, brick by brick.
    fn naive(contents: &Contents) -> Digest {
        let Contents { grid, material, .. } = contents;
        let mut all = b"virtual-sculpture 1".to_vec();
        grid.dims().to_array().iter().for_each(|edge| all.extend(edge.to_le_bytes()));
        grid.voxel_size()
            .to_array()
            .iter()
            .for_each(|edge| all.extend(edge.to_bits().to_le_bytes()));
        all.push(material.depth().bits() as u8);
        all.extend(material.base().0);
        for first in (0..grid.brick_count()).step_by(RUN_BRICKS) {
            let mut run = Vec::new();
            for index in first..grid.brick_count().min(first + RUN_BRICKS) {
                let b = grid.brick_coords(index);
                let brick = grid.brick(b);
                match (brick.is_empty(), brick.is_full()) {
                    (true, _) => run.push(0),
                    (_, true) => run.push(1),
                    _ => {
                        run.push(2);
                        brick.words.iter().for_each(|word| run.extend(word.to_le_bytes()));
                    }
                }
                if let Some(page) = material.page(b) {
                    run.push(3);
                    run.extend(page.write_to(&mut [0; MAX_PAGE_BYTES]));
                }
            }
            all.extend(Digest::of_bytes(&run).0);
        }
        Digest::of_bytes(&all)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        #[test]
        fn the_digest_is_that_of_all_bricks(
            dims in prop::array::uniform3(1u32..200),
            long in 0usize..4,
            fills in prop::collection::vec(
                (any::<prop::sample::Index>(), 1usize..6000, 0u32..3, 0u8..3), 0..8,
            ),
            depth in prop::sample::select(&ColourDepth::ALL[..]),
        ) {
            let mut dims = UVec3::from(dims);
            if long < 3 {
                dims[long] = 700;
            }
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            let mut material = Material::for_grid(&grid, depth, Rgb::STONE);
            for (index, len, kind, colour) in fills {
                let first = index.index(grid.brick_count());
                for index in first..grid.brick_count().min(first + len) {
                    let b = grid.brick_coords(index);
                    let valid = grid.valid_mask(b);
                    let odd = Brick { words: [0x1234_5678_9ABC_DEF0; 8] };
                    grid.set_brick(index, [Brick::EMPTY, valid, odd.and(&valid)][kind as usize]);
                    if colour > 0 {
                        let mask = if colour == 1 { odd } else { Brick::FULL };
                        material.paint(b, &mask, Rgb::new(80 * colour, 10, 200));
                    }
                }
            }
            let contents = Contents::new(grid, material);
            prop_assert_eq!(Digest::of(&contents), naive(&contents));
        }
    }

    #[test]
    fn a_large_dyed_block_has_the_digest_of_all_its_bricks() {
        let mut grid = Grid::new(UVec3::splat(520), Vec3::ONE, 1 << 30).unwrap();
        grid.fill_bricks(|b| if b.x == 40 && b.y == 3 { Brick::EMPTY } else { Brick::FULL });
        let material = Material::for_grid(&grid, ColourDepth::Bits8, Rgb::STONE);
        let contents = Contents::new(grid, material);
        assert_eq!(Digest::of(&contents), naive(&contents));
    }
}
