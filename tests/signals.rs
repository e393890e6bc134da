//! Which signals end a program that the tests start: not those that the tests themselves were started to ignore, in the
//! background of a shell or under `nohup`, as children inherit that.

/// Those of SIGTERM, SIGINT and SIGHUP that are not ignored, as options of `kill`.
pub fn heeded() -> Vec<&'static str> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = mask.map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap());
    let signals = [("-TERM", 15), ("-INT", 2), ("-HUP", 1)];
    let (heeded, others): (Vec<_>, Vec<_>) =
        signals.into_iter().partition(|(_, number)| ignored >> (number - 1) & 1 == 0);
    if !others.is_empty() {
        eprintln!("not tried, since they are ignored here: {others:?}");
    }
    heeded.into_iter().map(|(signal, _)| signal).collect()
}
