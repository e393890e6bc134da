//! Compiles `shaders/NAME.{vert,frag,comp}.wgsl` to SPIR-V with naga, so that a plain
//! `cargo build` needs no shader tool.
//!
//! Files with another name hold shared definitions: a line `//!include "file.wgsl"` is replaced
//! by that file's text, once per stage. Each stage becomes `pub static NAME_STAGE: &[u32]` in
//! `OUT_DIR/shaders.rs`, and its expanded text `OUT_DIR/NAME.stage.wgsl`, which a test compares
//! with the layouts on the Rust side. The entry point is always `main`.

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
    if let Err(message) = build() {
        eprintln!("{message}");
        std::process::exit(1);
    }
}

fn build() -> Result<(), String> {
    let out = PathBuf::from(env::var("OUT_DIR").map_err(|e| format!("OUT_DIR: {e}"))?);
    let mut table = String::new();
    for (path, stage) in stages(Path::new("shaders"))? {
        let name = file_name(&path);
        let source = Source::expand(&path)?;
        let words = compile(&source, stage)?;
        let constant = name.trim_end_matches(".wgsl").replace(['.', '-'], "_").to_uppercase();
        let _ = writeln!(table, "pub static {constant}: &[u32] = &{words:?};");
        write(&out.join(&name), &source.text)?;
    }
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
        lang_version: (1, 5),
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
        .map_err(|e| source.message(None, &e.to_string()))
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default()
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}
