//! The state of the interface: how the sculpture is shown, and which windows are open. None of it
//! belongs to the sculpture.
//!
//! Panels change these values by themselves; the rest of the program reads them. For changes to values that another
//! part owns (the document, the tool, the viewpoint, the controls) they send a [`UiRequest`].

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::command::{Command, NewSculpture};
use crate::editor::questions::{ChangedOnDisk, Next};
use crate::editor::tool::ToolEdit;
use crate::format::options::ImportOptions;
use crate::input::hands::HandSide;
use crate::input::pen::PenCurve;
use crate::input::remap::KeyChange;
use crate::input::{Action, Panel};
use crate::print_check::CheckOptions;
use crate::render::{Finish, LightOptions, RenderMode, RenderOptions, StereoOptions};
use crate::screen::headset::{Blend, HeadsetOptions};
use crate::shade::Lighting;
use crate::ui::dialogs::Dialogs;
use crate::ui::dialogs::film::FilmRequest;
use crate::ui::dialogs::final_picture::FinalRequest;
use crate::ui::dialogs::upright::Upright;
use crate::ui::memory::recent::Recent;
use crate::ui::options::pen::PenState;
use crate::ui::references::Reference;
use crate::ui::widgets::spot::Spot;
use crate::ui::widgets::toasts::Toasts;
use crate::ui::{SCALE_RANGE, Theme, ViewOptions, WindowOptions};
use crate::video::VideoOptions;
use crate::viewpoint::head::CalibrationStep;

/// A request that a person made in the interface.
#[derive(Clone, PartialEq, Debug)]
pub enum UiRequest {
    /// The same as by key or mouse.
    Do(Action),
    /// A command whose arguments were chosen in a window.
    Run(Command),
    /// Add a reference picture from a file.
    AddReference(PathBuf),
    /// Rotate the sculpture by angles in radians: to the right, and down.
    Turn(Vec2),
    /// Change the tool.
    Tool(ToolEdit),
    /// Make a final picture of the view.
    FinalPicture(Box<FinalRequest>),
    /// Make a film.
    Film(FilmRequest),
    /// Read a file to ask how it is to be imported.
    Study(PathBuf, ImportOptions),
    /// Check whether the sculpture can be printed.
    PrintCheck(CheckOptions),
    /// Stop the long work under way, where it can be stopped.
    StopWork,
    /// A step of the calibration of the tracker.
    Calibrate(CalibrationStep),
    /// Change the table of keys in use.
    Keys(KeyChange),
    /// Use another table of keys, by its index.
    UsePreset(usize),
    /// Do what would lose unsaved work, without asking again.
    Go(Next),
    /// Save, under a name that is asked for if there is none, then do that.
    SaveFirst(Next),
    /// Carry out a command that saves, then do that.
    SaveThen(Command, Next),
    /// Brings back what an earlier session has left in the journal of this number.
    Recover(u64),
    /// Removes that journal.
    DiscardLeft(u64),
    /// List what earlier sessions have left, or say that there is nothing.
    ListLeft,
    /// Save to this file although another program has changed it, then do that.
    Overwrite(ChangedOnDisk),
    /// Do not save to the sculpture's file, which another program has open.
    KeepReadOnly,
    /// Go on with a copy of the sculpture's file, without a name.
    BecomeCopy,
    /// Carry out a command although it cannot be undone.
    Irreversibly(Command),
}

/// How the sculpture is shown.
#[derive(Clone, PartialEq, Debug)]
pub struct ViewState {
    pub mode: RenderMode,
    /// The person has not chosen the mode.
    pub mode_is_automatic: bool,
    pub light: LightOptions,
    pub finish: Finish,
    /// The surface between near voxels instead of their cubes, of sculptures that are to be shown so.
    pub smooth_surface: bool,
    /// Smooth edges while nothing moves.
    pub refine: bool,
    /// Smooth edges in pictures that are not refined.
    pub smooth_edges: bool,
    /// The person has not chosen that.
    pub smooth_edges_is_automatic: bool,
    pub stereo: StereoOptions,
    pub video: VideoOptions,
    /// Parallel lines stay parallel; not before a tracked head or a printed marker.
    pub orthographic: bool,
    /// The axis gizmo.
    pub gizmo: bool,
    /// The floor grid.
    pub floor: bool,
    /// The ground with the sculpture's shadow; it has lines of its own.
    pub ground: bool,
    /// The axis of the grid that is up when the view is reset.
    pub up: Vec3,
    /// The edges of the grid.
    pub bounds: bool,
    /// Protected voxels are tinted.
    pub mask: bool,
    /// The line from the grid's centre to the tool.
    pub line: bool,
    /// The tool itself.
    pub tool: bool,
}

impl ViewState {
    /// Takes the mode that the person wants.
    pub fn choose_mode(&mut self, mode: RenderMode) {
        self.mode = mode;
        self.mode_is_automatic = false;
    }

    /// Takes the mode that suits a device to draw with, unless the person has chosen one, and likewise smooth edges. A
    /// choice that suits a GPU stays: the window may draw without one while a headset has one.
    pub fn suit_device(&mut self, software: bool) {
        if self.mode_is_automatic && !software {
            self.choose_mode(RenderMode::usual(software));
        }
        self.smooth_edges |= self.smooth_edges_is_automatic && !software;
    }

    /// Returns the name of the feature that draws lines below the sculpture, if one does.
    pub fn has_lines(&self) -> Option<&'static str> {
        match (self.ground, self.floor) {
            (true, _) => Some("Ground lines"),
            (false, true) => Some("Floor grid"),
            (false, false) => None,
        }
    }

    /// Returns the lighting as the shaders take it.
    pub fn lighting(&self) -> Lighting {
        self.finish.of(self.light.lighting())
    }
}

/// The size of text and buttons, on top of the display's own scale.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scale {
    now: f32,
    configured: f32,
}

impl Scale {
    pub fn new(configured: f32) -> Scale {
        Scale { now: configured, configured }
    }

    pub fn factor(self) -> f32 {
        self.now
    }

    /// Larger by tenths, as far as the settings allow.
    pub fn change_by(&mut self, tenths: f32) {
        let to = (self.now * 10.0 + tenths).round() / 10.0;
        self.now = to.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
    }

    /// To a factor, as far as the settings allow.
    pub fn set(&mut self, factor: f32) {
        self.now = factor.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
    }

    pub fn reset(&mut self) {
        self.now = self.configured;
    }
}

/// Where the window of a panel is, in pixels of the screen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct PanelPlace {
    /// Not known everywhere.
    #[serde(default)]
    pub corner_px: Option<[i32; 2]>,
    pub size_px: [u32; 2],
}

/// How large the windows were last, and where those of panels.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Windows {
    /// Width and height of the main window in points, while it does not fill the screen; none
    /// before it was open.
    pub main: Option<[u32; 2]>,
    pub maximised: bool,
    pub panels: BTreeMap<Panel, PanelPlace>,
}

/// How the interface looks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Appearance {
    pub theme: Theme,
    pub scale: Scale,
}

/// Where panels and windows are.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PanelLayout {
    /// The panels that are windows of their own.
    pub detached: BTreeSet<Panel>,
    pub windows: Windows,
    /// Nothing but the picture is shown in the main window. Not remembered.
    pub hidden: bool,
    /// The sections of the options and of the toolbox that were opened or closed, by their titles.
    pub sections: BTreeMap<String, bool>,
    /// The option that is to be shown. Not remembered.
    pub led_to: Option<Spot>,
}

impl PanelLayout {
    /// Detaches a panel, or docks it again.
    pub fn toggle_detached(&mut self, panel: Panel) {
        if !self.detached.remove(&panel) {
            self.detached.insert(panel);
        }
    }
}

/// The tasks that the main window is still to do.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct WindowTasks {
    /// The window is to fill its screen, or no longer.
    pub switch_fullscreen: bool,
    /// The use of a picture of the view.
    pub screenshot: Option<ScreenshotTo>,
    /// The use of the picture on the clipboard of the system.
    pub paste: Option<PasteAs>,
}

/// The use of a pasted picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PasteAs {
    /// A reference picture.
    Reference,
    /// The picture that solids paint with.
    ToolPicture,
}

/// Where a picture of the view goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ScreenshotTo {
    /// A file with a name of its own.
    File,
    /// The clipboard of the system.
    Clipboard,
}

/// The facts known about files that were opened or saved.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct KnownFiles {
    /// The files opened or saved last.
    pub recent: Recent,
    /// Which axis points up in files that do not say so.
    pub upright: Upright,
}

/// The choices made for a headset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeadsetChoices {
    /// The hand that has the tool.
    pub hand_side: HandSide,
    /// How the pictures are blended with the surroundings.
    pub blend: Blend,
}

/// The interface's own state: all that panels change by themselves.
pub struct UiState {
    pub view: ViewState,
    pub appearance: Appearance,
    pub layout: PanelLayout,
    pub window_tasks: WindowTasks,
    pub known_files: KnownFiles,
    pub headset: HeadsetChoices,
    pub pen: PenState,
    /// Pictures in the scene to sculpt from.
    pub references: Vec<Reference>,
    pub autosave: AutosaveChoice,
    pub dialogs: Dialogs,
    pub toasts: Toasts,
}

/// When the sculpture's file is saved by itself.
#[derive(Clone, Copy, Debug)]
pub struct AutosaveChoice {
    /// After how many minutes with unsaved changes; 0: never.
    pub minutes: u32,
    /// The value in the settings.
    pub usual_min: u32,
}

/// The options that the interface starts with.
#[derive(Clone, Debug)]
pub struct UiOptions<'a> {
    pub window: &'a WindowOptions,
    pub view: &'a ViewOptions,
    /// After how many minutes unsaved changes are saved; 0: never.
    pub autosave_min: u32,
    /// The default of the dialog for a new sculpture.
    pub new: NewSculpture,
    pub render: &'a RenderOptions,
    pub light: &'a LightOptions,
    pub stereo: &'a StereoOptions,
    pub video: &'a VideoOptions,
    pub headset: &'a HeadsetOptions,
    /// How the press of a pen counts.
    pub pen: PenCurve,
}

impl UiState {
    /// The state at the start.
    pub fn new(options: &UiOptions) -> UiState {
        let finish = options.render.finish();
        let mut dialogs = Dialogs::new(&options.new);
        dialogs.light.usual = (options.light.clone(), finish);
        let minutes = options.autosave_min;
        UiState {
            autosave: AutosaveChoice { minutes, usual_min: minutes },
            view: ViewState {
                mode: options.render.mode.unwrap_or_default(),
                mode_is_automatic: options.render.mode.is_none(),
                light: options.light.clone(),
                finish,
                smooth_surface: options.render.smooth_surface,
                refine: options.render.refine,
                smooth_edges: options.render.smooth_edges.unwrap_or(false),
                smooth_edges_is_automatic: options.render.smooth_edges.is_none(),
                stereo: *options.stereo,
                video: options.video.clone(),
                orthographic: options.view.orthographic,
                gizmo: options.view.gizmo,
                floor: options.view.floor,
                ground: options.view.ground,
                up: Vec3::Y,
                bounds: true,
                mask: true,
                line: true,
                tool: true,
            },
            appearance: Appearance {
                theme: options.window.theme,
                scale: Scale::new(options.window.scale),
            },
            layout: PanelLayout::default(),
            window_tasks: WindowTasks::default(),
            known_files: KnownFiles::default(),
            headset: HeadsetChoices {
                hand_side: options.headset.hand,
                blend: options.headset.blend,
            },
            pen: PenState::new(options.pen),
            references: Vec::new(),
            dialogs,
            toasts: Toasts::default(),
        }
    }
}

/// The last folder of a file, to open dialogs there.
pub fn folder_of(path: Option<&std::path::Path>) -> Option<PathBuf> {
    path.and_then(|p| p.parent()).filter(|p| !p.as_os_str().is_empty()).map(PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_goes_by_tenths_within_its_range_and_back() {
        let mut scale = Scale::new(1.25);
        scale.change_by(1.0);
        assert_eq!(scale.factor(), 1.4);
        scale.change_by(-1.0);
        assert_eq!(scale.factor(), 1.3);
        (0..50).for_each(|_| scale.change_by(1.0));
        assert_eq!(scale.factor(), 4.0);
        (0..50).for_each(|_| scale.change_by(-1.0));
        assert_eq!(scale.factor(), 0.5);
        scale.reset();
        assert_eq!(scale.factor(), 1.25);
    }
}
