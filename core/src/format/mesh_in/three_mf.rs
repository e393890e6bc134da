//! Reads `.3mf` (3mf.io, core specification 1.3, production extension 1.1): the triangles of all objects as placed by
//! the build, from all models of the archive, with colours of colour groups and base materials. Parts that slicers do
//! not print (`three_mf_parts.rs`) are left out, and reported.
//!
//! An archive may unpack to far more than its size: the unpacked size is bounded, and so are copies of objects.

use std::collections::{BTreeMap, HashMap};
use std::io::{Cursor, Read};

use glam::{Mat4, Vec3, Vec4};
use roxmltree::{Document, Node};
use zip::ZipArchive;

use super::glb_json::fault;
use super::imported::{Imported, MeshReader};
use super::three_mf_parts::{PLACES, UnprintedParts};
use crate::format::FormatError;
use crate::format::budget::check_budget;
use crate::format::error::{excerpt, printable};
use crate::format::mesh_out::{self, MeshTraits, MeshWriter};
use crate::format::options::MeshUp;
use crate::format::spec::{Export, FormatSpec, Import, Packing};
use crate::sculpture::Rgb;
use crate::sculpture::orientation::Up;

pub static SPEC: FormatSpec = FormatSpec {
    packing: Some(Packing::Zip),
    write: Some(Export::Mesh(MeshWriter {
        write: mesh_out::three_mf::write,
        traits: MeshTraits::new(MeshUp::Z),
    })),
    exported_as: Some("Print (3MF)"),
    ..FormatSpec::new(
        "a mesh",
        &["3mf"],
        Import::Mesh(MeshReader::new(Up::Z, |file| read(file.bytes, file.rest_bytes))),
    )
};

/// Path of the model, unless the relations of the archive name another.
const USUAL_PLACE: &str = "3D/3dmodel.model";
const RELATIONS: &str = "_rels/.rels";
const MODEL_TYPE: &str = "/3dmodel";
const MODEL_ENDING: &str = ".model";
/// Greatest nesting of components, and greatest number of them: they may be shared.
const MOST_DEPTH: usize = 100;
const MOST_VISITS: u32 = 1 << 20;
/// Greatest number of triangles, including those of copies.
const MOST_TRIANGLES: usize = 1 << 25;

/// Reads a file, whose model may take `budget_bytes` once it is unpacked.
fn read(file: &[u8], budget_bytes: u64) -> Result<Imported, FormatError> {
    let mut archive = ZipArchive::new(Cursor::new(file)).map_err(damaged)?;
    let name = model_name(&mut archive, budget_bytes)?;
    // An undecodable name cannot be that of a model, which is named in the XML.
    let others = archive.file_names().filter_map(|other| Some(other.ok()?.into_owned()));
    let is_other = |other: &String| other.ends_with(MODEL_ENDING) && !is_same_name(other, &name);
    let others: Vec<String> = others.filter(is_other).collect();
    let mut left_bytes = budget_bytes;
    let mut texts: Vec<(String, String)> = Vec::new();
    for name in std::iter::once(name).chain(others) {
        let text = entry(&mut archive, &name, left_bytes)?;
        left_bytes = left_bytes.saturating_sub(text.len() as u64);
        texts.push((name, text));
    }
    let mut parts = UnprintedParts::default();
    for place in PLACES {
        if archive.index_for_name(place).is_some() {
            parts.read(&entry(&mut archive, place, left_bytes)?);
        }
    }
    let models = texts.iter().map(|(name, text)| Ok((name.as_str(), parse(text)?)));
    let models: Vec<(&str, Document)> = models.collect::<Result<_, FormatError>>()?;
    let model = models[0].1.root_element();
    if model.tag_name().name() != "model" {
        return Err(fault("the model", "it does not begin with <model>"));
    }
    let mm_per_unit = match model.attribute("unit").unwrap_or("millimeter") {
        "micron" => 0.001,
        "millimeter" => 1.0,
        "centimeter" => 10.0,
        "inch" => 25.4,
        "foot" => 304.8,
        "meter" => 1000.0,
        other => {
            let unit = excerpt(other.as_bytes());
            return Err(fault("the model", format!("`{unit}` is no unit of length")));
        }
    };
    let out = Imported { kind: "3MF".to_string(), ..Imported::default() };
    let (objects, colours, left_out) = (HashMap::new(), HashMap::new(), BTreeMap::new());
    let names = models.iter().map(|(name, _)| *name).collect();
    let (has_colours, visits) = (false, 0);
    let mut reader =
        ThreeMfReader { names, objects, colours, parts, left_out, out, has_colours, visits };
    for (number, (_, xml)) in models.iter().enumerate() {
        reader.resources(number, xml.root_element())?;
    }
    let build =
        children(model, "build").next().ok_or_else(|| fault("the model", "<build> is missing"))?;
    let to_mm = Mat4::from_scale(Vec3::splat(mm_per_unit));
    for item in children(build, "item") {
        reader.placed(item, 0, None, to_mm, 0)?;
    }
    let left_out = reader.left_out.iter();
    let said = left_out.map(|(kind, count)| {
        format!("parts left out as they are no part of the print, {kind}: {count}")
    });
    reader.out.notes.extend(said);
    if !reader.has_colours {
        reader.out.mesh.corner_colours = Vec::new();
    }
    Ok(reader.out)
}

/// Returns whether two names in an archive are the same; either may begin with a slash.
fn is_same_name(a: &str, b: &str) -> bool {
    a.trim_start_matches('/').eq_ignore_ascii_case(b.trim_start_matches('/'))
}

fn damaged(error: zip::result::ZipError) -> FormatError {
    fault("the archive", printable(&error.to_string()))
}

fn parse(text: &str) -> Result<Document<'_>, FormatError> {
    Document::parse(text).map_err(|error| fault("the XML", printable(&error.to_string())))
}

/// Returns the path of the model in the archive.
fn model_name(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    budget_bytes: u64,
) -> Result<String, FormatError> {
    if archive.index_for_name(RELATIONS).is_none() {
        return Ok(USUAL_PLACE.to_string());
    }
    let text = entry(archive, RELATIONS, budget_bytes)?;
    let xml = parse(&text)?;
    let is_model =
        |node: &Node| node.attribute("Type").is_some_and(|kind| kind.ends_with(MODEL_TYPE));
    let target = xml.descendants().find(is_model).and_then(|node| node.attribute("Target"));
    Ok(target.unwrap_or(USUAL_PLACE).trim_start_matches('/').to_string())
}

/// Returns a text of the archive.
fn entry(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    name: &str,
    budget_bytes: u64,
) -> Result<String, FormatError> {
    let shown = excerpt(name.as_bytes());
    let faulty = |what: String| fault(format!("`{shown}` in the archive"), what);
    let entry = archive.by_name(name).map_err(|error| faulty(printable(&error.to_string())))?;
    check_budget(entry.size(), budget_bytes)?;
    let mut bytes = Vec::new();
    // The size that the archive states is not trusted.
    let read = entry.take(budget_bytes + 1).read_to_end(&mut bytes);
    read.map_err(|error| faulty(printable(&error.to_string())))?;
    check_budget(bytes.len() as u64, budget_bytes)?;
    String::from_utf8(bytes).map_err(|_| faulty("it is no text".to_string()))
}

fn children<'a, 'b>(node: Node<'a, 'b>, name: &'static str) -> impl Iterator<Item = Node<'a, 'b>> {
    node.children().filter(move |child| child.tag_name().name() == name)
}

/// Parses a number of a tag.
fn number<T: std::str::FromStr>(node: Node, name: &str) -> Result<T, FormatError> {
    let text = node.attribute(name).unwrap_or_default();
    text.trim().parse().map_err(|_| {
        let (tag, text) = (excerpt(node.tag_name().name().as_bytes()), excerpt(text.as_bytes()));
        fault(format!("<{tag}>"), format!("{name} is `{text}`, which is no such number"))
    })
}

/// Returns the matrix of an item or a component, whose rows are the images of the axes and of the origin.
fn transform(node: Node) -> Result<Mat4, FormatError> {
    let Some(text) = node.attribute("transform") else { return Ok(Mat4::IDENTITY) };
    let values: Option<Vec<f32>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let rows: Option<[f32; 12]> = values.and_then(|values| values.try_into().ok());
    let rows = rows.ok_or_else(|| fault("a transform", "it must be twelve numbers"))?;
    let [x, y, z, origin] = [0, 3, 6, 9].map(|i| Vec3::new(rows[i], rows[i + 1], rows[i + 2]));
    Ok(Mat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), Vec4::from((origin, 1.0))))
}

/// Parses `#RRGGBB` or `#RRGGBBAA`, and ignores the opacity.
fn colour(text: &str) -> Option<Rgb> {
    text.get(..7)?.parse().ok()
}

/// An object or a group of colours: the number of its model in the archive, and its own there.
type Id = (usize, u32);

struct ThreeMfReader<'a, 'b> {
    /// The models; the first one has the build.
    names: Vec<&'a str>,
    objects: HashMap<Id, Node<'a, 'b>>,
    /// The colours of colour groups and base materials.
    colours: HashMap<Id, Vec<Rgb>>,
    parts: UnprintedParts,
    /// Number of parts of each kind that were left out.
    left_out: BTreeMap<&'static str, usize>,
    out: Imported,
    has_colours: bool,
    visits: u32,
}

impl<'a, 'b> ThreeMfReader<'a, 'b> {
    fn resources(
        &mut self,
        number_of_model: usize,
        model: Node<'a, 'b>,
    ) -> Result<(), FormatError> {
        for node in children(model, "resources").flat_map(|resources| resources.children()) {
            let (tag, attribute) = match node.tag_name().name() {
                "object" => {
                    self.objects.insert((number_of_model, number(node, "id")?), node);
                    continue;
                }
                "colorgroup" => ("color", "color"),
                "basematerials" => ("base", "displaycolor"),
                _ => continue,
            };
            let of = |node: Node| node.attribute(attribute).and_then(colour).unwrap_or(Rgb::STONE);
            let id = (number_of_model, number(node, "id")?);
            self.colours.insert(id, children(node, tag).map(of).collect());
        }
        Ok(())
    }

    /// Returns the object that an item, or a component of the object `within`, of a model places.
    fn placed(
        &mut self,
        node: Node<'a, 'b>,
        model: usize,
        within: Option<u32>,
        above: Mat4,
        depth: usize,
    ) -> Result<(), FormatError> {
        self.visits += 1;
        if depth > MOST_DEPTH || self.visits > MOST_VISITS {
            return Err(fault("the build", "components are nested without end, or too many"));
        }
        let path = node.attributes().find(|attribute| attribute.name() == "path");
        let model = match path.map(|path| path.value()) {
            None => model,
            Some(path) => {
                let named = self.names.iter().position(|name| is_same_name(name, path));
                named.ok_or_else(|| {
                    let shown = excerpt(path.as_bytes());
                    fault(format!("`{shown}` in the archive"), "it is named, but not there")
                })?
            }
        };
        let id = number(node, "objectid")?;
        let object = self.objects.get(&(model, id)).copied();
        let object =
            object.ok_or_else(|| fault(format!("object {id}"), "it is named, but not there"))?;
        if let Some(kind @ ("support" | "solidsupport" | "other")) = object.attribute("type") {
            self.out.notes.push(format!("an object of the type `{kind}` was left out"));
            return Ok(());
        }
        if let Some(kind) = within.and_then(|within| self.parts.of_component(within, id)) {
            *self.left_out.entry(kind).or_default() += 1;
            return Ok(());
        }
        let world = above * transform(node)?;
        for mesh in children(object, "mesh") {
            self.mesh(object, (model, id), mesh, world)?;
        }
        for component in children(object, "components").flat_map(|node| children(node, "component"))
        {
            self.placed(component, model, Some(id), world, depth + 1)?;
        }
        Ok(())
    }

    fn mesh(
        &mut self,
        object: Node,
        (model, id): Id,
        mesh: Node,
        world: Mat4,
    ) -> Result<(), FormatError> {
        let first = self.out.mesh.positions.len();
        for vertex in children(mesh, "vertices").flat_map(|node| children(node, "vertex")) {
            let [x, y, z] = ["x", "y", "z"].map(|axis| number(vertex, axis));
            let at = Vec3::new(x?, y?, z?);
            self.out.mesh.positions.push(world.transform_point3(at));
        }
        let count = self.out.mesh.positions.len() - first;
        let is_mirrored = world.determinant() < 0.0;
        let triangles = children(mesh, "triangles").flat_map(|node| children(node, "triangle"));
        let mut last_left_out = None;
        for (i, node) in triangles.enumerate() {
            let left_out = self.parts.of_triangle(id, i);
            if let Some(kind) = left_out.filter(|_| left_out != last_left_out) {
                *self.left_out.entry(kind).or_default() += 1;
            }
            last_left_out = left_out;
            if left_out.is_some() {
                continue;
            }
            let [a, b, c] = ["v1", "v2", "v3"].map(|corner| number::<u32>(node, corner));
            let mut triangle = [a?, b?, c?];
            if let Some(corner) = triangle.iter().find(|corner| **corner as usize >= count) {
                let what = format!("corner {corner} is named, but there are {count}");
                return Err(fault("<triangle>", what));
            }
            let mut colours = self.corners(model, object, node);
            if is_mirrored {
                triangle.swap(1, 2);
                colours.swap(1, 2);
            }
            let mesh = &mut self.out.mesh;
            mesh.triangles.push(triangle.map(|corner| first as u32 + corner));
            mesh.corner_colours.push(colours);
            if mesh.triangles.len() > MOST_TRIANGLES || mesh.positions.len() > 3 * MOST_TRIANGLES {
                return Err(fault("the build", "it has more than 2^25 triangles, copies counted"));
            }
        }
        Ok(())
    }

    /// Returns the colours of the corners of a triangle: its own, those of its object, or none.
    fn corners(&mut self, model: usize, object: Node, triangle: Node) -> [Rgb; 3] {
        let index = |node: Node, name: &str| node.attribute(name)?.trim().parse::<usize>().ok();
        let own = index(triangle, "p1").map(|first| {
            let of = |name| index(triangle, name).unwrap_or(first);
            [first, of("p2"), of("p3")]
        });
        let group = index(triangle, "pid").or(index(object, "pid"));
        let group = group.and_then(|id| self.colours.get(&(model, u32::try_from(id).ok()?)));
        let (Some(group), Some(corners)) =
            (group, own.or(index(object, "pindex").map(|index| [index; 3])))
        else {
            return [Rgb::STONE; 3];
        };
        self.has_colours = true;
        corners.map(|at| group.get(at).copied().unwrap_or(Rgb::STONE))
    }
}
