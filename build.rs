//! Compiles `shaders/NAME.{vert,frag,comp}.wgsl` to SPIR-V with naga, so that a plain
//! `cargo build` needs no shader tool.
//!
//! Files with another name hold shared definitions: a line `//!include "file.wgsl"` is replaced
//! by that file's text, once per stage. Each stage becomes `pub static NAME_STAGE: &[u32]` in
//! `OUT_DIR/shaders.rs` (with a list of them all, `ALL`, for tests), and its expanded text `OUT_DIR/NAME.stage.wgsl`, which a test compares
//! with the layouts on the Rust side. The entry point is always `main`.
//!
//! Also gives the program the commit that it is built from.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use naga::ShaderStage;
use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=shaders");
    let commit = commit().unwrap_or_else(|| "unknown".to_string());
    println!("cargo:rustc-env=VIRTUAL_SCULPTURE_COMMIT={commit}");
    if let Err(message) = build() {
        eprintln!("{message}");
        std::process::exit(1);
    }
}

/// The commit that is checked out, read without git. Known in release builds of a clone; other builds would compile
/// the program anew after each commit.
fn commit() -> Option<String> {
    if env::var("PROFILE").ok()? != "release" {
        return None;
    }
    let folder = Path::new(".git");
    let read = |name: &str| {
        let path = folder.join(name);
        let text = fs::read_to_string(&path).ok()?;
        println!("cargo:rerun-if-changed={}", path.display());
        Some(text.trim().to_string())
    };
    let head = read("HEAD")?;
    let Some(name) = head.strip_prefix("ref: ") else { return Some(head) };
    read(name).or_else(|| {
        let packed = read("packed-refs")?;
        let line = packed.lines().find(|line| line.ends_with(&format!(" {name}")))?;
        line.split(' ').next().map(str::to_string)
    })
}

fn build() -> Result<(), String> {
    let out = PathBuf::from(env::var("OUT_DIR").map_err(|e| format!("OUT_DIR: {e}"))?);
    let mut table = String::new();
    let mut all = String::new();
    for (path, stage) in stages(Path::new("shaders"))? {
        let name = file_name(&path);
        let source = Source::expand(&path)?;
        let words = compile(&source, stage)?;
        let constant = name.trim_end_matches(".wgsl").replace(['.', '-'], "_").to_uppercase();
        let _ = writeln!(table, "pub static {constant}: &[u32] = &{words:?};");
        let _ = writeln!(all, "(\"{name}\", {constant}),");
        write(&out.join(&name), &source.text)?;
    }
    let _ = writeln!(table, "#[cfg(test)]\nstatic ALL: &[(&str, &[u32])] = &[\n{all}];");
    write(&out.join("shaders.rs"), &table)
}

/// The files that are stages, in the order of their names.
fn stages(folder: &Path) -> Result<Vec<(PathBuf, ShaderStage)>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.map_err(|e| format!("{}: {e}", folder.display()))?.path();
        println!("cargo:rerun-if-changed={}", path.display());
        let name = file_name(&path);
        let stage = match name.rsplit('.').nth(1) {
            Some("vert") => ShaderStage::Vertex,
            Some("frag") => ShaderStage::Fragment,
            Some("comp") => ShaderStage::Compute,
            _ => continue,
        };
        found.push((path, stage));
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(found)
}

/// A stage's text with its includes, and where each line comes from.
struct Source {
    path: PathBuf,
    text: String,
    origin: Vec<(PathBuf, usize)>,
}

impl Source {
    fn expand(path: &Path) -> Result<Source, String> {
        let mut source =
            Source { path: path.to_path_buf(), text: String::new(), origin: Vec::new() };
        source.append(path, &mut BTreeSet::new())?;
        Ok(source)
    }

    fn append(&mut self, path: &Path, seen: &mut BTreeSet<PathBuf>) -> Result<(), String> {
        if !seen.insert(path.to_path_buf()) {
            return Ok(());
        }
        let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        for (index, line) in text.lines().enumerate() {
            if let Some(name) = line.strip_prefix("//!include ") {
                let included = path.with_file_name(name.trim().trim_matches('"'));
                self.append(&included, seen)
                    .map_err(|e| format!("{}:{}: {e}", path.display(), index + 1))?;
            } else {
                self.text.push_str(line);
                self.text.push('\n');
                self.origin.push((path.to_path_buf(), index + 1));
            }
        }
        Ok(())
    }

    /// Whether the file of that name is part of it.
    fn includes(&self, name: &str) -> bool {
        self.origin.iter().any(|(path, _)| path.ends_with(name))
    }

    /// A message with the file and line that `location` of the expanded text came from.
    fn message(&self, location: Option<naga::SourceLocation>, text: &str) -> String {
        let place = location
            .and_then(|l| self.origin.get((l.line_number as usize).saturating_sub(1)))
            .map_or_else(
                || self.path.display().to_string(),
                |(path, line)| format!("{}:{line}", path.display()),
            );
        format!("{place}: {text}")
    }
}

fn compile(source: &Source, stage: ShaderStage) -> Result<Vec<u32>, String> {
    let module = naga::front::wgsl::parse_str(&source.text)
        .map_err(|e| source.message(e.location(&source.text), &e.emit_to_string(&source.text)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::IMMEDIATES)
        .validate(&module)
        .map_err(|e| {
        source.message(e.location(&source.text), &e.emit_to_string(&source.text))
    })?;
    let options = spv::Options {
        // The last version in which variables of functions may be of a type with offsets, which naga
        // gives every structure; from 1.5 on only buffers and push constants may.
        lang_version: (1, 4),
        // Clip space and depth are handled by the projection, not by naga.
        flags: spv::WriterFlags::DEBUG,
        // Without a map of bindings naga takes those of the source.
        fake_missing_bindings: true,
        // Every loop here ends by a counter, and every fetch is checked where it can stray.
        force_loop_bounding: false,
        emit_int_div_checks: false,
        ..spv::Options::default()
    };
    let entry = spv::PipelineOptions { shader_stage: stage, entry_point: "main".to_string() };
    spv::write_vec(&module, &info, &options, Some(&entry))
        .map(specialise)
        .map(|words| if source.includes(EXACT) { uncontracted(words) } else { words })
        .map_err(|e| source.message(None, &e.to_string()))
}

/// Literals from this one on stand for the specialization constants from 0 on, which naga does not
/// write.
const FIRST_SPECIALISED: u32 = 0x5bec_0000;
const MAX_SPECIALISED: u32 = 16;

/// The shared file whose arithmetic must be that of its twin on the CPU.
const EXACT: &str = "ray.wgsl";

const OP_DECORATE: u32 = 71;

/// The instructions of a module: their place, length in words, and operation.
fn instructions(words: &[u32]) -> impl Iterator<Item = (usize, usize, u32)> {
    const HEADER_WORDS: usize = 5;
    let mut at = HEADER_WORDS;
    std::iter::from_fn(move || {
        let first = *words.get(at)?;
        let (place, length) = (at, (first >> 16) as usize);
        at += length.max(1);
        Some((place, length, first & 0xffff))
    })
}

/// Adds these decorations where annotations are: before the types, of which the first are 19 to 33.
fn annotate(words: &mut Vec<u32>, decorations: Vec<u32>) {
    let is_annotation = |operation| matches!(operation, OP_DECORATE | 72 | 19..=33);
    let place = instructions(words).find(|(_, _, operation)| is_annotation(*operation));
    let place = place.map_or(words.len(), |(place, ..)| place);
    words.splice(place..place, decorations);
}

/// Turns the constants of these literals into specialization constants (SPIR-V 1.5, 3.42).
fn specialise(mut words: Vec<u32>) -> Vec<u32> {
    const OP_CONSTANT: u32 = 43;
    const OP_SPEC_CONSTANT: u32 = 50;
    const SPEC_ID: u32 = 1;
    let found: Vec<(usize, u32)> = instructions(&words)
        .filter(|(_, length, operation)| (*operation, *length) == (OP_CONSTANT, 4))
        .map(|(at, ..)| (at, words[at + 3].wrapping_sub(FIRST_SPECIALISED)))
        .filter(|(_, number)| *number < MAX_SPECIALISED)
        .collect();
    let mut decorations = Vec::new();
    for (at, number) in found {
        words[at] = 4 << 16 | OP_SPEC_CONSTANT;
        words[at + 3] = 0;
        decorations.extend([4 << 16 | OP_DECORATE, words[at + 2], SPEC_ID, number]);
    }
    annotate(&mut words, decorations);
    words
}

/// Forbids that a product and a sum be rounded as one (SPIR-V 1.5, 3.20, `NoContraction`): then both are rounded like
/// those of the CPU, and rays along the edges of voxels find the same voxels.
fn uncontracted(mut words: Vec<u32>) -> Vec<u32> {
    const NO_CONTRACTION: u32 = 42;
    /// Sums, differences, products, of vectors and numbers, too, and dot products.
    const ARITHMETIC: [u32; 5] = [129, 131, 133, 142, 148];
    let results = instructions(&words)
        .filter(|(_, _, operation)| ARITHMETIC.contains(operation))
        .map(|(at, ..)| words[at + 2]);
    let decorations =
        results.flat_map(|result| [3 << 16 | OP_DECORATE, result, NO_CONTRACTION]).collect();
    annotate(&mut words, decorations);
    words
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}
