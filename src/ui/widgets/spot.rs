//! Guides a person to an option: its panel opens and scrolls to it, and the option blinks.
//!
//! Takes the option and gives its section. The panels name their options with [`mark`]; must not know what these do.

use egui::{Align, Context, Id, Response, Stroke, StrokeKind};

use crate::input::Action;
use crate::tools::brush::BrushId;

/// Duration and period of blinking, in seconds.
const BLINK_S: f64 = 2.4;
const CHANGE_S: f64 = 0.3;
/// Options move while the section opens.
const SCROLL_S: f64 = 0.6;

/// An option that can be searched for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Spot {
    Array,
    Symmetry,
    /// The image that a brush paints.
    Stencil,
    /// The checkboxes for a pen's pressure.
    Pressure,
    /// The rope by which the pointer pulls a brush.
    Steady,
    /// Clay, stone, a matcap or true colours.
    Looks,
    Occlusion,
    RenderMode,
}

impl Spot {
    /// Returns the section of the option; `None` in the bar along the top.
    pub fn section(self) -> Option<&'static str> {
        match self {
            Spot::Array | Spot::Symmetry => Some("Symmetry and array"),
            Spot::Stencil | Spot::Steady | Spot::Pressure => Some("Tool"),
            Spot::Looks | Spot::Occlusion => Some("Light"),
            Spot::RenderMode => None,
        }
    }

    /// Returns the action that selects the tool with the option.
    pub fn needs(self) -> Option<Action> {
        match self {
            Spot::Stencil => Some(Action::Brush(BrushId::Paint)),
            Spot::Steady | Spot::Pressure => Some(Action::Brush(BrushId::Draw)),
            _ => None,
        }
    }
}

/// The blinking option of a window, and since when.
#[derive(Clone, Copy)]
struct Blinking {
    spot: Spot,
    since_s: f64,
}

fn id() -> Id {
    Id::new("led to")
}

/// Starts to blink the wanted option in this window, in the panel or in the bar along the top.
pub fn begin(ctx: &Context, led_to: &mut Option<Spot>, in_panel: bool) {
    if let Some(spot) = led_to.take_if(|spot| spot.section().is_some() == in_panel) {
        let since_s = ctx.input(|input| input.time);
        ctx.data_mut(|data| data.insert_temp(id(), Blinking { spot, since_s }));
    }
}

/// Returns the blinking option of a window.
pub fn blinking(ctx: &Context) -> Option<Spot> {
    let blinking = ctx.data(|data| data.get_temp::<Blinking>(id()))?;
    let age_s = ctx.input(|input| input.time) - blinking.since_s;
    (age_s < BLINK_S).then_some(blinking.spot)
}

/// Marks `response` as this option.
pub fn mark(response: &Response, spot: Spot) {
    let ctx = &response.ctx;
    if blinking(ctx) != Some(spot) {
        return;
    }
    let Some(Blinking { since_s, .. }) = ctx.data(|data| data.get_temp(id())) else { return };
    let age_s = ctx.input(|input| input.time) - since_s;
    if age_s < SCROLL_S {
        response.scroll_to_me(Some(Align::Center));
    }
    if ((age_s / CHANGE_S) as u64).is_multiple_of(2) {
        let style = ctx.global_style();
        let stroke = Stroke::new(2.0, style.visuals.selection.stroke.color);
        let painter = ctx.layer_painter(response.layer_id);
        painter.rect_stroke(response.rect.expand(3.0), 4.0, stroke, StrokeKind::Outside);
    }
    ctx.request_repaint_after_secs((CHANGE_S * 0.5) as f32);
}
