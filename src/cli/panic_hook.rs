//! The message when an internal error ends the program, with the place of the work.
//!
//! A hook that runs before anything is dropped; it writes every journal to the disk.

use std::time::Duration;

use crate::persist::journal;
use crate::terminal;

/// Longest wait for a disk.
const PATIENCE: Duration = Duration::from_secs(5);

/// Installs the hook: a panic of the main thread syncs the journals and reports their place. Panics of other threads do
/// not end the program: their work fails, and the failure is reported there.
pub fn install() {
    let main = std::thread::current().id();
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let kept = match std::thread::current().id() == main {
            true => journal::sync_all(PATIENCE),
            false => Vec::new(),
        };
        before(panic);
        for path in kept {
            terminal::print_notice(format_args!(
                "This is a fault of the program. The work until then is in the journal {}: the next start offers it, \
                 and `virtual-sculpture recover` lists it",
                path.display()
            ));
        }
    }));
}
