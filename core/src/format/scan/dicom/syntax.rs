//! Transfer syntaxes: the encodings of DICOM files and the packing of their pixels (PS3.5 chapter 10).

use crate::format::FormatError;

/// A supported transfer syntax.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Syntax {
    ImplicitLittle,
    ExplicitLittle,
    ExplicitBig,
    Deflated,
    /// Not packed, but in fragments.
    Encapsulated,
    /// 8 bits with loss, or lossless.
    Jpeg,
    Jpeg2000,
    Rle,
}

/// Names of the unsupported ones, by the continuation of their identifiers after [`ROOT`].
const OTHERS: [(&str, &str); 10] = [
    ("4.80", "JPEG-LS"),
    ("4.81", "JPEG-LS"),
    ("4.92", "JPEG 2000 of several components"),
    ("4.93", "JPEG 2000 of several components"),
    ("4.201", "High-Throughput JPEG 2000"),
    ("4.202", "High-Throughput JPEG 2000"),
    ("4.203", "High-Throughput JPEG 2000"),
    ("4.110", "JPEG XL"),
    ("4.111", "JPEG XL"),
    ("4.112", "JPEG XL"),
];
/// The prefix of the identifiers of the standard.
const ROOT: &str = "1.2.840.10008.1.2.";
/// Greatest length of an unknown identifier that is shown.
const SHOWN: usize = 64;

impl Syntax {
    /// Returns the syntax of an identifier. An error names an unsupported one.
    pub fn of(uid: &str) -> Result<Syntax, FormatError> {
        if uid == ROOT.trim_end_matches('.') {
            return Ok(Syntax::ImplicitLittle);
        }
        let own = uid.strip_prefix(ROOT).unwrap_or_default();
        Ok(match own {
            "1" => Syntax::ExplicitLittle,
            "2" => Syntax::ExplicitBig,
            "1.98" => Syntax::Encapsulated,
            "1.99" => Syntax::Deflated,
            "4.50" | "4.51" | "4.57" | "4.70" => Syntax::Jpeg,
            "4.90" | "4.91" => Syntax::Jpeg2000,
            "5" => Syntax::Rle,
            _ => {
                let known = OTHERS.iter().find(|(uid, _)| *uid == own).map(|(_, name)| *name);
                let name = match known {
                    Some(name) => name,
                    None if own.starts_with("4.10") => "an MPEG video",
                    None if uid.is_empty() => "a transfer syntax that it does not name",
                    None => "an unknown transfer syntax",
                };
                let shown: String = uid.chars().take(SHOWN).collect();
                return Err(FormatError::Scan(format!(
                    "its pixels are packed as {name} ({}), which is not read; unpack it first, such as with \
                     `gdcmconv --raw` or dcmtk",
                    shown.escape_debug()
                )));
            }
        })
    }

    pub fn is_big(self) -> bool {
        self == Syntax::ExplicitBig
    }

    pub(crate) fn is_explicit(self) -> bool {
        self != Syntax::ImplicitLittle
    }

    pub(crate) fn is_deflated(self) -> bool {
        self == Syntax::Deflated
    }

    /// Returns the display name of the packing of the pixels.
    pub fn packing(self) -> &'static str {
        match self {
            Syntax::Jpeg => ", packed as JPEG",
            Syntax::Jpeg2000 => ", packed as JPEG 2000",
            Syntax::Rle => ", packed as RLE",
            Syntax::Deflated => ", deflated",
            _ => "",
        }
    }
}
