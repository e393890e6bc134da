//! VRPN (Virtual-Reality Peripheral Network, version 07.xx): a client that provides a server's
//! trackers, buttons, analogs and dials as a [`crate::Source`], and a small server.
//!
//! `wire` frames bytes, `messages` decodes payloads, `session` and `peer` are the client's and the server's half of
//! a conversation without sockets, `client` and `server` run them on sockets and threads.

mod address;
pub mod client;
mod link;
pub mod messages;
pub mod peer;
mod reports;
mod sender_clock;
pub mod server;
mod server_link;
mod server_state;
pub mod session;
pub mod wire;

pub use address::{AddressError, DEFAULT_PORT, DeviceAddress, Mode, ServerAddress};
pub use client::{Client, ClientTiming};
pub use messages::Message;
pub use reports::pose_reports;
pub use server::{DeviceSpec, Server, ServerOptions};
pub use wire::Stamp;
