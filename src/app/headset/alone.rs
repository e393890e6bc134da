//! Owns the program in a headset alone, on a machine without a display: no window, the board is
//! all there is of the interface.

use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use super::Headset;
use crate::app::AppError;
use crate::app::Workspace;
use crate::config::Config;
use crate::editor::recovery;
use crate::folders::state_folder;
use crate::gpu::DeviceOptions;
use crate::input::Bindings;
use crate::session::Session;

/// Waits for a headset and works on `session` in it until the person leaves.
pub fn run(
    session: Session,
    config: &Config,
    device: DeviceOptions,
    shots: Option<PathBuf>,
) -> Result<(), AppError> {
    let (tell, heard) = channel();
    let mut workspace = Workspace::new(session, config, Bindings::presets()?);
    let tell = move |connection, news| tell.send((connection, news)).is_ok();
    let mut headset = Headset::new(&config.headset, device, shots, tell);
    loop {
        let again = headset.poll(&mut workspace);
        let (Some(again), false) = (again, workspace.is_leaving()) else { break };
        let patience = again.saturating_duration_since(Instant::now());
        match heard.recv_timeout(patience.max(Duration::from_millis(1))) {
            Ok((connection, news)) => headset.hear(&mut workspace, connection, news),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    workspace.finish_job();
    if headset.is_left() && workspace.session().modified() {
        // The runtime has ended the program: nobody could be asked.
        match recovery::save(workspace.session_mut(), &state_folder()) {
            Ok(path) => tracing::warn!("the sculpture was saved to {}", path.display()),
            Err(error) => tracing::error!("the sculpture could not be saved: {error}"),
        }
    }
    match headset.complaints() {
        0 => Ok(()),
        count => Err(AppError::Validation(count)),
    }
}
