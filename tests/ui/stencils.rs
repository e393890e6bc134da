//! The brush paints images on the surface, and colours through them.

use virtual_sculpture::editor::tool::{ToolEdit, ToolKind};
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::RADIUS;

use super::bench::{Bench, bench, has, middle, press, rest, run};

const RED: Rgb = Rgb::new(255, 0, 0);
const WHITE: Rgb = Rgb::new(255, 255, 255);
const BLACK: Rgb = Rgb::new(0, 0, 0);

/// A workspace with a solid block of 64^3 voxels, seen from the front, a brush of 60 pixels, and an image of two halves:
/// white above, black below.
fn with_stencil(folder: &std::path::Path) -> Bench {
    let path = folder.join("halves.png");
    let picture =
        image::RgbImage::from_fn(8, 8, |_, y| image::Rgb([if y < 4 { 255 } else { 0 }; 3]));
    picture.save(&path).unwrap();
    let mut harness = bench();
    rest(&mut harness);
    run(&mut harness, "place");
    let tool = &mut harness.state_mut().editor.tool;
    tool.kind = ToolKind::Brush(BrushId::Paint);
    tool.colour = RED;
    tool.brushes.of_mut(BrushId::Paint).set(RADIUS, 60.0);
    tool.edit(ToolEdit::Picture(Some(path)));
    harness
}

fn press_middle(harness: &mut Bench) {
    let at = middle(harness);
    press(harness, at);
}

fn colours(harness: &Bench) -> [Rgb; 3] {
    let contents = harness.state().session().document().contents();
    [36, 28, 60].map(|y| contents.rgb([32, y, 63].into()))
}

#[test]
fn the_brush_paints_an_image_or_a_colour_through_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = with_stencil(folder.path());
    rest(&mut harness);
    assert!(has(&harness, "halves.png") && has(&harness, "Colour through it"));
    press_middle(&mut harness);
    assert_eq!(colours(&harness), [WHITE, BLACK, Rgb::STONE]);
    run(&mut harness, "undo");
    assert_eq!(colours(&harness), [Rgb::STONE; 3]);
    harness.state_mut().editor.tool.edit(ToolEdit::ThroughStencil(true));
    press_middle(&mut harness);
    assert_eq!(colours(&harness), [RED, Rgb::STONE, Rgb::STONE]);
    // A solid has an image of its own.
    harness.state_mut().editor.tool.kind = ToolKind::Solid;
    assert!(harness.state().editor.tool.picture_in_use().is_none());
    // Without the file, a stroke says what is missing and leaves all as it is.
    harness.state_mut().editor.tool.kind = ToolKind::Brush(BrushId::Paint);
    harness.state_mut().editor.tool.edit(ToolEdit::Picture(Some("/nonexistent/leaf.png".into())));
    let before = harness.state().session().document().contents().clone();
    press_middle(&mut harness);
    assert!(*harness.state().session().document().contents() == before);
    assert!(harness.state().ui.toasts.texts().any(|(_, text)| text.contains("leaf.png")));
}
