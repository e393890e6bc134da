//! `.3mf` files of other programs through the public interface: units, placement, colours, and damage.

use std::io::{Cursor, Write};
use std::path::PathBuf;

use glam::{UVec3, Vec3};
use sculpture_core::format::options::{ImportOptions, MeshSize};
use sculpture_core::format::{self, Loaded};
use sculpture_core::sculpture::{Limits, Rgb};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// A box of 4 x 2 x 1 units, with a corner at the origin.
const BOX: &str = "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='4' y='0' z='0'/><vertex x='0' y='2' z='0'/>\
    <vertex x='4' y='2' z='0'/><vertex x='0' y='0' z='1'/><vertex x='4' y='0' z='1'/><vertex x='0' y='2' z='1'/>\
    <vertex x='4' y='2' z='1'/></vertices><triangles>";

fn triangles(paint: &str) -> String {
    [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ]
    .map(|[a, b, c]| format!("<triangle v1='{a}' v2='{b}' v3='{c}' {paint}/>"))
    .concat()
}

fn model(unit: &str, object: &str, paint: &str, rest: &str, build: &str) -> String {
    format!(
        "<model unit='{unit}' xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02' \
         xmlns:m='http://schemas.microsoft.com/3dmanufacturing/material/2015/02'><resources>\
         <basematerials id='5'><base name='a' displaycolor='#0000FF'/><base name='b' displaycolor='#FF0000FF'/>\
         </basematerials><object id='1' {object}>{BOX}{}</triangles></mesh></object>{rest}</resources>\
         <build>{build}</build></model>",
        triangles(paint)
    )
}

fn archive(entries: &[(&str, &str)]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in entries {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn load(folder: &tempfile::TempDir, file: &[u8], limits: &Limits) -> Result<Loaded, String> {
    let path: PathBuf = folder.path().join("a.3mf");
    std::fs::write(&path, file).unwrap();
    let options = ImportOptions { mesh_size: MeshSize::LongestVx(16), ..ImportOptions::default() };
    format::load(&path, &options, limits, &()).map_err(|error| error.to_string())
}

#[test]
fn units_placements_and_colours_are_those_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let limits = Limits::default();
    let item = "<item objectid='1'/>";
    for (unit, mm) in [("micron", 0.001), ("millimeter", 1.0), ("inch", 25.4), ("meter", 1000.0)] {
        let text = model(unit, "pid='5' pindex='1'", "", "", item);
        let loaded = load(&folder, &archive(&[("3D/3dmodel.model", &text)]), &limits).unwrap();
        let grid = &loaded.contents.grid;
        // z points up.
        assert_eq!((grid.dims(), grid.opaque_count()), (UVec3::new(16, 4, 8), 512), "{unit}");
        let edge = grid.voxel_size().x;
        assert!((edge / (0.25 * mm) - 1.0).abs() < 1e-4, "{unit}: {edge}");
        assert_eq!(loaded.contents.rgb(UVec3::new(0, 3, 2)), Rgb::new(255, 0, 0));
        assert_eq!(loaded.notes, Vec::<String>::new());
    }
    // Two boxes, one of them mirrored, by a component of a component; in a file that the relations name.
    let rest = "<object id='2'><components><component objectid='1'/><component objectid='1' \
        transform='-1 0 0 0 1 0 0 0 1 12 0 0'/></components></object>\
        <object id='3'><components><component objectid='2' transform='2 0 0 0 2 0 0 0 2 0 0 7'/></components>\
        </object><object id='9' type='support'/>";
    let text =
        model("millimeter", "", "pid='5' p1='0'", rest, "<item objectid='3'/><item objectid='9'/>");
    let relations = "<Relationships><Relationship Target='/other/m.model' \
        Type='http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel'/></Relationships>";
    let file = archive(&[("_rels/.rels", relations), ("other/m.model", &text)]);
    let loaded = load(&folder, &file, &limits).unwrap();
    let grid = &loaded.contents.grid;
    assert_eq!(grid.voxel_size(), Vec3::splat(1.5));
    let empty = (0..grid.dims().x).filter(|x| !grid.get(glam::IVec3::new(*x as i32, 0, 1))).count();
    assert!((4..=6).contains(&empty), "a gap of eight millimetres: {empty}");
    assert_eq!(loaded.contents.rgb(UVec3::ZERO), Rgb::new(0, 0, 255));
    assert!(loaded.notes.len() == 1 && loaded.notes[0].contains("support"), "{:?}", loaded.notes);
}

#[test]
fn damaged_archives_are_refused_with_a_place() {
    let folder = tempfile::tempdir().unwrap();
    let limits = Limits::default();
    let item = "<item objectid='1'/>";
    let good = model("millimeter", "", "", "", item);
    let round = "<object id='2'><components><component objectid='2'/></components></object>";
    for (text, part) in [
        (good.replace("millimeter", "league"), "league"),
        (good.replace("v1='0'", "v1='8'"), "corner 8"),
        (good.replace("x='4'", "x='four'"), "four"),
        (good.replace("objectid='1'", "objectid='7'"), "object 7"),
        (good.replace("objectid='1'/>", "objectid='1' transform='1 0 0'/>"), "twelve numbers"),
        (good.replace("<build>", "<built>").replace("</build>", "</built>"), "<build>"),
        (good.replace("objectid='1'/>", "objectid='1' path='/3D/b.model'/>"), "b.model"),
        (good.replace(item, ""), "no triangles"),
        (model("millimeter", "", "", round, "<item objectid='2'/>"), "nested without end"),
        (good[..900].to_string(), "XML"),
        ("<html/>".to_string(), "<model>"),
    ] {
        let error = load(&folder, &archive(&[("3D/3dmodel.model", &text)]), &limits).unwrap_err();
        assert!(error.contains(part), "{part}: {error}");
    }
    let error = load(&folder, &archive(&[("a.txt", "a")]), &limits).unwrap_err();
    assert!(error.contains("3dmodel.model"), "{error}");
    // 64 MiB of spaces in some 64 KiB.
    let bomb = archive(&[("3D/3dmodel.model", &" ".repeat(64 << 20))]);
    let small = Limits { grid_bytes: 16 << 20, colour_bytes: 16 << 20, ..limits };
    let error = load(&folder, &bomb, &small).unwrap_err();
    assert!(error.contains("MiB"), "{error}");
    let file = archive(&[("3D/3dmodel.model", &good)]);
    assert!(load(&folder, &file, &limits).is_ok());
    for end in (0..file.len()).step_by(41) {
        assert!(load(&folder, &file[..end], &limits).is_err(), "{end}");
    }
}
