//! The space of the room in which a session places head, hands and eyes.
//!
//! Takes a session and the requested origin; knows no threads and no pictures.

use openxr as xr;

use super::error::{Doing, Result};

/// The origin of the room's space.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RoomOrigin {
    /// On the floor, in the centre of the play area, if the runtime knows it.
    #[default]
    Stage,
    /// The head's position when the session began.
    Local,
}

/// Returns the requested space of the room, or the default that every runtime has.
pub(super) fn create_room_space<G: xr::Graphics>(
    session: &xr::Session<G>,
    origin: RoomOrigin,
) -> Result<xr::Space> {
    const DOING: &str = "create the space of the room";
    let offered = session.enumerate_reference_spaces().doing(DOING)?;
    let stage = xr::ReferenceSpaceType::STAGE;
    let kind = match origin {
        RoomOrigin::Stage if offered.contains(&stage) => stage,
        _ => xr::ReferenceSpaceType::LOCAL,
    };
    session.create_reference_space(kind, xr::Posef::IDENTITY).doing(DOING)
}
