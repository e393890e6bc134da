//! The state of the interface: the view of the sculpture, and the open windows. None of it belongs to the sculpture.
//!
//! It is above the dialogs, whose states it owns, and below the panels, which change these values directly; the rest of
//! the program reads them. Must not know any panel.

use egui::Ui;
use glam::Vec3;

use super::context::UiContext;
use super::dialogs::{DialogContext, Dialogs};
use super::layout::{Appearance, PanelLayout, Scale};
use super::memory::recent::Recent;
use super::memory::upright::Upright;
use super::pens::PenState;
use super::references::Reference;
use super::request::UiRequest;
use super::tasks::WindowTasks;
use super::view_options::ViewOptions;
use super::view_state::ViewState;
use super::widgets::toasts::Toasts;
use super::window_options::WindowOptions;
use crate::command::NewSculpture;
use crate::input::hands::HandSide;
use crate::input::pen::PenCurve;
use crate::render::{LightOptions, RenderOptions, StereoOptions};
use crate::screen::headset::{BlendMode, HeadsetOptions};
use crate::video::VideoOptions;

/// The facts known about files opened or saved.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct KnownFiles {
    /// The files opened or saved last.
    pub recent: Recent,
    /// The up axes of files that do not state them.
    pub upright: Upright,
}

/// The choices made for a headset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeadsetChoices {
    /// The hand with the tool.
    pub hand_side: HandSide,
    /// The blending of pictures with the surroundings.
    pub blend: BlendMode,
}

/// The interface's own state: everything that panels change directly.
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

/// The interval of automatic saves.
#[derive(Clone, Copy, Debug)]
pub struct AutosaveChoice {
    /// Minutes with unsaved changes before a save; 0: never.
    pub minutes: u32,
    /// The value in the settings.
    pub usual_min: u32,
}

/// The initial options of the interface.
#[derive(Clone, Debug)]
pub struct UiOptions<'a> {
    pub window: &'a WindowOptions,
    pub view: &'a ViewOptions,
    /// Minutes with unsaved changes before a save; 0: never.
    pub autosave_min: u32,
    /// The default of the dialog for a new sculpture.
    pub new: NewSculpture,
    pub render: &'a RenderOptions,
    pub light: &'a LightOptions,
    pub stereo: &'a StereoOptions,
    pub video: &'a VideoOptions,
    pub headset: &'a HeadsetOptions,
    /// The pressure curve of pens.
    pub pen: PenCurve,
}

impl UiState {
    /// Returns the state at the start.
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

    /// Shows the open dialogs and windows.
    pub fn show_dialogs(&mut self, root: &Ui, context: &UiContext, requests: &mut Vec<UiRequest>) {
        let mut shared = DialogContext {
            context,
            is_busy: self.dialogs.busy.is_some(),
            view: &mut self.view,
            references: &mut self.references,
            upright: &mut self.known_files.upright,
            toasts: &mut self.toasts,
            requests,
            ask_import: self.dialogs.import.ask,
            openings: Vec::new(),
            led_to: None,
            paste: None,
        };
        self.dialogs.show(root, &mut shared);
        let DialogContext { led_to, paste, .. } = shared;
        if let Some(spot) = led_to {
            self.layout.lead_to(spot);
        }
        self.window_tasks.paste = paste.or(self.window_tasks.paste);
    }
}

impl AsMut<PanelLayout> for UiState {
    fn as_mut(&mut self) -> &mut PanelLayout {
        &mut self.layout
    }
}
