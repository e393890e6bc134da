//! The scene of a film: the sculpture of each frame before the camera at rest.
//!
//! A script is executed twice: to its end, for the camera, and again along with the frames, so that a part of a film
//! needs no other part. Frames are requested in rising order.

use std::path::Path;
use std::sync::Arc;

use image::RgbImage;

use super::framing::FilmFraming;
use super::lapse::Lapse;
use super::timing::Timing;
use super::{FilmError, FilmJob, Subject};
use crate::command::Command;
use crate::document::{Document, DocumentSnapshot};
use crate::headless::{Context, JobError, execute_command};
use crate::picture::{PictureMaker, PictureView};
use crate::progress::Progress;
use crate::sculpture::history::Contents;
use crate::session::{Session, SessionError};

/// The sculpture of a film.
pub enum FilmScene {
    /// With files, as scripts need.
    Session(Box<Session>),
    Document(Box<Document>),
}

impl FilmScene {
    fn document(&self) -> &Document {
        match self {
            FilmScene::Session(session) => session.document(),
            FilmScene::Document(document) => document,
        }
    }

    fn document_mut(&mut self) -> &mut Document {
        match self {
            FilmScene::Session(session) => session.document_mut(),
            FilmScene::Document(document) => document,
        }
    }

    /// Executes a command of the script at `path`.
    fn execute(&mut self, command: &(usize, Command), path: &Path) -> Result<(), JobError> {
        match self {
            FilmScene::Session(session) => execute_command(session, command, path),
            FilmScene::Document(document) => match document.apply(&command.1) {
                Ok(_) => Ok(()),
                Err(error) => Err(SessionError::from(error).into()),
            },
        }
    }
}

/// See the module text.
pub struct FilmStage<'a> {
    scene: FilmScene,
    lapse: Option<Lapse>,
    /// Number of executed commands.
    executed: usize,
    view: PictureView,
    timing: Timing,
    framing: FilmFraming,
    maker: PictureMaker,
    progress: &'a dyn Progress,
    /// The last picture, with its turn and number of commands: nothing may change for some frames.
    last: Option<(usize, f32, Arc<RgbImage>)>,
}

/// Returns the sculpture of a turntable, or the initial one of a script.
pub fn begin(job: &FilmJob, context: &Context) -> Result<FilmScene, FilmError> {
    let file = match &job.subject {
        Subject::Sculpture { contents, placement } => {
            let limits = context.config.limits();
            let mut document = Document::from_contents(Contents::clone(contents), limits);
            let placed = document.apply(&Command::Place(*placement));
            placed.map_err(|error| JobError::from(SessionError::from(error)))?;
            return Ok(FilmScene::Document(Box::new(document)));
        }
        Subject::Steps { now, store } => {
            let (limits, store) = (context.config.limits(), store.clone());
            let document = Document::restored(DocumentSnapshot::clone(now), limits, store);
            let document = document.map_err(|error| JobError::from(SessionError::from(error)))?;
            return Ok(FilmScene::Document(Box::new(document)));
        }
        Subject::File(_) if job.is_lapse() => job.input.as_ref(),
        Subject::File(file) => Some(file),
    };
    let session = match file {
        Some(file) => context.open_session(file, &job.import),
        None => context.new_session(),
    };
    Ok(FilmScene::Session(Box::new(session.map_err(JobError::from)?)))
}

impl<'a> FilmStage<'a> {
    /// Creates a stage for `scene` in its [initial](begin) state.
    pub fn new(
        job: &FilmJob,
        mut scene: FilmScene,
        lapse: Option<Lapse>,
        view: PictureView,
        timing: Timing,
        context: &Context<'a>,
    ) -> Result<FilmStage<'a>, FilmError> {
        let progress = context.progress;
        if let Some(lapse) = &lapse {
            let count = lapse.commands.len().max(1) as f32;
            progress.begin("repeating what was done");
            for (i, command) in lapse.commands.iter().enumerate() {
                go_on(progress)?;
                scene.execute(command, &lapse.path)?;
                progress.advance(i as f32 / count);
            }
            progress.end();
        }
        let framing = FilmFraming::new(&view, scene.document(), timing.spins());
        if lapse.is_some() {
            // Drop the first one before the second one is made.
            drop(scene);
            scene = begin(job, context)?;
        }
        let maker = PictureMaker::new(&context.config.picture_options(context.device));
        Ok(FilmStage {
            scene,
            lapse,
            executed: 0,
            view,
            timing,
            framing,
            maker,
            progress,
            last: None,
        })
    }

    /// Returns the picture of a frame, counted from 0. Frames must not decrease from call to call.
    pub fn picture(&mut self, frame: u32) -> Result<Arc<RgbImage>, FilmError> {
        go_on(self.progress)?;
        if let Some(lapse) = &self.lapse {
            for command in
                &lapse.commands[self.executed..lapse.commands_at(frame, self.timing.frames)]
            {
                go_on(self.progress)?;
                self.scene.execute(command, &lapse.path)?;
                self.executed += 1;
            }
        }
        let turn_rad = self.timing.turn_rad(frame);
        if let Some((executed, turn, picture)) = &self.last
            && (*executed, *turn) == (self.executed, turn_rad)
        {
            return Ok(picture.clone());
        }
        let placement = self.framing.placement(self.scene.document(), turn_rad);
        let pictures = self.maker.make(self.scene.document_mut(), &self.view, &placement);
        let mut pictures = pictures.map_err(JobError::from)?;
        // Only the layout `layers`, which films refuse, makes more.
        let picture = Arc::new(pictures.swap_remove(0));
        self.last = Some((self.executed, turn_rad, picture.clone()));
        Ok(picture)
    }
}

fn go_on(progress: &dyn Progress) -> Result<(), FilmError> {
    if progress.is_cancelled() { Err(FilmError::Cancelled) } else { Ok(()) }
}
