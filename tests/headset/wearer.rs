//! The program without its window, in a headset: the turns of its main loop, made by the test itself.
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

/// The scripted head and hands, the editor, and the program in the headset.
pub struct Wearer {
    pub remote: Remote,
    pub workspace: Workspace,
    pub config: Config,
    pub headset: Headset,
    news: Receiver<(Connection, XrEvent)>,
}

impl Wearer {
    /// Looks for a headset from now on. The sculpture is a cube of `dims` voxels; the headset tracks the
    /// head before the screen, too.
    pub fn new(dims: u32) -> Wearer {
        let mut remote = Remote::connect();
        remote.send();
        let mut config = Config::default();
        config.new.dims = [dims; 3];
        config.headset.enabled = true;
        config.tracking.source = "openxr".parse().unwrap();
        let session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        let mut workspace = Workspace::new(session, &config, Bindings::presets().unwrap());
        workspace.start_head();
        let (headset, news) = connect(&config);
        Wearer { remote, workspace, config, headset, news }
    }

    /// Leaves the headset, and looks for it anew.
    pub fn reconnect(&mut self) {
        (self.headset, self.news) = connect(&self.config);
    }

    /// One turn of the main loop; gives how long it took.
    pub fn turn(&mut self) -> Duration {
        let news = self.news.recv_timeout(Duration::from_millis(5));
        let start = Instant::now();
        self.headset.poll(&mut self.workspace);
        if let Ok((connection, news)) = news {
            self.headset.handle(&mut self.workspace, connection, news);
        }
        self.workspace.track();
        let _ = self.workspace.viewpoint.tracked_eyes(0.0);
        start.elapsed()
    }

    /// Turns until something is so; gives how long the longest took. `is_so` is told how long it has
    /// been waited for.
    pub fn until(&mut self, what: &str, is_so: impl Fn(&Wearer, Duration) -> bool) -> Duration {
        let (start, mut longest) = (Instant::now(), Duration::ZERO);
        while !is_so(self, start.elapsed()) {
            assert!(start.elapsed() < PATIENCE, "{what}: in vain; {:?}", self.messages());
            longest = longest.max(self.turn());
        }
        longest
    }

    /// Turns until pictures are shown; gives how long the longest took.
    pub fn until_showing(&mut self) -> Duration {
        self.until("pictures", |wearer, _| wearer.headset.is_showing())
    }

    /// What the person was told.
    pub fn messages(&self) -> Vec<String> {
        self.workspace.ui.toasts.texts().map(|(_, text)| text.to_owned()).collect()
    }
}

fn connect(config: &Config) -> (Headset, Receiver<(Connection, XrEvent)>) {
    let (tell, news) = channel();
    let tell = move |connection, news| tell.send((connection, news)).is_ok();
    (Headset::new(&config.headset, config.device_options(None), None, tell), news)
}
