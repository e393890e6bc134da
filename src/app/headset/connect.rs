//! Attempts to connect to a headset. Connecting and creating the renderer with its pipelines may take seconds, so a
//! thread does it and no window waits.
//!
//! Takes options and a sink for events; gives a connected [`XrFrameLoop`] or the reason why there is none. The caller
//! decides when to try.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use super::frame_loop::XrFrameLoop;
use crate::screen::headset::{
    BlendMode, Connector, HeadsetError, HeadsetOptions, RuntimeThread, SessionHead, XrEvent,
    XrSessionOptions,
};
use crate::sculpture::ColourDepth;
use crate::ui::ViewState;

/// The number of an attempt to connect and of its session. Events carry it, so that events of an earlier session are
/// ignored.
pub type Connection = u64;

/// Receives the events of a connection on another thread. Returns whether they are still wanted.
pub(super) type EventSink = Arc<dyn Fn(Connection, XrEvent) -> bool + Send + Sync>;

type ConnectResult = Result<Box<XrFrameLoop>, HeadsetError>;

/// The state of the program that a session starts with.
pub(super) struct SessionStart {
    pub blend: BlendMode,
    /// The sculpture has been placed in a room by an earlier session.
    pub placed: bool,
    /// Receives the poses of the head.
    pub head: Option<SessionHead>,
    /// The view that the first picture shows, and the colour depth of the sculpture.
    pub view: ViewState,
    pub depth: ColourDepth,
}

/// The attempts to connect, one after another.
pub(super) struct ConnectAttempts {
    /// The connection of the last attempt.
    connection: Connection,
    settings: HeadsetOptions,
    options: XrSessionOptions,
    sink: EventSink,
    /// `None` before the first attempt.
    thread: Option<ConnectThread>,
}

impl ConnectAttempts {
    pub fn new(
        settings: HeadsetOptions,
        options: XrSessionOptions,
        sink: EventSink,
    ) -> ConnectAttempts {
        ConnectAttempts { connection: 0, settings, options, sink, thread: None }
    }

    /// Returns the connection of the last attempt.
    pub fn connection(&self) -> Connection {
        self.connection
    }

    /// Begins an attempt on the thread.
    pub fn begin(&mut self, start: SessionStart) -> Result<(), HeadsetError> {
        self.connection += 1;
        self.options.blend = start.blend;
        let thread = match &mut self.thread {
            Some(thread) => thread,
            none => {
                let thread = ConnectThread::start(self.sink.clone());
                none.insert(thread.map_err(HeadsetError::Thread)?)
            }
        };
        thread.request(ConnectRequest {
            connection: self.connection,
            settings: self.settings.clone(),
            options: self.options.clone(),
            start,
        });
        Ok(())
    }

    /// Returns the result of the attempt, once. The session has been started: its events go to the sink.
    pub fn take_result(&self) -> Option<ConnectResult> {
        let connected = self.thread.as_ref()?.take_result()?;
        let (connection, sink) = (self.connection, self.sink.clone());
        Some(connected.and_then(|mut frame_loop| {
            frame_loop.start(move |event| sink(connection, event)).map(|()| frame_loop)
        }))
    }
}

struct ConnectRequest {
    connection: Connection,
    settings: HeadsetOptions,
    options: XrSessionOptions,
    start: SessionStart,
}

impl ConnectRequest {
    fn run(self, connector: &mut Connector) -> ConnectResult {
        let SessionStart { placed, head, view, depth, .. } = self.start;
        let mut frames =
            XrFrameLoop::connect(connector, &self.settings, &self.options, placed, head.as_ref())?;
        frames.warm_up(view, depth)?;
        Ok(Box::new(frames))
    }
}

struct ConnectThread {
    /// `None` once the thread should end.
    requests: Option<Sender<ConnectRequest>>,
    results: Receiver<ConnectResult>,
    thread: RuntimeThread,
}

impl ConnectThread {
    /// Starts the thread. `sink` receives [`XrEvent::ConnectFinished`] when there is a result.
    fn start(sink: EventSink) -> io::Result<ConnectThread> {
        let (requests, received) = channel::<ConnectRequest>();
        let (send, results) = channel();
        let work = move || {
            let mut connector = Connector::default();
            while let Ok(request) = received.recv() {
                let connection = request.connection;
                let result = request.run(&mut connector);
                if send.send(result).is_err() || !sink(connection, XrEvent::ConnectFinished) {
                    return;
                }
            }
        };
        let thread = RuntimeThread::start("headset connect", work)?;
        Ok(ConnectThread { requests: Some(requests), results, thread })
    }

    fn request(&self, request: ConnectRequest) {
        if let Some(requests) = &self.requests
            && requests.send(request).is_err()
        {
            tracing::debug!("the thread that connects to a headset has ended");
        }
    }

    fn take_result(&self) -> Option<ConnectResult> {
        match self.results.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(HeadsetError::Lost("the thread that connects to it has ended")))
            }
        }
    }
}

impl Drop for ConnectThread {
    fn drop(&mut self) {
        self.requests = None;
        self.thread.join_or_detach();
    }
}
