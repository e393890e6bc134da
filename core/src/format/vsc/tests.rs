use std::sync::LazyLock;

use super::*;
use crate::refusal::MemoryBudget;
use crate::scenes::{self, Random};
use crate::sculpture::brick::{Brick, BrickKind};
use proptest::prelude::*;

/// Returns a sculpture of empty, full and mixed bricks, with pages of one, some and many colours, some of them under
/// voxels that do not exist.
fn sculpture(dims: [u32; 3], depth: ColourDepth, seed: u64) -> Contents {
    let mut grid = Grid::new(UVec3::from(dims), Vec3::new(1.0, 0.5, 3.25), 1 << 30).unwrap();
    let cheese = scenes::cheese(96, 12, seed).unwrap();
    grid.fill_bricks(|b| {
        let mut random = Random(seed ^ u64::from(b.x + 64 * b.y + 4096 * b.z));
        match random.next_u64() % 8 {
            0 => Brick::EMPTY,
            1 => Brick { words: std::array::from_fn(|_| random.next_u64()) },
            2 => Brick::FULL,
            _ => *cheese.brick(b % 12),
        }
    });
    let mut material = Material::for_grid(&grid, depth, Rgb::new(10, 200, 30));
    let mut random = Random(seed);
    for brick in 0..grid.brick_count() {
        let colours = match random.next_u64() % 6 {
            0 => 1,
            1 => 2 + random.next_u64() % 15,
            2 => 17,
            3 => 512,
            _ => continue,
        };
        let mask = Brick { words: std::array::from_fn(|_| random.next_u64()) };
        material.paint_each(
            grid.brick_coords(brick),
            if colours == 1 { &Brick::FULL } else { &mask },
            |i| {
                let shade = (u64::from(i) * 7 % colours) as u8;
                Rgb::new(shade.wrapping_mul(37), 255 - shade, seed as u8)
            },
        );
    }
    Contents::new(grid, material)
}

fn texts() -> Texts {
    Texts { description: b"a head".to_vec(), comment: vec![0, 255, 10], ..Texts::default() }
}

const DEPTHS: [ColourDepth; 4] =
    [ColourDepth::None, ColourDepth::Bits8, ColourDepth::Bits16, ColourDepth::Bits24];

#[test]
fn a_written_sculpture_is_read_back_to_the_byte() {
    for (i, dims) in [[1, 1, 1], [8, 8, 8], [61, 90, 47], [200, 17, 130]].into_iter().enumerate() {
        for depth in DEPTHS {
            let contents = sculpture(dims, depth, i as u64);
            for texts in [Texts::default(), texts()] {
                let file = write(&contents, &texts, &()).unwrap();
                let read = read(&file, &Limits::default(), &()).unwrap();
                assert!(read == (contents.clone(), texts), "{dims:?} {depth:?}");
            }
        }
    }
}

#[test]
fn a_block_takes_next_to_nothing() {
    for grid in [scenes::solid_cube(260).unwrap(), scenes::cheese(260, 0, 1).unwrap()] {
        let material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::default());
        let contents = Contents::new(grid, material);
        let file = write(&contents, &Texts::default(), &()).unwrap();
        assert!(file.len() < 300, "{} bytes", file.len());
        assert!(read(&file, &Limits::default(), &()).unwrap().0 == contents);
    }
}

#[test]
fn a_cut_file_is_refused_at_every_length() {
    let file = write(&sculpture([40, 30, 20], ColourDepth::Bits16, 4), &texts(), &()).unwrap();
    for len in 0..file.len() {
        let error = read(&file[..len], &Limits::default(), &()).unwrap_err();
        assert!(!matches!(error, FormatError::OverBudget(_)), "{len}: {error}");
    }
    let longer = [&file[..], &[0]].concat();
    assert!(read(&longer, &Limits::default(), &()).is_err());
}

#[test]
fn limits_are_asked_before_memory_is_taken() {
    let contents = sculpture([80, 80, 80], ColourDepth::Bits24, 4);
    let file = write(&contents, &Texts::default(), &()).unwrap();
    let limits = Limits { grid_bytes: 1 << 10, ..Limits::default() };
    assert!(matches!(read(&file, &limits, &()), Err(FormatError::Grid(_))));
    let limits = Limits { colour_bytes: 1 << 10, ..Limits::default() };
    let Err(FormatError::OverBudget(over)) = read(&file, &limits, &()) else { panic!("read") };
    assert_eq!(over.budget, MemoryBudget::Colours);
    assert!(matches!(read(b"PVM3\n", &limits, &()), Err(FormatError::NotVsc(_))));
    let mut newer = file.clone();
    newer[8] = 5;
    assert!(matches!(read(&newer, &Limits::default(), &()), Err(FormatError::VscVersion(5))));
    // A file with a mask must contain it.
    newer[8] = 2;
    assert!(matches!(read(&newer, &Limits::default(), &()), Err(FormatError::Damaged(_))));
}

/// Sculptures are written in the lowest version that can represent them, and those of earlier programs are smooth.
#[test]
fn cubes_are_kept_with_and_without_a_mask() {
    let smooth = sculpture([40, 30, 20], ColourDepth::Bits16, 4);
    let masked = Contents { mask: Some(Box::new(smooth.grid.clone())), ..smooth.clone() };
    for (contents, usual) in [(smooth, 1), (masked, 2)] {
        for (surface, version) in [(SurfaceKind::Smooth, usual), (SurfaceKind::Cubes, 3)] {
            let contents = Contents { surface, ..contents.clone() };
            let file = write(&contents, &texts(), &()).unwrap();
            assert_eq!(file[8], version);
            assert!(read(&file, &Limits::default(), &()).unwrap() == (contents, texts()));
        }
    }
    let contents = sculpture([40, 30, 20], ColourDepth::Bits16, 4);
    let contents = Contents { surface: SurfaceKind::Cubes, ..contents };
    let file = write(&contents, &texts(), &()).unwrap();
    for len in 0..file.len() {
        assert!(read(&file[..len], &Limits::default(), &()).is_err(), "{len}");
    }
    let mut unknown = file.clone();
    unknown[START_BYTES] |= 4;
    sign(&mut unknown);
    assert!(matches!(read(&unknown, &Limits::default(), &()), Err(FormatError::Damaged(_))));
}

/// Recomputes all checksums, so that the data behind them is tested.
fn sign(file: &mut [u8]) {
    let number = |file: &[u8], at: usize| {
        file.get(at..at + 4).map_or(0, |b| u32::from_le_bytes(b.try_into().unwrap()) as usize)
    };
    let (count, texts) = (number(file, 44), number(file, 48));
    let head = START_BYTES + if number(file, 8) == VERSION_WITH_FLAGS as usize { 4 } else { 0 };
    let table = head + 4;
    let body = table.saturating_add(count.saturating_mul(ENTRY_BYTES)).saturating_add(texts);
    if body > file.len() {
        return;
    }
    let mut from = body;
    for entry in (table..table + count * ENTRY_BYTES).step_by(ENTRY_BYTES) {
        let to = from.saturating_add(number(file, entry)).min(file.len());
        let crc = crc32fast::hash(&file[from..to]);
        file[entry + 12..entry + 16].copy_from_slice(&crc.to_le_bytes());
        from = to;
    }
    let crc = checksum(&file[..head], &file[table..body]);
    file[head..table].copy_from_slice(&crc.to_le_bytes());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// A damaged file yields an error, or a valid sculpture, but no panic.
    #[test]
    fn damage_is_found_or_harmless(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        early: bool,
        signed: bool,
    ) {
        static ORIGINAL: LazyLock<Vec<u8>> = LazyLock::new(|| {
            write(&sculpture([40, 30, 20], ColourDepth::Bits16, 4), &texts(), &()).unwrap()
        });
        let mut file = ORIGINAL.clone();
        for (at, value) in changes {
            let len = if early { 120.min(file.len()) } else { file.len() };
            file[at.index(len)] = value;
        }
        if signed {
            sign(&mut file);
        }
        let limits = Limits { grid_bytes: 4 << 20, colour_bytes: 4 << 20, ..Limits::default() };
        match read(&file, &limits, &()) {
            Err(error) => prop_assert!(error.to_string().len() < 300),
            Ok((Contents { grid, material, .. }, _)) => {
                prop_assert!(signed || file == *ORIGINAL);
                for index in 0..grid.brick_count() {
                    let brick = grid.brick_at(index);
                    let kind = match brick.count() {
                        0 => BrickKind::Empty,
                        512 => BrickKind::Full,
                        _ => BrickKind::Mixed,
                    };
                    prop_assert_eq!(grid.brick_kind(index), kind);
                    let valid = grid.valid_mask(grid.brick_coords(index));
                    prop_assert_eq!(brick.and_not(&valid), Brick::EMPTY);
                    let page = material.page(grid.brick_coords(index));
                    let bytes = page.map(|page| page.write_to(&mut [0; 1536]).to_vec());
                    let page = page.map(|page| page.to_page());
                    prop_assert_eq!(page, bytes.map(|bytes| Page::of_bytes(&bytes, material.depth())));
                }
            }
        }
    }
}
