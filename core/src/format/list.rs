//! The list of all formats, and its derived data: the format of a file name or of the first bytes of a file, the
//! extensions to choose from, and the errors and texts that name them.
//!
//! Takes names and bytes; opens no files except those of a requested folder.

use std::path::Path;

use super::FormatError;
use super::mesh_out::{MeshTraits, MeshWriter};
use super::options::{ExportForm, MeshUp};
use super::spec::{Export, Format, Import};
use super::{mesh_in, pvm, raw, scan, voxel, vsc};
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::Up;

/// All formats, in the order in which texts list them. If a file has signatures of several formats, the first one
/// counts.
static LISTS: [&[Format]; 4] =
    [&[&vsc::SPEC, &pvm::SPEC, &raw::SPEC], scan::FORMATS, voxel::FORMATS, mesh_in::FORMATS];
static FORMATS: [Format; COUNT] = one_list();

const COUNT: usize = {
    let (mut i, mut count) = (0, 0);
    while i < LISTS.len() {
        count += LISTS[i].len();
        i += 1;
    }
    count
};

const fn one_list() -> [Format; COUNT] {
    let mut formats = [LISTS[0][0]; COUNT];
    let (mut i, mut count) = (0, 0);
    while i < LISTS.len() {
        let mut own = 0;
        while own < LISTS[i].len() {
            formats[count] = LISTS[i][own];
            (own, count) = (own + 1, count + 1);
        }
        i += 1;
    }
    formats
}

/// Extensions of the files that can be read.
pub const READ_ENDINGS: [&str; READ_COUNT] = read_endings();
/// Extensions of the files that can be written.
pub const WRITE_ENDINGS: [&str; WRITE_COUNT] = written_endings();

const READ_COUNT: usize = {
    let (mut i, mut count) = (0, 0);
    while i < FORMATS.len() {
        count += FORMATS[i].extensions.len();
        i += 1;
    }
    count
};

const WRITE_COUNT: usize = {
    let (mut i, mut count) = (0, 0);
    while i < FORMATS.len() {
        count += FORMATS[i].write.is_some() as usize;
        i += 1;
    }
    count
};

const fn read_endings() -> [&'static str; READ_COUNT] {
    let mut endings = [""; READ_COUNT];
    let (mut i, mut count) = (0, 0);
    while i < FORMATS.len() {
        let mut own = 0;
        while own < FORMATS[i].extensions.len() {
            endings[count] = FORMATS[i].extensions[own];
            (own, count) = (own + 1, count + 1);
        }
        i += 1;
    }
    endings
}

const fn written_endings() -> [&'static str; WRITE_COUNT] {
    let mut endings = [""; WRITE_COUNT];
    let (mut i, mut count) = (0, 0);
    while i < FORMATS.len() {
        if FORMATS[i].write.is_some() {
            endings[count] = FORMATS[i].extension();
            count += 1;
        }
        i += 1;
    }
    endings
}

/// Returns all formats.
pub fn formats() -> impl DoubleEndedIterator<Item = Format> {
    FORMATS.iter().copied()
}

/// Returns the format of a file by its name.
pub fn named(path: &Path) -> Result<Format, FormatError> {
    let ending = path.extension().ok_or_else(|| FormatError::NoEnding(commas(&READ_ENDINGS)))?;
    formats().find(|format| format.is_named(path)).ok_or_else(|| FormatError::UnknownEnding {
        ending: format!(".{}", ending.to_string_lossy()),
        known: commas(&READ_ENDINGS),
    })
}

/// Returns the format that a file's first bytes identify.
pub(crate) fn identified(start: &[u8], length: u64) -> Option<Format> {
    let signs = formats().flat_map(|format| format.signs.iter().map(move |sign| (format, sign)));
    let found = signs.filter(|(_, sign)| sign.is_in(start, length));
    // The first of those of one rank.
    found.min_by_key(|(_, sign)| sign.rank()).map(|(format, _)| format)
}

/// Returns the format of the files in a folder that are opened together.
pub(crate) fn of_folder(folder: &Path) -> Option<Format> {
    formats().find(|format| format.folder.is_some_and(|holds| holds(folder)))
}

/// Returns the format in which a file of that name is written.
pub fn written(path: &Path) -> Option<Format> {
    let extension = path.extension()?;
    let is_own = |format: &Format| extension.eq_ignore_ascii_case(format.extension());
    formats().find(|format| format.write.is_some() && is_own(format))
}

/// Returns whether a file of that name is written as a mesh.
pub fn is_mesh(path: &Path) -> bool {
    mesh_traits(path).is_some()
}

/// Returns whether a file of that name is written as a volume, whose form can be chosen.
pub fn is_volume(path: &Path) -> bool {
    written(path).is_some_and(|format| matches!(format.write, Some(Export::Volume(_))))
}

/// Returns the format of raw voxels.
pub fn raw() -> Format {
    &raw::SPEC
}

/// Returns whether the name is that of raw voxels, which a layout has to describe.
pub fn is_raw(path: &Path) -> bool {
    raw::SPEC.is_named(path)
}

/// Returns what a mesh of that name can hold. `None` if files of that name are not written as meshes.
pub fn mesh_traits(path: &Path) -> Option<&'static MeshTraits> {
    mesh_export(path).map(|(_, mesh)| &mesh.traits)
}

/// Returns the format of meshes that are written under that name, and its writer.
pub(crate) fn mesh_export(path: &Path) -> Option<(Format, &'static MeshWriter)> {
    let format = written(path)?;
    match &format.write {
        Some(Export::Mesh(mesh)) => Some((format, mesh)),
        _ => None,
    }
}

/// Returns the formats to export to, with their names and extensions: meshes, then models, then volumes.
pub fn exports() -> Vec<(&'static str, &'static str)> {
    let order = |format: &Format| match format.write {
        Some(Export::Mesh(_)) => 0,
        Some(Export::Model(_)) => 1,
        _ => 2,
    };
    let mut exported: Vec<Format> = formats().filter(|f| f.exported_as.is_some()).collect();
    exported.sort_by_key(order);
    exported.iter().filter_map(|f| Some((f.exported_as?, f.extension()))).collect()
}

/// Returns a text that lists the files that can be written: `.vsc, .pvm, or a mesh: .stl, .ply`.
pub fn written_text() -> String {
    let is_mesh = |format: &Format| matches!(format.write, Some(Export::Mesh(_)));
    let (meshes, others): (Vec<Format>, Vec<Format>) =
        formats().filter(|format| format.write.is_some()).partition(is_mesh);
    let text =
        |formats: &[Format]| commas(&formats.iter().map(|f| f.extension()).collect::<Vec<_>>());
    format!("{}, or a mesh: {}", text(&others), text(&meshes))
}

/// Returns a text that lists the meshes in which an axis points up by default: `.obj and .glb`.
pub fn meshes_with_up_text(up: MeshUp) -> String {
    joined(&meshes_with(|traits| traits.up == up), "and")
}

/// Returns a text that lists the meshes that can hold points alone.
pub fn meshes_of_points_text() -> String {
    joined(&meshes_with(|traits| traits.holds_points), "and")
}

/// Returns a text that lists the meshes whose files are read with an axis pointing up by default.
pub fn meshes_read_with_up_text(up: Up) -> String {
    joined(&read_with(|import| matches!(import, Import::Mesh(mesh) if mesh.usual_up == up)), "and")
}

/// Returns a text that lists the models that are shown as cubes.
pub fn models_of_cubes_text() -> String {
    let is_of_cubes = |import: &Import| match import {
        Import::Model(model) => model.surface == SurfaceKind::Cubes,
        _ => false,
    };
    commas(&read_with(is_of_cubes))
}

/// Returns the error for a name under which nothing is written.
pub(crate) fn not_written(path: &Path) -> FormatError {
    let why = match named(path) {
        Ok(_) => return FormatError::ReadOnly(commas(&WRITE_ENDINGS)),
        Err(FormatError::UnknownEnding { ending, .. }) => {
            format!("`{ending}` is not the extension")
        }
        Err(_) => "the file name has no extension".to_string(),
    };
    FormatError::NotWritten { why, written: commas(&WRITE_ENDINGS) }
}

/// Returns the error for a mesh requested under the name of another format.
pub(crate) fn not_a_mesh() -> FormatError {
    FormatError::NotAMeshFile(joined(&meshes_with(|_| true), "or"))
}

/// Returns the error for points requested in a mesh that cannot hold them.
pub(crate) fn no_points() -> FormatError {
    FormatError::NoPoints(joined(&meshes_with(|traits| traits.holds_points), "or"))
}

/// Returns the error for a form requested for a file that is no volume.
pub(crate) fn no_forms(export: &Export, form: ExportForm) -> FormatError {
    let is_volume = |format: &Format| matches!(format.write, Some(Export::Volume(_)));
    let volumes: Vec<_> = formats().filter(is_volume).map(|format| format.extension()).collect();
    let volumes = joined(&volumes, "or");
    match export {
        Export::Sculpture => FormatError::FormOfVsc { form, volumes },
        Export::Mesh(_) => FormatError::FormOfMesh { form, volumes },
        Export::Model(_) | Export::Volume(_) => FormatError::FormOfModel { form, volumes },
    }
}

/// Returns the extensions of the written meshes for which `is_so` holds.
fn meshes_with(is_so: impl Fn(&MeshTraits) -> bool) -> Vec<&'static str> {
    let is_so = |format: &Format| match &format.write {
        Some(Export::Mesh(mesh)) => is_so(&mesh.traits),
        _ => false,
    };
    formats().filter(is_so).map(|format| format.extension()).collect()
}

/// Returns the first extensions of the formats for whose readers `is_so` holds.
fn read_with(is_so: impl Fn(&Import) -> bool) -> Vec<&'static str> {
    formats().filter(|format| is_so(&format.read)).map(|format| format.extension()).collect()
}

/// Joins extensions as `.a, .b, .c`.
fn commas(extensions: &[&str]) -> String {
    extensions.iter().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(", ")
}

/// Joins extensions as `.a, .b or .c`, with `word` before the last.
fn joined(extensions: &[&str], word: &str) -> String {
    match extensions {
        [] | [_] => commas(extensions),
        [others @ .., last] => format!("{} {word} .{last}", commas(others)),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::format::spec::Sign;

    /// Returns the Rust files below a folder.
    fn sources(folder: &Path) -> Vec<std::path::PathBuf> {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        entries
            .flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] })
            .filter(|path| path.extension().is_some_and(|ending| ending == "rs"))
            .collect()
    }

    #[test]
    fn every_description_is_in_the_list() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/format");
        let is_described = |path: &std::path::PathBuf| {
            let text = std::fs::read_to_string(path).unwrap();
            text.lines().any(|line| line.starts_with("pub static SPEC: FormatSpec"))
        };
        let described = sources(&folder).into_iter().filter(is_described).count();
        assert_eq!(described, FORMATS.len());
        let names: BTreeMap<_, _> = formats().map(|format| (format.title(), format)).collect();
        assert_eq!(names.len(), FORMATS.len(), "a format twice");
    }

    #[test]
    fn each_extension_belongs_to_one_format() {
        let mut owners = BTreeMap::new();
        for format in formats() {
            assert!(!format.extensions.is_empty(), "{format:?}");
            for ending in format.extensions.iter().chain(format.parts) {
                assert_eq!(ending.to_ascii_lowercase(), **ending);
                assert_eq!(owners.insert(ending, format), None, ".{ending} of {format:?}");
                assert_eq!(named(Path::new(&format!("a.{ending}"))).unwrap(), format);
            }
            let is_exported =
                matches!(&format.write, Some(export) if !matches!(export, Export::Sculpture));
            assert_eq!(format.exported_as.is_some(), is_exported, "{format:?}");
        }
    }

    #[test]
    fn signs_of_two_formats_do_not_clash() {
        let words = |format: Format| {
            format.signs.iter().filter_map(|sign| match sign {
                Sign::At(at, magic) => Some((*at, magic.to_vec())),
                Sign::Word(word) => Some((0, word.to_vec())),
                Sign::Exact(_) | Sign::Likely(_) => None,
            })
        };
        for format in formats() {
            for (at, magic) in words(format) {
                let start = [vec![0; at], magic.clone(), b" and more".to_vec()].concat();
                assert_eq!(identified(&start, 900), Some(format));
                assert_ne!(identified(&start[..at + magic.len() - 1], 900), Some(format));
                for other in formats().filter(|other| *other != format) {
                    let clashes = |(own, bytes): &(usize, Vec<u8>)| {
                        *own == at && (bytes.starts_with(&magic) || magic.starts_with(bytes))
                    };
                    assert!(!words(other).any(|sign| clashes(&sign)), "{format:?}, {other:?}");
                }
            }
        }
    }

    #[test]
    fn texts_list_what_the_descriptions_say() {
        assert_eq!(joined(&["a"], "or"), ".a");
        assert_eq!(joined(&["a", "b", "c"], "or"), ".a, .b or .c");
        assert_eq!(models_of_cubes_text(), ".vox, .qb, .gox");
        assert_eq!(meshes_of_points_text(), ".ply");
        assert!(written_text().starts_with(".vsc, .pvm, .raw, .vox, .qb, or a mesh: .stl"));
        assert_eq!(exports().len(), WRITE_ENDINGS.len() - 1);
        assert_eq!(exports()[0], ("Print (STL)", "stl"));
    }
}
