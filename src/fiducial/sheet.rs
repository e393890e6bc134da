//! Printable markers: a drawing of one at true size, as SVG or PNG.

use std::io::Cursor;

use super::family::{self, CELLS};

/// Width of the white paper around the marker, in cells.
const PAPER_CELLS: usize = 1;
/// Pixels per cell of a PNG.
const CELL_PX: u32 = 64;

/// Returns the side of the whole drawing, paper included, for a marker with a rim `size_mm` wide.
pub fn side_mm(size_mm: f64) -> f64 {
    size_mm * (CELLS + 2 * PAPER_CELLS) as f64 / CELLS as f64
}

/// Returns a drawing of marker `id` whose black rim is `size_mm` wide; `None` for an unknown number.
pub fn svg(id: u32, size_mm: f64) -> Option<String> {
    family::is_white(id, 0, 0)?;
    let cell = size_mm / CELLS as f64;
    let (side, edge) = (side_mm(size_mm), cell * PAPER_CELLS as f64);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{side}mm\" height=\"{side}mm\" \
         viewBox=\"0 0 {side} {side}\" shape-rendering=\"crispEdges\">\n\
         <title>tag36h11 {id}, black square {size_mm} mm</title>\n\
         <rect width=\"{side}\" height=\"{side}\" fill=\"white\"/>\n\
         <rect x=\"{edge}\" y=\"{edge}\" width=\"{size_mm}\" height=\"{size_mm}\"/>\n"
    );
    for y in 0..CELLS {
        for x in 0..CELLS {
            if family::is_white(id, x, y) == Some(true) {
                let (left, top) = (edge + cell * x as f64, edge + cell * y as f64);
                out += &format!(
                    "<rect x=\"{left}\" y=\"{top}\" width=\"{cell}\" height=\"{cell}\" fill=\"white\"/>\n"
                );
            }
        }
    }
    out += "</svg>\n";
    Some(out)
}

/// Returns that drawing as a PNG with its print size; `None` for an unknown number.
pub fn png(id: u32, size_mm: f64) -> Option<Vec<u8>> {
    family::is_white(id, 0, 0)?;
    let side = (CELLS + 2 * PAPER_CELLS) as u32 * CELL_PX;
    let picture = image::GrayImage::from_fn(side, side, |x, y| {
        let cell = |v: u32| ((v / CELL_PX) as usize).wrapping_sub(PAPER_CELLS);
        // Outside the marker is paper.
        let white = family::is_white(id, cell(x), cell(y)).unwrap_or(true);
        image::Luma([if white { 255 } else { 0 }])
    });
    let mut plain = Cursor::new(Vec::new());
    picture.write_to(&mut plain, image::ImageFormat::Png).ok()?;
    let px_per_m = f64::from(CELL_PX) * CELLS as f64 / (size_mm * 1e-3);
    with_resolution(&plain.into_inner(), px_per_m.round() as u32)
}

/// Inserts a pHYs chunk behind the header of a PNG (PNG specification, third edition, 11.3.4.3).
fn with_resolution(png: &[u8], px_per_m: u32) -> Option<Vec<u8>> {
    // Signature, then IHDR: length, name, 13 bytes, checksum.
    const HEADER_BYTES: usize = 8 + 4 + 4 + 13 + 4;
    let (header, rest) = png.split_at_checked(HEADER_BYTES)?;
    let mut chunk = b"pHYs".to_vec();
    chunk.extend(px_per_m.to_be_bytes());
    chunk.extend(px_per_m.to_be_bytes());
    chunk.push(1);
    let mut out = header.to_vec();
    out.extend((chunk.len() as u32 - 4).to_be_bytes());
    out.extend(&chunk);
    out.extend(crc32(&chunk).to_be_bytes());
    out.extend(rest);
    Some(out)
}

/// Returns the checksum of PNG chunks (PNG specification, third edition, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    let turn = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 }
        })
    };
    !bytes.iter().fold(u32::MAX, turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_says_its_size_and_shows_the_marker() {
        let bytes = png(3, 80.0).unwrap();
        let at = bytes.windows(4).position(|w| w == b"pHYs").unwrap();
        let px_per_m = u32::from_be_bytes(bytes[at + 4..at + 8].try_into().unwrap());
        let picture = image::load_from_memory(&bytes).unwrap().to_luma8();
        let width_mm = f64::from(picture.width()) / f64::from(px_per_m) * 1e3;
        assert!((width_mm - 100.0).abs() < 0.05, "{width_mm}");
        for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
            let pixel = picture.get_pixel((x + 1) * CELL_PX + 30, (y + 1) * CELL_PX + 30).0[0];
            assert_eq!(Some(pixel == 255), family::is_white(3, x as usize, y as usize));
        }
        assert_eq!(picture.get_pixel(5, 300).0[0], 255, "paper");
        // From the specification: the checksum of an empty IEND.
        assert_eq!(crc32(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn an_svg_has_a_rectangle_for_every_white_cell() {
        let text = svg(0, 80.0).unwrap();
        assert!(text.contains("width=\"100mm\""));
        let white = (0..64).filter(|i| family::is_white(0, i % 8, i / 8) == Some(true)).count();
        assert_eq!(text.matches("<rect").count(), white + 2);
        assert_eq!((svg(family::COUNT, 80.0), png(family::COUNT, 80.0)), (None, None));
    }
}
