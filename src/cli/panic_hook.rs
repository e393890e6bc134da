//! The program's message when a fault of its own ends it: where the work is.
//!
//! A hook that runs before anything else is torn down; it puts every journal on the disk.

use std::time::Duration;

use crate::persist::journal;
use crate::terminal;

/// How long a disk may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// From now on a panic of the main thread syncs the journals and says where they are. Panics of other threads do not
/// end the program: their work has failed, and the failure is reported there.
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
