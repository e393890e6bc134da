//! Reads the output of the voxeliser binvox: a header of lines, then runs of equal voxels, without colours.

use glam::I64Vec3;

use super::model::{Model, ModelReader, Sink};
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::error::excerpt;
use crate::format::spec::{FormatSpec, Import, Sign};
use crate::sculpture::Rgb;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::Up;

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, MAGIC)],
    ..FormatSpec::new(
        "voxels of binvox",
        &["binvox"],
        Import::Model(ModelReader {
            read: |file| Ok(Box::new(read(file)?)),
            surface: SurfaceKind::Smooth,
        }),
    )
};

const MAGIC: &[u8] = b"#binvox";
/// Greatest number of header lines.
const MOST_LINES: usize = 64;

/// A file: y fastest, then z, then x.
#[derive(Debug)]
struct Binvox<'a> {
    size: I64Vec3,
    runs: Bytes<'a>,
}

/// Reads the header.
fn read(file: &[u8]) -> Result<Binvox<'_>, FormatError> {
    let mut bytes = Bytes::new(file);
    let mut size = None;
    if !file.starts_with(MAGIC) {
        return Err(bytes.fault(format!("the file begins with `{}`, not #binvox", excerpt(file))));
    }
    for _ in 0..MOST_LINES {
        let start = bytes;
        let length = bytes.rest().iter().position(|&b| b == b'\n');
        let line = bytes.take(length.ok_or_else(|| start.fault("the header has no end"))? + 1)?;
        let line = line.trim_ascii();
        if let Some(numbers) = line.strip_prefix(b"dim ") {
            // The lengths along x, z and y.
            let mut numbers = numbers
                .split(|b| *b == b' ')
                .map(|number| std::str::from_utf8(number).ok()?.parse().ok().filter(|n| *n > 0));
            let mut next = || numbers.next().flatten().filter(|n| *n <= i64::from(MAX_AXIS_VX));
            let parsed = (|| Some(I64Vec3 { x: next()?, z: next()?, y: next()? }))();
            let rule = format!("the size must be three numbers of 1 to {MAX_AXIS_VX}");
            size = Some(parsed.ok_or_else(|| start.fault(rule))?);
        }
        if line == b"data" {
            let size = size.ok_or_else(|| start.fault("the header has no line dim"))?;
            return Ok(Binvox { size, runs: bytes });
        }
    }
    Err(bytes.fault("the header has no line data"))
}

impl Model for Binvox<'_> {
    fn kind(&self) -> String {
        "binvox".to_string()
    }

    fn up(&self) -> Up {
        Up::Y
    }

    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)> {
        Some((I64Vec3::ZERO, self.size))
    }

    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError> {
        let I64Vec3 { x: width, y: height, z: depth } = self.size;
        let (mut at, end) = (0, width * height * depth);
        let mut runs = self.runs;
        while at < end {
            let start = runs;
            let (exists, count) = (runs.u8()? != 0, i64::from(runs.u8()?));
            if at + count > end {
                return Err(start.fault("a run of voxels goes beyond the last one"));
            }
            if exists {
                for i in at..at + count {
                    let (x, z, y) = (i / (height * depth), i / height % depth, i % height);
                    sink(I64Vec3::new(x, y, z), Rgb::STONE)?;
                }
            }
            at += count;
        }
        Ok(())
    }
}
