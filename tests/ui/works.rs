//! Whole works made as a sculptor would make them: from scripts of what a person does, by pointer and keys in the window or
//! by the hands in a headset, in fewer than a hundred strokes each.
//!
//! A script is a list of lines; points are in voxels. `size`, `turn`, `colour`, `brush`, `spray`, `tube` and `lathe` are
//! options of tools; `do ACTION` is a key or button; `to` moves the tool by its keys; the others are strokes:
//!
//! | line | what the person does |
//! |---|---|
//! | `new X,Y,Z #rrggbb` | begins an empty sculpture of a colour |
//! | `apply` | uses the tool where it is (Space) |
//! | `press P`, `drag P P ...` | presses the button over what is seen at a point, and leads it to others |
//! | `ctrl-press P`, `ctrl-drag P P ...` | the same with Ctrl |

use std::path::{Path, PathBuf};

use egui::{Event, Modifiers, PointerButton};
use glam::{Quat, Vec3};
use virtual_sculpture::editor::sizes::SizeUnit;
use virtual_sculpture::editor::tool::ToolEdit;
use virtual_sculpture::input::hands::{HandMapper, HandSettings, HandSide, HandState, HandsState};
use virtual_sculpture::input::pad::stick::Response;
use virtual_sculpture::input::{Action, DrawKind, ScreenDirection};
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::tools::brush::BrushId;
use virtual_sculpture::tools::brush::kernel::grab::Falloff;
use virtual_sculpture::tools::brush::keys::{FALLOFF, RADIUS, STRENGTH};
use virtual_sculpture::view::{Room, RoomPose};

use super::bench::{Bench, bench_of, config, look, rest, run, screen, send};

/// The devices that make strokes.
enum Hand {
    Pointer,
    /// The main hand of a person in a room, who reaches this far with the tool.
    Tracked {
        mapper: Box<HandMapper>,
        room: Box<Room>,
        state: Box<HandsState>,
    },
}

const REACH_M: f32 = 0.08;
const FRAME_S: f64 = 1.0 / 72.0;

struct Sculptor {
    harness: Bench,
    hand: Hand,
    strokes: usize,
}

impl Sculptor {
    fn new(in_headset: bool) -> Sculptor {
        let mut harness = bench_of(&config(64), egui::vec2(1600.0, 1200.0));
        rest(&mut harness);
        let hand = match in_headset {
            false => Hand::Pointer,
            true => {
                run(&mut harness, "place");
                let response = Response { dead_zone: 0.2, curve: 2.0 };
                let main = HandSide::Right;
                let mapper = HandMapper::new(HandSettings { main, response, reach_m: REACH_M });
                let head = RoomPose { position: Vec3::Y * 1.6, rotation: Quat::IDENTITY };
                Hand::Tracked {
                    mapper: Box::new(mapper),
                    room: Box::new(Room::before(&head, 0.7, 0.3, 0.6 / 224.0)),
                    state: Box::default(),
                }
            }
        };
        Sculptor { harness, hand, strokes: 0 }
    }

    fn follow(&mut self, script: &str) {
        for (i, line) in script.lines().enumerate() {
            let line = line.split(" #!").next().unwrap_or_default().trim();
            if !line.is_empty() && !line.starts_with("# ") {
                let before = self.changes();
                let is_stroke = self.line(line);
                assert!(
                    !is_stroke || self.changes() > before,
                    "line {}: `{line}` did nothing",
                    i + 1
                );
            }
        }
    }

    fn changes(&self) -> u64 {
        self.harness.state().session().document().revision()
    }

    /// Whether it was a stroke.
    fn line(&mut self, line: &str) -> bool {
        let words: Vec<&str> = line.split_whitespace().collect();
        let tool = &mut self.harness.state_mut().editor.tool;
        match words[..] {
            ["new", dims, base] => {
                let line = format!("new dims={dims} colour=24 base={base} fill=empty");
                run(&mut self.harness, &line);
            }
            ["do", name] => {
                let action = Action::named(name).unwrap_or_else(|| panic!("{line}"));
                self.harness.state_mut().act(action);
                // Until the view has turned.
                rest(&mut self.harness);
            }
            ["size", sizes] => {
                tool.edit(ToolEdit::Uniform(false));
                for (axis, half) in point(sizes).to_array().into_iter().enumerate() {
                    tool.edit(ToolEdit::Half { axis, half });
                }
            }
            ["turn", degrees] => tool.edit(ToolEdit::Turn(point(degrees))),
            ["colour", colour] => tool.edit(ToolEdit::Colour(colour.parse::<Rgb>().unwrap())),
            ["brush", name, radius, strength, ref falloff @ ..] => {
                tool.edit(ToolEdit::SizeUnit(SizeUnit::Sculpture));
                let brush = BrushId::ALL.iter().find(|brush| brush.spec().name == name).unwrap();
                let options = tool.brushes.of(*brush).with(RADIUS, number(radius));
                let options = options.with(STRENGTH, number(strength));
                let options = match falloff {
                    ["sharp"] => options.with(FALLOFF, Falloff::Sharp),
                    ["flat"] => options.with(FALLOFF, Falloff::Flat),
                    ["smooth"] => options.with(FALLOFF, Falloff::Smooth),
                    _ => options,
                };
                tool.edit(ToolEdit::Brush(options));
                self.harness.state_mut().act(Action::Brush(*brush));
            }
            ["tube", start, end] => {
                let mut draws = tool.draws.clone();
                (draws.radii, draws.on_surface) = ([number(start), number(end)], false);
                tool.edit(ToolEdit::Draw(draws));
                self.harness.state_mut().act(Action::Draw(DrawKind::Curve));
            }
            ["lathe"] => self.harness.state_mut().act(Action::Draw(DrawKind::Lathe)),
            ["to", place] => self.move_tool(point(place)),
            ["apply"] => {
                self.apply();
                return true;
            }
            ["press" | "drag", ref path @ ..] => {
                self.stroke(Modifiers::NONE, path);
                return true;
            }
            ["ctrl-press" | "ctrl-drag", ref path @ ..] => {
                self.stroke(Modifiers::COMMAND, path);
                return true;
            }
            _ => panic!("`{line}` is not understood"),
        }
        look(&mut self.harness);
        self.harness.step();
        false
    }

    /// Moves the tool by its keys, a voxel each, or with the hand.
    fn move_tool(&mut self, to: Vec3) {
        if let Hand::Tracked { .. } = self.hand {
            self.hold(to, 0.0, 15);
            return;
        }
        let state = self.harness.state_mut();
        let steps = [
            [ScreenDirection::Left, ScreenDirection::Right],
            [ScreenDirection::Down, ScreenDirection::Up],
            [ScreenDirection::Farther, ScreenDirection::Nearer],
        ];
        for (axis, [back, on]) in steps.into_iter().enumerate() {
            let by = (to - state.editor.tool.centre_vx)[axis].round();
            let step = if by < 0.0 { back } else { on };
            (0..by.abs() as u32).for_each(|_| state.act(Action::Nudge(step)));
        }
    }

    fn apply(&mut self) {
        self.strokes += 1;
        match self.hand {
            Hand::Pointer => {
                super::bench::key(&mut self.harness, Modifiers::NONE, egui::Key::Space);
            }
            Hand::Tracked { .. } => {
                let at = self.harness.state().editor.tool.centre_vx;
                self.hold(at, 1.0, 3);
                self.hold(at, 0.0, 3);
            }
        }
    }

    fn stroke(&mut self, modifiers: Modifiers, path: &[&str]) {
        self.strokes += 1;
        let path: Vec<Vec3> = path.iter().map(|place| point(place)).collect();
        if let Hand::Tracked { .. } = self.hand {
            self.hold(path[0], 0.0, 15);
            self.hold(path[0], 1.0, 3);
            self.hold(path[path.len() - 1], 0.0, 3);
            return;
        }
        let path: Vec<_> = path.iter().map(|place| screen(&self.harness, *place)).collect();
        let press = |pos, pressed| {
            let button = PointerButton::Primary;
            Event::PointerButton { pos, button, pressed, modifiers }
        };
        send(&mut self.harness, Event::PointerMoved(path[0]));
        look(&mut self.harness);
        send(&mut self.harness, press(path[0], true));
        for pair in path.windows(2) {
            // As a hand would lead it: not in leaps.
            let steps = (pair[0].distance(pair[1]) / 6.0).ceil().max(1.0);
            for i in 1..=steps as u32 {
                let at = pair[0] + (pair[1] - pair[0]) * (i as f32 / steps);
                send(&mut self.harness, Event::PointerMoved(at));
            }
        }
        send(&mut self.harness, press(path[path.len() - 1], false));
        look(&mut self.harness);
        self.harness.step();
    }

    /// The main hand holds the tool at a point of the grid for some frames.
    fn hold(&mut self, at: Vec3, trigger: f32, frames: usize) {
        let Hand::Tracked { mapper, room, state } = &mut self.hand else { return };
        let workspace = self.harness.state_mut();
        let world = workspace.session().document().world_from_grid().transform_point3(at);
        let position = room.room_from_world.apply(world) + Vec3::Z * REACH_M;
        let pose = Some(RoomPose { position, rotation: Quat::IDENTITY });
        let hand = HandState { grip: pose, aim: pose, trigger, ..HandState::default() };
        state.hands[HandSide::Right.index()] = hand;
        for _ in 0..frames {
            state.time_s += FRAME_S;
            for event in mapper.update(state, None) {
                workspace.answer_hand(&event, room);
            }
        }
        look(&mut self.harness);
    }

    /// Saves the work, for whoever wants to see it.
    fn save(&mut self, name: &str) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/test-output/works");
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name);
        run(&mut self.harness, &format!("save \"{}\"", path.display()));
    }
}

fn number(text: &str) -> f32 {
    text.parse().unwrap_or_else(|_| panic!("`{text}` is no number"))
}

fn point(text: &str) -> Vec3 {
    let numbers: Vec<f32> = text.split(',').map(number).collect();
    Vec3::from_slice(&numbers)
}

/// Follows a script in the window; each line that is a stroke must change something.
fn made(script: &str, name: &str) -> Sculptor {
    let mut sculptor = Sculptor::new(false);
    sculptor.follow(script);
    let (steps, strokes) = {
        let document = sculptor.harness.state().session().document();
        (document.history().undo_count(), sculptor.strokes)
    };
    assert!(strokes < 100, "{name}: {strokes} strokes");
    // `new` is a step, too.
    assert_eq!(steps, strokes + 1, "{name}: each stroke is one step");
    sculptor.save(name);
    sculptor
}

#[test]
fn a_bust_is_made_in_the_window() {
    let sculptor = made(include_str!("works/bust.txt"), "bust.vsc");
    // Mirrored to the voxel.
    let grid = sculptor.harness.state().session().document().grid();
    let dims = grid.dims().as_ivec3();
    for z in 0..dims.z {
        for y in 0..dims.y {
            for x in 0..dims.x / 2 {
                let other = glam::IVec3::new(dims.x - 1 - x, y, z);
                assert_eq!(grid.get(glam::IVec3::new(x, y, z)), grid.get(other), "{x} {y} {z}");
            }
        }
    }
}

#[test]
fn a_creature_is_made_in_the_window() {
    made(include_str!("works/creature.txt"), "creature.vsc");
}

#[test]
fn a_house_a_tree_a_lake_and_a_hill_are_made_in_the_window() {
    let sculptor = made(include_str!("works/house.txt"), "house.vsc");
    let document = sculptor.harness.state().session().document();
    let is_blue = |v: glam::UVec3| {
        let [r, g, b] = document.contents().rgb(v).0;
        b > r && b > g
    };
    // The lake is painted, and no part of what was put beside it later.
    assert!(is_blue(glam::UVec3::new(72, 5, 168)) && !is_blue(glam::UVec3::new(56, 60, 148)));
}

#[test]
fn a_mug_with_glaze_is_made_in_the_window() {
    let sculptor = made(include_str!("works/mug.txt"), "mug.vsc");
    let grid = sculptor.harness.state().session().document().grid();
    // Still a mug: a wall all around, room inside, and a bottom.
    for (x, z) in [(40, 80), (120, 80), (80, 40), (80, 120)] {
        assert!(grid.get(glam::IVec3::new(x, 100, z)), "{x} {z}");
    }
    let middle = glam::IVec3::new(80, 100, 80);
    assert!(!grid.get(middle) && grid.get(middle.with_y(22)));
}

#[test]
fn a_pot_with_a_lid_is_made_in_the_window() {
    let sculptor = made(include_str!("works/pot.txt"), "pot.vsc");
    let grid = sculptor.harness.state().session().document().grid();
    let hollow = glam::IVec3::new(80, 60, 80);
    assert!(!grid.get(hollow) && grid.get(hollow.with_y(12)), "there is room in it, and a bottom");
    assert!((96..160).any(|y| grid.get(hollow.with_y(y))), "the lid is over it");
}

/// Hands in a headset draw the same as the pointer along the same lines, apart from the direction of view.
#[test]
fn the_same_bust_is_begun_by_hand_in_a_headset() {
    let mut sculptor = Sculptor::new(true);
    sculptor.follow(include_str!("works/bust-by-hand.txt"));
    let document = sculptor.harness.state().session().document();
    assert_eq!(document.history().undo_count(), sculptor.strokes + 1);
    let by_hand = document.grid().opaque_count() as f32;
    // The solids of the bust that was made in the window.
    let solids = include_str!("works/bust.txt").split("# The neck runs").next().unwrap();
    let mut other = Sculptor::new(false);
    other.follow(solids);
    let by_pointer = other.harness.state().session().document().grid().opaque_count() as f32;
    assert!((by_hand / by_pointer - 1.0).abs() < 0.06, "{by_hand} {by_pointer}");
    sculptor.save("bust-by-hand.vsc");
}

#[test]
fn a_script_of_ones_own() {
    // For trying scripts: VS_WORK names one, and its result is target/test-output/works/own.vsc.
    let Some(path) = std::env::var_os("VS_WORK").map(PathBuf::from) else { return };
    made(&std::fs::read_to_string(path).unwrap(), "own.vsc");
}
