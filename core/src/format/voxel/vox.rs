//! Reads MagicaVoxel's `.vox` (versions 150 and 200): models, palette, and the scene that places them. Other files with
//! that extension are read as Voxlap's (`voxlap.rs`).
//!
//! The voxels stay in the file's bytes. Of animations the first frame is read; hidden objects and layers are left
//! out. `scene.rs` places the models.

use std::collections::{HashMap, HashSet};

use glam::I64Vec3;

use super::model::{Model, ModelReader, Sink, upright, upright_box};
use super::palette::default_palette;
use super::scene::{self, Instance, Node, Turn};
use super::vox_write::{self, MAGIC, MAX_EDGE_VX};
use super::voxlap;
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::spec::{Export, FormatSpec, Import, Sign};
use crate::sculpture::Rgb;
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::Up;

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, MAGIC)],
    write: Some(Export::Model(vox_write::write)),
    exported_as: Some("MagicaVoxel"),
    ..FormatSpec::new(
        "a MagicaVoxel model",
        &["vox"],
        Import::Model(ModelReader {
            read: |file| match file.starts_with(MAGIC) {
                true => Ok(Box::new(read(file)?)),
                false => Ok(Box::new(voxlap::read(file)?)),
            },
            surface: SurfaceKind::Cubes,
        }),
    )
};

/// Size of a name, and of the lengths of the chunk and of its children.
const CHUNK_HEADER_BYTES: usize = 12;

/// A model in the layout of the file: four bytes per voxel, x, y, z and colour, z up.
#[derive(Debug)]
struct VoxModel<'a> {
    size: I64Vec3,
    voxels: &'a [[u8; 4]],
}

/// A file: models, their placement, and their colours.
#[derive(Debug)]
struct Vox<'a> {
    version: u32,
    parts: Vec<VoxModel<'a>>,
    instances: Vec<Instance>,
    palette: [Rgb; 256],
    notes: Vec<String>,
}

/// The contents of the chunks, before the scene graph is followed.
#[derive(Default)]
struct Chunks<'a> {
    parts: Vec<VoxModel<'a>>,
    size: Option<I64Vec3>,
    palette: Option<[Rgb; 256]>,
    nodes: HashMap<i32, Node>,
    root: Option<i32>,
    hidden_layers: HashSet<i32>,
    notes: Vec<String>,
}

/// Reads the structure of a file.
fn read(file: &[u8]) -> Result<Vox<'_>, FormatError> {
    let mut bytes = Bytes::new(file);
    bytes.take(MAGIC.len())?;
    let version = bytes.u32()?;
    let mut chunks = Chunks::default();
    let start = bytes;
    if bytes.take(4)? != b"MAIN" {
        return Err(start.fault("the chunk MAIN is missing"));
    }
    let (own, children) = (bytes.count("bytes")?, bytes.count("bytes")?);
    bytes.take(own)?;
    // Some programs do not count the contents of MAIN.
    if (1..bytes.rest().len()).contains(&children) {
        let behind = bytes.rest().len() - children;
        bytes = bytes.part(children)?;
        chunks.notes.push(format!("{behind} bytes behind the model were left out"));
    }
    while !bytes.is_empty() {
        if bytes.rest().len() < CHUNK_HEADER_BYTES {
            let behind = bytes.rest().len();
            chunks.notes.push(format!("{behind} bytes behind the model were left out"));
            break;
        }
        let id = bytes.take(4)?;
        let (own, children) = (bytes.count("bytes")?, bytes.count("bytes")?);
        let content = bytes.part(own)?;
        bytes.take(children)?;
        chunks.take(id, content)?;
    }
    let Chunks { parts, nodes, root, hidden_layers, palette, mut notes, .. } = chunks;
    let instances = match root {
        Some(root) => {
            let placed = scene::place(&nodes, root, &hidden_layers, parts.len())?;
            if placed.hidden > 0 {
                notes.push(format!("{} hidden objects or groups were left out", placed.hidden));
            }
            if placed.has_frames {
                notes.push("of its animation only the first frame was read".to_string());
            }
            placed.instances
        }
        None => {
            if parts.len() > 1 {
                notes.push(format!("of {} models, or frames, the first was read", parts.len()));
            }
            (0..parts.len().min(1)).map(Instance::alone).collect()
        }
    };
    Ok(Vox { version, parts, instances, palette: palette.unwrap_or(default_palette()), notes })
}

impl<'a> Chunks<'a> {
    fn take(&mut self, id: &[u8], chunk: Bytes<'a>) -> Result<(), FormatError> {
        match id {
            b"SIZE" => self.take_size(chunk),
            b"XYZI" => self.take_voxels(chunk),
            b"RGBA" => {
                self.palette = Some(palette(chunk));
                Ok(())
            }
            b"TDCZ" => Err(FormatError::Scan(
                "its voxels are packed as the game Teardown does (chunk TDCZ), which is not read; save the model anew with MagicaVoxel"
                    .to_string(),
            )),
            b"nTRN" => self.take_node(chunk, transform),
            b"nGRP" => self.take_node(chunk, group),
            b"nSHP" => self.take_node(chunk, shape),
            b"LAYR" => self.take_layer(chunk),
            _ => Ok(()),
        }
    }

    /// Takes the size of the model whose voxels follow.
    fn take_size(&mut self, mut chunk: Bytes<'a>) -> Result<(), FormatError> {
        let start = chunk;
        let size = [chunk.u32()?, chunk.u32()?, chunk.u32()?];
        if size.iter().any(|&edge| edge == 0 || edge > MAX_EDGE_VX) {
            let [x, y, z] = size;
            let rule = format!("but an axis has 1 to {MAX_EDGE_VX} voxels");
            return Err(start.fault(format!("a model of {x}x{y}x{z} voxels, {rule}")));
        }
        self.size = Some(I64Vec3::from_array(size.map(i64::from)));
        Ok(())
    }

    fn take_voxels(&mut self, mut chunk: Bytes<'a>) -> Result<(), FormatError> {
        let size = self.size.take();
        let size = size.ok_or_else(|| chunk.fault("voxels without a chunk SIZE before"))?;
        let count = chunk.count("voxels")?;
        let (voxels, _) = chunk.take(count.saturating_mul(4))?.as_chunks();
        let outside = voxels.iter().filter(|v| !is_inside(v, size)).count();
        if outside > 0 {
            let note = "voxels outside of their model, which were left out";
            self.notes.push(format!("{note}: {outside}"));
        }
        self.parts.push(VoxModel { size, voxels });
        Ok(())
    }

    /// Takes a node of the scene, which `read` parses after its number. The first one is the root.
    fn take_node(
        &mut self,
        mut chunk: Bytes<'a>,
        read: fn(Bytes<'a>) -> Result<Node, FormatError>,
    ) -> Result<(), FormatError> {
        let number = chunk.i32()?;
        self.nodes.insert(number, read(chunk)?);
        self.root.get_or_insert(number);
        Ok(())
    }

    fn take_layer(&mut self, mut chunk: Bytes<'a>) -> Result<(), FormatError> {
        let layer = chunk.i32()?;
        if is_hidden(&dictionary(&mut chunk)?) {
            self.hidden_layers.insert(layer);
        }
        Ok(())
    }
}

fn palette(chunk: Bytes<'_>) -> [Rgb; 256] {
    let (colours, _) = chunk.rest().as_chunks::<4>();
    // The last of 256 is unused, and some programs write only those in use.
    let mut palette = default_palette();
    // Entry k is colour k + 1; 0 is no voxel.
    palette[1..].iter_mut().zip(colours).for_each(|(to, from)| {
        *to = Rgb([from[0], from[1], from[2]]);
    });
    palette
}

/// Parses a node that transforms another.
fn transform(mut chunk: Bytes<'_>) -> Result<Node, FormatError> {
    let is_hidden = is_hidden(&dictionary(&mut chunk)?);
    let (child, _, layer) = (chunk.i32()?, chunk.i32()?, chunk.i32()?);
    let frames = chunk.count("frames")?;
    let start = chunk;
    let frame = if frames > 0 { dictionary(&mut chunk)? } else { HashMap::new() };
    let turn = Turn::parse(frame.get(&b"_r"[..]).copied())
        .ok_or_else(|| start.fault("the rotation is not one"))?;
    let shift = parse_shift(frame.get(&b"_t"[..]).copied())
        .ok_or_else(|| start.fault("the translation is not three whole numbers"))?;
    Ok(Node::Transform { child, layer, is_hidden, turn, shift, has_frames: frames > 1 })
}

fn group(mut chunk: Bytes<'_>) -> Result<Node, FormatError> {
    dictionary(&mut chunk)?;
    let count = chunk.count("children")?;
    let (ids, _) = chunk.take(count.saturating_mul(4))?.as_chunks();
    let children = ids.iter().map(|id| i32::from_le_bytes(*id)).collect();
    Ok(Node::Group { children })
}

/// Parses a node that refers to a model.
fn shape(mut chunk: Bytes<'_>) -> Result<Node, FormatError> {
    dictionary(&mut chunk)?;
    let count = chunk.count("models")?;
    if count == 0 {
        return Err(chunk.fault("a shape without a model"));
    }
    let start = chunk;
    let part = chunk.count("as the number of a model")?;
    dictionary(&mut chunk).map_err(|_| start.fault("the shape's text is cut"))?;
    Ok(Node::Shape { part, has_frames: count > 1 })
}

/// Returns whether a voxel lies in its model.
fn is_inside(voxel: &[u8; 4], size: I64Vec3) -> bool {
    (0..3).all(|axis| i64::from(voxel[axis]) < size[axis])
}

/// Texts by their names.
type Dictionary<'a> = HashMap<&'a [u8], &'a [u8]>;

fn dictionary<'a>(chunk: &mut Bytes<'a>) -> Result<Dictionary<'a>, FormatError> {
    let pairs = chunk.count("texts")?;
    let mut texts = HashMap::new();
    for _ in 0..pairs {
        let length = chunk.count("bytes")?;
        let key = chunk.take(length)?;
        let length = chunk.count("bytes")?;
        texts.insert(key, chunk.take(length)?);
    }
    Ok(texts)
}

fn is_hidden(texts: &Dictionary<'_>) -> bool {
    texts.get(&b"_hidden"[..]).is_some_and(|text| *text == b"1")
}

/// Parses three whole numbers of 32 bits; a missing text means zeros.
fn parse_shift(text: Option<&[u8]>) -> Option<I64Vec3> {
    let Some(text) = text else { return Some(I64Vec3::ZERO) };
    let mut numbers = std::str::from_utf8(text).ok()?.split_ascii_whitespace();
    let mut next = || numbers.next()?.parse::<i32>().ok().map(i64::from);
    Some(I64Vec3::new(next()?, next()?, next()?))
}

impl Model for Vox<'_> {
    fn kind(&self) -> String {
        let (models, objects) = (self.parts.len(), self.instances.len());
        let version = self.version;
        format!("MagicaVoxel, version {version}, models: {models}, objects: {objects}")
    }

    fn up(&self) -> Up {
        Up::Z
    }

    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)> {
        let boxes = self.instances.iter().map(|instance| {
            let size = self.parts[instance.part].size;
            let [a, b] = [I64Vec3::ZERO, size - 1].map(|v| instance.place(v, size));
            (a.min(b), a.max(b) + 1)
        });
        boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).map(upright_box)
    }

    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError> {
        for instance in &self.instances {
            let VoxModel { size, voxels } = self.parts[instance.part];
            for voxel in voxels {
                let &[x, y, z, colour] = voxel;
                if colour > 0 && is_inside(voxel, size) {
                    let v = instance.place(I64Vec3::new(x.into(), y.into(), z.into()), size);
                    sink(upright(v), self.palette[usize::from(colour)])?;
                }
            }
        }
        Ok(())
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}
