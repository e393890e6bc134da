//! The job `track`, for setting up head tracking: shows the poses of a source, or serves them by
//! VRPN.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::time::{Duration, Instant, SystemTime};

use clap::Args;
use glam::EulerRot;
use thiserror::Error;
use tracking::vrpn::messages::{MAX_BUTTONS, MAX_CHANNELS};
use tracking::vrpn::server::{PublishError, ServerError};
use tracking::vrpn::{
    DEFAULT_PORT, DeviceSpec, Message, Server, ServerOptions, Stamp, pose_reports,
};
use tracking::{Event, HeadPose, HostClock, Source, SourceState};

use crate::config::Config;
use crate::head_tracking::{SourceAddress, SourceError, source};
use crate::terminal::{self, OutputError};

/// Interval of polling the sources.
const LOOK_EVERY: Duration = Duration::from_millis(2);

#[derive(Args, Debug, Clone)]
pub struct TrackArgs {
    /// Source of the poses: Device@host, Device@tcp://host, opentrack:PORT, openxr, script:FILE (default:
    /// tracking.source in the settings)
    #[arg(long, visible_alias = "source", value_name = "SOURCE")]
    pub from: Option<SourceAddress>,
    /// Serve the poses over VRPN instead of showing them
    #[arg(long)]
    pub serve: bool,
    /// Address to serve at; 0.0.0.0 allows other machines
    #[arg(long, default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST), value_name = "ADDRESS")]
    pub listen: IpAddr,
    /// Port to serve at; 0 chooses a free one
    #[arg(long, default_value_t = DEFAULT_PORT, value_name = "PORT")]
    pub port: u16,
    /// Name under which to serve
    #[arg(long, default_value = "Tracker0", value_name = "NAME")]
    pub device: String,
    /// Stop after this many seconds
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    pub seconds: Option<Duration>,
}

fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|s| Duration::try_from_secs_f64(s).ok());
    seconds.ok_or_else(|| "must be a number of seconds".to_string())
}

/// The reason why tracking ended.
#[derive(Debug, Error)]
pub enum TrackError {
    #[error(
        "no source of poses is set; use --from, or tracking.source in the settings: \
         Device@host, Device@tcp://host, opentrack:PORT, openxr or script:FILE"
    )]
    NoSource,
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error("cannot serve: {0}")]
    Server(#[from] ServerError),
    #[error("cannot serve: {0}")]
    Publish(#[from] PublishError),
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Shows or serves poses until the time is over, a script has ended, or the program is stopped.
pub fn run(args: &TrackArgs, config: &Config) -> Result<(), TrackError> {
    let settings = &config.tracking;
    let address = args.from.as_ref().unwrap_or(&settings.source);
    if *address == SourceAddress::None {
        return Err(TrackError::NoSource);
    }
    let clock = HostClock::starting_now();
    let controls = settings.controls();
    let mut sources = source::open(address, controls.as_ref(), settings.signs(), None, clock)?;
    if args.serve {
        serve(args, address, &mut sources, clock)
    } else {
        show(args, &mut sources, clock)
    }
}

/// Pauses. Returns whether the job continues.
fn goes_on(args: &TrackArgs, sources: &[Box<dyn Source>], started: Instant) -> bool {
    std::thread::sleep(LOOK_EVERY);
    let over = args.seconds.is_some_and(|limit| started.elapsed() >= limit);
    !over && !sources.iter().all(|source| matches!(source.state(), SourceState::Ended(_)))
}

/// Publishes the events of the sources as one device.
fn serve(
    args: &TrackArgs,
    address: &SourceAddress,
    sources: &mut [Box<dyn Source>],
    clock: HostClock,
) -> Result<(), TrackError> {
    let listen = SocketAddr::new(args.listen, args.port);
    let devices = [DeviceSpec { name: args.device.clone(), buttons: MAX_BUTTONS }];
    let server = Server::start(ServerOptions { listen, ..Default::default() }, &devices)?;
    let (device, label, at) = (&args.device, address.label(), server.address());
    terminal::print_done(format_args!("serving {device} of {label} at {at}"));
    let (mut events, mut reports) = (Vec::new(), Vec::new());
    let mut channels: Vec<f64> = Vec::new();
    let started = Instant::now();
    loop {
        for source in sources.iter_mut() {
            source.poll(clock.now_s(), &mut events);
        }
        for event in events.drain(..) {
            match event {
                Event::Pose(pose) => reports.extend(pose_reports(&pose)),
                Event::Button { button, pressed, .. } => {
                    reports.push(Message::ButtonChange { button, pressed });
                }
                Event::Analog { channel, value, .. } if (channel as usize) < MAX_CHANNELS => {
                    let channel = channel as usize;
                    channels.resize(channels.len().max(channel + 1), 0.0);
                    channels[channel] = value;
                    reports.push(Message::Analog(channels.clone()));
                }
                Event::Dial { dial, revolutions, .. } => {
                    reports.push(Message::Dial { dial, revolutions });
                }
                _ => {}
            }
        }
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        server.publish(&args.device, &reports, Stamp::from(now))?;
        reports.clear();
        if !goes_on(args, sources, started) {
            return Ok(());
        }
    }
}

/// The events since the monitor's last line.
#[derive(Default)]
struct MonitorTally {
    pose: Option<HeadPose>,
    poses: u32,
    losses: u32,
    buttons: Vec<String>,
}

impl MonitorTally {
    fn take(&mut self, event: Event) {
        match event {
            Event::Pose(pose) => {
                self.poses += 1;
                self.pose = Some(pose);
            }
            Event::Lost { .. } => self.losses += 1,
            Event::Button { button, pressed, .. } => {
                self.buttons
                    .push(format!("button {button} {}", if pressed { "down" } else { "up" }));
            }
            Event::Analog { channel, value, .. } => {
                self.buttons.push(format!("analog {channel} {value:.3}"));
            }
            _ => {}
        }
    }
}

/// Prints the poses and the quality of the source twice a second.
fn show(
    args: &TrackArgs,
    sources: &mut [Box<dyn Source>],
    clock: HostClock,
) -> Result<(), TrackError> {
    const LINE_EVERY: Duration = Duration::from_millis(500);
    for source in sources.iter() {
        terminal::print_result(format_args!("source {}", source.name()))?;
    }
    let (started, mut last_line) = (Instant::now(), Instant::now());
    let (mut tally, mut losses) = (MonitorTally::default(), 0);
    let mut events = Vec::new();
    loop {
        for source in sources.iter_mut() {
            source.poll(clock.now_s(), &mut events);
        }
        events.drain(..).for_each(|event| tally.take(event));
        let goes_on = goes_on(args, sources, started);
        let elapsed = last_line.elapsed();
        if elapsed >= LINE_EVERY || !goes_on {
            losses += tally.losses;
            for line in lines(&tally, sources, elapsed, losses) {
                terminal::print_result(format_args!(
                    "{:7.1} s  {line}",
                    started.elapsed().as_secs_f64()
                ))?;
            }
            (tally, last_line) = (MonitorTally::default(), Instant::now());
        }
        if !goes_on {
            return Ok(());
        }
    }
}

fn lines(
    tally: &MonitorTally,
    sources: &[Box<dyn Source>],
    elapsed: Duration,
    losses: u32,
) -> Vec<String> {
    let rate_hz = f64::from(tally.poses) / elapsed.as_secs_f64().max(1e-3);
    let counters = sources.iter().map(|source| source.counters());
    let (dropped, unread) =
        counters.fold((0, 0), |sum, c| (sum.0 + c.rejected(), sum.1 + c.unread));
    let quality = format!("{rate_hz:5.1} Hz  lost {losses}  dropped {dropped}  unread {unread}");
    let mut lines = Vec::new();
    if let Some(pose) = &tally.pose {
        let at = pose.placement.position_m;
        let (yaw, pitch, roll) = pose.placement.orientation.to_euler(EulerRot::YXZ);
        let [yaw, pitch, roll] = [yaw, pitch, roll].map(f64::to_degrees);
        lines.push(format!(
            "sensor {}  x {:+.3} y {:+.3} z {:+.3} m  yaw {yaw:+.1} pitch {pitch:+.1} roll \
             {roll:+.1} deg  confidence {:.2}  {quality}",
            pose.sensor, at.x, at.y, at.z, pose.confidence
        ));
    } else {
        let states = sources.iter().map(|source| match source.state() {
            SourceState::Running => "connected, no poses".to_owned(),
            SourceState::Seeking(why) | SourceState::Ended(why) => why,
        });
        lines.push(format!("{}  {quality}", states.collect::<Vec<_>>().join("; ")));
    }
    if !tally.buttons.is_empty() {
        lines.push(tally.buttons.join(", "));
    }
    lines
}
