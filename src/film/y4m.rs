//! Raw video, YUV4MPEG2 as ffmpeg and mjpegtools read it: the header and the planes of a frame. Pure.
//!
//! 4:4:4, so that odd sizes need no rule and colours lose nothing, in the default matrix (BT.601) and range (limited)
//! of readers. Uses integers only: the bytes are the same on every machine.

use glam::UVec2;
use image::RgbImage;

/// Precedes each frame.
pub const FRAME: &[u8] = b"FRAME\n";

/// Number of fractional bits of the factors below.
const SHIFT: u32 = 16;
/// Luma, Cb and Cr of red, green and blue, times 2^[`SHIFT`]. Those of Cb and Cr add up to 0: grey stays grey.
const FACTORS: [[i32; 3]; 3] =
    [[16829, 33039, 6416], [-9714, -19071, 28785], [28785, -24104, -4681]];
const OFFSETS: [i32; 3] = [16, 128, 128];

pub fn header(size: UVec2, fps: u16) -> String {
    let UVec2 { x, y } = size;
    format!("YUV4MPEG2 W{x} H{y} F{fps}:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n")
}

/// Fills `planes` with those of a picture: Y', Cb, Cr.
pub fn write_planes(picture: &RgbImage, planes: &mut Vec<u8>) {
    planes.clear();
    for (factors, offset) in FACTORS.iter().zip(OFFSETS) {
        let start = (offset << SHIFT) + (1 << (SHIFT - 1));
        planes.extend(picture.pixels().map(|pixel| {
            let sum: i32 = factors.iter().zip(pixel.0).map(|(f, c)| f * i32::from(c)).sum();
            ((start + sum) >> SHIFT) as u8
        }));
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    #[test]
    fn the_header_says_what_follows() {
        let header = header(UVec2::new(321, 201), 24);
        assert_eq!(header, "YUV4MPEG2 W321 H201 F24:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n");
    }

    #[test]
    fn known_colours_have_the_values_of_the_recommendation() {
        // From ITU-R BT.601, rounded.
        for (rgb, expected) in [
            ([0, 0, 0], [16, 128, 128]),
            ([255, 255, 255], [235, 128, 128]),
            ([128, 128, 128], [126, 128, 128]),
            ([255, 0, 0], [81, 90, 240]),
            ([0, 255, 0], [145, 54, 34]),
            ([0, 0, 255], [41, 240, 110]),
        ] {
            let mut planes = vec![9];
            write_planes(&RgbImage::from_pixel(1, 1, Rgb(rgb)), &mut planes);
            assert_eq!(planes, expected, "{rgb:?}");
        }
    }

    #[test]
    fn planes_follow_one_another() {
        let mut picture = RgbImage::from_pixel(3, 1, Rgb([0; 3]));
        picture.put_pixel(2, 0, Rgb([255, 0, 0]));
        let mut planes = Vec::new();
        write_planes(&picture, &mut planes);
        assert_eq!(planes, [16, 16, 81, 128, 128, 90, 128, 128, 240]);
    }
}
