//! The board in the room: its visibility, its pose, and the ray that points at it.
//!
//! Takes controller states and events; its interface and picture are those of [`BoardPane`].

use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3};

use super::board_pane::BoardPane;
use crate::gpu::{Device, GpuError};
use crate::input::hands::{Board, HandEvent, HandSide, HandsState};
use crate::screen::headset::HeadsetOptions;
use crate::view::RoomPose;

/// The board on the off hand.
pub struct BoardPanel {
    pub pane: BoardPane,
    open: bool,
    size_m: Vec2,
}

impl BoardPanel {
    /// Creates a board with a picture of `size_px` pixels.
    pub fn new(
        device: &Arc<Device>,
        size_px: UVec2,
        settings: &HeadsetOptions,
    ) -> Result<BoardPanel, GpuError> {
        let pane = BoardPane::new(device, size_px, settings.board_pixels_per_point())?;
        Ok(BoardPanel { pane, open: false, size_m: settings.board_size_m() })
    }

    /// Handles a controller event for the board.
    pub fn handle(&mut self, event: &HandEvent) {
        if *event == HandEvent::ToggleBoard {
            self.open = !self.open;
            tracing::debug!("board {}", if self.open { "open" } else { "closed" });
        }
        self.pane.handle(event);
    }

    /// Returns the board's pose in the room while it is visible: while it is open, or `modal` because a dialog needs an
    /// answer.
    pub fn quad(&self, hands: Option<&HandsState>, main: HandSide, modal: bool) -> Option<Board> {
        let hand = hands?.hand(main.other());
        let grip = hand.grip.filter(|_| self.open || modal)?;
        // Grip poses are tilted differently on every controller, aim poses are not.
        let rotation = hand.aim.map_or(grip.rotation, |aim| aim.rotation);
        let pose = RoomPose { rotation, ..grip };
        Some(Board::on_hand(&pose, self.size_m))
    }
}

/// Returns the line from the main hand to the point of the board that it points at.
pub fn ray_to_board(
    hands: Option<&HandsState>,
    main: HandSide,
    board: Option<&Board>,
) -> Option<[Vec3; 2]> {
    let aim = hands?.hand(main).aim?;
    let hit = board?.hit(&aim)?;
    Some([aim.position, hit.point])
}
