//! Parses the parts of a glTF file: its description in JSON and its numbers, with all bounds checked.

use std::borrow::Cow;

use serde_json::Value;

use super::gltf_files::GltfFolder;
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::error::{excerpt, printable};

pub const MAGIC: &[u8] = b"glTF";
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// A file.
pub struct Glb<'a> {
    pub json: Value,
    /// Whether it is a `.glb`.
    pub is_binary: bool,
    /// The bytes of each buffer; `None` for buffers without data.
    buffers: Vec<Option<Cow<'a, [u8]>>>,
}

/// Returns an error in the description.
pub fn fault(place: impl Into<String>, what: impl Into<String>) -> FormatError {
    FormatError::Malformed { place: place.into(), what: what.into() }
}

/// Returns a whole number of an object.
pub fn whole(object: &Value, key: &str) -> Option<usize> {
    usize::try_from(object.get(key)?.as_u64()?).ok()
}

/// Numbers of an accessor: `width` for each element.
pub struct AccessorValues {
    pub width: usize,
    pub values: Vec<f32>,
}

/// The bytes of the numbers of an accessor: `width` numbers of this type for each element.
struct Stored {
    width: usize,
    component: usize,
    numbers: Vec<[u8; 4]>,
}

/// Greatest number of elements that are 0 because the file names no buffer view for them.
const MOST_ZEROS: usize = 1 << 22;

impl<'a> Glb<'a> {
    /// Reads the chunks of a `.glb`, or the description of a `.gltf`, and the files that it names.
    pub fn read(file: &'a [u8], beside: &GltfFolder) -> Result<Glb<'a>, FormatError> {
        let is_binary = !file.trim_ascii_start().starts_with(b"{");
        let (json, binary) = if is_binary { chunks(file)? } else { (description(file)?, None) };
        let named = json.get("buffers").and_then(Value::as_array);
        let mut buffers = Vec::new();
        for (number, buffer) in named.into_iter().flatten().enumerate() {
            buffers.push(match buffer.get("uri").and_then(Value::as_str) {
                Some(uri) => Some(Cow::Owned(beside.read(uri)?)),
                None => binary.filter(|_| number == 0).map(Cow::Borrowed),
            });
        }
        Ok(Glb { json, is_binary, buffers })
    }

    /// Returns an entry of one of the lists of the description.
    pub fn entry(&self, list: &str, at: usize) -> Result<&Value, FormatError> {
        let found = self.json.get(list).and_then(|list| list.get(at));
        found.ok_or_else(|| fault(format!("{list} {at}"), "it is named, but not there"))
    }

    /// Returns the bytes of a view of a buffer.
    pub fn view(&self, at: usize) -> Result<&[u8], FormatError> {
        let view = self.entry("bufferViews", at)?;
        let place = || format!("bufferViews {at}");
        let buffer = whole(view, "buffer").and_then(|buffer| self.buffers.get(buffer)?.as_deref());
        let buffer = buffer.ok_or_else(|| fault(place(), "the file does not have its buffer"))?;
        let start = whole(view, "byteOffset").unwrap_or(0);
        let end = whole(view, "byteLength").and_then(|length| start.checked_add(length));
        let bytes = end.and_then(|end| buffer.get(start..end));
        bytes.ok_or_else(|| fault(place(), "it goes beyond the end of its buffer"))
    }

    /// Returns the numbers of an accessor. Normalised integers are converted to 0 to 1.
    pub fn numbers(&self, at: usize) -> Result<AccessorValues, FormatError> {
        let accessor = self.entry("accessors", at)?;
        let stored = self.stored(accessor, &format!("accessors {at}"))?;
        let is_share = accessor.get("normalized").and_then(Value::as_bool) == Some(true);
        let number = |b: &[u8; 4]| {
            let (value, full) = match stored.component {
                5120 => (f32::from(b[0] as i8), 127.0),
                5121 => (f32::from(b[0]), 255.0),
                5122 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
                5123 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
                5125 => (u32::from_le_bytes(*b) as f32, 1.0),
                _ => (f32::from_le_bytes(*b), 1.0),
            };
            if is_share { value / full } else { value }
        };
        Ok(AccessorValues {
            width: stored.width,
            values: stored.numbers.iter().map(number).collect(),
        })
    }

    /// Returns the whole numbers of an accessor of indices.
    pub fn indices(&self, at: usize) -> Result<Vec<u32>, FormatError> {
        let accessor = self.entry("accessors", at)?;
        let place = format!("accessors {at}");
        let stored = self.stored(accessor, &place)?;
        if stored.width != 1 || !matches!(stored.component, 5121 | 5123 | 5125) {
            return Err(fault(place, "it does not number corners"));
        }
        Ok(stored.numbers.iter().map(|number| u32::from_le_bytes(*number)).collect())
    }

    /// Returns the bytes of each number of an accessor, padded with zeros.
    fn stored(&self, accessor: &Value, place: &str) -> Result<Stored, FormatError> {
        let width = match accessor.get("type").and_then(Value::as_str) {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            _ => return Err(fault(place, "its type cannot be read")),
        };
        let component = whole(accessor, "componentType").unwrap_or(0);
        let count = whole(accessor, "count").unwrap_or(0);
        let sparse = accessor.get("sparse");
        let mut numbers = match (accessor.get("bufferView"), sparse) {
            // Numbers that the sparse ones omit are 0.
            (None, Some(_)) if count <= MOST_ZEROS => vec![[0; 4]; count * width],
            (None, Some(_)) => return Err(fault(place, "it has too many numbers that are 0")),
            _ => self.listed(accessor, component, [count, width], place)?,
        };
        if let Some(sparse) = sparse {
            let changed = whole(sparse, "count").unwrap_or(0);
            let part = |key: &str| sparse.get(key).unwrap_or(&Value::Null);
            let places = part("indices");
            let of_places = whole(places, "componentType").unwrap_or(0);
            let places = self.listed(places, of_places, [changed, 1], place)?;
            let values = self.listed(part("values"), component, [changed, width], place)?;
            for (at, value) in places.iter().zip(values.chunks_exact(width)) {
                let at = u32::from_le_bytes(*at) as usize;
                let target = at.checked_mul(width).and_then(|at| numbers.get_mut(at..at + width));
                let target = target.ok_or_else(|| fault(place, "a sparse number is not in it"))?;
                target.copy_from_slice(value);
            }
        }
        Ok(Stored { width, component, numbers })
    }

    /// Returns the bytes of `count` times `width` numbers in the buffer view that `list` names.
    fn listed(
        &self,
        list: &Value,
        component: usize,
        [count, width]: [usize; 2],
        place: &str,
    ) -> Result<Vec<[u8; 4]>, FormatError> {
        let size = match component {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            _ => return Err(fault(place, "its type of numbers is not known")),
        };
        let view_at = whole(list, "bufferView").ok_or_else(|| fault(place, "it is empty"))?;
        let bytes = self.view(view_at)?;
        let start = whole(list, "byteOffset").unwrap_or(0);
        let stride = whole(self.entry("bufferViews", view_at)?, "byteStride");
        let stride = stride.unwrap_or(width * size).max(1);
        let end = count
            .checked_sub(1)
            .map(|last| last.checked_mul(stride)?.checked_add(start)?.checked_add(width * size));
        if end.is_some_and(|end| end.is_none_or(|end| end > bytes.len())) {
            return Err(fault(place, "it goes beyond the end of its view"));
        }
        let mut numbers = Vec::with_capacity(count * width);
        for i in 0..count {
            for k in 0..width {
                let mut number = [0; 4];
                number[..size].copy_from_slice(&bytes[start + i * stride + k * size..][..size]);
                numbers.push(number);
            }
        }
        Ok(numbers)
    }
}

/// Returns the description in a `.glb`, and the buffer that follows it.
fn chunks(file: &[u8]) -> Result<(Value, Option<&[u8]>), FormatError> {
    let mut bytes = Bytes::new(file);
    if !file.starts_with(MAGIC) {
        return Err(bytes.fault("glTF begins with `glTF` or, as text, with `{`"));
    }
    bytes.take(4)?;
    let start = bytes;
    let version = bytes.u32()?;
    if version != 2 {
        return Err(start.fault(format!("glTF version {version} cannot be read, only 2")));
    }
    bytes.u32()?;
    let (mut json, mut binary) = (None, None);
    while !bytes.is_empty() {
        let length = bytes.u32()? as usize;
        let kind = bytes.u32()?;
        let start = bytes;
        let chunk = bytes.take(length)?;
        match kind {
            JSON => {
                let parsed = serde_json::from_slice(chunk);
                json = Some(parsed.map_err(|error| start.fault(error.to_string()))?);
            }
            BIN => binary = Some(chunk),
            _ => {}
        }
    }
    Ok((json.ok_or_else(|| bytes.fault("the file has no description"))?, binary))
}

/// Parses the description of a `.gltf`.
fn description(file: &[u8]) -> Result<Value, FormatError> {
    let json: Value = serde_json::from_slice(file)
        .map_err(|error| fault("the description", printable(&error.to_string())))?;
    let version = json.get("asset").and_then(|asset| asset.get("version"));
    match version.and_then(Value::as_str) {
        Some(version) if version.starts_with("2.") => Ok(json),
        Some(version) => {
            let version = excerpt(version.as_bytes());
            Err(fault("asset", format!("glTF version {version} cannot be read, only 2")))
        }
        None => Err(fault("asset", "it does not say that it is glTF, nor which version")),
    }
}
