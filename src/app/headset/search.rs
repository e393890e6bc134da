//! Owns the thread that looks for a headset: connecting, and making all that draws into it, may
//! take a second, for which no window is to wait.

use std::io;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use super::presence::Presence;
use super::{Connection, Tell};
use crate::screen::headset::{
    Connector, HeadsetError, HeadsetOptions, Helper, LinkNews, LinkOptions, WornHead,
};
use crate::sculpture::ColourDepth;
use crate::ui::ViewState;

type Found = Result<Box<Presence>, HeadsetError>;

/// What is looked for.
pub(super) struct Wanted {
    pub connection: Connection,
    pub settings: HeadsetOptions,
    pub options: LinkOptions,
    pub stood: bool,
    pub worn: Option<WornHead>,
    /// What is to be shown, and in how many colours.
    pub view: ViewState,
    pub depth: ColourDepth,
}

/// The thread.
pub(super) struct Search {
    /// None once the thread is to end.
    wants: Option<Sender<Wanted>>,
    found: Receiver<Found>,
    thread: Helper,
}

impl Search {
    /// `tell` hears [`LinkNews::Tried`] when there is something to be taken.
    pub fn start(tell: Tell) -> io::Result<Search> {
        let (wants, heard) = channel::<Wanted>();
        let (give, found) = channel();
        let work = move || {
            let mut connector = Connector::default();
            while let Ok(wanted) = heard.recv() {
                let Wanted { connection, settings, options, stood, worn, view, depth } = wanted;
                let tried =
                    Presence::new(&mut connector, &settings, &options, stood, worn.as_ref())
                        .and_then(|mut presence| presence.warm_up(view, depth).map(|()| presence));
                if give.send(tried.map(Box::new)).is_err() || !tell(connection, LinkNews::Tried) {
                    return;
                }
            }
        };
        let thread = Helper::start("headset search", work)?;
        Ok(Search { wants: Some(wants), found, thread })
    }

    /// Looks once.
    pub fn seek(&self, wanted: Wanted) {
        if let Some(wants) = &self.wants
            && wants.send(wanted).is_err()
        {
            tracing::debug!("the thread that looks for a headset has ended");
        }
    }

    /// What the look has led to, once.
    pub fn found(&self) -> Option<Found> {
        match self.found.try_recv() {
            Ok(found) => Some(found),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(HeadsetError::Lost("the search for it has ended")))
            }
        }
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        self.wants = None;
        self.thread.part();
    }
}
