//! The layout of the pictures of two eyes on one screen, pixel by pixel: the CPU twin of `shaders/stereo.frag.wgsl`,
//! and the inverse, from a pixel of the screen to the picture shown there.
//!
//! Every layout shows both pictures entirely; each has the size of the screen. Knows no Vulkan and no cameras.

use std::str::FromStr;

use glam::{UVec2, Vec2};
use serde::Deserialize;

/// The layout of two pictures on one screen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StereoLayout {
    /// One picture for both eyes
    #[default]
    Mono,
    /// One layer per eye of a quad-buffered window
    Layers,
    /// Left and right half, each squeezed, as 3D televisions expect
    SideBySide,
    /// Upper and lower half, each squeezed
    TopBottom,
    /// Even rows for the left eye, odd rows for the right one
    Rows,
    /// Even columns for the left eye, odd columns for the right one
    Columns,
    /// Red for the left eye, green and blue for the right one
    Anaglyph,
}

impl StereoLayout {
    /// All layouts, in the order in which interfaces offer them.
    pub const ALL: [StereoLayout; 7] = [
        StereoLayout::Mono,
        StereoLayout::Layers,
        StereoLayout::SideBySide,
        StereoLayout::TopBottom,
        StereoLayout::Rows,
        StereoLayout::Columns,
        StereoLayout::Anaglyph,
    ];

    /// Returns its name in the interface.
    pub fn label(self) -> &'static str {
        match self {
            StereoLayout::Mono => "Mono",
            StereoLayout::Layers => "Quad-buffered",
            StereoLayout::SideBySide => "Side by side",
            StereoLayout::TopBottom => "Top and bottom",
            StereoLayout::Rows => "Rows",
            StereoLayout::Columns => "Columns",
            StereoLayout::Anaglyph => "Anaglyph",
        }
    }

    /// Returns its name in text, as it is stored.
    pub const fn name(self) -> &'static str {
        match self {
            StereoLayout::Mono => "mono",
            StereoLayout::Layers => "layers",
            StereoLayout::SideBySide => "side-by-side",
            StereoLayout::TopBottom => "top-bottom",
            StereoLayout::Rows => "rows",
            StereoLayout::Columns => "columns",
            StereoLayout::Anaglyph => "anaglyph",
        }
    }

    /// Returns the number of pictures that it shows.
    pub fn eyes(self) -> usize {
        if self == StereoLayout::Mono { 1 } else { 2 }
    }

    /// Returns the eye whose picture is shown at `at` (pixels of a screen of `size`), and the position in that picture.
    /// Where both eyes see a pixel, the left one counts.
    pub fn unfold(self, at: Vec2, size: UVec2) -> (usize, Vec2) {
        let half = (size / 2).as_vec2();
        match self {
            StereoLayout::SideBySide => {
                let right = at.x >= half.x;
                let x = if right { at.x - half.x } else { at.x };
                (usize::from(right), Vec2::new(2.0 * x, at.y))
            }
            StereoLayout::TopBottom => {
                let right = at.y >= half.y;
                let y = if right { at.y - half.y } else { at.y };
                (usize::from(right), Vec2::new(at.x, 2.0 * y))
            }
            _ => (0, at),
        }
    }

    /// Returns one pixel of a screen of `size`. `picture` returns the pixel of an eye's picture.
    /// [`StereoLayout::Layers`] has two screens, selected by `layer`.
    pub fn pixel(
        self,
        at: UVec2,
        size: UVec2,
        layer: usize,
        picture: impl Fn(usize, UVec2) -> [u8; 3],
    ) -> [u8; 3] {
        let half = size / 2;
        // The mean of the two pixels that are squeezed into one.
        let squeezed = |eye: usize, axis: usize, place: u32| {
            let mut first = at;
            first[axis] = (2 * place).min(size[axis] - 1);
            let mut second = at;
            second[axis] = (2 * place + 1).min(size[axis] - 1);
            let (a, b) = (picture(eye, first), picture(eye, second));
            std::array::from_fn(|i| (u16::from(a[i]) + u16::from(b[i])).div_ceil(2) as u8)
        };
        let halves = |axis: usize| match at[axis].checked_sub(half[axis]) {
            Some(place) => squeezed(1, axis, place),
            None => squeezed(0, axis, at[axis]),
        };
        match self {
            StereoLayout::Mono => picture(0, at),
            StereoLayout::Layers => picture(layer, at),
            StereoLayout::SideBySide => halves(0),
            StereoLayout::TopBottom => halves(1),
            StereoLayout::Rows => picture((at.y % 2) as usize, at),
            StereoLayout::Columns => picture((at.x % 2) as usize, at),
            StereoLayout::Anaglyph => {
                let ([red, ..], [_, green, blue]) = (picture(0, at), picture(1, at));
                [red, green, blue]
            }
        }
    }
}

impl FromStr for StereoLayout {
    type Err = String;

    fn from_str(text: &str) -> Result<StereoLayout, String> {
        StereoLayout::ALL.into_iter().find(|layout| layout.name() == text).ok_or_else(|| {
            let names = StereoLayout::ALL.map(StereoLayout::name).join(", ");
            format!("`{text}` is not a stereo layout; use one of {names}")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: UVec2 = UVec2::new(8, 6);

    /// Returns a picture whose pixels identify their eye and position.
    fn tell(eye: usize, at: UVec2) -> [u8; 3] {
        [100 * eye as u8 + at.x as u8, 100 * eye as u8 + at.y as u8, 10 + eye as u8]
    }

    fn pixel(layout: StereoLayout, x: u32, y: u32) -> [u8; 3] {
        layout.pixel(UVec2::new(x, y), SIZE, 1, tell)
    }

    #[test]
    fn the_name_of_a_layout_is_that_of_its_stored_form() {
        for layout in StereoLayout::ALL {
            let stored = format!("\"{}\"", layout.name());
            assert_eq!(serde_json::from_str::<StereoLayout>(&stored).unwrap(), layout);
            assert_eq!(layout.name().parse(), Ok(layout));
        }
        let error = "3d".parse::<StereoLayout>().unwrap_err();
        assert!(error.contains("`3d`") && error.contains("side-by-side"), "{error}");
    }

    #[test]
    fn every_layout_puts_the_eyes_where_it_says() {
        assert_eq!(pixel(StereoLayout::Mono, 5, 4), [5, 4, 10]);
        assert_eq!(pixel(StereoLayout::Layers, 5, 4), [105, 104, 11]);
        assert_eq!(pixel(StereoLayout::Rows, 5, 4), [5, 4, 10]);
        assert_eq!(pixel(StereoLayout::Rows, 5, 3), [105, 103, 11]);
        assert_eq!(pixel(StereoLayout::Columns, 5, 3), [105, 103, 11]);
        assert_eq!(pixel(StereoLayout::Anaglyph, 5, 3), [5, 103, 11]);
        // Pixels 6 and 7 of the left eye, 2 and 3 of the right one.
        assert_eq!(pixel(StereoLayout::SideBySide, 3, 3), [7, 3, 10]);
        assert_eq!(pixel(StereoLayout::SideBySide, 5, 3), [103, 103, 11]);
        assert_eq!(pixel(StereoLayout::TopBottom, 3, 2), [3, 5, 10]);
        assert_eq!(pixel(StereoLayout::TopBottom, 3, 4), [103, 103, 11]);
    }

    #[test]
    fn the_pointer_is_over_the_pixel_that_is_shown_there() {
        for layout in StereoLayout::ALL {
            for (x, y) in (0..SIZE.x).flat_map(|x| (0..SIZE.y).map(move |y| (x, y))) {
                let (eye, at) = layout.unfold(UVec2::new(x, y).as_vec2() + 0.5, SIZE);
                let shown = layout.pixel(UVec2::new(x, y), SIZE, 0, tell);
                let [px, py, _] = tell(eye, at.as_uvec2());
                // Where two pixels are squeezed into one, `at` lies on the edge between them.
                let near = |a: u8, b: u8| a.abs_diff(b) <= 1;
                let anaglyph = layout == StereoLayout::Anaglyph;
                let interleaved = matches!(layout, StereoLayout::Rows | StereoLayout::Columns);
                if !interleaved {
                    assert!(near(px, shown[0]) && (anaglyph || near(py, shown[1])), "{layout:?}");
                }
            }
        }
    }

    #[test]
    fn odd_sizes_have_no_pixel_outside_a_picture() {
        let size = UVec2::new(7, 5);
        for layout in StereoLayout::ALL {
            for (x, y) in (0..size.x).flat_map(|x| (0..size.y).map(move |y| (x, y))) {
                layout.pixel(UVec2::new(x, y), size, 0, |_, at| {
                    assert!(at.cmplt(size).all());
                    [0; 3]
                });
            }
        }
    }
}
