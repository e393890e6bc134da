//! Owns the program in a headset: connecting and trying again, and one frame read aloud.
//!
//! The headset has a device and a renderer of its own beside the window's; both show the one
//! sculpture of the one workbench. Whatever happens to the runtime, the workbench and the window go
//! on.

pub mod alone;
mod face;
mod guides;
mod hands;
mod pane;
mod presence;
mod shots;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::workbench::Workbench;
use crate::config::{Config, HeadsetSettings};
use crate::gpu::ValidationLog;
use crate::screen::headset::{FrameNews, HeadsetError, LinkOptions, Standing};

use presence::Presence;
use shots::Shots;

/// How long to wait before a runtime is looked for again.
const AGAIN: Duration = Duration::from_secs(2);
/// How often a runtime is asked for events while it shows no frames.
const POLL: Duration = Duration::from_millis(100);

/// Which connection news belongs to: each has another number.
pub type Connection = u64;

/// The link to a headset, or the wait for one.
pub struct Headset {
    state: State,
    connection: Connection,
    settings: HeadsetSettings,
    options: LinkOptions,
    shots: Option<Shots>,
    /// What was last said of why there is no headset, so that it is said once.
    said: String,
    tell: Arc<dyn Fn(Connection, FrameNews) -> bool + Send + Sync>,
    started: Instant,
    /// The sculpture has stood in a headset before.
    stood: bool,
    /// What the validation layers have said of connections that are over.
    complaints: usize,
}

enum State {
    /// Looked for again at this time.
    Away(Instant),
    Here(Box<Presence>),
    /// The person has left the program in the headset.
    Left,
}

impl Headset {
    /// `tell` is called on another thread with frames that may be made, to be given to
    /// [`Headset::frame`]; it says whether anybody still listens. `shots`: a folder for pictures
    /// of what the eyes see.
    pub fn new(
        config: &Config,
        shots: Option<PathBuf>,
        tell: impl Fn(Connection, FrameNews) -> bool + Send + Sync + 'static,
    ) -> Headset {
        let started = Instant::now();
        Headset {
            state: State::Away(started),
            connection: 0,
            settings: config.headset.clone(),
            options: config.headset.link(config.device_options()),
            shots: shots.map(Shots::new),
            said: String::new(),
            tell: Arc::new(tell),
            started,
            stood: false,
            complaints: 0,
        }
    }

    /// Connects if it is time, hears the runtime, asks for frames. Gives when to be called again at
    /// the latest; never, once the person has left.
    pub fn poll(&mut self, bench: &mut Workbench) -> Option<Instant> {
        let now = Instant::now();
        if let State::Away(again) = self.state
            && now >= again
        {
            self.connect(bench);
        }
        if let State::Here(presence) = &mut self.state {
            let standing = presence.poll();
            self.stand(bench, standing);
        }
        match &self.state {
            State::Away(again) => Some(*again),
            State::Here(_) => Some(now + POLL),
            State::Left => None,
        }
    }

    /// Makes the frame that was told of.
    pub fn frame(&mut self, bench: &mut Workbench, connection: Connection, news: FrameNews) {
        if connection != self.connection {
            return;
        }
        let now_s = self.started.elapsed().as_secs_f64();
        let State::Here(presence) = &mut self.state else { return };
        let made = news.and_then(|frame| presence.frame(bench, &frame, &mut self.shots, now_s));
        // The next one is asked for only now: none queues up.
        let standing = made.and_then(|()| presence.poll());
        self.stand(bench, standing);
    }

    /// Whether somebody looks at the sculpture through the headset.
    pub fn is_showing(&self) -> bool {
        matches!(&self.state, State::Here(presence) if presence.is_showing())
    }

    /// Whether the person has left the program in the headset.
    pub fn is_left(&self) -> bool {
        matches!(self.state, State::Left)
    }

    /// Messages of the validation layers so far.
    pub fn complaints(&self) -> usize {
        let count = |log: Arc<ValidationLog>| log.messages().len();
        match &self.state {
            State::Here(presence) => self.complaints + count(presence.validation_log()),
            _ => self.complaints,
        }
    }

    fn connect(&mut self, bench: &mut Workbench) {
        self.connection += 1;
        let (connection, tell) = (self.connection, self.tell.clone());
        let tell = move |news| tell(connection, news);
        let worn = bench.worn_head();
        self.options.blend = bench.ui.blend;
        match Presence::new(&self.settings, &self.options, self.stood, worn, tell) {
            Ok(presence) => {
                let text = format!("Headset connected: {}", presence.name());
                tracing::info!("{text}");
                bench.ui.toasts.note(text);
                self.said.clear();
                bench.ui.blends = presence.blends();
                self.state = State::Here(Box::new(presence));
            }
            Err(error) => self.lose(bench, &error),
        }
    }

    /// Goes on as the session stands.
    fn stand(&mut self, bench: &mut Workbench, standing: Result<Standing, HeadsetError>) {
        match standing {
            Ok(Standing::Going) => {}
            Ok(Standing::Recentred) => {
                if let State::Here(presence) = &mut self.state {
                    presence.recentre();
                }
            }
            Ok(Standing::Over { again: true }) => {
                self.lose(bench, &HeadsetError::Lost("the runtime ends"));
            }
            Ok(Standing::Over { again: false }) => {
                self.part(bench);
                self.state = State::Left;
                let text = "The headset session has ended; start the program with --headset to return to it";
                tracing::info!("{text}");
                bench.ui.toasts.note(text);
            }
            Err(error) => self.lose(bench, &error),
        }
    }

    /// There is no headset, or no longer: says why, once, and looks for it again later.
    fn lose(&mut self, bench: &mut Workbench, error: &HeadsetError) {
        self.part(bench);
        let reason = error.to_string();
        if self.said != reason {
            tracing::warn!("no headset: {reason}; trying again every {AGAIN:?}");
            bench.ui.toasts.error(format!("No headset: {reason}. Still looking for one."));
            self.said = reason;
        }
        self.state = State::Away(Instant::now() + AGAIN);
    }

    /// Lets go of what hands hold, and of the connection.
    fn part(&mut self, bench: &mut Workbench) {
        if let State::Here(mut presence) = std::mem::replace(&mut self.state, State::Left) {
            presence.let_go(bench);
            bench.ui.blends.clear();
            self.stood |= presence.has_stood();
            let log = presence.validation_log();
            drop(presence);
            self.complaints += log.messages().len();
        }
    }
}
