//! The signature of files written by this program: a line in the parameter text of a PVM3 volume that describes the
//! sculpture.
//!
//! It is trusted only as far as the volume agrees with it, since anyone can write a text.

use super::options::ExportForm;
use super::volume::{Samples, Texts};
use crate::sculpture::{ColourDepth, Rgb};

const WORD: &str = "virtual-sculpture";
const VERSION: &str = "1";

/// Properties of a sculpture that the voxels of a volume do not show.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Signature {
    /// The meaning of the voxels. Not [`ExportForm::Auto`].
    pub form: ExportForm,
    /// Bits of colour per voxel.
    pub colour_depth: ColourDepth,
    /// Colour of unpainted voxels.
    pub base: Rgb,
}

impl Signature {
    /// Puts the line into the texts and removes any other such line.
    pub fn put(&self, texts: &mut Texts) {
        let line = format!(
            "{WORD} {VERSION} form={} colour_bits={} base={}",
            self.form,
            self.colour_depth.bits(),
            self.base
        );
        let mut lines: Vec<&[u8]> =
            texts.parameter.split(|&b| b == b'\n').filter(|l| !is_signature(l)).collect();
        // An empty text is one empty line; it must not grow with every save.
        lines.retain(|l| !l.is_empty());
        lines.insert(0, line.as_bytes());
        texts.parameter = lines.join(&b'\n');
    }

    /// Returns the signature in the texts of a volume of `samples`, if there is one; an error states why it is not
    /// trusted.
    pub fn find(texts: &Texts, samples: Samples) -> Option<Result<Signature, &'static str>> {
        let line = texts.parameter.split(|&b| b == b'\n').find(|l| is_signature(l))?;
        Some(std::str::from_utf8(line).map_err(|_| "it is not text").and_then(|line| {
            let signature = Signature::parse(line)?;
            signature.check(samples)?;
            Ok(signature)
        }))
    }

    fn parse(line: &str) -> Result<Signature, &'static str> {
        let mut words = line.split_ascii_whitespace().skip(1);
        if words.next() != Some(VERSION) {
            return Err("it is of another version");
        }
        let (mut form, mut depth, mut base) = (None, None, None);
        for word in words {
            match word.split_once('=') {
                Some(("form", value)) => form = value.parse().ok(),
                Some(("colour_bits", value)) => {
                    depth = value.parse().ok().and_then(ColourDepth::from_bits);
                }
                Some(("base", value)) => base = value.parse().ok(),
                _ => return Err("it has an unknown word"),
            }
        }
        match (form, depth, base) {
            (Some(form), Some(colour_depth), Some(base)) => {
                Ok(Signature { form, colour_depth, base })
            }
            _ => Err("it is incomplete"),
        }
    }

    fn check(&self, samples: Samples) -> Result<(), &'static str> {
        let fits = match self.form {
            ExportForm::Auto => false,
            ExportForm::Densities => {
                samples == Samples::U8 && self.colour_depth == ColourDepth::None
            }
            ExportForm::Rgba => samples == Samples::Rgba8,

            ExportForm::Packed => samples.bytes() as usize == self.colour_depth.bytes(),
        };
        if fits { Ok(()) } else { Err("it does not fit the voxels") }
    }
}

fn is_signature(line: &[u8]) -> bool {
    line.strip_prefix(WORD.as_bytes()).is_some_and(|rest| rest.is_empty() || rest[0] == b' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIGNATURE: Signature = Signature {
        form: ExportForm::Rgba,
        colour_depth: ColourDepth::Bits16,
        base: Rgb::new(0xc8, 0xbe, 0xaa),
    };

    #[test]
    fn it_is_found_beside_other_parameters_and_stays_one_line() {
        let mut texts = Texts { parameter: b"kV=120\nmA=80".to_vec(), ..Texts::default() };
        SIGNATURE.put(&mut texts);
        SIGNATURE.put(&mut texts);
        assert_eq!(
            String::from_utf8_lossy(&texts.parameter),
            "virtual-sculpture 1 form=rgba colour_bits=16 base=#c8beaa\nkV=120\nmA=80"
        );
        assert_eq!(Signature::find(&texts, Samples::Rgba8), Some(Ok(SIGNATURE)));
        let mut texts = Texts::default();
        assert_eq!(Signature::find(&texts, Samples::Rgba8), None);
        SIGNATURE.put(&mut texts);
        assert!(!texts.parameter.contains(&b'\n'));
    }

    #[test]
    fn it_is_not_trusted_against_the_voxels() {
        let mut texts = Texts::default();
        SIGNATURE.put(&mut texts);
        assert!(matches!(Signature::find(&texts, Samples::U8), Some(Err(_))));
        for line in [
            "virtual-sculpture",
            "virtual-sculpture 2 form=rgba colour_bits=16 base=#c8beaa",
            "virtual-sculpture 1 form=rgba colour_bits=12 base=#c8beaa",
            "virtual-sculpture 1 form=packed colour_bits=0 base=#c8beaa",
            "virtual-sculpture 1 form=auto colour_bits=16 base=#c8beaa",
            "virtual-sculpture 1 form=rgba colour_bits=16",
            "virtual-sculpture 1 form=rgba colour_bits=16 base=#c8beaa more",
        ] {
            let texts = Texts { parameter: line.into(), ..Texts::default() };
            assert!(matches!(Signature::find(&texts, Samples::Rgba8), Some(Err(_))), "{line}");
        }
    }
}
