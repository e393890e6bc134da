//! Tests the integer conversion against a floating-point one that reads each pixel separately.

use proptest::prelude::*;

use super::colour::{Colour, Matrix, Range};
use super::yuv::{LineBuffers, YuvLayout, YuvPicture, to_rgba};

const COLOURS: [Colour; 4] = [
    Colour { matrix: Matrix::Bt601, range: Range::Limited },
    Colour { matrix: Matrix::Bt601, range: Range::Full },
    Colour { matrix: Matrix::Bt709, range: Range::Limited },
    Colour { matrix: Matrix::Bt709, range: Range::Full },
];

const LAYOUTS: [YuvLayout; 8] = [
    YuvLayout::Yuyv,
    YuvLayout::Uyvy,
    YuvLayout::Nv12,
    YuvLayout::Planar { across: 1, down: 1 },
    YuvLayout::Planar { across: 1, down: 0 },
    YuvLayout::Planar { across: 0, down: 0 },
    YuvLayout::Planar { across: 2, down: 0 },
    YuvLayout::Grey,
];

/// Returns the colour by the published factors: Cr to red, Cb to green, Cr to green, Cb to blue (ITU-R BT.601-7,
/// BT.709-6).
fn reference_rgb(colour: Colour, [y, cb, cr]: [u8; 3]) -> [f64; 3] {
    let (y, cb, cr) = (f64::from(y), f64::from(cb) - 128.0, f64::from(cr) - 128.0);
    let (y, [rv, gu, gv, bu]) = match (colour.matrix, colour.range) {
        (Matrix::Bt601, Range::Limited) => {
            (1.164384 * (y - 16.0), [1.596027, -0.391762, -0.812968, 2.017232])
        }
        (Matrix::Bt601, Range::Full) => (y, [1.402, -0.344136, -0.714136, 1.772]),
        (Matrix::Bt709, Range::Limited) => {
            (1.164384 * (y - 16.0), [1.792741, -0.213249, -0.532909, 2.112402])
        }
        (Matrix::Bt709, Range::Full) => (y, [1.5748, -0.187324, -0.468124, 1.8556]),
    };
    [y + rv * cr, y + gu * cb + gv * cr, y + bu * cb].map(|v| v.clamp(0.0, 255.0))
}

/// Returns luma, Cb and Cr of one pixel, by the definitions of the formats.
fn sample(planes: YuvPicture, x: usize, y: usize) -> [u8; 3] {
    let YuvPicture { layout, height, stride, data, .. } = planes;
    let at = |i: usize| data[i];
    let luma = stride * height;
    match layout {
        YuvLayout::Yuyv => {
            let quad = y * stride + x / 2 * 4;
            [at(quad + x % 2 * 2), at(quad + 1), at(quad + 3)]
        }
        YuvLayout::Uyvy => {
            let quad = y * stride + x / 2 * 4;
            [at(quad + 1 + x % 2 * 2), at(quad), at(quad + 2)]
        }
        YuvLayout::Nv12 => {
            let pair = luma + y / 2 * stride + x / 2 * 2;
            [at(y * stride + x), at(pair), at(pair + 1)]
        }
        YuvLayout::Planar { across, down } => {
            let (across, down) = (1 << across, 1 << down);
            let (w, h) = (stride.div_ceil(across), height.div_ceil(down));
            let place = luma + y / down * w + x / across;
            [at(y * stride + x), at(place), at(place + w * h)]
        }
        YuvLayout::Grey => [at(y * stride + x), 128, 128],
    }
}

#[test]
fn colours_known_by_name() {
    // The bars of 75 % in BT.601, as V4L2's test drivers and broadcast equipment give them.
    let bars = [
        ([180, 128, 128], [191, 191, 191]),
        ([162, 44, 142], [191, 191, 0]),
        ([131, 156, 44], [0, 191, 191]),
        ([112, 72, 58], [0, 191, 0]),
        ([84, 184, 198], [191, 0, 191]),
        ([65, 100, 212], [191, 0, 0]),
        ([35, 212, 114], [0, 0, 191]),
        ([16, 128, 128], [0, 0, 0]),
        ([235, 128, 128], [255, 255, 255]),
    ];
    for ([y, cb, cr], rgb) in bars {
        let mut out = [0; 8];
        let planes = YuvPicture {
            layout: YuvLayout::Yuyv,
            width: 2,
            height: 1,
            stride: 4,
            data: &[y, cb, y, cr],
        };
        to_rgba(planes, Colour::DEFAULT, &mut LineBuffers::default(), &mut out).unwrap();
        for channel in 0..3 {
            assert!(out[channel].abs_diff(rgb[channel]) <= 1, "{y} {cb} {cr}: {out:?}");
        }
        assert_eq!((out[3], &out[..4]), (255, &out[4..]));
    }
}

#[test]
fn every_colour_is_within_one_step() {
    // All of Cb and Cr over lumas with a stride of every residue.
    let mut lines = LineBuffers::default();
    let mut out = vec![0; 256 * 4];
    for colour in COLOURS {
        let (mut off, mut all) = (0_u64, 0_u64);
        for luma in (0..=255_u8).step_by(5) {
            for cb in 0..=255_u8 {
                let mut data = vec![luma; 256];
                data.extend([cb; 256]);
                data.extend(0..=255_u8);
                let layout = YuvLayout::Planar { across: 0, down: 0 };
                let planes = YuvPicture { layout, width: 256, height: 1, stride: 256, data: &data };
                to_rgba(planes, colour, &mut lines, &mut out).unwrap();
                for (cr, pixel) in out.as_chunks::<4>().0.iter().enumerate() {
                    let exact = reference_rgb(colour, [luma, cb, cr as u8]);
                    for (got, exact) in pixel.iter().zip(exact) {
                        let error = (f64::from(*got) - exact).abs();
                        assert!(error < 0.6, "{colour:?} {luma} {cb} {cr}: {got} {exact}");
                        off += u64::from(f64::from(*got) != exact.round());
                        all += 1;
                    }
                }
            }
        }
        // Rounded differently only if the exact value is next to the middle of two steps.
        assert!(off * 50 < all, "{colour:?}: {off} of {all}");
    }
}

proptest! {
    #[test]
    fn every_layout_agrees_with_the_reference(
        width in 1usize..70, height in 1usize..6, slack in 0usize..5, seed: u64,
        colour in prop::sample::select(&COLOURS[..]),
    ) {
        let mut lines = LineBuffers::default();
        for layout in LAYOUTS {
            let stride = (layout.least_stride(width) + slack).next_multiple_of(
                if layout == YuvLayout::Nv12 { 2 } else { 1 },
            );
            let len = layout.byte_len(height, stride).unwrap();
            let mut state = seed | 1;
            let data: Vec<u8> = (0..len)
                .map(|_| {
                    state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    (state >> 56) as u8
                })
                .collect();
            let planes = YuvPicture { layout, width, height, stride, data: &data };
            let mut out = vec![7; width * height * 4 + 3];
            to_rgba(planes, colour, &mut lines, &mut out).unwrap();
            for y in 0..height {
                for x in 0..width {
                    let exact = reference_rgb(colour, sample(planes, x, y));
                    let got = &out[(y * width + x) * 4..][..4];
                    for channel in 0..3 {
                        prop_assert!(
                            (f64::from(got[channel]) - exact[channel]).abs() < 0.6,
                            "{layout:?} at {x} {y}: {got:?} {exact:?}"
                        );
                    }
                    prop_assert_eq!(got[3], 255);
                }
            }
            prop_assert_eq!(&out[width * height * 4..], &[7; 3]);
            // Too short by one byte, in each of the three ways.
            let short = YuvPicture { data: &data[..len - 1], ..planes };
            prop_assert!(to_rgba(short, colour, &mut lines, &mut out).is_err());
            let narrow = YuvPicture { stride: layout.least_stride(width) - 1, ..planes };
            prop_assert!(to_rgba(narrow, colour, &mut lines, &mut out).is_err());
            let room = &mut out[..width * height * 4 - 1];
            prop_assert!(to_rgba(planes, colour, &mut lines, room).is_err());
        }
    }
}
