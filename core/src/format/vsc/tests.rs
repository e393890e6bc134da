use std::sync::LazyLock;

use super::*;
use crate::refusal::MemoryBudget;
use crate::scenes::{self, Random};
use crate::sculpture::brick::{Brick, BrickKind};
use crate::sculpture::material::ColourCube;
use crate::sculpture::region::VoxelBox;
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
    newer[8] = 6;
    assert!(matches!(read(&newer, &Limits::default(), &()), Err(FormatError::VscVersion(6))));
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

/// Returns a large block with holes, paint of one colour over leaves and nodes and of many colours in bricks, and a mask.
fn large() -> Contents {
    let dims = UVec3::new(1100, 1030, 1051);
    let mut grid = Grid::of_size(dims, Vec3::new(1.0, 2.0, 0.5)).unwrap();
    grid.fill_box(VoxelBox { min: IVec3::new(3, 0, 8), max: IVec3::new(1100, 1000, 1051) });
    let mut random = Random(7);
    for _ in 0..3000 {
        let mut at = || (random.next_u64() % 1100) as i32;
        let v = IVec3::new(at(), at(), at());
        let exists = grid.get(v);
        grid.set(v, !exists);
    }
    let mut material = Material::for_grid(&grid, ColourDepth::Bits16, Rgb::STONE);
    let red = Page::uniform(Rgb::new(248, 0, 0), ColourDepth::Bits16);
    for (low, level) in [([64, 64, 64], 2), ([8, 0, 16], 1), ([136, 128, 128], 1), ([3, 3, 3], 0)] {
        material.set_cube(ColourCube { low: low.into(), level }, red.clone());
    }
    material.paint_each(UVec3::new(100, 7, 99), &Brick::FULL, |i| Rgb::new(i as u8, 8, 8));
    let mut mask = grid.emptied();
    mask.fill_box(VoxelBox { min: IVec3::splat(50), max: IVec3::new(90, 1030, 77) });
    let frame = CanvasFrame { origin: IVec3::splat(-64), home: UVec3::splat(900), grows: true };
    let surface = SurfaceKind::Cubes;
    Contents { mask: Some(Box::new(mask)), frame, surface, ..Contents::new(grid, material) }
}

#[test]
fn a_large_sculpture_is_written_by_nodes_and_read_back_to_the_byte() {
    let contents = large();
    let file = write(&contents, &texts(), &()).unwrap();
    assert_eq!(file[8], 5);
    assert!(file.len() < 400_000, "{} bytes", file.len());
    let (read_back, read_texts) = read(&file, &Limits::default(), &()).unwrap();
    assert_eq!(read_back, contents);
    assert_eq!(read_texts, texts());
    assert_eq!(read_back.material.page_count(), contents.material.page_count());
    assert_eq!(read_back.material.heap_bytes(), contents.material.heap_bytes());
    assert_eq!(read_back.grid.opaque_count(), contents.grid.opaque_count());
    // Any cut and any change is noticed.
    for at in (0..file.len()).step_by(file.len() / 60).chain(0..300) {
        assert!(read(&file[..at], &Limits::default(), &()).is_err(), "cut at {at}");
        let mut damaged = file.clone();
        damaged[at] ^= 0x10;
        assert!(read(&damaged, &Limits::default(), &()).is_err(), "damaged at {at}");
    }
    let limits = Limits { grid_bytes: 1 << 10, ..Limits::default() };
    assert!(matches!(read(&file, &limits, &()), Err(FormatError::Grid(_))));
}

#[test]
fn uniform_sculptures_take_next_to_nothing_whatever_their_size() {
    for dims in [
        UVec3::splat(1025),
        UVec3::new(4096, 4095, 2000),
        UVec3::new(8192, 24, 8192),
        UVec3::splat(8192),
    ] {
        for is_full in [false, true] {
            let mut grid = Grid::of_size(dims, Vec3::ONE).unwrap();
            if is_full {
                grid.fill_box(VoxelBox::of_grid(&grid));
            }
            let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
            let all = ColourCube { low: UVec3::ZERO, level: 4 };
            for index in 0..512 {
                let cube = all.child_at(index);
                if is_full && cube.low.cmplt(grid.brick_dims()).all() {
                    let page = Page::uniform(Rgb::new(1, 2, 3), ColourDepth::Bits24);
                    material.set_cube(cube, page);
                }
            }
            let contents = Contents::new(grid, material);
            let file = write(&contents, &Texts::default(), &()).unwrap();
            assert!(file.len() < 400, "{dims}: {} bytes", file.len());
            assert_eq!(read(&file, &Limits::default(), &()).unwrap().0, contents);
        }
    }
}

/// A map from elsewhere may say anything.
#[test]
fn maps_that_are_not_possible_are_refused() {
    let dims = UVec3::new(1100, 1030, 1051);
    let unpack = |plain: &[u8], bytes: u32| {
        let packed = lz4_flex::block::compress(plain);
        NodeMap::unpack(&packed, bytes, dims, ColourDepth::Bits24)
    };
    // The root has 3^3 children of 64^3 bricks.
    assert!(unpack(&[1; 27], 27).is_ok());
    for (plain, bytes) in [
        (vec![1; 26], 26),
        (vec![1; 28], 28),
        (vec![1; 27], 26),
        (vec![1; 27], 28),
        (vec![1; 27], u32::MAX),
        (vec![3; 27], 27),
        (vec![6; 27], 27),
        (vec![2; 27], 27),
        (vec![5; 27], 27),
        ([vec![5; 27], vec![2; 27 * 7]].concat(), 27 * 8),
    ] {
        assert!(unpack(&plain, bytes).is_err(), "{plain:?}");
    }
    let none = lz4_flex::block::compress(&[5; 27]);
    assert!(NodeMap::unpack(&none, 27, dims, ColourDepth::None).is_err());
}
