//! Tests pens of X11 with the bytes of a server.

use x11rb::protocol::xinput::XIQueryDeviceReply;
use x11rb::x11_utils::TryParse;

use super::*;

const ATOMS: AxisAtoms = AxisAtoms { x: 101, pressure: 103, tilt_x: 104, tilt_y: 105 };

/// Bytes as a server of this machine would send them.
#[derive(Default)]
struct Wire(Vec<u8>);

impl Wire {
    fn u8(mut self, value: u8) -> Wire {
        self.0.push(value);
        self
    }

    fn u16(mut self, value: u16) -> Wire {
        self.0.extend(value.to_ne_bytes());
        self
    }

    fn u32(mut self, value: u32) -> Wire {
        self.0.extend(value.to_ne_bytes());
        self
    }

    fn fixed(self, value: f64) -> Wire {
        let whole = value.floor();
        self.u32(whole as i32 as u32).u32(((value - whole) * 4_294_967_296.0) as u32)
    }

    fn bytes(mut self, bytes: &[u8]) -> Wire {
        self.0.extend(bytes);
        self
    }

    /// Returns a valuator class: kind 2, 11 words long.
    fn axis(self, device: u16, number: u16, label: u32, range: [f64; 2], mode: u8) -> Wire {
        let head = self.u16(2).u16(11).u16(device).u16(number).u32(label);
        head.fixed(range[0]).fixed(range[1]).fixed(range[0]).u32(5080).u8(mode).bytes(&[0; 3])
    }

    /// Returns a device: slave pointers are of use 3, attached to device 2.
    fn device(self, id: u16, kind: u16, classes: u16, name: &str) -> Wire {
        let length = name.len() as u16;
        let head = self.u16(id).u16(kind).u16(2).u16(classes).u16(length).u8(1).u8(0);
        head.bytes(name.as_bytes()).bytes(&vec![0; name.len().next_multiple_of(4) - name.len()])
    }

    fn pen(self, id: u16, name: &str) -> Wire {
        self.device(id, 3, 5, name)
            .axis(id, 0, 101, [0.0, 44_704.0], 1)
            .axis(id, 1, 102, [0.0, 27_940.0], 1)
            .axis(id, 2, 103, [0.0, 65_536.0], 1)
            .axis(id, 3, 104, [-64.0, 63.0], 1)
            .axis(id, 4, 105, [-64.0, 63.0], 1)
    }
}

/// Returns the answer to `XIQueryDevice` of a server with a mouse, a touchpad that feels pressure, and a pen with two
/// ends.
fn devices() -> PenDevices {
    let body = Wire::default()
        .device(8, 3, 1, "Logitech Mouse")
        .axis(8, 0, 201, [-1.0, -1.0], 0)
        .device(9, 3, 3, "SynPS/2 Synaptics TouchPad")
        .axis(9, 0, 201, [0.0, 6000.0], 0)
        .axis(9, 1, 202, [0.0, 6000.0], 0)
        .axis(9, 2, 103, [0.0, 255.0], 1)
        .pen(12, "Wacom Intuos Pro M Pen stylus")
        .pen(13, "Wacom Intuos Pro M Pen eraser")
        .0;
    let head = Wire::default().u8(1).u8(48).u16(7).u32(body.len() as u32 / 4).u16(4);
    let reply = head.bytes(&[0; 22]).bytes(&body).0;
    let (reply, rest) = XIQueryDeviceReply::try_parse(&reply).unwrap();
    assert!(rest.is_empty());
    assert_eq!(reply.infos.len(), 4);
    PenDevices::among(&reply.infos, &ATOMS)
}

/// Returns a device event over window 0x2a00007 at (120.5, 80.25). `axes`: the numbers and values of its axes.
fn event(kind: u16, device: u16, detail: u32, held: u32, axes: &[(u16, f64)]) -> ButtonPressEvent {
    let fixed = |value: f64| (value * 65536.0) as i32 as u32;
    let mask = axes.iter().fold(0, |mask, (number, _)| mask | 1u32 << number);
    let tail = axes.iter().fold(Wire::default().u32(held).u32(mask), |w, (_, v)| w.fixed(*v));
    // 80 bytes and the lists; the length counts words beyond the first 32 bytes.
    let length = (80 + tail.0.len() - 32) as u32 / 4;
    let bytes = Wire::default()
        .u8(35)
        .u8(131)
        .u16(9)
        .u32(length)
        .u16(kind)
        .u16(device)
        .u32(123_456)
        .u32(detail)
        .u32(0x1f0)
        .u32(0x2a0_0007)
        .u32(0)
        .u32(fixed(1120.5))
        .u32(fixed(480.25))
        .u32(fixed(120.5))
        .u32(fixed(80.25))
        .u16(1)
        .u16(1)
        .u16(device)
        .u16(0)
        .u32(0)
        .bytes(&[0; 20])
        .bytes(&tail.0)
        .0;
    let (event, rest) = ButtonPressEvent::try_parse(&bytes).unwrap();
    assert!(rest.is_empty());
    event
}

const PRESS: u16 = 4;
const RELEASE: u16 = 5;
const MOTION: u16 = 6;

#[test]
fn pens_are_told_from_mice_and_touchpads_and_their_ends_from_each_other() {
    let devices = devices();
    let ends: Vec<(u16, PenEnd)> = devices.iter().map(|pen| (pen.id, pen.end)).collect();
    assert_eq!(ends, [(12, PenEnd::Tip), (13, PenEnd::Eraser)]);
    assert_eq!(devices.names()[0], "Wacom Intuos Pro M Pen stylus");
}

#[test]
fn a_stroke_has_its_place_pressure_and_tilt_and_axes_that_are_not_told_stay() {
    let mut devices = devices();
    let hover = event(MOTION, 12, 0, 0, &[(0, 100.0), (1, 100.0), (2, 0.0), (3, 20.5), (4, -7.0)]);
    let hover = devices.report(&hover, EventKind::Motion).unwrap();
    assert_eq!(hover.window, WindowKey::numbered(0x2a0_0007));
    assert_eq!(hover.sample.position_px, Vec2::new(120.5, 80.25));
    assert_eq!(hover.sample.tilt_deg, Vec2::new(20.5, -7.0));
    assert_eq!((hover.sample.pressure, hover.sample.touch()), (Some(0.0), None));

    let press = event(PRESS, 12, 1, 0, &[(2, 16_384.0)]);
    let press = devices.report(&press, EventKind::Press).unwrap().sample;
    assert_eq!((press.pressure, press.tilt_deg), (Some(0.25), Vec2::new(20.5, -7.0)));
    assert_eq!(press.buttons, Buttons::NONE.with(Button::Left));

    let drag = event(MOTION, 12, 0, 1 << 1, &[(2, 32_768.0), (4, 3.0)]);
    let drag = devices.report(&drag, EventKind::Motion).unwrap().sample;
    assert_eq!((drag.pressure, drag.tilt_deg), (Some(0.5), Vec2::new(20.5, 3.0)));
    assert!(drag.is_down());

    let release = event(RELEASE, 12, 1, 1 << 1, &[(2, 0.0)]);
    let release = devices.report(&release, EventKind::Release).unwrap().sample;
    assert_eq!((release.pressure, release.buttons), (Some(0.0), Buttons::NONE));
}

#[test]
fn the_eraser_and_the_buttons_of_the_barrel_are_known_and_a_wheel_is_none() {
    let mut devices = devices();
    let mut held = |device, kind, detail, mask| {
        let wire = match kind {
            EventKind::Press => PRESS,
            EventKind::Release => RELEASE,
            EventKind::Motion => MOTION,
        };
        devices.report(&event(wire, device, detail, mask, &[]), kind).map(|r| r.sample.buttons)
    };
    let set = |buttons: &[Button]| Some(buttons.iter().fold(Buttons::NONE, |s, b| s.with(*b)));
    assert_eq!(held(13, EventKind::Press, 1, 0), set(&[Button::Eraser]));
    assert_eq!(held(12, EventKind::Press, 2, 0), set(&[Button::PenLower]));
    assert_eq!(held(12, EventKind::Press, 3, 1 << 2), set(&[Button::PenLower, Button::PenUpper]));
    assert_eq!(held(12, EventKind::Release, 2, 1 << 2), set(&[]));
    assert_eq!(held(12, EventKind::Press, 8, 0), set(&[Button::PenThird]));
    assert_eq!(held(12, EventKind::Press, 4, 0), set(&[]), "a wheel");
    assert_eq!(held(8, EventKind::Press, 1, 0), None, "a mouse");
}
