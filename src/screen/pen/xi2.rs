//! The pens of XInput2: recognises pen devices by their axes, and turns their events into reports.
//!
//! Pure: takes what the server has sent. The pointer of a pen comes with the events of the window.

use glam::Vec2;
use x11rb::protocol::xinput::{
    ButtonPressEvent, DeviceClassData, DeviceClassDataValuator, DeviceType, Fp3232, ValuatorMode,
    XIDeviceInfo,
};
use x11rb::protocol::xproto::Atom;

use super::{PenReport, WindowKey};
use crate::input::pen::{PenEnd, PenSample};
use crate::input::{Button, Buttons};

/// The kinds of axes, as named by the server.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct AxisAtoms {
    pub x: Atom,
    pub pressure: Atom,
    pub tilt_x: Atom,
    pub tilt_y: Atom,
}

impl AxisAtoms {
    /// The names, in the order of the fields.
    pub const NAMES: [&'static str; 4] = ["Abs X", "Abs Pressure", "Abs Tilt X", "Abs Tilt Y"];
}

/// The buttons of a pen by their numbers: those of the barrel are 2 and 3, 4 to 7 are notches of a wheel.
const BUTTONS: [(u32, Button); 4] =
    [(1, Button::Left), (2, Button::PenLower), (3, Button::PenUpper), (8, Button::PenThird)];

#[derive(Clone, Copy, PartialEq, Debug)]
struct PenAxis {
    number: u16,
    min: f32,
    max: f32,
    value: f32,
}

impl PenAxis {
    fn of(class: &DeviceClassDataValuator) -> Option<PenAxis> {
        let [min, max, value] = [class.min, class.max, class.value].map(number);
        let axis = PenAxis { number: class.number, min, max, value };
        (class.mode == ValuatorMode::ABSOLUTE && min < max).then_some(axis)
    }

    /// Returns its position in its range, 0 to 1.
    fn share(&self) -> f32 {
        (self.value - self.min) / (self.max - self.min)
    }
}

/// One end of a pen, which X11 treats as a device.
#[derive(Clone, PartialEq, Debug)]
pub struct PenDevice {
    pub id: u16,
    pub name: String,
    pub end: PenEnd,
    pressure: PenAxis,
    tilt: [Option<PenAxis>; 2],
}

impl PenDevice {
    /// Returns the device, if it is a pen: a separate pointer with absolute positions and pressure.
    pub fn of(info: &XIDeviceInfo, atoms: &AxisAtoms) -> Option<PenDevice> {
        if info.type_ != DeviceType::SLAVE_POINTER && info.type_ != DeviceType::FLOATING_SLAVE {
            return None;
        }
        let axis = |label: Atom| {
            info.classes.iter().find_map(|class| match &class.data {
                DeviceClassData::Valuator(axis) if axis.label == label => PenAxis::of(axis),
                _ => None,
            })
        };
        axis(atoms.x)?;
        let name = String::from_utf8_lossy(&info.name).into_owned();
        let erases = name.to_lowercase().contains("eraser");
        Some(PenDevice {
            id: info.deviceid,
            end: if erases { PenEnd::Eraser } else { PenEnd::Tip },
            pressure: axis(atoms.pressure)?,
            tilt: [axis(atoms.tilt_x), axis(atoms.tilt_y)],
            name,
        })
    }

    /// Updates the axes contained in an event; the others stay.
    fn follow(&mut self, event: &ButtonPressEvent) {
        let mut values = event.axisvalues.iter();
        let numbers = event.valuator_mask.iter().zip(0..).flat_map(|(word, i)| {
            (0..32).filter(move |bit| word >> bit & 1 == 1).map(move |bit| i * 32 + bit)
        });
        for axis_number in numbers {
            let Some(value) = values.next() else { return };
            let axes = self.tilt.iter_mut().flatten().chain([&mut self.pressure]);
            axes.filter(|axis| axis.number == axis_number)
                .for_each(|axis| axis.value = number(*value));
        }
    }

    /// Returns the buttons that are down after an event, which itself reports those before.
    fn buttons(&self, event: &ButtonPressEvent, kind: EventKind) -> Buttons {
        let mut held = Buttons::NONE;
        for (number, button) in BUTTONS {
            let own = if button == Button::Left { self.tip() } else { button };
            let word = event.button_mask.get(number as usize / 32).copied().unwrap_or(0);
            let is_down = match kind {
                EventKind::Press if event.detail == number => true,
                EventKind::Release if event.detail == number => false,
                _ => word >> (number % 32) & 1 == 1,
            };
            if is_down {
                held = held.with(own);
            }
        }
        held
    }

    fn tip(&self) -> Button {
        match self.end {
            PenEnd::Tip => Button::Left,
            PenEnd::Eraser => Button::Eraser,
        }
    }
}

/// The events with the layout of a press.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum EventKind {
    Motion,
    Press,
    Release,
}

/// The pens of a server.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PenDevices(Vec<PenDevice>);

impl PenDevices {
    /// Returns the pens among all devices.
    pub fn among(infos: &[XIDeviceInfo], atoms: &AxisAtoms) -> PenDevices {
        PenDevices(infos.iter().filter_map(|info| PenDevice::of(info, atoms)).collect())
    }

    /// Returns a device that a test declares a pen, with a pressure axis that it does not have.
    #[cfg(test)]
    pub fn pretended(id: u16) -> PenDevices {
        let pressure = PenAxis { number: 99, min: 0.0, max: 1.0, value: 0.5 };
        let (name, end, tilt) = ("pretended".to_string(), PenEnd::Tip, [None, None]);
        PenDevices(vec![PenDevice { id, name, end, pressure, tilt }])
    }

    pub fn iter(&self) -> impl Iterator<Item = &PenDevice> {
        self.0.iter()
    }

    pub fn names(&self) -> Vec<String> {
        self.0.iter().map(|pen| pen.name.clone()).collect()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the report of a pen event over its window; `None` if it is not from a pen.
    pub fn report(&mut self, event: &ButtonPressEvent, kind: EventKind) -> Option<PenReport> {
        let pen = self.0.iter_mut().find(|pen| pen.id == event.deviceid)?;
        pen.follow(event);
        let position_px = Vec2::new(event.event_x as f32, event.event_y as f32) / 65536.0;
        let tilt = pen.tilt.map(|axis| axis.map_or(0.0, |axis| axis.value));
        let sample = PenSample {
            position_px,
            pressure: Some(pen.pressure.share()),
            tilt_deg: tilt.into(),
            end: pen.end,
            buttons: pen.buttons(event, kind),
            is_near: true,
        };
        let window = WindowKey::numbered(event.event.into());
        sample.checked().map(|sample| PenReport { window, sample })
    }
}

fn number(fixed: Fp3232) -> f32 {
    (f64::from(fixed.integral) + f64::from(fixed.frac) / 4_294_967_296.0) as f32
}

#[cfg(test)]
#[path = "xi2_tests.rs"]
mod tests;
