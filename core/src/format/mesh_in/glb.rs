//! Reads glTF 2.0, in one file (`.glb`) or with others beside it (`.gltf`): the triangles of all nodes of the scene in
//! their positions, with colours of corners, of materials, and of base colour textures.
//!
//! Bones and morph targets are ignored. Colours of glTF are linear; those of a sculpture are sRGB.

use std::path::Path;
use std::sync::Arc;

use glam::{Affine2, Mat4, Quat, Vec2, Vec3};
use serde_json::Value;

use super::glb_json::{Glb, MAGIC, fault, whole};
use super::gltf_files::GltfFolder;
use super::imported::{Imported, MeshReader};
use crate::format::FormatError;
use crate::format::error::excerpt;
use crate::format::mesh_out::{self, MeshTraits, MeshWriter};
use crate::format::options::MeshUp;
use crate::format::picture::picture_of;
use crate::format::spec::{Export, FormatSpec, Import, Sign};
use crate::progress::Progress;
use crate::sculpture::Rgb;
use crate::sculpture::orientation::Up;
use crate::voxelise::Skin;

/// Lengths are metres, and y points up, as the format defines.
pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, MAGIC)],
    write: Some(Export::Mesh(MeshWriter {
        write: mesh_out::glb::write,
        traits: MeshTraits { is_up_fixed: true, ..MeshTraits::new(MeshUp::Y) },
    })),
    exported_as: Some("Mesh (glTF)"),
    ..FormatSpec::new(
        "a mesh",
        &["glb", "gltf"],
        Import::Mesh(MeshReader {
            read: |file| read(file.bytes, file.path, file.rest_bytes, file.progress),
            usual_up: Up::Y,
            knows_up: true,
            mm_per_unit: 1000.0,
        }),
    )
};

/// Extensions that a file may require: read here, or irrelevant to shape and colour.
const KNOWN_EXTENSIONS: [&str; 7] = [
    INSTANCING,
    SPECULAR_GLOSSINESS,
    TEXTURE_TRANSFORM,
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_xmp_json_ld",
    "KHR_animation_pointer",
];
const INSTANCING: &str = "EXT_mesh_gpu_instancing";
const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";
const TEXTURE_TRANSFORM: &str = "KHR_texture_transform";
/// All other material extensions change reflection or transmission, not the base colour.
const OF_MATERIALS: &str = "KHR_materials_";
/// Greatest nesting of nodes, and greatest number of visits of nodes: children may be shared.
const MOST_DEPTH: usize = 200;
const MOST_VISITS: u32 = 1 << 20;
/// Greatest number of triangles, including those of copies.
const MOST_TRIANGLES: usize = 1 << 25;
const WHITE: Rgb = Rgb::new(255, 255, 255);

struct GlbReader<'a> {
    glb: Glb<'a>,
    beside: GltfFolder<'a>,
    out: Imported,
    /// The texture mapping of each material.
    layings: Vec<Laying>,
    has_colours: bool,
    visits: u32,
}

/// Reads a file, with others in its folder, which may take `budget_bytes` together.
fn read(
    file: &[u8],
    path: &Path,
    budget_bytes: u64,
    progress: &dyn Progress,
) -> Result<Imported, FormatError> {
    let beside = GltfFolder::new(path, budget_bytes, progress);
    let glb = Glb::read(file, &beside)?;
    let required = glb.json.get("extensionsRequired").and_then(Value::as_array);
    let is_known = |name: &&str| KNOWN_EXTENSIONS.contains(name) || name.starts_with(OF_MATERIALS);
    let mut required = required.into_iter().flatten().filter_map(Value::as_str);
    if let Some(name) = required.find(|name| !is_known(name)) {
        let name = excerpt(name.as_bytes());
        return Err(FormatError::Scan(format!(
            "the file needs the extension {name}, which is not read; export it without"
        )));
    }
    let kind = if glb.is_binary { "glTF 2.0, binary" } else { "glTF 2.0" };
    let out = Imported { kind: kind.to_string(), ..Imported::default() };
    let mut reader =
        GlbReader { glb, beside, out, layings: Vec::new(), has_colours: false, visits: 0 };
    reader.materials();
    for root in reader.roots()? {
        reader.node(root, Mat4::IDENTITY, 0)?;
    }
    if !reader.has_colours {
        reader.out.mesh.corner_colours = Vec::new();
    }
    Ok(reader.out)
}

/// Returns the entries of a list, if it is one.
fn list<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    object.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}

fn numbers<const N: usize>(object: &Value, key: &str) -> Option<[f32; N]> {
    let values: Vec<f32> =
        list(object, key).iter().filter_map(|v| Some(v.as_f64()? as f32)).collect();
    values.try_into().ok()
}

/// Converts a linear level to sRGB.
fn srgb(linear: f32) -> u8 {
    let v = linear.clamp(0.0, 1.0);
    let v = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    (v * 255.0).round() as u8
}

/// Returns an extension of an object of the file.
fn extension<'a>(object: &'a Value, name: &str) -> Option<&'a Value> {
    object.get("extensions")?.get(name)
}

/// The mapping of a texture to a surface.
#[derive(Clone, Copy, Debug, Default)]
struct Laying {
    /// The set of texture coordinates that it uses.
    uv_set: usize,
    /// The transform of these coordinates.
    transform: Affine2,
}

impl Laying {
    fn of(texture: &Value) -> Laying {
        let own = extension(texture, TEXTURE_TRANSFORM).unwrap_or(&Value::Null);
        let of = |key: &str, usual: Vec2| numbers(own, key).map_or(usual, Vec2::from_array);
        let angle = own.get("rotation").and_then(Value::as_f64).unwrap_or(0.0) as f32;
        // The angles refer to coordinates whose second component points down.
        let transform = Affine2::from_scale_angle_translation(
            of("scale", Vec2::ONE),
            -angle,
            of("offset", Vec2::ZERO),
        );
        let uv_set = whole(own, "texCoord").or_else(|| whole(texture, "texCoord")).unwrap_or(0);
        Laying { uv_set, transform }
    }
}

impl GlbReader<'_> {
    /// Returns the root nodes of the scene; without a scene, all nodes that are no children.
    fn roots(&self) -> Result<Vec<usize>, FormatError> {
        let scene = whole(&self.glb.json, "scene").unwrap_or(0);
        let is_index = |node: &Value| usize::try_from(node.as_u64()?).ok();
        if !list(&self.glb.json, "scenes").is_empty() {
            let scene = self.glb.entry("scenes", scene)?;
            return Ok(list(scene, "nodes").iter().filter_map(is_index).collect());
        }
        let nodes = list(&self.glb.json, "nodes");
        let children: std::collections::HashSet<usize> =
            nodes.iter().flat_map(|node| list(node, "children")).filter_map(is_index).collect();
        Ok((0..nodes.len()).filter(|node| !children.contains(node)).collect())
    }

    /// Reads the materials. A texture that cannot be read is left out with a note.
    fn materials(&mut self) {
        for (number, material) in list(&self.glb.json, "materials").iter().enumerate() {
            // A file with both provides the older one for programs that support only that.
            let older = extension(material, SPECULAR_GLOSSINESS);
            let surface = material.get("pbrMetallicRoughness").unwrap_or(&Value::Null);
            let (surface, factor, texture) = match older {
                Some(older) => (older, "diffuseFactor", "diffuseTexture"),
                None => (surface, "baseColorFactor", "baseColorTexture"),
            };
            let [r, g, b, _] = numbers(surface, factor).unwrap_or([1.0; 4]);
            let mut skin = Skin { colour: Rgb([r, g, b].map(srgb)), texture: None };
            let mut laying = Laying::default();
            if let Some(base) = surface.get(texture) {
                laying = Laying::of(base);
                match self.texture(base) {
                    Ok(texture) => skin.texture = Some(Arc::new(texture)),
                    Err(error) => {
                        let note =
                            format!("the texture of material {number} was not read: {error}");
                        self.out.notes.push(note);
                    }
                }
            }
            self.layings.push(laying);
            self.out.mesh.skins.push(skin);
        }
    }

    fn texture(&self, base: &Value) -> Result<crate::tools::texture::Texture, FormatError> {
        let missing = |what: &str| fault(format!("{what} of a texture"), "it is not in the file");
        let texture =
            self.glb.entry("textures", whole(base, "index").ok_or_else(|| missing("index"))?)?;
        let source = whole(texture, "source").ok_or_else(|| missing("image"))?;
        let image = self.glb.entry("images", source)?;
        if let Some(uri) = image.get("uri").and_then(Value::as_str) {
            return picture_of(&self.beside.read(uri)?);
        }
        picture_of(self.glb.view(whole(image, "bufferView").ok_or_else(|| missing("image"))?)?)
    }

    fn node(&mut self, at: usize, above: Mat4, depth: usize) -> Result<(), FormatError> {
        self.visits += 1;
        if depth > MOST_DEPTH || self.visits > MOST_VISITS {
            return Err(fault(format!("nodes {at}"), "nodes are nested without end, or too many"));
        }
        let node = self.glb.entry("nodes", at)?.clone();
        let own = match numbers(&node, "matrix") {
            Some(matrix) => Mat4::from_cols_array(&matrix),
            None => Mat4::from_scale_rotation_translation(
                numbers(&node, "scale").map_or(Vec3::ONE, Vec3::from),
                numbers(&node, "rotation").map_or(Quat::IDENTITY, Quat::from_array),
                numbers(&node, "translation").map_or(Vec3::ZERO, Vec3::from),
            ),
        };
        let world = above * own;
        if let Some(mesh) = whole(&node, "mesh") {
            let copies = match extension(&node, INSTANCING) {
                Some(instancing) => self.copies(instancing)?,
                None => vec![Mat4::IDENTITY],
            };
            let mesh = self.glb.entry("meshes", mesh)?.clone();
            for copy in copies {
                for primitive in list(&mesh, "primitives") {
                    self.primitive(primitive, world * copy)?;
                }
            }
        }
        for child in list(&node, "children").iter().filter_map(Value::as_u64) {
            self.node(child as usize, world, depth + 1)?;
        }
        Ok(())
    }

    /// Returns the transforms of the copies of a mesh that a node has by its instancing extension.
    fn copies(&mut self, instancing: &Value) -> Result<Vec<Mat4>, FormatError> {
        let attributes = instancing.get("attributes").unwrap_or(&Value::Null);
        let numbers = |name: &str, width: usize| match whole(attributes, name) {
            Some(at) => {
                let numbers = self.glb.numbers(at)?;
                let fault = || fault(name, "the copies of a mesh have numbers of another kind");
                (numbers.width == width).then_some(Some(numbers.values)).ok_or_else(fault)
            }
            None => Ok(None),
        };
        let (shifts, turns) = (numbers("TRANSLATION", 3)?, numbers("ROTATION", 4)?);
        let scales = numbers("SCALE", 3)?;
        let counts = [(&shifts, 3), (&turns, 4), (&scales, 3)];
        let counts =
            counts.into_iter().filter_map(|(all, width)| Some(all.as_ref()?.len() / width));
        let count = counts.min().unwrap_or(1);
        self.visits = self.visits.saturating_add(u32::try_from(count).unwrap_or(u32::MAX));
        if self.visits > MOST_VISITS {
            return Err(fault(INSTANCING, "it has more than a million copies"));
        }
        let of = |all: &Option<Vec<f32>>, i: usize| {
            all.as_ref().and_then(|all| all.get(3 * i..3 * i + 3).map(Vec3::from_slice))
        };
        let turn = |i: usize| turns.as_ref()?.get(4 * i..4 * i + 4).map(Quat::from_slice);
        Ok((0..count)
            .map(|i| {
                Mat4::from_scale_rotation_translation(
                    of(&scales, i).unwrap_or(Vec3::ONE),
                    turn(i).unwrap_or(Quat::IDENTITY).normalize(),
                    of(&shifts, i).unwrap_or(Vec3::ZERO),
                )
            })
            .collect())
    }

    fn primitive(&mut self, primitive: &Value, world: Mat4) -> Result<(), FormatError> {
        let attributes = primitive.get("attributes").unwrap_or(&Value::Null);
        let mode = whole(primitive, "mode").unwrap_or(4);
        let Some(positions) = whole(attributes, "POSITION").filter(|_| (4..=6).contains(&mode))
        else {
            self.out.notes.push("points or lines were left out".to_string());
            return Ok(());
        };
        let positions = self.glb.numbers(positions)?;
        if positions.width != 3 {
            return Err(fault("POSITION", "places must have three coordinates"));
        }
        let points = positions.values.as_chunks::<3>().0;
        let indices = match whole(primitive, "indices") {
            Some(at) => self.glb.indices(at)?,
            None => (0..points.len() as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|index| **index as usize >= points.len()) {
            let count = points.len();
            return Err(fault(
                "indices",
                format!("corner {index} is named, but there are {count}"),
            ));
        }
        let triangles = triangles(mode, &indices);
        let (triangles_so_far, points_so_far) =
            (self.out.mesh.triangles.len(), self.out.mesh.positions.len());
        if triangles_so_far + triangles.len() > MOST_TRIANGLES
            || points_so_far + points.len() > 3 * MOST_TRIANGLES
        {
            return Err(fault("the scene", "it has more than 2^25 triangles, copies counted"));
        }
        let material = whole(primitive, "material").unwrap_or(usize::MAX);
        let laying = self.layings.get(material).copied().unwrap_or_default();
        let uv_set = laying.uv_set;
        let uvs = self.attribute(attributes, &format!("TEXCOORD_{uv_set}"), points.len())?;
        let colours = self.attribute(attributes, "COLOR_0", points.len())?;
        let mesh = &mut self.out.mesh;
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(points.iter().map(|p| world.transform_point3(Vec3::from(*p))));
        let is_mirrored = world.determinant() < 0.0;
        for mut triangle in triangles {
            if is_mirrored {
                triangle.swap(1, 2);
            }
            let at = |corner: u32, values: &super::glb_json::AccessorValues| {
                let start = corner as usize * values.width;
                (values.values[start], values.values[start + 1], start)
            };
            // glTF counts from the upper edge of a texture, this program from the lower.
            mesh.corner_uvs.push(triangle.map(|corner| {
                uvs.as_ref().map_or(Vec2::ZERO, |uvs| {
                    let (u, v, _) = at(corner, uvs);
                    let Vec2 { x, y } = laying.transform.transform_point2(Vec2::new(u, v));
                    Vec2::new(x, 1.0 - y)
                })
            }));
            mesh.corner_colours.push(triangle.map(|corner| {
                colours.as_ref().filter(|colours| colours.width >= 3).map_or(WHITE, |colours| {
                    let (r, g, start) = at(corner, colours);
                    Rgb([r, g, colours.values[start + 2]].map(srgb))
                })
            }));
            self.has_colours |= colours.is_some();
            mesh.skin_of.push(u32::try_from(material).unwrap_or(u32::MAX));
            mesh.triangles.push(triangle.map(|corner| first + corner));
        }
        Ok(())
    }

    /// Returns the numbers of an attribute, if it exists: two or more for each of `count` corners.
    fn attribute(
        &self,
        attributes: &Value,
        name: &str,
        count: usize,
    ) -> Result<Option<super::glb_json::AccessorValues>, FormatError> {
        let Some(at) = whole(attributes, name) else { return Ok(None) };
        let numbers = self.glb.numbers(at)?;
        if numbers.width < 2 || numbers.values.len() < count * numbers.width {
            return Err(fault(name, "it has fewer entries than there are corners"));
        }
        Ok(Some(numbers))
    }
}

/// Returns the triangles of a list (4), a strip (5) or a fan (6) of corners.
fn triangles(mode: usize, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        4 => indices.as_chunks().0.to_vec(),
        5 => {
            let turned = |(i, t): (usize, &[u32])| match i % 2 {
                0 => [t[0], t[1], t[2]],
                _ => [t[1], t[0], t[2]],
            };
            indices.windows(3).enumerate().map(turned).collect()
        }
        _ => {
            let Some((first, rest)) = indices.split_first() else { return Vec::new() };
            rest.windows(2).map(|pair| [*first, pair[0], pair[1]]).collect()
        }
    }
}
