//! The description of the machine in a benchmark.

use std::fmt;
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use crate::gpu::Device;

#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Machine {
    /// The name of the processor.
    pub processor: String,
    /// Number of threads that the kernels use.
    pub threads: usize,
    /// Vector instructions that the kernels use.
    pub vectors: String,
    /// Bytes read and written per second by a memory copy on all threads.
    pub copy_bytes_per_s: f64,
    /// Vulkan device and driver, or the reason why there is none.
    pub vulkan: String,
    pub os: &'static str,
    /// Load average of the last minute: a quiet machine has less than 1 besides the benchmark.
    pub load: Option<f64>,
}

impl Machine {
    pub fn survey(device: Result<&Arc<Device>, String>) -> Machine {
        Machine {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_string()),
            threads: rayon::current_num_threads(),
            vectors: vectors(),
            copy_bytes_per_s: copy_bytes_per_s(),
            vulkan: device.map_or_else(|why| format!("none: {why}"), |d| d.device_name()),
            os: std::env::consts::OS,
            load: load(),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Machine { processor, threads, vectors, copy_bytes_per_s, vulkan, os, load } = self;
        writeln!(f, "processor: {processor}, {threads} threads, {vectors}, {os}")?;
        if let Some(load) = load {
            writeln!(f, "load before: {load:.2}")?;
        }
        writeln!(f, "memory: {:.1} GB/s copied", copy_bytes_per_s * 1e-9)?;
        write!(f, "vulkan: {vulkan}")
    }
}

/// Returns the name of the first processor, which Linux has in a file; unknown elsewhere.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_string())
}

fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

fn vectors() -> String {
    let level = format!("{:?}", fearless_simd::Level::new());
    level.split('(').next().unwrap_or_default().to_lowercase()
}

/// Returns the fastest of several copies between two buffers larger than any cache, in bytes per second.
fn copy_bytes_per_s() -> f64 {
    const BYTES: usize = 128 << 20;
    let from = vec![1u64; BYTES / 8];
    let mut to = vec![0u64; BYTES / 8];
    let part = to.len().div_ceil(rayon::current_num_threads() * 4);
    let copy = |to: &mut Vec<u64>| {
        let start = Instant::now();
        let parts = to.par_chunks_mut(part).zip(from.par_chunks(part));
        parts.for_each(|(to, from)| to.copy_from_slice(from));
        start.elapsed().as_secs_f64()
    };
    let best = (0..5).map(|_| copy(&mut to)).fold(f64::INFINITY, f64::min);
    2.0 * BYTES as f64 / best
}

/// Returns the peak memory of the process in bytes, which Linux has in a file.
pub fn peak_memory_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}
