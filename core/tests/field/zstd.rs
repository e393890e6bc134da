//! TIFF files packed with ZSTD: strips, tiles, differences, both byte orders, and damaged ones; see `mod.rs`.

use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use sculpture_core::format::load_volume;

use super::*;

/// A grey page of 16 bits.
struct Page {
    is_big: bool,
    size: [u32; 2],
    /// Width and height of tiles; `None` for strips of `rows` rows.
    tiles: Option<[u32; 2]>,
    rows: u32,
    /// 2: each number of a row is a difference from the previous one.
    predictor: u32,
}

const STRIPS: Page = Page { is_big: false, size: [5, 4], tiles: None, rows: 4, predictor: 1 };

impl Page {
    fn two(&self, number: u16) -> [u8; 2] {
        if self.is_big { number.to_be_bytes() } else { number.to_le_bytes() }
    }

    fn four(&self, number: u32) -> [u8; 4] {
        if self.is_big { number.to_be_bytes() } else { number.to_le_bytes() }
    }

    /// Returns the number at a place.
    fn level(x: u32, y: u32) -> u16 {
        (1000 + 300 * x + 7 * y) as u16
    }

    /// Returns the bytes of each strip or tile, unpacked.
    fn chunks(&self) -> Vec<Vec<u8>> {
        let [width, height] = self.size;
        let [wide, high] = self.tiles.unwrap_or([width, self.rows]);
        let mut chunks = Vec::new();
        for top in (0..height).step_by(high as usize) {
            for left in (0..width).step_by(wide as usize) {
                let end = if self.tiles.is_some() { top + high } else { height.min(top + high) };
                let mut bytes = Vec::new();
                for y in top..end {
                    let mut last = 0;
                    for x in left..left + wide {
                        let level = Page::level(x, y);
                        let told =
                            if self.predictor == 2 { level.wrapping_sub(last) } else { level };
                        last = level;
                        bytes.extend(self.two(told));
                    }
                }
                chunks.push(bytes);
            }
        }
        chunks
    }

    /// Returns a file of this page with these strips or tiles.
    fn file(&self, chunks: &[Vec<u8>]) -> Vec<u8> {
        let begin = 8u32;
        let begins = chunks.iter().scan(begin, |at, chunk| {
            *at += chunk.len() as u32;
            Some(*at - chunk.len() as u32)
        });
        let begins: Vec<u32> = begins.collect();
        let lengths: Vec<u32> = chunks.iter().map(|chunk| chunk.len() as u32).collect();
        let [width, height] = self.size;
        let mut entries = vec![
            (256, vec![width]),
            (257, vec![height]),
            (258, vec![16]),
            (259, vec![50000]),
            (262, vec![1]),
            (277, vec![1]),
            (317, vec![self.predictor]),
        ];
        match self.tiles {
            Some([wide, high]) => {
                entries.extend([
                    (322, vec![wide]),
                    (323, vec![high]),
                    (324, begins),
                    (325, lengths),
                ]);
            }
            None => entries.extend([(273, begins), (278, vec![self.rows]), (279, lengths)]),
        }
        entries.sort();
        let pixels = chunks.concat();
        let directory = 8 + pixels.len();
        let mut beside = directory + 6 + 12 * entries.len();
        let mut file = if self.is_big { b"MM".to_vec() } else { b"II".to_vec() };
        file.extend(self.two(42));
        file.extend(self.four(directory as u32));
        file.extend(pixels);
        file.extend(self.two(entries.len() as u16));
        for (tag, values) in &entries {
            file.extend(self.two(*tag));
            file.extend(self.two(4));
            file.extend(self.four(values.len() as u32));
            match values[..] {
                [value] => file.extend(self.four(value)),
                _ => {
                    file.extend(self.four(beside as u32));
                    beside += 4 * values.len();
                }
            }
        }
        file.extend(self.four(0));
        for (_, values) in entries.iter().filter(|(_, values)| values.len() > 1) {
            values.iter().for_each(|value| file.extend(self.four(*value)));
        }
        file
    }

    fn packed(&self) -> Vec<Vec<u8>> {
        let pack = |chunk: &Vec<u8>| compress_to_vec(chunk.as_slice(), CompressionLevel::Fastest);
        self.chunks().iter().map(pack).collect()
    }
}

fn densities(path: &Path) -> Result<Vec<f32>, String> {
    let volume = load_volume(path, &ImportOptions::default(), &Limits::default(), &());
    let volume = volume.map_err(|error| error.to_string())?;
    let (width, height) = (volume.dims.x, volume.dims.y);
    let at = |i: u32| volume.density(UVec3::new(i % width, i / width, 0)).unwrap();
    Ok((0..width * height).map(at).collect())
}

#[test]
fn strips_and_tiles_packed_with_zstd_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    for is_big in [false, true] {
        for predictor in [1, 2] {
            for (size, tiles, rows) in [
                ([5, 4], None, 4),
                ([5, 4], None, 3),
                ([5, 4], None, u32::MAX),
                ([7, 9], None, 1),
                ([5, 4], Some([16, 16]), 0),
                ([40, 20], Some([16, 16]), 0),
            ] {
                let page = Page { is_big, size, tiles, rows: rows.min(size[1]), predictor };
                let chunks = page.packed();
                std::fs::write(&path, Page { rows, ..page }.file(&chunks)).unwrap();
                let right: Vec<f32> = (0..size[0] * size[1])
                    .map(|i| f32::from(Page::level(i % size[0], i / size[0])))
                    .collect();
                let found = densities(&path);
                assert_eq!(found, Ok(right), "{is_big} {predictor} {size:?} {tiles:?} {rows}");
            }
        }
    }
}

#[test]
fn damaged_pages_packed_with_zstd_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    let whole = STRIPS.file(&STRIPS.packed());
    for at in 0..whole.len() {
        for bit in [0, 3, 7] {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << bit;
            std::fs::write(&path, &bytes).unwrap();
            let _ = densities(&path);
        }
    }
    // A frame of fewer bytes than the strip has, a truncated one, other data, and a window of 2 TiB.
    let short = compress_to_vec(&[1u8; 39][..], CompressionLevel::Fastest);
    let mut cut = STRIPS.packed().concat();
    cut.pop();
    let foreign = b"no frame at all, but text".to_vec();
    let wide = [&0xFD2F_B528u32.to_le_bytes()[..], &[0, 0xF8, 1, 0, 0]].concat();
    for (chunk, told) in
        [(short, "40 bytes were expected"), (cut, "ZSTD"), (foreign, "ZSTD"), (wide, "ZSTD")]
    {
        std::fs::write(&path, STRIPS.file(&[chunk])).unwrap();
        let error = densities(&path).unwrap_err();
        assert!(error.contains(told), "{error}");
    }
    // Data beyond the strip is not unpacked.
    let endless = compress_to_vec(&vec![0u8; 1 << 24][..], CompressionLevel::Fastest);
    std::fs::write(&path, STRIPS.file(&[endless])).unwrap();
    assert_eq!(densities(&path), Ok(vec![0.0; 20]));
}
