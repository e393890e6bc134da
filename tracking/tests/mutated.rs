//! Hostile bytes do no harm: a million mutated packets, the same in every run, through every decoder. None may
//! cause a panic, a pose that is not finite, or unbounded memory. `VS_FUZZ_RUNS=N` makes it N packets, for long runs by
//! hand.

use std::sync::Arc;

use tracking::vrpn::Message;
use tracking::vrpn::messages::MessageKind;
use tracking::vrpn::peer::{DeviceState, Peer};
use tracking::vrpn::session::Session;
use tracking::vrpn::wire::{Frame, StreamReader, datagram_frames};
use tracking::{Event, opentrack};

/// Xorshift64*: S. Vigna, "An experimental exploration of Marsaglia's xorshift generators", 2016.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() >> 33) as usize % limit.max(1)
    }
}

/// Values that break decoders: huge, negative, not a number, just over a limit.
const NASTY: [u64; 12] = [
    0,
    u64::MAX,
    0x7ff8_0000_0000_0000,
    0x7ff0_0000_0000_0000,
    0xfff0_0000_0000_0000,
    0x7fef_ffff_ffff_ffff,
    0x8000_0000_8000_0000,
    0x7fff_ffff_7fff_ffff,
    0x0001_0000_0001_0000,
    0x4060_2000_0000_0000,
    0x0000_fa18_0000_fa19,
    0x0000_07d0_0000_07cf,
];

/// One to four mutations: a flipped bit, a bad word, truncation, growth, a copy from elsewhere.
fn mutate(packet: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..=random.below(3) {
        let at = random.below(packet.len());
        match random.below(8) {
            0 | 1 if !packet.is_empty() => packet[at] ^= 1 << random.below(8),
            2..=4 if !packet.is_empty() => {
                // Mostly on word boundaries, where the fields are.
                let at = if random.below(4) == 0 { at } else { at & !3 };
                let word = NASTY[random.below(NASTY.len())].to_be_bytes();
                let end = packet.len().min(at + if random.below(2) == 0 { 4 } else { 8 });
                packet[at..end].copy_from_slice(&word[..end - at]);
            }
            5 => packet.truncate(at),
            6 => packet.extend(std::iter::repeat_n(random.next() as u8, random.below(64))),
            _ if !packet.is_empty() => {
                let from = random.below(packet.len());
                let length = random.below(packet.len() - at.max(from));
                packet.copy_within(from..from + length, at);
            }
            _ => {}
        }
    }
}

/// The peak memory of this process in KiB, if the system reports it.
fn peak_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

fn check_events(events: &mut Vec<Event>) {
    for event in events.drain(..) {
        match event {
            Event::Pose(pose) => {
                assert!(pose.placement.position_m.is_finite() && pose.time_s.is_finite());
                assert!((pose.placement.orientation.length() - 1.0).abs() < 1e-9);
            }
            Event::Velocity { velocity, .. } => {
                assert!(velocity.linear_m_s.is_finite() && velocity.angular_rad_s.is_finite());
            }
            Event::Analog { channel, value, .. } => assert!(channel < 128 && value.is_finite()),
            Event::Button { button, .. } => assert!(button < 256),
            Event::Dial { dial, revolutions, .. } => assert!(dial < 256 && revolutions.is_finite()),
            Event::Text { text, .. } => assert!(text.len() <= 3 * 1023),
            Event::Acceleration { linear_m_s2, .. } => assert!(linear_m_s2.is_finite()),
            Event::Found { .. } | Event::Lost { .. } => {}
        }
    }
}

fn session() -> Session {
    let label = |name: &str| (name.to_owned(), Arc::from(name));
    Session::new(["Head0", "Wand0", "Spin0", "Button0", "Dial0"].map(label))
}

/// Feeds a captured stream, so that ids are known.
fn introduce(session: &mut Session, name: &str) {
    let mut reader = StreamReader::default();
    reader.push(&super::captured::bytes(name)[24..]);
    while let Some(frame) = reader.next_frame().unwrap() {
        session.receive(&frame, 0.0, &mut Vec::new());
    }
}

#[test]
fn a_million_mutated_packets() {
    let before_kib = peak_kib();
    let mut random = Random(0x5eed_0000_0000_0001);
    let mut originals = super::captured::datagrams();
    for name in ["det_tcp.s2c.bin", "min_tcp.s2c.bin", "stock_tcp.s2c.bin", "det_udp.c2s.bin"] {
        let all = super::captured::bytes(name);
        let mut rest = &all[24..];
        while let Ok(Some((_, taken))) = tracking::vrpn::wire::split_frame(rest) {
            originals.push(rest[..taken].to_vec());
            rest = &rest[taken..];
        }
    }
    let devices = [
        DeviceState { name: "Head0".into(), held: vec![], sensors: (0..64).collect() },
        DeviceState { name: "Wand0".into(), held: vec![true; 256], sensors: vec![] },
    ];
    let (mut session, mut peer) = (session(), Peer::default());
    let mut reader = StreamReader::default();
    let mut events = Vec::new();
    let mut packet = Vec::new();
    let mut largest_buffer = 0;
    let rounds = std::env::var("VS_FUZZ_RUNS").map_or(1_000_000, |runs| runs.parse().unwrap());
    let rounds: u32 = u32::max(rounds, 10_000);
    for round in 0..rounds {
        // Mutated descriptions may have redefined ids: restart now and then.
        if round % 5000 == 0 {
            session.forget(f64::from(round), &mut events);
            check_events(&mut events);
            introduce(
                &mut session,
                if round % 10_000 == 0 { "det_tcp.s2c.bin" } else { "stock_tcp.s2c.bin" },
            );
            peer = Peer::default();
        }
        packet.clear();
        packet.extend_from_slice(&originals[random.below(originals.len())]);
        mutate(&mut packet, &mut random);

        for frame in datagram_frames(&packet) {
            match frame {
                Ok(frame) => {
                    session.receive(&frame, f64::from(round) * 1e-3, &mut events);
                    assert!(peer.receive(&frame, &devices).len() <= 64);
                }
                Err(error) => session.reject(error),
            }
        }
        check_events(&mut events);

        // The same as a stream, which ends at its first error.
        reader.push(&packet);
        loop {
            match reader.next_frame() {
                Ok(Some(Frame { payload, .. })) => assert!(payload.len() <= 64_000),
                Ok(None) => break,
                Err(_) => {
                    reader = StreamReader::default();
                    break;
                }
            }
        }
        largest_buffer = largest_buffer.max(reader.capacity());

        let kind = MessageKind::ALL[random.below(MessageKind::ALL.len())];
        let _ = Message::decode(kind, packet.get(24..).unwrap_or(&[]));
        if let Ok(placement) =
            opentrack::decode(packet.get(..48).unwrap_or(&packet), opentrack::Signs::default())
        {
            assert!(placement.position_m.is_finite());
        }
    }
    let counters = session.counters;
    let [tenth, hundredth] = [10, 100].map(|part| u64::from(rounds / part));
    assert!(counters.accepted > tenth && counters.malformed > tenth, "{counters:?}");
    assert!(counters.not_finite > hundredth && counters.oversized > hundredth, "{counters:?}");
    assert!(largest_buffer <= 4 * 65_536, "{largest_buffer} bytes held for a stream");
    if let (Some(before), Some(after)) = (before_kib, peak_kib()) {
        assert!(after - before < 32 * 1024, "memory grew by {} KiB", after - before);
    }
}
