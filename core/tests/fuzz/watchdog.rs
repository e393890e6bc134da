//! Ends the tests if one damaged input is worked on for too long: a hang would otherwise stop the whole suite, and say
//! nothing of what it hangs on.

use std::process::abort;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// Longest time for one input: all of a target take seconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// Watches one target, until it is dropped.
pub struct Watchdog {
    inputs: Sender<Input>,
}

/// What is worked on from now on.
struct Input {
    name: String,
    bytes: Vec<u8>,
}

impl Watchdog {
    /// `keep` stores an input and returns where.
    pub fn new(keep: impl Fn(&str, &[u8]) -> String + Send + 'static) -> Watchdog {
        let (inputs, next) = channel::<Input>();
        std::thread::spawn(move || {
            let Ok(mut input) = next.recv() else { return };
            loop {
                input = match next.recv_timeout(PATIENCE) {
                    Ok(next) => next,
                    Err(RecvTimeoutError::Disconnected) => return,
                    Err(RecvTimeoutError::Timeout) => {
                        let Input { name, bytes } = input;
                        let path = keep(&name, &bytes);
                        eprintln!("{name}: not done in {} seconds: {path}", PATIENCE.as_secs());
                        abort();
                    }
                };
            }
        });
        Watchdog { inputs }
    }

    /// Work on another input begins.
    pub fn begin(&self, name: String, bytes: &[u8]) {
        let input = Input { name, bytes: bytes.to_vec() };
        self.inputs.send(input).expect("the watchdog lives as long as this");
    }
}
