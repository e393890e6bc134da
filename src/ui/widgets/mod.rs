//! The building blocks of panels and dialogs, and their look: buttons, icons, numbers, messages.
//!
//! Takes values and returns the person's changes; knows no panel and no dialog.

pub mod brush_icons;
pub mod buttons;
pub mod draw_icons;
pub mod filter;
pub mod icons;
pub mod keyboard;
pub mod names;
pub mod numbers;
pub mod section;
pub mod spot;
pub mod theme;
pub mod toasts;
