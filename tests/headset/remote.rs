//! Client of Monado's `remote` driver: sets the poses and inputs of a headset and two controllers by packets of 376 bytes
//! (../../shared/openxr/README.md).

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use glam::{Quat, Vec3};

use super::program::PATIENCE;

/// Initial position of the head.
pub const HEAD: Vec3 = Vec3::new(0.0, 1.6, 0.0);
/// Behind the person, out of view.
pub const AWAY: Vec3 = Vec3::new(0.0, 1.0, 2.0);
/// Half angles of view of both eyes in radians: left, right, up, down; not symmetric, so that a wrong
/// sign is noticed.
pub const ANGLES: [[f32; 4]; 2] = [[-0.8, 0.7, 0.75, -0.85], [-0.7, 0.8, 0.75, -0.85]];
/// Position of each eye relative to the head's centre, in metres.
pub const EYES: [Vec3; 2] = [Vec3::new(-0.04, 0.0, 0.0), Vec3::new(0.04, 0.0, 0.0)];
const SIZE: usize = 376;

#[derive(Clone, Copy)]
pub enum Side {
    Left,
    Right,
}

#[derive(Clone, Copy)]
struct Hand {
    position: Vec3,
    rotation: Quat,
    trigger: f32,
    squeeze: f32,
    stick: [f32; 2],
    menu: bool,
    pick: bool,
}

pub struct Remote {
    stream: TcpStream,
    pub head: (Vec3, Quat),
    hands: [Hand; 2],
}

impl Remote {
    /// Connects to the driver, once it listens.
    pub fn connect() -> Remote {
        let start = Instant::now();
        let mut stream = loop {
            match TcpStream::connect("127.0.0.1:4242") {
                Ok(stream) => break stream,
                Err(error) => {
                    assert!(start.elapsed() < PATIENCE, "no driver: {error}");
                    std::thread::sleep(Duration::from_millis(50));
                }
            }
        };
        stream.set_nodelay(true).unwrap();
        // The driver first sends two packets.
        let mut greeting = [0; 2 * SIZE];
        stream.read_exact(&mut greeting).unwrap();
        let hand = |x| Hand {
            position: Vec3::new(x, 1.3, -0.35),
            rotation: Quat::IDENTITY,
            trigger: 0.0,
            squeeze: 0.0,
            stick: [0.0; 2],
            menu: false,
            pick: false,
        };
        Remote { stream, head: (HEAD, Quat::IDENTITY), hands: [hand(-0.2), hand(0.2)] }
    }

    pub fn send(&mut self) {
        let mut packet = b"mndrmt3\0".to_vec();
        let floats = |packet: &mut Vec<u8>, values: &[f32]| {
            values.iter().for_each(|value| packet.extend(value.to_le_bytes()));
        };
        for (angles, eye) in ANGLES.iter().zip(EYES) {
            floats(&mut packet, angles);
            floats(&mut packet, &Quat::IDENTITY.to_array());
            floats(&mut packet, &eye.to_array());
            packet.extend([0; 4]);
        }
        let (position, rotation) = self.head;
        floats(&mut packet, &rotation.to_array());
        floats(&mut packet, &position.to_array());
        packet.extend([1, 0, 0, 0]);
        for hand in &self.hands {
            floats(&mut packet, &hand.rotation.to_array());
            floats(&mut packet, &hand.position.to_array());
            // Velocities and curled fingers.
            floats(&mut packet, &[0.0; 11]);
            floats(&mut packet, &[hand.trigger, hand.squeeze, hand.squeeze]);
            floats(&mut packet, &hand.stick);
            floats(&mut packet, &[0.0; 3]);
            let pressed = u8::from(hand.trigger > 0.5);
            // Hand tracking, active, system, a, b, trigger, stick, trackpad, padding.
            let menu = u8::from(hand.menu);
            let pick = u8::from(hand.pick);
            packet.extend([0, 1, 0, 0, pick, pick, menu, menu, pressed, pressed, 0, 0, 0, 0, 0, 0]);
        }
        assert_eq!(packet.len(), SIZE);
        self.stream.write_all(&packet).unwrap();
    }

    fn hand(&mut self, side: Side) -> &mut Hand {
        &mut self.hands[side as usize]
    }

    pub fn place(&mut self, side: Side, position: Vec3, rotation: Quat) {
        (self.hand(side).position, self.hand(side).rotation) = (position, rotation);
        self.send();
    }

    /// Moves both hands out of view.
    pub fn hands_away(&mut self) {
        self.place(Side::Left, AWAY, Quat::IDENTITY);
        self.place(Side::Right, AWAY, Quat::IDENTITY);
    }

    pub fn trigger(&mut self, side: Side, down: bool) {
        self.hand(side).trigger = f32::from(u8::from(down));
        self.send();
    }

    pub fn squeeze(&mut self, side: Side, down: bool) {
        self.hand(side).squeeze = f32::from(u8::from(down));
        self.send();
    }

    pub fn stick(&mut self, side: Side, stick: [f32; 2]) {
        self.hand(side).stick = stick;
        self.send();
    }

    /// The button that picks a colour: A on this controller.
    pub fn pick(&mut self, side: Side, down: bool) {
        self.hand(side).pick = down;
        self.send();
    }

    /// The button that opens the board: B on this controller.
    pub fn menu(&mut self, side: Side, down: bool) {
        self.hand(side).menu = down;
        self.send();
    }
}
