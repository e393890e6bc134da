//! Pages whose pixels are palette indices. The decoder does not support palettes: it is told that the indices are grey,
//! and the colours are inserted afterwards.
//!
//! Takes the bytes of a file; gives the colours of its first palette. Files whose directories cannot be followed are
//! left unchanged: the decoder reports the fault.

const PHOTOMETRIC: u16 = 262;
const BITS: u16 = 258;
const COLOURS: u16 = 320;
/// Values of [`PHOTOMETRIC`].
const BLACK_IS_0: u16 = 1;
const IS_PALETTE: u16 = 3;
const ENTRY_BYTES: usize = 12;
const MOST_DIRECTORIES: usize = 1 << 16;

/// Marks pages with palettes of 256 colours as grey; returns the first palette, unless it is one of greys.
pub fn taken(file: &mut [u8]) -> Option<[[u8; 3]; 256]> {
    let is_big = match file.get(..4)? {
        b"II*\0" => false,
        b"MM\0*" => true,
        _ => return None,
    };
    let mut found = None;
    let mut directory = u32_at(file, 4, is_big)? as usize;
    for _ in 0..MOST_DIRECTORIES {
        let Some(count) = u16_at(file, directory, is_big) else { break };
        let mut places = [None; 3];
        for i in 0..usize::from(count) {
            let entry = directory + 2 + i * ENTRY_BYTES;
            let tag = u16_at(file, entry, is_big)?;
            if let Some(at) = [PHOTOMETRIC, BITS, COLOURS].iter().position(|own| *own == tag) {
                places[at] = Some(entry);
            }
        }
        if let [Some(photometric), Some(bits), Some(colours)] = places
            && u16_at(file, photometric + 8, is_big) == Some(IS_PALETTE)
            && u16_at(file, bits + 8, is_big) == Some(8)
        {
            let own = palette(file, colours, is_big)?;
            found.get_or_insert(own);
            let grey = if is_big { BLACK_IS_0.to_be_bytes() } else { BLACK_IS_0.to_le_bytes() };
            file.get_mut(photometric + 8..)?.get_mut(..2)?.copy_from_slice(&grey);
        }
        let next = directory + 2 + usize::from(count) * ENTRY_BYTES;
        match u32_at(file, next, is_big) {
            Some(0) | None => break,
            Some(next) => directory = next as usize,
        }
    }
    let is_grey = |all: &[[u8; 3]; 256]| (0..256).all(|i| all[i] == [i as u8; 3]);
    found.filter(|all| !is_grey(all))
}

/// Reads a palette, stored as all reds, then all greens and blues, of 16 bits each. Keeps the high bytes.
fn palette(file: &[u8], entry: usize, is_big: bool) -> Option<[[u8; 3]; 256]> {
    if u32_at(file, entry + 4, is_big)? != 3 * 256 {
        return None;
    }
    let begin = u32_at(file, entry + 8, is_big)? as usize;
    let mut colours = [[0; 3]; 256];
    for (channel, i) in (0..3).flat_map(|channel| (0..256).map(move |i| (channel, i))) {
        let level = u16_at(file, begin + 2 * (channel * 256 + i), is_big)?;
        colours[i][channel] = (level >> 8) as u8;
    }
    Some(colours)
}

fn u16_at(file: &[u8], at: usize, is_big: bool) -> Option<u16> {
    let bytes = *file.get(at..)?.first_chunk()?;
    Some(if is_big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
}

fn u32_at(file: &[u8], at: usize, is_big: bool) -> Option<u32> {
    let bytes = *file.get(at..)?.first_chunk()?;
    Some(if is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
}
