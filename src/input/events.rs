//! Device events as values: pointer, pens, keys and wheel over the viewport. Keys have egui's names, since they come
//! through it.
//!
//! Takes egui's events, so that windows and panels above the viewport keep theirs; returns
//! [`DeviceEvent`]s in pixels of the viewport.

use egui::{Event, Key, MouseWheelUnit, Pos2, Rect, TouchPhase};
use glam::Vec2;

use super::button::Button;
use super::pen::{PenTouch, PenTrack};

/// Points of scrolling per notch of a wheel.
const POINTS_PER_NOTCH: f32 = 50.0;
/// Notches per page of scrolling.
const NOTCHES_PER_PAGE: f32 = 10.0;
/// Natural logarithm of the pinch zoom per notch.
const PINCH_PER_NOTCH: f32 = 0.1;

/// Modifier keys. On a Mac the command key counts as `ctrl`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Modifiers {
    pub ctrl: bool,
    pub shift: bool,
    pub alt: bool,
}

impl From<egui::Modifiers> for Modifiers {
    fn from(m: egui::Modifiers) -> Modifiers {
        Modifiers { ctrl: m.ctrl || m.command, shift: m.shift, alt: m.alt }
    }
}

/// A device event. Positions are in pixels from the viewport's upper left corner.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum DeviceEvent {
    Moved {
        at: Vec2,
        modifiers: Modifiers,
    },
    /// The pointer has left the viewport.
    Left,
    Pressed {
        button: Button,
        at: Vec2,
        modifiers: Modifiers,
    },
    Released {
        button: Button,
    },
    /// Positive notches: the wheel turned away from the hand.
    Wheel {
        notches: f32,
        at: Vec2,
        modifiers: Modifiers,
    },
    KeyPressed {
        key: Key,
        /// The key at its position on a keyboard with Latin letters.
        place: Option<Key>,
        modifiers: Modifiers,
        repeat: bool,
    },
    KeyReleased {
        key: Key,
    },
    /// The touch of a pen or a finger from here on; `None` for a mouse.
    Touch(Option<PenTouch>),
    /// The window has lost the focus: nothing is held.
    FocusLost,
}

/// The area of the viewport, and the input that it gets.
#[derive(Clone, Copy, Debug)]
pub struct ViewportInput {
    /// In points.
    pub rect: Rect,
    pub pixels_per_point: f32,
    /// The pointer is over the viewport, with nothing in between.
    pub hovered: bool,
    /// A button was pressed in the viewport and is still held.
    pub captured: bool,
    /// Neither a text field nor a dialog has the keyboard.
    pub keyboard: bool,
    /// Keys that something else uses nevertheless.
    pub kept: KeptKeys,
}

/// Keys that a focused button, a slider or an open list withholds from the viewport.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct KeptKeys {
    pub enter: bool,
    pub space: bool,
    pub arrows: bool,
    pub escape: bool,
}

impl KeptKeys {
    fn has(self, key: Key) -> bool {
        match key {
            Key::Enter => self.enter,
            Key::Space => self.space,
            Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown => self.arrows,
            Key::Escape => self.escape,
            _ => false,
        }
    }
}

impl ViewportInput {
    /// Converts to pixels of the window.
    fn window_pixels(&self, at: Pos2) -> Vec2 {
        Vec2::new(at.x, at.y) * self.pixels_per_point
    }

    fn pixels(&self, at: Pos2) -> Vec2 {
        let at = (at - self.rect.min) * self.pixels_per_point;
        Vec2::new(at.x, at.y)
    }
}

/// Returns the events of this frame for the viewport. `pens`: tracks the pens that lead the pointer.
pub fn device_events(
    input: &egui::InputState,
    viewport: &ViewportInput,
    pens: &mut PenTrack,
) -> Vec<DeviceEvent> {
    let mut pointer = input.pointer.latest_pos();
    let mut modifiers = Modifiers::from(input.modifiers);
    let mut events = Vec::new();
    let mut lifted = false;
    for event in &input.events {
        let of_pen = follow_pen(event, viewport, pens);
        let is_release = matches!(event, Event::PointerButton { pressed: false, .. });
        if !is_release {
            events.extend(pens.news().map(DeviceEvent::Touch));
        }
        events.extend(match *event {
            Event::ModifiersChanged(now) => {
                modifiers = now.into();
                None
            }
            Event::PointerMoved(at) => {
                pointer = Some(at);
                (viewport.hovered || viewport.captured)
                    .then(|| DeviceEvent::Moved { at: viewport.pixels(at), modifiers })
            }
            Event::PointerButton { pos, button, pressed: true, modifiers } => {
                (viewport.hovered || viewport.captured).then(|| DeviceEvent::Pressed {
                    button: of_pen.unwrap_or(button.into()),
                    at: viewport.pixels(pos),
                    modifiers: modifiers.into(),
                })
            }
            Event::PointerButton { button, pressed: false, .. } => {
                Some(DeviceEvent::Released { button: of_pen.unwrap_or(button.into()) })
            }
            Event::Touch { phase: TouchPhase::Start | TouchPhase::Move, force, .. } => {
                // Devices without pressure report no force at all.
                let force = force.filter(|force| *force > 0.0);
                force.map(|force| DeviceEvent::Touch(Some(PenTouch::of_pressure(force))))
            }
            Event::Touch { .. } => {
                lifted = true;
                None
            }
            Event::PointerGone => Some(DeviceEvent::Left),
            Event::MouseWheel { unit, delta, modifiers, .. } => {
                let notches = match unit {
                    MouseWheelUnit::Line => delta.y,
                    MouseWheelUnit::Point => delta.y / POINTS_PER_NOTCH,
                    MouseWheelUnit::Page => delta.y * NOTCHES_PER_PAGE,
                };
                wheel(viewport, pointer, notches, modifiers.into())
            }
            Event::Zoom(factor) if factor > 0.0 => {
                wheel(viewport, pointer, factor.ln() / PINCH_PER_NOTCH, Modifiers::default())
            }
            Event::Key { key, physical_key: place, pressed: true, repeat, modifiers }
                if viewport.keyboard && !viewport.kept.has(key) =>
            {
                Some(DeviceEvent::KeyPressed { key, place, modifiers: modifiers.into(), repeat })
            }
            // A focused text field gets these itself.
            Event::Copy if viewport.keyboard => Some(shortcut(Key::C, modifiers)),
            Event::Cut if viewport.keyboard => Some(shortcut(Key::X, modifiers)),
            Event::Paste(_) if viewport.keyboard => Some(shortcut(Key::V, modifiers)),
            Event::Key { key, pressed: false, .. } => Some(DeviceEvent::KeyReleased { key }),
            Event::WindowFocused(false) => Some(DeviceEvent::FocusLost),
            _ => None,
        });
        events.extend(pens.news().map(DeviceEvent::Touch));
    }
    if lifted {
        events.push(DeviceEvent::Touch(None));
    }
    if !viewport.hovered && !viewport.captured {
        events.push(DeviceEvent::Left);
    }
    events
}

/// Advances the known pen samples to the pointer. Returns the pen button of a press or a release.
fn follow_pen(event: &Event, viewport: &ViewportInput, pens: &mut PenTrack) -> Option<Button> {
    match *event {
        Event::PointerMoved(at) => {
            pens.moved(viewport.window_pixels(at));
            None
        }
        Event::PointerButton { button, pressed: true, .. } => pens.press(button),
        Event::PointerButton { button, pressed: false, .. } => pens.release(button),
        Event::WindowFocused(false) => {
            pens.let_go();
            None
        }
        _ => None,
    }
}

/// Returns the key with ctrl that the window system has translated to an event of its own.
fn shortcut(key: Key, modifiers: Modifiers) -> DeviceEvent {
    let modifiers = Modifiers { ctrl: true, ..modifiers };
    DeviceEvent::KeyPressed { key, place: None, modifiers, repeat: false }
}

fn wheel(
    viewport: &ViewportInput,
    pointer: Option<Pos2>,
    notches: f32,
    modifiers: Modifiers,
) -> Option<DeviceEvent> {
    let at = viewport.pixels(pointer?);
    (viewport.hovered && notches != 0.0).then_some(DeviceEvent::Wheel { notches, at, modifiers })
}
