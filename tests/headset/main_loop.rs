//! The program in a headset without its window: the iterations of its main loop, run by the test itself.
//! For clients of a runtime ([`super::runtime::Runtime::run_client`]).

use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use virtual_sculpture::app::Workspace;
use virtual_sculpture::app::headset::{Connection, Headset};
use virtual_sculpture::config::Config;
use virtual_sculpture::input::Bindings;
use virtual_sculpture::screen::headset::XrEvent;
use virtual_sculpture::session::Session;

use super::program::PATIENCE;
use super::remote::Remote;

/// The scripted headset, the workspace, and the program in the headset.
pub struct MainLoop {
    pub remote: Remote,
    pub workspace: Workspace,
    pub config: Config,
    pub headset: Headset,
    events: Receiver<(Connection, XrEvent)>,
}

impl MainLoop {
    /// Connects to a headset. The sculpture is a cube of `dims` voxels; the headset also tracks the head for
    /// the view of the window.
    pub fn new(dims: u32) -> MainLoop {
        let mut remote = Remote::connect();
        remote.send();
        let mut config = Config::default();
        config.new.dims = [dims; 3];
        config.headset.enabled = true;
        config.tracking.source = "openxr".parse().unwrap();
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        let mut workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
        workspace.start_head();
        let (headset, events) = connect(&config);
        MainLoop { remote, workspace, config, headset, events }
    }

    /// Ends the session and connects again.
    pub fn reconnect(&mut self) {
        (self.headset, self.events) = connect(&self.config);
    }

    /// One iteration of the main loop; returns its duration.
    pub fn iterate(&mut self) -> Duration {
        let event = self.events.recv_timeout(Duration::from_millis(5));
        let start = Instant::now();
        self.headset.poll(&mut self.workspace);
        if let Ok((connection, event)) = event {
            self.headset.handle(&mut self.workspace, connection, event);
        }
        self.workspace.track();
        let _ = self.workspace.viewpoint.tracked_eyes(0.0);
        start.elapsed()
    }

    /// Iterates until `is_so` holds, which receives the time since the start; returns the duration of the
    /// longest iteration.
    pub fn until(&mut self, what: &str, is_so: impl Fn(&MainLoop, Duration) -> bool) -> Duration {
        let (start, mut longest) = (Instant::now(), Duration::ZERO);
        while !is_so(self, start.elapsed()) {
            assert!(start.elapsed() < PATIENCE, "waited in vain for {what}: {:?}", self.messages());
            longest = longest.max(self.iterate());
        }
        longest
    }

    /// Iterates until pictures are shown; returns the duration of the longest iteration.
    pub fn until_showing(&mut self) -> Duration {
        self.until("pictures", |main, _| main.headset.is_showing())
    }

    /// The messages shown to the person.
    pub fn messages(&self) -> Vec<String> {
        self.workspace.ui.toasts.texts().map(|(_, text)| text.to_owned()).collect()
    }
}

fn connect(config: &Config) -> (Headset, Receiver<(Connection, XrEvent)>) {
    let (send, events) = channel();
    let send = move |connection, event| send.send((connection, event)).is_ok();
    (Headset::new(&config.headset, config.device_options(None), None, send), events)
}
