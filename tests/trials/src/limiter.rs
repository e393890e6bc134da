//! Limits the memory of the running process, for tests of what happens without: such a test runs [`alone`](crate::alone).

use std::io::{BufReader, Read, Write};
use std::process::{Child, ChildStdout, Command, Stdio};

/// Limits the address space of this process. A process of its own does so: once there is a limit, this one may have no
/// memory to start another.
pub struct Limiter {
    shell: Child,
    done: BufReader<ChildStdout>,
}

impl Limiter {
    /// Sets no limit yet. Panics if there is no shell.
    pub fn start() -> Limiter {
        let set = format!("prlimit --pid {} --as=$most:unlimited && echo done", std::process::id());
        let mut shell = Command::new("sh")
            .args(["-c", &format!("while read most; do {set}; done")])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let done = BufReader::new(shell.stdout.take().unwrap());
        Limiter { shell, done }
    }

    /// Allows this much more than is in use, in MiB.
    pub fn limit(&mut self, more_mib: u64) {
        // A thread that has just started reserves 64 MiB for its heap. If it does so after the size was read, nothing is
        // left: the limit is right once the size has not changed around it.
        loop {
            let used_kib = address_space_kib();
            self.set(&(used_kib * 1024 + (more_mib << 20)).to_string());
            if address_space_kib() == used_kib {
                return;
            }
            self.lift();
        }
    }

    /// Allows as much as there is.
    pub fn lift(&mut self) {
        self.set("unlimited");
    }

    /// Does `work` under a limit.
    pub fn within<T>(&mut self, more_mib: u64, work: impl FnOnce() -> T) -> T {
        self.limit(more_mib);
        let done = work();
        self.lift();
        done
    }

    fn set(&mut self, most: &str) {
        writeln!(self.shell.stdin.as_ref().unwrap(), "{most}").unwrap();
        let mut answer = [0; 5];
        self.done.read_exact(&mut answer).unwrap();
        assert_eq!(&answer, b"done\n");
    }
}

impl Drop for Limiter {
    fn drop(&mut self) {
        // The end of its input ends the shell.
        drop(self.shell.stdin.take());
        let _ = self.shell.wait();
    }
}

fn address_space_kib() -> u64 {
    crate::memory::status_kib("VmSize:").unwrap()
}
