//! Opens the sources of poses behind an address.

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

use thiserror::Error;
use tracking::opentrack::{Opentrack, OpentrackOptions, Signs};
use tracking::scripted::{Script, ScriptError, Scripted};
use tracking::vrpn::{Client, ClientTiming, DeviceAddress};
use tracking::{HostClock, Source};

use super::SourceAddress;
use crate::format::store;
use crate::screen::headset::{HeadsetTracker, SessionHead};

/// The reason why a source of poses cannot be opened.
#[derive(Debug, Error)]
pub enum SourceError {
    #[error("cannot listen for opentrack at {0}: {1}")]
    Listen(SocketAddr, io::Error),
    #[error("cannot start a thread for tracking: {0}")]
    Thread(io::Error),
    #[error("cannot read the script of poses {0}: {1}")]
    ReadScript(PathBuf, io::Error),
    #[error("the script of poses {0}: {1}")]
    Script(PathBuf, ScriptError),
}

/// Opens a source, and a second VRPN device for buttons and analogs if `controls` names one. Servers and senders may
/// start later: their sources wait for them. `session_head`: of the program's own headset, which becomes the source of
/// its pose.
pub fn open(
    address: &SourceAddress,
    controls: Option<&DeviceAddress>,
    signs: Signs,
    session_head: Option<&SessionHead>,
    clock: HostClock,
) -> Result<Vec<Box<dyn Source>>, SourceError> {
    let mut sources: Vec<Box<dyn Source>> = Vec::new();
    let mut devices: Vec<DeviceAddress> = controls.into_iter().cloned().collect();
    match address {
        SourceAddress::None => {}
        SourceAddress::Vrpn(device) => {
            devices.retain(|other| other != device);
            devices.insert(0, device.clone());
        }
        SourceAddress::Opentrack(listen) => {
            let options = OpentrackOptions { listen: *listen, label: address.label(), signs };
            let source = Opentrack::start(options, clock)
                .map_err(|error| SourceError::Listen(*listen, error))?;
            sources.push(Box::new(source));
        }
        SourceAddress::Script(path) => {
            let text = store::read_text(path)
                .map_err(|error| SourceError::ReadScript(path.clone(), error))?;
            let script =
                Script::parse(&text).map_err(|error| SourceError::Script(path.clone(), error))?;
            sources.push(Box::new(Scripted::new(&address.label(), script)));
        }
        SourceAddress::Openxr(origin) => match session_head {
            Some(head) => sources.push(Box::new(head.source())),
            None => {
                let source = HeadsetTracker::start(&address.label(), *origin, clock)
                    .map_err(SourceError::Thread)?;
                sources.push(Box::new(source));
            }
        },
    }
    let clients = Client::start_all(&devices, ClientTiming::default(), clock);
    for client in clients.map_err(SourceError::Thread)? {
        sources.push(Box::new(client));
    }
    Ok(sources)
}
