//! Ends the tests if one damaged input takes too long: a hang would otherwise stop the whole suite without naming its
//! input.

use std::process::abort;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// The longest time for one input: all inputs of a target take seconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// Watches one target until it is dropped.
pub struct Watchdog {
    inputs: Sender<Input>,
}

/// The input that is processed from now on.
struct Input {
    name: String,
    bytes: Vec<u8>,
}

impl Watchdog {
    /// Starts a watchdog. `keep` stores an input and returns its path.
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

    /// Begins work on another input.
    pub fn begin(&self, name: String, bytes: &[u8]) {
        let input = Input { name, bytes: bytes.to_vec() };
        self.inputs.send(input).expect("the watchdog lives as long as this");
    }
}
