//! The meaning of Y'CbCr values: matrix and range.

/// The conversion matrix.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Matrix {
    /// ITU-R BT.601: cameras, JPEG, films up to 576 lines.
    Bt601,
    /// ITU-R BT.709: films in HD.
    Bt709,
}

/// The range of values.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Range {
    /// Limited: luma 16 to 235, chroma 16 to 240.
    Limited,
    /// Full: 0 to 255.
    Full,
}

/// The decoding of Y'CbCr.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Colour {
    pub matrix: Matrix,
    pub range: Range,
}

impl Colour {
    /// The default of cameras and films.
    pub const DEFAULT: Colour = Colour { matrix: Matrix::Bt601, range: Range::Limited };

    /// Returns the factors of luma, Cr to red, Cb to green, Cr to green, Cb to blue, and the luma of black.
    pub fn factors(self) -> ([f64; 5], f64) {
        // Weights of red and blue in luma, from the two recommendations.
        let (red, blue): (f64, f64) = match self.matrix {
            Matrix::Bt601 => (0.299, 0.114),
            Matrix::Bt709 => (0.2126, 0.0722),
        };
        let (luma, chroma, black) = match self.range {
            Range::Limited => (255.0 / 219.0, 255.0 / 224.0, 16.0),
            Range::Full => (1.0, 1.0, 0.0),
        };
        let green = 1.0 - red - blue;
        let (r_cr, b_cb) = (2.0 * (1.0 - red) * chroma, 2.0 * (1.0 - blue) * chroma);
        ([luma, r_cr, -b_cb * blue / green, -r_cr * red / green, b_cb], black)
    }
}

/// The user's choice for sources that do not describe their colours.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ColourChoice {
    pub matrix: Option<Matrix>,
    pub range: Option<Range>,
}

impl ColourChoice {
    /// Returns the choice if there is one, otherwise `said`.
    pub fn over(self, said: Colour) -> Colour {
        Colour {
            matrix: self.matrix.unwrap_or(said.matrix),
            range: self.range.unwrap_or(said.range),
        }
    }
}
