//! Addresses of VRPN devices: `Head0@host`, `Head0@host:port`, `Head0@tcp://host:port`. Takes text, gives device,
//! mode, host and port; opens no sockets.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::vrpn::wire::MAX_NAME_BYTES;

/// The default port of VRPN servers.
pub const DEFAULT_PORT: u16 = 3883;

/// The connection of client and server.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Mode {
    /// The client connects by TCP, and all messages use it.
    Tcp,
    /// The client sends a request by UDP, the server connects back by TCP, and poses are sent by UDP.
    Udp,
}

/// A server and its connection mode.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct ServerAddress {
    pub mode: Mode,
    pub host: String,
    pub port: u16,
}

/// A device on a server.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct DeviceAddress {
    pub device: String,
    pub server: ServerAddress,
}

/// The reason why a text is not the address of a VRPN device.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error(
    "\"{0}\" names no VRPN device: expected device@host, device@host:port or device@tcp://host:port"
)]
pub struct AddressError(String);

impl FromStr for DeviceAddress {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        let error = || AddressError(text.to_owned());
        let (device, place) = text.split_once('@').ok_or_else(error)?;
        let (mode, place) = match place.split_once("://") {
            Some(("tcp", place)) => (Mode::Tcp, place),
            Some(("x-vrpn" | "vrpn", place)) => (Mode::Udp, place),
            Some(_) => return Err(error()),
            None => (Mode::Udp, place),
        };
        // An IPv6 address is in brackets, as in URLs.
        let (host, port) = match place.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            Some((host, "")) => (host, None),
            Some((host, rest)) => (host, Some(rest.strip_prefix(':').ok_or_else(error)?)),
            None => match place.split_once(':') {
                Some((host, port)) => (host, Some(port)),
                None => (place, None),
            },
        };
        let port = match port {
            Some(port) => port.parse().ok().filter(|port| *port != 0).ok_or_else(error)?,
            None => DEFAULT_PORT,
        };
        let device_is_sound =
            (1..=MAX_NAME_BYTES).contains(&device.len()) && !device.contains(char::is_control);
        let host_is_sound = !host.is_empty()
            && host.chars().all(|c| c.is_ascii_alphanumeric() || ".-_:%".contains(c));
        if !device_is_sound || !host_is_sound {
            return Err(error());
        }
        let server = ServerAddress { mode, host: host.to_owned(), port };
        Ok(Self { device: device.to_owned(), server })
    }
}

impl fmt::Display for ServerAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.mode == Mode::Tcp {
            f.write_str("tcp://")?;
        }
        if self.host.contains(':') {
            write!(f, "[{}]:{}", self.host, self.port)
        } else {
            write!(f, "{}:{}", self.host, self.port)
        }
    }
}

impl fmt::Display for DeviceAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@{}", self.device, self.server)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_apart_and_together() {
        for (text, full) in [
            ("Head0@lab", "Head0@lab:3883"),
            ("Head0@127.0.0.1:4000", "Head0@127.0.0.1:4000"),
            ("Wand 1@tcp://lab", "Wand 1@tcp://lab:3883"),
            ("Wand0@tcp://[::1]:99", "Wand0@tcp://[::1]:99"),
            ("Wand0@x-vrpn://lab", "Wand0@lab:3883"),
        ] {
            let address: DeviceAddress = text.parse().unwrap();
            assert_eq!(address.to_string(), full);
            assert_eq!(full.parse::<DeviceAddress>().unwrap(), address);
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "",
            "Head0",
            "@lab",
            "Head0@",
            "Head0@http://lab",
            "Head0@lab:0",
            "Head0@lab:99999",
            "Head0@lab:x",
            "Head0@a b",
            "Head0@[::1]x",
            "He\nad@lab",
            "Head0@tcp://",
        ] {
            assert!(text.parse::<DeviceAddress>().is_err(), "{text:?}");
        }
        assert!(format!("{}@lab", "a".repeat(96)).parse::<DeviceAddress>().is_err());
    }
}
