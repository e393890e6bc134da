//! Owns the program in a headset: connecting and trying again, and one frame read aloud.
//!
//! The headset has a device and a renderer of its own beside the window's; both show the one
//! sculpture of the one workspace. Whatever happens to the runtime, the workspace and the window go
//! on.

pub mod alone;
mod face;
mod overlay;
mod pane;
mod presence;
mod search;
mod shots;

#[cfg(test)]
mod hands_tests;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::workspace::Workspace;
use crate::gpu::{DeviceOptions, ValidationLog};
use crate::screen::headset::{HeadsetError, HeadsetOptions, LinkNews, LinkOptions};

use presence::Presence;
use search::{Search, Wanted};
use shots::Shots;

/// How long to wait before a runtime is looked for again.
const AGAIN: Duration = Duration::from_secs(2);
/// Longest time between two tries with a device that lacks memory.
const LONGEST_AGAIN: Duration = Duration::from_secs(64);
/// How often it is seen to that a runtime answers.
const POLL: Duration = Duration::from_millis(100);

/// Which connection news belongs to: each has another number.
pub type Connection = u64;

/// Tells of a connection's news on another thread; says whether anybody still listens.
type Tell = Arc<dyn Fn(Connection, LinkNews) -> bool + Send + Sync>;

/// The link to a headset, or the wait for one.
pub struct Headset {
    state: State,
    connection: Connection,
    settings: HeadsetOptions,
    options: LinkOptions,
    shots: Option<Shots>,
    /// What was last said of why there is no headset, so that it is said once.
    said: String,
    /// Until the next try, should this connection fail.
    pause: Duration,
    tell: Tell,
    search: Option<Search>,
    started: Instant,
    /// The sculpture has stood in a headset before.
    stood: bool,
    /// What the validation layers have said of connections that are over.
    complaints: usize,
}

enum State {
    /// Looked for again at this time.
    Away(Instant),
    /// Being looked for.
    Sought,
    Here(Box<Presence>),
    /// The person has left the program in the headset.
    Left,
}

impl Headset {
    /// `tell` is called on another thread with news, to be given to [`Headset::hear`]; it says
    /// whether anybody still listens. `shots`: a folder for pictures
    /// of what the eyes see.
    pub fn new(
        options: &HeadsetOptions,
        device: DeviceOptions,
        shots: Option<PathBuf>,
        tell: impl Fn(Connection, LinkNews) -> bool + Send + Sync + 'static,
    ) -> Headset {
        let started = Instant::now();
        Headset {
            state: State::Away(started),
            connection: 0,
            settings: options.clone(),
            options: options.link(device),
            shots: shots.map(Shots::new),
            said: String::new(),
            pause: AGAIN,
            tell: Arc::new(tell),
            search: None,
            started,
            stood: false,
            complaints: 0,
        }
    }

    /// Looks for a headset if it is time, and sees to it that its runtime answers. Gives when to be
    /// called again at the latest; never, once the person has left.
    pub fn poll(&mut self, workspace: &mut Workspace) -> Option<Instant> {
        let now = Instant::now();
        if let State::Away(again) = self.state
            && now >= again
        {
            self.seek(workspace);
        }
        self.take_found(workspace);
        if let State::Here(presence) = &mut self.state
            && presence.falls_silent(workspace)
        {
            let text = "The headset's runtime does not respond";
            tracing::warn!("{text}");
            workspace.ui.toasts.error(text);
        }
        match &self.state {
            State::Away(again) => Some(*again),
            State::Sought | State::Here(_) => Some(now + POLL),
            State::Left => None,
        }
    }

    /// Hears what was told of a connection; makes the frame that is to be made.
    pub fn hear(&mut self, workspace: &mut Workspace, connection: Connection, news: LinkNews) {
        if connection != self.connection {
            return;
        }
        let now_s = self.started.elapsed().as_secs_f64();
        let State::Here(presence) = &mut self.state else { return };
        match news {
            LinkNews::Frame(frame) => {
                if let Err(error) = presence.frame(workspace, &frame, &mut self.shots, now_s) {
                    self.lose(workspace, &error);
                }
            }
            LinkNews::Recentred => presence.recentre(),
            LinkNews::Over { again: true } => {
                self.lose(workspace, &HeadsetError::Lost("the runtime ends"));
            }
            LinkNews::Over { again: false } => {
                self.part(workspace);
                let text = "The headset session has ended; start the program with --headset to return to it";
                tracing::info!("{text}");
                workspace.ui.toasts.note(text);
            }
            LinkNews::Failed(error) => self.lose(workspace, &error),
            // It is taken by `poll`.
            LinkNews::Tried => {}
        }
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

    /// Has the headset looked for, on another thread.
    fn seek(&mut self, workspace: &mut Workspace) {
        self.connection += 1;
        self.options.blend = workspace.ui.headset.blend;
        let wanted = Wanted {
            connection: self.connection,
            settings: self.settings.clone(),
            options: self.options.clone(),
            stood: self.stood,
            worn: workspace.viewpoint.head.worn().cloned(),
            view: workspace.ui.view.clone(),
            depth: workspace.session().document().material().depth(),
        };
        if self.search.is_none() {
            match Search::start(self.tell.clone()) {
                Ok(search) => self.search = Some(search),
                Err(error) => return self.lose(workspace, &HeadsetError::Thread(error)),
            }
        }
        if let Some(search) = &self.search {
            search.seek(wanted);
        }
        self.state = State::Sought;
    }

    /// Takes the headset that was found, or hears why there is none.
    fn take_found(&mut self, workspace: &mut Workspace) {
        if !matches!(self.state, State::Sought) {
            return;
        }
        let Some(found) = self.search.as_ref().and_then(Search::found) else { return };
        let (connection, tell) = (self.connection, self.tell.clone());
        let started = found.and_then(|mut presence| {
            presence.start(move |news| tell(connection, news)).map(|()| presence)
        });
        match started {
            Ok(presence) => {
                let text = format!("Headset connected: {}", presence.name());
                tracing::info!("{text}");
                workspace.ui.toasts.note(text);
                self.said.clear();
                workspace.display.blends = presence.blends();
                workspace.ui.view.suit_device(presence.is_software());
                self.state = State::Here(presence);
            }
            Err(error) => self.lose(workspace, &error),
        }
    }

    /// There is no headset, or no longer: says why, once, and looks for it again later. A device
    /// that lacks memory will still lack it in a moment.
    fn lose(&mut self, workspace: &mut Workspace, error: &HeadsetError) {
        self.part(workspace);
        self.pause = match error {
            HeadsetError::Gpu(_) => (self.pause * 2).min(LONGEST_AGAIN),
            _ => AGAIN,
        };
        let (reason, pause) = (error.to_string(), self.pause);
        if self.said != reason {
            tracing::warn!("no headset: {reason}; trying again every {pause:?}");
            workspace.ui.toasts.error(format!("No headset: {reason}. Still looking for one."));
            self.said = reason;
        }
        self.state = State::Away(Instant::now() + pause);
    }

    /// Lets go of what hands hold, and of the connection.
    fn part(&mut self, workspace: &mut Workspace) {
        if let State::Here(mut presence) = std::mem::replace(&mut self.state, State::Left) {
            presence.let_go(workspace);
            workspace.display.blends.clear();
            self.stood |= presence.has_stood();
            let log = presence.validation_log();
            drop(presence);
            self.complaints += log.messages().len();
        }
    }
}
