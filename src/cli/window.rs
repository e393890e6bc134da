//! The program without a job: its window, its headset, or the demo.

use std::path::Path;

use super::{Cli, ProgramError, journal_options};
use crate::app;
use crate::config::Config;
use crate::folders;
use crate::gpu::DeviceOptions;
use crate::headless::{self, Context, DemoScene, PictureRequest};
use crate::progress_bar::Bar;
use crate::session::{FileAccess, Session};
use crate::terminal;

/// Runs the program without a job: the window if there is a display, otherwise the headset if one is wanted. The demo
/// works on a machine without either, but writes files, and so runs only on demand (`--or-demo`).
pub fn window_or_demo(
    cli: Cli,
    config: Config,
    device: DeviceOptions,
    progress: &Bar,
) -> Result<(), ProgramError> {
    let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    let display =
        cfg!(not(unix)) || cfg!(target_os = "macos") || set("DISPLAY") || set("WAYLAND_DISPLAY");
    let mut config = config;
    config.headset.enabled |= cli.headset;
    if display || config.headset.enabled {
        let mut session = match &cli.file {
            Some(file) => {
                let mut import = cli.import.options();
                if cli.import.upright.is_none() {
                    import.upright = app::remembered_up(file);
                }
                Session::open(file, &import, config.limits(), progress)?
            }
            None => Session::new(&config.new_sculpture(), config.limits())?,
        };
        if let Some(record) = &cli.record {
            session.record_to(record)?;
        }
        match journal_options(&config).journal_dir.count_left() {
            0 => {}
            left => terminal::print_notice(format_args!(
                "{left} of your earlier sessions did not end properly; `virtual-sculpture recover` lists what is left"
            )),
        }
        session.keep_history_in(&folders::journal_folder()).map_err(ProgramError::Journal)?;
        if config.saved_history.keep {
            session.keep_saved_histories(config.saved_history.options());
        }
        let access = if cli.read_only { FileAccess::ReadOnly } else { FileAccess::Locked };
        session.set_file_access(access);
        session.keep_meshes();
        if config.journal.keep && !cli.no_journal {
            session.keep_journal(journal_options(&config)).map_err(ProgramError::Journal)?;
        }
        let journals = journal_options(&config);
        if display {
            app::run(session, config, device, cli.headset_shots, journals)?;
        } else {
            app::headset::standalone::run(session, &config, device, cli.headset_shots, journals)?;
        }
        return Ok(());
    }
    if !cli.or_demo || cli.file.is_some() || cli.record.is_some() {
        return Err(ProgramError::NoDisplay);
    }
    terminal::print_notice(
        "no display: making the demo instead; see `virtual-sculpture --help` for more",
    );
    let context = Context { config: &config, device: &device, progress };
    let (scene, picture) = (DemoScene::default(), PictureRequest::default());
    Ok(headless::demo(scene, Path::new("out"), &picture, &context)?)
}
