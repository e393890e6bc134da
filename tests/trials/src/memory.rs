//! The memory of the running process, as the system reports it.

/// Returns the most memory that the process has used, in MiB; `None` where the system does not report it.
pub fn peak_mib() -> Option<u64> {
    status_kib("VmHWM:").map(|kib| kib >> 10)
}

/// Returns the memory that the process uses, in MiB; `None` where the system does not report it.
pub fn resident_mib() -> Option<u64> {
    status_kib("VmRSS:").map(|kib| kib >> 10)
}

/// Returns a size from the status of the process.
pub(crate) fn status_kib(field: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(field))?;
    line.trim().strip_suffix(" kB")?.trim().parse().ok()
}
