//! The thread that writes a journal. The session passes it entries without ever waiting. The thread appends each in one
//! write, and makes sure that they are on disk soon after a stroke has ended.
//!
//! If something cannot be written, the thread reports it once, drops entries, and requests a checkpoint from time to
//! time: the next one that can be written completes the journal again. It also requests one where a replay would take
//! long or the file has grown large. Written entries stay until a checkpoint has replaced them.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::checkpoint::Checkpoint;
use super::dir::JournalDir;
use super::entry::JournalEntry;
use super::growing::{GrowingJournal, Trouble};
use super::live::{Live, LiveKey};

/// Number of entries that may wait for the disk; more leave a gap that a checkpoint closes.
const QUEUE: usize = 4096;
/// Longest delay from an entry that settles to the disk; several within that time share a sync.
const SETTLE: Duration = Duration::from_millis(40);
/// Delay from any other entry to the disk.
const WITHIN_STROKE: Duration = Duration::from_secs(1);
/// Polling interval of a running sync.
const LOOK_EVERY: Duration = Duration::from_millis(5);
/// Pause between two attempts after repeated failures.
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// Target of log messages at level `trace` that report the states of a session and which of them are in the journal,
/// for tests that kill the session.
pub const STATES: &str = "sculpture_core::states";

/// Options of a journal.
#[derive(Clone, Debug)]
pub struct JournalOptions {
    /// The folder of the journal.
    pub journal_dir: JournalDir,
    /// Size in bytes from which it is rewritten from a checkpoint. Half of it is for undo steps in a checkpoint. While
    /// a checkpoint is being written, the old and the new journal both take space.
    pub max_bytes: u64,
    /// Replay time from which the journal is rewritten from a checkpoint.
    pub replay: Duration,
    /// Pause before a failed write is retried; longer after repeated failures.
    pub retry: Duration,
}

impl JournalOptions {
    /// Returns the options for a folder, with the usual limits.
    pub fn new(journal_dir: JournalDir) -> JournalOptions {
        JournalOptions {
            journal_dir,
            max_bytes: 1 << 30,
            replay: Duration::from_secs(5),
            retry: Duration::from_secs(2),
        }
    }
}

/// The state that the thread and the session share without waiting.
#[derive(Debug, Default)]
struct WriterState {
    /// Whether the thread requests a checkpoint.
    wanted: AtomicBool,
    /// The journal's number; 0 before it has one.
    number: AtomicU64,
    /// The reason why nothing can be written, for the user, until it is reported.
    news: Mutex<Option<String>>,
    /// The same reason for as long as nothing can be written.
    trouble: Mutex<Option<String>>,
    /// Whether writing has recovered since.
    caught_up: AtomicBool,
    /// Whether an executed entry could not be written.
    incomplete: AtomicBool,
}

#[derive(Debug)]
enum Message {
    Entry {
        entry: Box<JournalEntry>,
        took: Duration,
    },
    Checkpoint {
        checkpoint: Box<Checkpoint>,
        after_gap: bool,
    },
    /// Answered when all previous entries are written.
    Written(SyncSender<()>),
    /// Answered when all previous entries are on disk.
    Synced(SyncSender<()>),
    End {
        remove: bool,
    },
}

/// A journal that is being written.
#[derive(Debug)]
pub struct JournalWriter {
    sender: SyncSender<Message>,
    shared: Arc<WriterState>,
    thread: Option<JoinHandle<()>>,
    /// Whether entries are missing: nothing is sent until a checkpoint is.
    gap: bool,
    options: JournalOptions,
    /// The key in the list of live journals.
    key: LiveKey,
    /// Number of entries so far.
    entries: u64,
}

impl JournalWriter {
    /// Begins a journal with a checkpoint.
    ///
    /// # Errors
    /// If no thread can be created.
    pub fn begin(
        options: JournalOptions,
        checkpoint: Checkpoint,
    ) -> std::io::Result<JournalWriter> {
        let (sender, receiver) = sync_channel(QUEUE);
        let shared = Arc::new(WriterState::default());
        let mut work = WriterThread {
            options: options.clone(),
            shared: shared.clone(),
            began_unix_s: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs()),
            number: None,
            file: None,
            appends: false,
            in_stroke: false,
            due: None,
            retry: None,
            pause: options.retry,
            replay: Duration::ZERO,
            told: false,
            entries: 0,
        };
        let thread = std::thread::Builder::new().name("journal".to_string());
        let thread = thread.spawn(move || work.run(&receiver))?;
        let ask = {
            let (sender, shared, journal_dir) =
                (sender.clone(), shared.clone(), options.journal_dir.clone());
            move |answer: SyncSender<()>| {
                // A full queue has no room for a question either.
                let asked = sender.try_send(Message::Synced(answer)).is_ok();
                let number = Some(shared.number.load(Ordering::Relaxed)).filter(|n| *n > 0);
                number.filter(|_| asked).map(|number| journal_dir.path(number))
            }
        };
        let mut writer = JournalWriter {
            key: Live::add(ask),
            sender,
            shared,
            thread: Some(thread),
            gap: false,
            options,
            entries: 0,
        };
        writer.checkpoint(checkpoint);
        Ok(writer)
    }

    /// Returns the options.
    pub fn options(&self) -> &JournalOptions {
        &self.options
    }

    /// Returns the number in the folder, once it has one.
    pub fn number(&self) -> Option<u64> {
        Some(self.shared.number.load(Ordering::Relaxed)).filter(|number| *number > 0)
    }

    /// Adds an entry that took the given time to execute. Never waits.
    pub fn push(&mut self, entry: JournalEntry, took: Duration) {
        self.entries += 1;
        if !self.gap {
            self.gap =
                self.sender.try_send(Message::Entry { entry: Box::new(entry), took }).is_err();
        }
    }

    /// Returns the number of entries added since the beginning.
    pub fn entries(&self) -> u64 {
        self.entries
    }

    /// Returns whether all entries added, and waited for, so far are in the journal's file.
    pub fn is_complete(&self) -> bool {
        !self.gap && self.number().is_some() && !self.shared.incomplete.load(Ordering::Relaxed)
    }

    /// Returns whether a checkpoint is wanted.
    pub(crate) fn wants_checkpoint(&self) -> bool {
        self.gap || self.shared.wanted.load(Ordering::Relaxed)
    }

    /// Rewrites the journal from this checkpoint. Never waits.
    pub fn checkpoint(&mut self, checkpoint: Checkpoint) {
        let checkpoint = Box::new(checkpoint);
        let message = Message::Checkpoint { checkpoint, after_gap: self.gap };
        match self.sender.try_send(message) {
            Ok(()) => {
                self.gap = false;
                self.shared.wanted.store(false, Ordering::Relaxed);
            }
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => self.gap = true,
        }
    }

    /// Notes that entries were left out: the next checkpoint closes the gap.
    pub(crate) fn note_gap(&mut self) {
        self.gap = true;
    }

    /// Returns the message for the user, once: that nothing can be written, or that it can again.
    pub(crate) fn take_message(&self) -> Option<String> {
        let mut news = self.shared.news.lock().unwrap_or_else(PoisonError::into_inner);
        let back = self.shared.caught_up.swap(false, Ordering::Relaxed);
        news.take().or_else(|| back.then(|| "the journal is complete again".to_string()))
    }

    /// Returns why nothing can be written, for as long as that lasts.
    pub fn trouble(&self) -> Option<String> {
        self.shared.trouble.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Waits until all entries so far are written. After that, not even killing the process loses them.
    pub(crate) fn wait_written(&self) {
        self.wait(Message::Written);
    }

    /// Waits until all entries so far are on disk. After that, not even a power cut loses them.
    pub(crate) fn wait_synced(&self) {
        self.wait(Message::Synced);
    }

    fn wait(&self, message: impl Fn(SyncSender<()>) -> Message) {
        let (sender, receiver) = sync_channel(1);
        if self.sender.send(message(sender)).is_ok() {
            // This fails only if the thread has ended; then nothing more is written.
            let _ = receiver.recv();
        }
    }

    /// Ends the journal; `remove`: it is no longer needed.
    pub fn end(mut self, remove: bool) {
        self.finish(remove);
    }

    fn finish(&mut self, remove: bool) {
        Live::remove(self.key);
        if let Some(thread) = self.thread.take() {
            let _ = self.sender.send(Message::End { remove });
            if thread.join().is_err() {
                tracing::error!("the thread of the journal has panicked");
            }
        }
    }
}

impl Drop for JournalWriter {
    fn drop(&mut self) {
        self.finish(false);
    }
}

/// The state of the thread.
struct WriterThread {
    options: JournalOptions,
    shared: Arc<WriterState>,
    began_unix_s: u64,
    number: Option<u64>,
    /// The journal as it is on disk. Kept open, and so locked, even where nothing can be written to it.
    file: Option<GrowingJournal>,
    /// Whether entries are appended; false after one could not be.
    appends: bool,
    /// Whether the entries so far leave a stroke open.
    in_stroke: bool,
    /// When the written data must be on disk.
    due: Option<Instant>,
    /// When to request a checkpoint again, and how long to wait after that.
    retry: Option<Instant>,
    pause: Duration,
    /// Estimated time of a replay.
    replay: Duration,
    /// Whether the user has been told that something is wrong.
    told: bool,
    /// Number of received entries, written or not.
    entries: u64,
}

impl WriterThread {
    fn run(&mut self, receiver: &Receiver<Message>) {
        loop {
            let is_syncing = self.file.as_ref().is_some_and(GrowingJournal::is_syncing);
            let look = is_syncing.then(|| Instant::now() + LOOK_EVERY);
            // One sync at a time: the next follows this one.
            let due = self.due.filter(|_| !is_syncing);
            let wake = [due, look, self.retry].into_iter().flatten().min();
            let message = match wake {
                None => receiver.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(wake) => receiver.recv_timeout(wake.saturating_duration_since(Instant::now())),
            };
            match message {
                Ok(Message::Entry { entry, took }) => self.entry(&entry, took),
                Ok(Message::Checkpoint { checkpoint, after_gap }) => {
                    self.appends &= !after_gap;
                    self.checkpoint(&checkpoint);
                }
                // The receiver of the answer may be gone.
                Ok(Message::Written(answer)) => {
                    let _ = answer.try_send(());
                }
                Ok(Message::Synced(answer)) => {
                    self.sync();
                    let _ = answer.try_send(());
                }
                Ok(Message::End { remove }) => return self.end(remove),
                Err(RecvTimeoutError::Disconnected) => return self.end(false),
                Err(RecvTimeoutError::Timeout) => {}
            }
            let now = Instant::now();
            if let Some(Err(error)) = self.file.as_mut().map(|open| open.end_sync(false)) {
                self.fail(&error.into());
            }
            let is_syncing = self.file.as_ref().is_some_and(GrowingJournal::is_syncing);
            if self.due.is_some_and(|due| due <= now && !is_syncing) {
                self.due = None;
                let begun = self.file.as_mut().map_or(Ok(()), GrowingJournal::begin_sync);
                if let Err(error) = begun {
                    self.fail(&error.into());
                }
            }
            if self.retry.is_some_and(|retry| retry <= now) {
                self.want();
            }
        }
    }

    /// Requests a checkpoint, and again after a while if it does not arrive or cannot be written.
    fn want(&mut self) {
        self.shared.wanted.store(true, Ordering::Relaxed);
        self.retry = Some(Instant::now() + self.pause);
    }

    fn entry(&mut self, entry: &JournalEntry, took: Duration) {
        self.entries += 1;
        let Some(open) = self.file.as_mut().filter(|_| self.appends) else { return };
        let done = entry.to_record().map_err(Trouble::from).and_then(|record| open.append(record));
        if let Err(trouble) = done {
            return self.fail(&trouble);
        }
        tracing::trace!(target: STATES, "written {}", self.entries);
        self.replay += took;
        let is_long = self.replay > self.options.replay || open.bytes > open.compact_at;
        let wait = if entry.settles(&mut self.in_stroke) { SETTLE } else { WITHIN_STROKE };
        let due = Instant::now() + wait;
        self.due = Some(self.due.map_or(due, |earlier| earlier.min(due)));
        if is_long && self.retry.is_none() {
            self.want();
        }
    }

    /// Syncs everything before it returns.
    fn sync(&mut self) {
        let ended = self.file.as_mut().map_or(Ok(()), |open| open.end_sync(true));
        if let Err(error) = ended {
            self.fail(&error.into());
        }
        if self.due.take().is_none() {
            return;
        }
        let synced = self.file.as_mut().map_or(Ok(()), |open| open.sync());
        if let Err(error) = synced {
            self.fail(&error.into());
        }
    }

    /// Stops appending entries, since one is missing. Tells the user once, and requests a checkpoint.
    fn fail(&mut self, trouble: &Trouble) {
        self.appends = false;
        self.shared.incomplete.store(true, Ordering::Relaxed);
        self.due = None;
        tracing::debug!("journal: {trouble}");
        if !std::mem::replace(&mut self.told, true) {
            let folder = self.options.journal_dir.folder().display();
            let remedy = trouble.remedy();
            let text = format!(
                "the journal in {folder} cannot be written: {trouble}; work goes on, but save it yourself until it \
                 can: {remedy}"
            );
            for told in [&self.shared.news, &self.shared.trouble] {
                *told.lock().unwrap_or_else(PoisonError::into_inner) = Some(text.clone());
            }
        }
        if self.retry.is_none() {
            self.retry = Some(Instant::now() + self.pause);
        }
    }

    fn checkpoint(&mut self, checkpoint: &Checkpoint) {
        match self.begin_anew(checkpoint) {
            Ok(()) => {
                (self.appends, self.in_stroke) = (true, false);
                self.shared.incomplete.store(false, Ordering::Relaxed);
                tracing::trace!(target: STATES, "written {}", self.entries);
                (self.retry, self.pause, self.due) = (None, self.options.retry, None);
                self.replay = Duration::ZERO;
                if std::mem::take(&mut self.told) {
                    *self.shared.trouble.lock().unwrap_or_else(PoisonError::into_inner) = None;
                    self.shared.caught_up.store(true, Ordering::Relaxed);
                }
            }
            Err(trouble) => {
                self.pause = (self.pause * 2).min(LONGEST_PAUSE);
                self.retry = Some(Instant::now() + self.pause);
                // As long as entries are appended to the old file, nothing is lost.
                if !self.appends {
                    self.fail(&trouble);
                }
            }
        }
    }

    /// Writes a journal that begins with the checkpoint, and replaces the present one.
    fn begin_anew(&mut self, checkpoint: &Checkpoint) -> Result<(), Trouble> {
        let is_there = self.file.as_ref().is_some_and(GrowingJournal::is_there);
        let journal_dir = &self.options.journal_dir;
        // If the journal was removed, another session may have its number by now.
        let (number, file) = journal_dir.create(self.number.filter(|_| is_there))?;
        let mut open = GrowingJournal::new(file);
        let written = open
            .append_head()
            .map_err(Trouble::from)
            .and_then(|()| checkpoint.write(self.began_unix_s, &mut |record| open.append(record)))
            .and_then(|()| Ok(open.sync()?));
        if let Err(trouble) = written {
            journal_dir.abandon(number);
            return Err(trouble);
        }
        if let Err(error) = journal_dir.publish(number) {
            if journal_dir.is_unfinished(number) {
                journal_dir.abandon(number);
                return Err(error.into());
            }
            // It has its name, though possibly not durably: writing continues with it.
            tracing::debug!("journal: {error}");
        }
        open.compact_at = self.options.max_bytes.max(2 * open.bytes);
        self.file = Some(open);
        self.number = Some(number);
        self.shared.number.store(number, Ordering::Relaxed);
        Ok(())
    }

    fn end(&mut self, remove: bool) {
        self.sync();
        let is_there = self.file.as_ref().is_some_and(GrowingJournal::is_there);
        if let Some(number) = self.number.filter(|_| remove && is_there)
            && let Err(error) = self.options.journal_dir.remove(number)
        {
            tracing::warn!("the journal {number} cannot be removed: {error}");
        }
    }
}
