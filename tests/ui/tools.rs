//! Brushes, marker, symmetry, clipboard and colours through the interface, without a window: mouse and keys cause the
//! right commands and leave the right sculpture.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::{IVec3, UVec3, Vec3};
use virtual_sculpture::editor::tool::ToolKind;
use virtual_sculpture::input::{DrawKind, ToolMode};
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::sculpture::region::VoxelBox;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::keys::{ONCE_PER_STROKE, STRENGTH};

use super::bench::{self, Bench, key, look, middle, rest, run, screen, send, voxels};

/// A workspace with a solid block of 64^3 voxels, seen from the front.
fn front() -> Bench {
    let mut harness = bench::bench();
    rest(&mut harness);
    run(&mut harness, "place");
    harness
}

fn drag_with(harness: &mut Bench, modifiers: Modifiers, path: &[Pos2]) {
    let press = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers,
    };
    send(harness, Event::PointerMoved(path[0]));
    send(harness, press(path[0], true));
    for &pos in path {
        send(harness, Event::PointerMoved(pos));
        look(harness);
    }
    send(harness, press(path[path.len() - 1], false));
    look(harness);
}

fn drag(harness: &mut Bench, path: &[Pos2]) {
    drag_with(harness, Modifiers::NONE, path);
}

fn click(harness: &mut Bench, label: &str) {
    harness.get_by_label(label).click();
    rest(harness);
}

fn colour_at(harness: &Bench, v: [u32; 3]) -> Rgb {
    harness.state().session().document().contents().rgb(v.into())
}

fn marker(harness: &Bench) -> VoxelBox {
    harness.state().session().document().selection().marker()
}

fn labels(harness: &Bench) -> Vec<String> {
    harness.state().session().document().history().undo_labels().map(String::from).collect()
}

const FULL: u64 = 64 * 64 * 64;

#[test]
fn every_brush_is_taken_by_button_and_works_where_the_pointer_is() {
    for (button, kind) in [
        ("Brush", BrushId::Paint),
        ("Devourer", BrushId::Devour),
        ("Clay", BrushId::Clay),
        ("Erosion", BrushId::Erode),
        ("Dilation", BrushId::Dilate),
        ("Growth", BrushId::Grow),
        ("Smooth", BrushId::Smooth),
    ] {
        let mut harness = front();
        // A step and a single voxel: something for filters to work on.
        run(&mut harness, "subtract cuboid at=48,48,60 half=16,16,4");
        run(&mut harness, "add cuboid at=30.5,30.5,64.5 half=0.5 colour=#ffffff");
        run(&mut harness, "subtract cuboid at=28.5,28.5,63.5 half=0.5");
        let before = harness.state().session().document().contents().clone();
        click(&mut harness, button);
        assert_eq!(harness.state().editor.tool.kind, ToolKind::Brush(kind));
        let at = middle(&harness);
        drag(&mut harness, &[at, at + vec2(10.0, -10.0)]);
        let now = harness.state().session().document().contents().clone();
        assert_ne!(now, before, "{button}");
        assert_eq!(labels(&harness).last().unwrap(), kind.spec().name);
        let painted = before.grid == now.grid;
        assert_eq!(painted, kind == BrushId::Paint, "{button}");
        key(&mut harness, Modifiers::COMMAND, Key::Z);
        assert_eq!(harness.state().session().document().contents(), &before);
    }
}

#[test]
fn a_stroke_of_the_devourer_does_not_dig_where_it_overlaps() {
    let depth_below = |once: bool| {
        let mut harness = front();
        key(&mut harness, Modifiers::NONE, Key::D);
        let options = harness.state_mut().editor.tool.brushes.of_mut(BrushId::Devour);
        assert!(options.get(ONCE_PER_STROKE));
        options.set(ONCE_PER_STROKE, once);
        let at = middle(&harness);
        let path: Vec<Pos2> = (0..12).map(|i| at + vec2((i % 2) as f32 * 30.0, 0.0)).collect();
        drag(&mut harness, &path);
        let grid = harness.state().session().document().grid();
        (0..64).filter(|z| !grid.get(IVec3::new(32, 32, *z))).count()
    };
    let (once, again) = (depth_below(true), depth_below(false));
    assert_eq!(once, 4, "the voxel hit and three around it");
    assert!(again > 3 * once, "{again}");
}

#[test]
fn modifiers_invert_smooth_and_pick() {
    let mut harness = front();
    key(&mut harness, Modifiers::SHIFT, Key::C);
    let at = middle(&harness);
    drag(&mut harness, &[at]);
    let clay = voxels(&harness);
    assert!(clay > FULL - 1, "the front of the block is the front of the grid");
    drag_with(&mut harness, Modifiers::COMMAND, &[at]);
    assert!(voxels(&harness) < FULL, "the opposite of clay is the devourer");
    // Over the edge of what it has cut: its ground is flat.
    harness.state_mut().editor.tool.brushes.of_mut(BrushId::Smooth).set(STRENGTH, 1.0);
    let path = [0.0, 20.0, 40.0, 60.0].map(|right| at + vec2(right, 0.0));
    drag_with(&mut harness, Modifiers::SHIFT, &path);
    assert_eq!(labels(&harness).last().unwrap(), "smooth");

    run(&mut harness, "dye marker colour=#123456");
    harness.state_mut().editor.tool.colour = Rgb::new(1, 1, 1);
    let before = voxels(&harness);
    run(&mut harness, "clear");
    run(&mut harness, "add cuboid at=32,32,32 half=20 colour=#654321");
    drag_with(&mut harness, Modifiers::ALT, &[at]);
    assert_eq!(harness.state().editor.tool.colour, Rgb::new(0x65, 0x43, 0x21));
    assert_ne!(before, voxels(&harness));
    // By key where the pointer is.
    harness.state_mut().editor.tool.colour = Rgb::new(1, 1, 1);
    key(&mut harness, Modifiers::NONE, Key::I);
    assert_eq!(harness.state().editor.tool.colour, Rgb::new(0x65, 0x43, 0x21));
}

#[test]
fn the_marker_is_drawn_slid_pulled_and_typed() {
    let mut harness = front();
    click(&mut harness, "Marker");
    let at = middle(&harness);
    // It lies inside the block: a drag on the block draws a new one, as thin as the surface.
    drag(&mut harness, &[at, at + vec2(60.0, 40.0)]);
    let drawn = marker(&harness);
    assert_eq!((drawn.min.z, drawn.max.z), (63, 64));
    let size = drawn.size();
    assert!(size.x > 4 && size.x < 20 && size.y > 2 && size.y < size.x, "{size}");
    // On itself it slides in the plane of the face.
    drag(&mut harness, &[at + vec2(20.0, 10.0), at + vec2(80.0, 10.0)]);
    let slid = marker(&harness);
    assert_eq!(slid.size(), size);
    assert!(slid.min.x > drawn.min.x + 3 && slid.min.y == drawn.min.y && slid.min.z == 63);
    // Keys move and lengthen it.
    key(&mut harness, Modifiers::NONE, Key::ArrowUp);
    key(&mut harness, Modifiers::SHIFT, Key::PageUp);
    let longer = marker(&harness);
    assert_eq!(longer.min, slid.min + IVec3::new(0, 1, -1));
    assert_eq!(longer.size(), slid.size() + UVec3::Z);
    assert_eq!(voxels(&harness), FULL, "none of it changes a voxel");
    assert!(labels(&harness).is_empty());
    // Pulled towards the viewer from the side.
    run(&mut harness, "mark at=20,20,60 size=24,24,6");
    run(&mut harness, "place turn=0,50,0");
    let path = [[32.0, 32.0, 66.0], [32.0, 32.0, 70.0], [32.0, 32.0, 76.2]];
    let path = path.map(|p| screen(&harness, p.into()));
    drag_with(&mut harness, Modifiers::COMMAND, &path);
    let pulled = VoxelBox { min: IVec3::new(20, 20, 60), max: IVec3::new(44, 44, 76) };
    assert_eq!(marker(&harness), pulled);
}

#[test]
fn regions_are_selected_limit_tools_and_are_edited() {
    let mut harness = front();
    key(&mut harness, Modifiers::NONE, Key::Q);
    run(&mut harness, "mark at=0,0,0 size=32,64,64");
    click(&mut harness, "Limit tools to selection");
    let selection = harness.state().session().document().selection().clone();
    assert!(selection.limits() && selection.boxes().len() == 1, "the marker is meant");
    // A cut in the middle takes the selected half of the ball only.
    key(&mut harness, Modifiers::NONE, Key::E);
    let at = middle(&harness);
    drag(&mut harness, &[at]);
    let grid = harness.state().session().document().grid();
    assert!(!grid.get(IVec3::new(31, 32, 63)) && grid.get(IVec3::new(32, 32, 63)));
    key(&mut harness, Modifiers::NONE, Key::L);
    assert!(!harness.state().session().document().selection().limits());
    // Delete, fill and dye what the marker holds.
    run(&mut harness, "mark at=0,0,0 size=8,8,8");
    key(&mut harness, Modifiers::NONE, Key::Delete);
    let cut = voxels(&harness);
    harness.state_mut().editor.tool.colour = Rgb::new(9, 8, 7);
    key(&mut harness, Modifiers::COMMAND, Key::F);
    assert_eq!(voxels(&harness), cut + 512);
    assert_eq!(colour_at(&harness, [3, 3, 3]), Rgb::new(9, 8, 7));
    harness.state_mut().editor.tool.colour = Rgb::new(90, 80, 70);
    key(&mut harness, Modifiers::COMMAND, Key::G);
    assert_eq!(colour_at(&harness, [3, 3, 3]), Rgb::new(90, 80, 70));
    assert_eq!(
        harness.state().editor.tool.recent()[..2],
        [Rgb::new(90, 80, 70), Rgb::new(9, 8, 7)]
    );
    // Take a box off again, and all of them.
    key(&mut harness, Modifiers::NONE, Key::A);
    key(&mut harness, Modifiers::ALT, Key::A);
    assert_eq!(harness.state().session().document().selection().boxes().len(), 2);
    key(&mut harness, Modifiers::NONE, Key::Backspace);
    assert_eq!(harness.state().session().document().selection().boxes().len(), 1);
    key(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::A);
    assert!(harness.state().session().document().selection().boxes().is_empty());
}

#[test]
fn copies_are_turned_mirrored_pasted_and_moved() {
    let mut harness = front();
    run(&mut harness, "clear");
    run(&mut harness, "add cuboid at=10,10,10 half=4,2,1 colour=#ff0000");
    run(&mut harness, "mark at=6,8,9 size=8,4,2");
    key(&mut harness, Modifiers::NONE, Key::Q);
    send(&mut harness, Event::Copy);
    assert!(harness.state().session().document().clip().is_some());
    rest(&mut harness);
    key(&mut harness, Modifiers::NONE, Key::Z);
    run(&mut harness, "mark at=30,30,30 size=4,4,4");
    send(&mut harness, Event::Paste("what another program has left".into()));
    let grid = harness.state().session().document().grid();
    assert_eq!(grid.opaque_count(), 128);
    assert!(grid.get(IVec3::new(33, 37, 31)) && !grid.get(IVec3::new(34, 30, 30)), "turned");
    assert_eq!(colour_at(&harness, [33, 37, 31]), Rgb::new(255, 0, 0));
    // The contents of the marker move with it.
    run(&mut harness, "mark at=30,30,30 size=4,8,2");
    key(&mut harness, Modifiers::ALT, Key::ArrowRight);
    assert_eq!(marker(&harness).min, IVec3::new(31, 30, 30));
    let grid = harness.state().session().document().grid();
    assert!(!grid.get(IVec3::new(30, 30, 30)) && grid.get(IVec3::new(34, 30, 30)));
    send(&mut harness, Event::Cut);
    assert_eq!(voxels(&harness), 64);
    assert_eq!(labels(&harness).last().unwrap(), "cut");
}

#[test]
fn mirrors_and_arrays_repeat_what_tools_do() {
    let mut harness = front();
    key(&mut harness, Modifiers::NONE, Key::Num1);
    let at = middle(&harness);
    drag(&mut harness, &[at - vec2(90.0, 0.0)]);
    let grid = harness.state().session().document().grid();
    let gone: Vec<IVec3> = (0..64)
        .flat_map(|y| (0..64).map(move |x| IVec3::new(x, y, 63)))
        .filter(|v| !grid.get(*v))
        .collect();
    assert!(!gone.is_empty());
    for v in &gone {
        assert!(!grid.get(IVec3::new(63 - v.x, v.y, v.z)), "{v}");
    }
    key(&mut harness, Modifiers::NONE, Key::Num1);
    let before = voxels(&harness);
    drag(&mut harness, &[at]);
    let one = before - voxels(&harness);
    harness.state_mut().editor.tool.array.count = 2;
    harness.state_mut().editor.tool.array.step = IVec3::new(0, 10, 0);
    key(&mut harness, Modifiers::COMMAND, Key::R);
    assert_eq!(before - voxels(&harness), 3 * one);
    assert_eq!(labels(&harness).last().unwrap(), "array");
}

#[test]
fn a_tool_stands_on_the_surface_when_asked_to() {
    let mut harness = front();
    key(&mut harness, Modifiers::NONE, Key::C);
    key(&mut harness, Modifiers::NONE, Key::T);
    run(&mut harness, "subtract cuboid at=32,32,48 half=32,32,16");
    click(&mut harness, "Rest on the surface");
    harness.state_mut().editor.tool.set_half(0, 4.2);
    let at = middle(&harness);
    drag(&mut harness, &[at]);
    let tool = &harness.state().editor.tool;
    assert!((tool.centre_vx.z - (32.0 + tool.half().z)).abs() < 1e-3);
    // In the middle between two voxels: eight centres across, eight before the surface.
    assert!((tool.centre_vx - Vec3::splat(32.0)).truncate().abs().max_element() < 0.1);
    assert_eq!(voxels(&harness), FULL / 2 + 8 * 8 * 8);
    assert_eq!(harness.state().editor.tool.mode, ToolMode::Add);
}

/// Nothing is cut off, whichever tool's options are shown.
#[test]
fn the_options_of_every_tool_fit_into_their_panel() {
    let mut harness = front();
    run(&mut harness, "copy");
    run(&mut harness, "select add");
    let brushes = BrushId::ALL.iter().map(|brush| ToolKind::Brush(*brush));
    let drawn = DrawKind::ALL.map(ToolKind::Draw);
    let others = [ToolKind::Solid, ToolKind::Marker];
    for tool in brushes.chain(drawn).chain(others) {
        harness.state_mut().editor.tool.kind = tool;
        harness.state_mut().editor.tool.mode = ToolMode::Recolour;
        harness.state_mut().editor.tool.used_colour();
        rest(&mut harness);
        for role in [Role::Button, Role::CheckBox, Role::SpinButton, Role::Slider, Role::Label] {
            for node in harness.query_all_by_role(role) {
                let rect = node.rect();
                assert!(rect.left() >= 0.0 && rect.right() <= 1280.0, "{tool:?} {rect} {node:?}");
            }
        }
    }
}

/// Returns the texts of the messages on screen.
fn told(harness: &Bench, text: &str) -> bool {
    harness.state().ui.toasts.texts().any(|(_, toast)| toast.contains(text))
}

#[test]
fn a_stroke_that_changes_nothing_says_why() {
    let mut harness = front();
    let at = middle(&harness);
    drag(&mut harness, &[at, at + vec2(60.0, 0.0)]);
    key(&mut harness, Modifiers::NONE, Key::T);
    let beside = at - vec2(0.0, 120.0);
    drag(&mut harness, &[beside]);
    assert!(told(&harness, "this part of the grid is full"));

    run(&mut harness, "mark at=0,0,0 size=64,8,64");
    key(&mut harness, Modifiers::NONE, Key::L);
    key(&mut harness, Modifiers::NONE, Key::R);
    let before = voxels(&harness);
    assert!(!told(&harness, "limited to the selection"));
    drag(&mut harness, &[beside]);
    assert_eq!(voxels(&harness), before);
    assert!(told(&harness, "limited to the selection (L)"));
    harness.get_by_label("Limited");
    key(&mut harness, Modifiers::NONE, Key::L);
    rest(&mut harness);
    assert!(harness.query_by_label("Limited").is_none());
}

#[test]
fn the_limit_takes_the_marker_where_it_is_unless_more_is_selected() {
    let mut harness = front();
    let boxes = |harness: &Bench| {
        let selection = harness.state().session().document().selection();
        selection.boxes().iter().map(|chosen| chosen.bounds).collect::<Vec<_>>()
    };
    for line in ["mark at=0,0,0 size=8,8,8", "mark at=16,0,0 size=8,8,8"] {
        run(&mut harness, line);
        let marker = marker(&harness);
        key(&mut harness, Modifiers::NONE, Key::L);
        assert_eq!(boxes(&harness), [marker]);
        key(&mut harness, Modifiers::NONE, Key::L);
        assert_eq!(boxes(&harness), []);
    }
    key(&mut harness, Modifiers::NONE, Key::A);
    let chosen = boxes(&harness);
    for _ in 0..2 {
        key(&mut harness, Modifiers::NONE, Key::L);
        assert_eq!(boxes(&harness), chosen, "what was selected stays so");
    }
}

/// Brushes that deform are tools like others: each has its button in the toolbox, which says which of them is in hand.
#[test]
fn every_brush_that_deforms_has_its_button_and_its_section_folds() {
    let mut harness = bench::bench_of(&bench::config(64), vec2(1280.0, 1200.0));
    rest(&mut harness);
    let buttons = ["Grab", "Draw", "Inflate", "Crease", "Flatten", "Scrape", "Fill up", "Pinch"];
    for name in buttons.into_iter().chain(["Smear", "Twist"]) {
        let button = harness.get_by_role_and_label(Role::Button, name);
        assert!(button.rect().right() < 120.0, "{name} stands in the toolbox");
        button.click();
        rest(&mut harness);
        let tool = &harness.state().editor.tool;
        let ToolKind::Brush(brush) = tool.kind else { panic!("{name}: {:?}", tool.kind) };
        let word = if name == "Fill up" { "fill".to_string() } else { name.to_lowercase() };
        assert_eq!(brush.spec().name, word);
        let chosen = |other: &str| {
            let node = harness.get_by_role_and_label(Role::Button, other);
            node.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
        };
        for other in buttons {
            assert_eq!(chosen(other), other == name, "{other} beside {name}");
        }
        // The options are those of the tool in hand, and choose no other.
        harness.get_by_label("Strength");
        assert_eq!(harness.query_all_by_label(name).count(), 2, "button and title");
    }
    click(&mut harness, "Deform");
    assert!(harness.query_by_role_and_label(Role::Button, "Pinch").is_none());
    harness.get_by_label("Erosion");
    click(&mut harness, "Deform");
    harness.get_by_role_and_label(Role::Button, "Pinch");
}
