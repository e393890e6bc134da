//! The program in a headset without a window, on a machine without a display: the board is the whole interface.

use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use super::Headset;
use crate::app::AppError;
use crate::app::Workspace;
use crate::config::Config;
use crate::editor::recovery::{self, SecuredPlace};
use crate::folders::state_folder;
use crate::gpu::DeviceOptions;
use crate::input::Bindings;
use crate::persist::journal::JournalOptions;
use crate::remedy::told;
use crate::session::Session;

/// Waits for a headset and works on `session` in it until the person exits.
pub fn run(
    session: Session,
    config: &Config,
    device: DeviceOptions,
    screenshots: Option<PathBuf>,
    journals: JournalOptions,
) -> Result<(), AppError> {
    let (send, events) = channel();
    let mut workspace = Workspace::new(session, config, Bindings::presets()?);
    workspace.look_for_left(journals);
    let send = move |connection, event| send.send((connection, event)).is_ok();
    let mut headset = Headset::new(&config.headset, device, screenshots, send);
    loop {
        let next_poll = headset.poll(&mut workspace);
        let (Some(next_poll), false) = (next_poll, workspace.is_leaving()) else { break };
        let timeout = next_poll.saturating_duration_since(Instant::now());
        match events.recv_timeout(timeout.max(Duration::from_millis(1))) {
            Ok((connection, event)) => headset.handle(&mut workspace, connection, event),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    workspace.finish_job();
    if workspace.is_leaving() {
        workspace.session_mut().discard_journal();
    }
    if headset.has_exited() && workspace.session().modified() {
        // The runtime has ended the program without a chance to ask.
        match recovery::secure(workspace.session_mut(), &state_folder()) {
            Ok(SecuredPlace::Journal(path)) => {
                tracing::warn!(
                    "the work is in the journal {}: the next start offers it",
                    path.display()
                )
            }
            Ok(SecuredPlace::File(path)) => {
                tracing::warn!("the sculpture was saved to {}", path.display())
            }
            Err(error) => tracing::error!("the sculpture could not be saved: {}", told(&error)),
        }
    }
    match headset.validation_messages() {
        0 => Ok(()),
        count => Err(AppError::Validation(count)),
    }
}
