//! The results of a benchmark: as values for JSON, and as tables.

use std::fmt;

use serde::Serialize;

use super::edits::EditReport;
use super::features::FeatureReport;
use super::files::FileReport;
use super::final_pictures::FinalReport;
use super::machine::Machine;
use super::statistics::Times;

/// The results of a benchmark. Times are in milliseconds.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct BenchReport {
    pub program: String,
    pub suite: String,
    pub machine: Machine,
    /// Size of the pictures in pixels.
    pub picture: [u32; 2],
    /// Number of eyes.
    pub eyes: u32,
    pub scenes: Vec<SceneReport>,
    pub edits: Vec<EditReport>,
    pub peak_memory_bytes: Option<u64>,
}

#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct SceneReport {
    pub name: String,
    pub dims: [u32; 3],
    pub voxels: u64,
    /// Memory of bits and colours.
    pub memory_bytes: u64,
    pub modes: Vec<ModeReport>,
    /// Upload of all bits.
    pub upload: Option<Times>,
    pub final_picture: FinalReport,
    pub files: Vec<FileReport>,
}

/// A mode with a scene.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct ModeReport {
    pub mode: String,
    /// With upload and readback if the device samples.
    pub sample: Times,
    /// The readback of the map, as a part of sampling.
    pub read_back: Option<Times>,
    pub shade: Times,
    pub composite: Option<Times>,
    /// All stages.
    pub frame: Times,
    /// The median frame, divided by that of the exact ray caster.
    pub to_ray: Option<f64>,
    pub device: DeviceReport,
    /// The costs of features of the picture; empty without a device.
    pub features: Vec<FeatureReport>,
    /// The time from subtracting a ball of radius 32 to the shaded picture.
    pub edit_32: Option<Times>,
    /// The time from there to the finished picture; `None` if the device shades.
    pub edit_32_composite: Option<Times>,
    pub edit_64: Option<Times>,
    pub edit_64_composite: Option<Times>,
}

/// The device's own times of whole pictures.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct DeviceReport {
    pub sample: Option<Times>,
    pub shade: Option<Times>,
    pub compose: Option<Times>,
}

impl DeviceReport {
    fn stages(&self) -> [Option<Times>; 3] {
        [self.sample, self.shade, self.compose]
    }
}

impl fmt::Display for BenchReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}, suite {}", self.program, self.suite)?;
        writeln!(f, "{}", self.machine)?;
        let [width, height] = self.picture;
        let eyes = match self.eyes {
            1 => "one eye",
            _ => "two eyes",
        };
        writeln!(f, "\npictures of {width}x{height} for {eyes}; ms: least, median, 99 of 100")?;
        let columns = ["sample", "(read back)", "shade", "composite", "frame"];
        write!(f, "{:<11} {:<14}", "scene", "mode")?;
        for column in columns {
            write!(f, " {column:>20}")?;
        }
        write!(f, " {:>6} {:>26} {:>20}", "to ray", "edit 32", "(composite)")?;
        writeln!(f, " {:>26} {:>20}", "edit 64", "(composite)")?;
        for scene in &self.scenes {
            for mode in &scene.modes {
                write!(f, "{:<11} {:<14}", scene.name, mode.mode)?;
                let stages = [
                    Some(mode.sample),
                    mode.read_back,
                    Some(mode.shade),
                    mode.composite,
                    Some(mode.frame),
                ];
                for times in stages {
                    write!(f, " {:>20}", three(times))?;
                }
                let to_ray = mode.to_ray.map_or("-".to_string(), |ratio| format!("{ratio:.2}"));
                write!(f, " {to_ray:>6}")?;
                let edits = [
                    (mode.edit_32, mode.edit_32_composite),
                    (mode.edit_64, mode.edit_64_composite),
                ];
                for (edit, composite) in edits {
                    let runs = edit.map_or(String::new(), |edit| format!(" x{}", edit.runs));
                    write!(f, " {:>26} {:>20}", three(edit) + &runs, three(composite))?;
                }
                writeln!(f)?;
            }
        }
        self.write_device_times(f)?;
        self.write_features(f)?;
        self.write_final_pictures(f)?;
        writeln!(f, "\n{:<11} {:>14} {:>10} {:>20} files", "scene", "voxels", "MiB", "upload ms")?;
        for scene in &self.scenes {
            let mib = scene.memory_bytes as f64 / f64::from(1 << 20);
            let upload = three(scene.upload);
            write!(f, "{:<11} {:>14} {mib:>10.1} {upload:>20}", scene.name, scene.voxels)?;
            for file in &scene.files {
                let (save, load) = (file.save.median_ms, file.load.median_ms);
                write!(
                    f,
                    " {}: {} bytes, save {save:.1}, load {load:.1};",
                    file.ending, file.bytes
                )?;
            }
            writeln!(f)?;
        }
        if !self.edits.is_empty() {
            writeln!(f, "\n{:<32} {:>12} {:>22} {:>10}", "edit", "voxels", "ms", "voxels/s")?;
        }
        for EditReport { name, voxels, times, voxels_per_s } in &self.edits {
            let times = three(Some(*times));
            writeln!(f, "{name:<32} {voxels:>12} {times:>22} {voxels_per_s:>10.2e}")?;
        }
        match self.peak_memory_bytes {
            Some(bytes) => write!(f, "\nmost memory in use: {} MiB", bytes >> 20),
            None => Ok(()),
        }
    }
}

impl BenchReport {
    /// Writes the device's times; nothing if it has no time stamps.
    fn write_device_times(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let modes = || self.scenes.iter().flat_map(|s| s.modes.iter().map(move |mode| (s, mode)));
        let timed = |mode: &ModeReport| mode.device.stages().iter().any(Option::is_some);
        if !modes().any(|(_, mode)| timed(mode)) {
            return Ok(());
        }
        let [sample, shade, compose] = ["sample", "shade", "compose"];
        write!(f, "\nof these on the device, by its time stamps\n{:<11} {:<14}", "scene", "mode")?;
        writeln!(f, " {sample:>20} {shade:>20} {compose:>20}")?;
        for (scene, mode) in modes().filter(|(_, mode)| timed(mode)) {
            let [sample, shade, compose] = mode.device.stages().map(three);
            write!(f, "{:<11} {:<14}", scene.name, mode.mode)?;
            writeln!(f, " {sample:>20} {shade:>20} {compose:>20}")?;
        }
        Ok(())
    }

    fn write_final_pictures(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\nfinal pictures; s")?;
        let columns = ["samples", "prepare", "trace", "denoise"];
        write!(f, "{:<11} {:<14}", "scene", "surface")?;
        columns.iter().try_for_each(|column| write!(f, " {column:>8}"))?;
        writeln!(f)?;
        for SceneReport { name, final_picture, .. } in &self.scenes {
            let FinalReport { samples, smooth, prepare_s, trace_s, denoise_s } = final_picture;
            let surface = if *smooth { "smooth" } else { "voxels" };
            write!(f, "{name:<11} {surface:<14} {samples:>8} {prepare_s:>8.2} {trace_s:>8.2}")?;
            writeln!(f, " {denoise_s:>8.2}")?;
        }
        Ok(())
    }

    /// Writes a column for each feature of any mode.
    fn write_features(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let modes = || self.scenes.iter().flat_map(|s| s.modes.iter().map(move |mode| (s, mode)));
        let mut names: Vec<&str> = Vec::new();
        for feature in modes().flat_map(|(_, mode)| &mode.features) {
            if !names.contains(&feature.name.as_str()) {
                names.push(&feature.name);
            }
        }
        if names.is_empty() {
            return Ok(());
        }
        writeln!(f, "\nwhat features add to a whole picture, median ms")?;
        write!(f, "{:<11} {:<14}", "scene", "mode")?;
        names.iter().try_for_each(|name| write!(f, " {name:>14}"))?;
        writeln!(f)?;
        for (scene, mode) in modes() {
            write!(f, "{:<11} {:<14}", scene.name, mode.mode)?;
            for name in &names {
                match mode.features.iter().find(|feature| feature.name == *name) {
                    Some(feature) => write!(f, " {:>14.2}", feature.more_ms)?,
                    None => write!(f, " {:>14}", "-")?,
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Formats minimum, median and 99th percentile.
fn three(times: Option<Times>) -> String {
    times.map_or("-".to_string(), |t| format!("{:.2} {:.2} {:.2}", t.min_ms, t.median_ms, t.p99_ms))
}
