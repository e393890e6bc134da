//! The choices of the last import of each family of files, stored as the command of such an import.
//!
//! Not kept here: thresholds, channel, time and region, which belong to one file, and the up axis, which belongs to a
//! file extension.

use std::collections::BTreeMap;

use crate::command::Command;
use crate::format::Family;
use crate::format::options::{Existence, ImportOptions};

/// The last choices.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Remembered {
    by_family: BTreeMap<Family, ImportOptions>,
    /// The layout of the last raw file, as its text.
    pub raw: String,
}

impl Remembered {
    /// Keeps the choices that hold for other files of the family, too.
    pub fn note(&mut self, family: Family, import: &ImportOptions) {
        let kept = ImportOptions {
            existence: Existence::Auto,
            region: None,
            channel: None,
            time: None,
            raw: None,
            upright: None,
            ..*import
        };
        self.by_family.insert(family, kept);
    }

    /// Returns `import`, or the last choices if `import` states no more than the up axis and a raw layout.
    pub fn applied(&self, family: Family, import: ImportOptions) -> ImportOptions {
        let ImportOptions { upright, raw, .. } = import;
        let is_open = import == ImportOptions { upright, raw, ..ImportOptions::default() };
        match self.by_family.get(&family).filter(|_| is_open) {
            Some(kept) => ImportOptions { upright, raw, ..*kept },
            None => import,
        }
    }

    /// Returns lines that name the families instead of files.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        let name = |family| {
            Family::NAMED.iter().find(|(one, _)| *one == family).map_or("", |(_, name)| name)
        };
        self.by_family.iter().map(move |(family, import)| {
            Command::Open { path: name(*family).into(), import: *import }.to_string()
        })
    }

    /// Reads such lines; skips others.
    pub fn from_lines<'a>(lines: impl Iterator<Item = &'a str>) -> Remembered {
        let mut remembered = Remembered::default();
        for line in lines {
            let Ok(Command::Open { path, import }) = line.parse() else { continue };
            let family = Family::NAMED.iter().find(|(_, name)| path.as_os_str() == *name);
            if let Some((family, _)) = family {
                remembered.note(*family, &import);
            }
        }
        remembered
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::options::{Colouring, Cubic, MeshSize};
    use crate::sculpture::orientation::Up;

    #[test]
    fn only_choices_that_hold_for_other_files_are_kept() {
        let mut remembered = Remembered::default();
        let import = "open \"a.nii\" threshold=3..9 colouring=tissue upright=z cubic=0.5mm \
                      region=0,0,0..3,3,3 channel=2 time=3 pieces=largest holes=filled";
        let Ok(Command::Open { import, .. }) = import.parse() else { panic!("{import}") };
        remembered.note(Family::Volume, &import);
        let fresh = ImportOptions { upright: Some(Up::X), ..ImportOptions::default() };
        let next = remembered.applied(Family::Volume, fresh);
        assert_eq!((next.existence, next.region), (Existence::Auto, None));
        assert_eq!((next.channel, next.time), (None, None));
        assert_eq!((next.upright, next.cubic), (Some(Up::X), Cubic::EdgeMm(0.5)));
        assert!(next.largest_piece && next.fill_holes && next.colouring == Colouring::Tissue);
        assert_eq!(remembered.applied(Family::Mesh, fresh), fresh, "another family");
        // Known facts about a file take precedence.
        let known = ImportOptions { existence: Existence::Threshold(2.0), ..fresh };
        assert_eq!(remembered.applied(Family::Volume, known), known);

        let size = MeshSize::VoxelMm(0.25);
        remembered.note(Family::Mesh, &ImportOptions { mesh_size: size, ..fresh });
        let lines: Vec<String> = remembered.lines().collect();
        let again = Remembered::from_lines(lines.iter().map(String::as_str));
        assert_eq!(again, remembered);
        let damaged = ["", "clear", "open \"other\"", "open"];
        assert_eq!(Remembered::from_lines(damaged.into_iter()), Remembered::default());
    }
}
