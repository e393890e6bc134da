//! The text form of commands: written commands read back, and unreadable text is reported precisely.

use std::collections::HashSet;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use sculpture_core::command::text::parse_script;
use sculpture_core::command::{COMMANDS, Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::{ColourDepth, Rgb};

use super::strategies::{any_command, hostile_text};

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn every_command_survives_its_text_form(command in any_command()) {
        let text = command.to_string();
        prop_assert!(!text.contains('\n'), "{}", text);
        let read: Command = match text.parse() {
            Ok(read) => read,
            Err(error) => return Err(TestCaseError::fail(format!("{text}: {error}"))),
        };
        prop_assert_eq!(&read, &command, "{}", &text);
        // 0 and -0 are equal by PartialEq; their texts must differ.
        prop_assert_eq!(read.to_string(), text);
    }

    #[test]
    fn a_script_is_the_list_of_its_lines(commands in prop::collection::vec(any_command(), 0..12)) {
        let mut script = String::from("\u{feff}# a comment\r\n");
        for command in &commands {
            script += &format!("  {command}\r\n\n");
        }
        let read = parse_script(&script).unwrap();
        let lines: Vec<usize> = read.iter().map(|(line, _)| *line).collect();
        prop_assert_eq!(lines, (0..commands.len()).map(|i| 2 + 2 * i).collect::<Vec<_>>());
        prop_assert_eq!(read.into_iter().map(|(_, c)| c).collect::<Vec<_>>(), commands);
    }

    #[test]
    fn any_text_is_read_or_refused_without_a_panic(
        verb in prop::sample::select(COMMANDS.iter().map(|c| c.verb).collect::<Vec<_>>()),
        rest in prop_oneof![
            any::<String>(),
            hostile_text(),
            "([a-z]{1,6}=?[-+0-9.,e#x\"\\\\]{0,12} ?){0,5}",
        ],
        cut in any::<prop::sample::Index>(),
        command in any_command(),
    ) {
        let line = format!("{verb} {rest}");
        let _ = line.parse::<Command>();
        let _ = rest.parse::<Command>();
        let _ = parse_script(&rest);
        let text = command.to_string();
        let end = (0..=cut.index(text.len() + 1)).rev().find(|&i| text.is_char_boundary(i));
        let _ = text[..end.unwrap_or(0)].parse::<Command>();
    }
}

#[test]
fn american_spelling_is_read_and_british_written() {
    for (line, written) in [
        ("new dims=4,4,4 color=8", "new dims=4,4,4 size=1,1,1 colour=8 base=#c8beaa fill=solid"),
        ("fill color=#102030", "fill grid colour=#102030"),
        ("open a.pvm coloring=grey color=8", "open \"a.pvm\" colouring=grey colour=8"),
        (
            "recolor cuboid at=1,2,3 half=4 color=#102030",
            "recolour cuboid at=1,2,3 half=4,4,4 turn=0,0,0,1 colour=#102030",
        ),
    ] {
        assert_eq!(line.parse::<Command>().unwrap().to_string(), written);
    }
}

#[test]
fn turning_an_axis_upright_is_written_as_an_orientation_of_all_axes() {
    for (up, axes) in [
        ("y", "x,y,z"),
        ("z", "x,-z,y"),
        ("+z", "x,-z,y"),
        ("-z", "x,z,-y"),
        ("-y", "-x,-y,z"),
        ("x", "y,-x,z"),
        ("-x", "-y,x,z"),
    ] {
        let command: Command = format!("orient upright={up}").parse().unwrap();
        assert_eq!(command.to_string(), format!("orient axes={axes}"));
    }
    let open = "open \"a.pvm\" upright=-z";
    assert_eq!(open.parse::<Command>().unwrap().to_string(), open);
}

#[test]
fn a_solid_is_added_in_the_base_colour_unless_one_is_named() {
    let mut document = Document::new(
        &NewSculpture {
            dims: glam::UVec3::splat(16),
            voxel_size: glam::Vec3::ONE,
            colour_depth: ColourDepth::Bits24,
            base: Rgb::new(1, 2, 3),
            solid: true,
            room_vx: 0,
            grows: false,
        },
        Limits::default(),
    )
    .unwrap();
    // The colour that a voxel had before it was removed is forgotten.
    for line in ["dye colour=#ff0000", "clear", "add cuboid at=8,8,8 half=3"] {
        document.apply(&line.parse().unwrap()).unwrap();
    }
    assert_eq!(document.grid().opaque_count(), 216);
    assert_eq!(document.contents().colour(glam::IVec3::splat(8)), Some(Rgb::new(1, 2, 3)));
}

#[test]
fn quoted_paths_are_taken_literally() {
    for path in ["C:\\dir\\new.vsc", "\\\\host\\share\\x.vsc", "C:\\", "\\n\\x41\\\\", "\\", "a e"]
    {
        let line = format!("open \"{path}\"");
        let command: Command = line.parse().unwrap();
        let Command::Open { path: read, .. } = &command else { panic!("{line}") };
        assert_eq!(read.to_str(), Some(path));
        assert_eq!(command.to_string(), line);
    }
    // A name with quotes, or that is not valid text, needs escapes.
    let command: Command = "begin e\"say \\\"hi\\\"\\n\\t\\\\\"".parse().unwrap();
    assert_eq!(command, Command::Begin { label: "say \"hi\"\n\t\\".into() });
    assert_eq!(command.to_string(), "begin e\"say \\\"hi\\\"\\n\\t\\\\\"");
    // Without quotes a backslash is literal as well.
    let command: Command = "save C:\\dir\\new.vsc".parse().unwrap();
    assert_eq!(command.to_string(), "save \"C:\\dir\\new.vsc\"");
}

proptest! {
    /// Any Windows path, typed between quotes, refers to that file and is written as it was typed.
    #[test]
    fn windows_paths_survive_both_ways(
        path in "([A-Z]:|\\\\\\\\[a-z]{1,4})(\\\\[-a-z0-9 .#=,'ntrxé]{0,8}){0,5}",
    ) {
        let line = format!("save \"{path}\"");
        let command: Command = line.parse().unwrap();
        let Command::Save { path: read, .. } = &command else { panic!("{line}") };
        prop_assert_eq!(read.to_str(), Some(path.as_str()));
        prop_assert_eq!(command.to_string(), line);
    }
}

#[test]
fn the_table_of_commands_names_each_verb_once() {
    let table: Vec<&str> = COMMANDS.iter().map(|c| c.verb).collect();
    let distinct: HashSet<&str> = table.iter().copied().collect();
    assert_eq!(table.len(), distinct.len());
    // Random commands until each kind has occurred: each must be in the table.
    let mut runner = TestRunner::deterministic();
    let strategy = any_command();
    let used: HashSet<&str> =
        (0..6000).map(|_| strategy.new_tree(&mut runner).unwrap().current().verb()).collect();
    assert_eq!(used, distinct);
}

#[test]
fn the_usage_of_each_command_matches_its_parser() {
    // Lines of each command according to its usage, with and without the optional parts.
    let lines = [
        "new dims=4,5,6 size=1,2,0.5 colour=8 base=#102030 fill=empty",
        "new dims=4,5,6",
        "new dims=4,5,6 room=7",
        "new dims=4,5,6 grow=on",
        "open \"a b.pvm\"",
        "open v.raw threshold=12.5 colouring=grey colour=8 upright=-z raw=4x5x6:u8:skip=3",
        "embed \"d.png\" data=Zm9v",
        "save c.pvm",
        "save c.pvm form=packed",
        "begin \"carve the nose\"",
        "begin",
        "end",
        "cancel",
        "add ellipsoid at=1,2,3 half=4 turn=10,20,30 colour=#ffffff",
        "add cuboid at=1,2,3 half=4,5,6 turn=0,0,0,1 colour=#ffffff",
        "subtract pyramid at=1,2,3 half=4",
        "recolour ellipsoid at=1,2,3 half=4 colour=#ffffff",
        "spray devourer eye=1,2,90 aim=0,0,-1 across=1,0,0 down=0,1,0 radius=5 bite=square",
        "spray paintbrush eye=1,2,90 aim=0,0,-1 across=1,0,0 down=0,1,0 radius=5 outline=square \
         reach=2 surface=stroke colour=#123456 cover=0.5",
        "spray growth eye=1,2,90 aim=0,0,-1 across=1,0,0 down=0,1,0 radius=5 threshold=12 \
         colour=#123456",
        "spray smooth eye=1,2,90 aim=0,0,-1 across=1,0,0 down=0,1,0 radius=5 around=3",
        "spray smooth eye=1,2,90 aim=0,0,-1 across=1,0,0 down=0,1,0 radius=5 strength=0.5",
        "spray smooth eye=1,2,90 aim=0,0,-1 across=1,0,0 down=0,1,0 radius=5 strength=1 rounding=0.25",
        "texture \"bark of a tree.png\" cuboid at=1,2,3 half=4,5,6 turn=0,0,0,1",
        "texture bark.png ellipsoid at=1,2,3 half=4",
        "fill selection colour=#123456",
        "fill",
        "clear marker",
        "clear",
        "dye grid colour=#123456",
        "dye colour=#123456",
        "adjust marker hue=-30 saturation=1.5 value=0.75",
        "adjust hue=90",
        "gradient grid from=0,-1.5,0 to=0,64,0 colour=#123456 end=#ffffff strength=0.5",
        "gradient from=0,0,0 to=0,64,0 colour=#123456 end=#ffffff",
        "noise selection colour=#123456 size=12 amount=0.25 seed=7",
        "noise colour=#123456",
        "flood at=1,2,3 colour=#123456 tolerance=0.125",
        "flood at=1,2,3 colour=#123456",
        "mask add cuboid at=1,2,3 half=4,5,6 turn=0,0,0,1",
        "mask add selection",
        "mask subtract colour colour=#123456 tolerance=0.125",
        "mask add cavities within=3 depth=1",
        "mask add patch at=1,2,3 angle=20 depth=0",
        "mask add patch at=1,2,3 tolerance=0.5",
        "mask subtract piece at=1,2,3",
        "mask clear",
        "mask invert",
        "mask grow by=3",
        "mask shrink by=3",
        "mask smooth around=3",
        "stencil \"a leaf.png\" eye=1,2,90 aim=0,0,-1 across=1,0,0 down=0,1,0 radius=5 \
         colour=#123456 cover=0.5",
        "mark at=-1,2,3 size=4,5,6",
        "select add",
        "select clear",
        "limit on",
        "limit off",
        "irreversible on",
        "symmetry x=even y=odd z=off",
        "symmetry plane=1,2,3 normal=0,1,0.5 radial=5 about=1,2,3 axis=0,0,1",
        "symmetry",
        "grab at=1,2,3 radius=4.5 by=0,-3,2",
        "deform inflate at=1,2,3 radius=4.5 height=-2 falloff=smooth",
        "deform scrape at=1,2,3 radius=4 normal=0,1,0 strength=0.5 falloff=flat surface=stroke",
        "deform twist at=1,2,3 radius=4 normal=0,1,0 angle=-45.5 falloff=smooth",
        "deform pinch at=1,2,3 radius=4 normal=0,1,0.5 strength=-0.25 falloff=flat surface=stroke",
        "deform draw at=1,2,3 radius=4 normal=0,1,0 height=3 falloff=smooth",
        "deform crease at=1,2,3 radius=4 normal=0,1,0.5 height=-3 falloff=sharp surface=stroke",
        "grab at=1,2,3 radius=4 by=1,0,0 falloff=flat",
        "grab at=1,2,3 radius=4 by=1,0,0 falloff=smooth surface=stroke",
        "copy",
        "cut",
        "paste at=-1,2,3 axes=z,-x,y",
        "paste at=1,2,3",
        "move by=1,0,-2 axes=-x,y,z",
        "move",
        "array count=3 step=8,0,0",
        "resample half",
        "resample double",
        "resample 1.5",
        "resample dims=4,5,6",
        "canvas size dims=4,5,6",
        "canvas grow by=7",
        "canvas grow by=7 sides=x,-y",
        "canvas crop",
        "canvas auto on",
        "canvas auto off",
        "orient upright=z",
        "orient axes=x,-z,y",
        "remove-islands",
        "remove-islands keep=largest smaller=40",
        "fill-cavities",
        "fill-cavities smaller=8",
        "thicken to=2.5",
        "drain",
        "drain diameter=4.5 toward=nearest",
        "surface smooth",
        "surface cubes",
        "undo",
        "undo 3",
        "undo all",
        "redo",
        "redo all",
        "place turn=0,90,0 move=1,2,3 scale=2",
        "place",
    ];
    let mut verbs = HashSet::new();
    for line in lines {
        let command: Command = line.parse().unwrap_or_else(|error| panic!("{line}: {error}"));
        assert_eq!(command.verb(), line.split(' ').next().unwrap());
        verbs.insert(command.verb());
    }
    assert_eq!(verbs.len(), COMMANDS.len());
    for help in COMMANDS.iter() {
        // Every key of the lines above is in the usage, and vice versa.
        let keys = |text: &str| -> HashSet<String> {
            let parts = text.split(['[', ']', ' ', '|']);
            parts.filter_map(|p| p.split_once('=').map(|(key, _)| key.to_string())).collect()
        };
        let lines = lines.iter().filter(|line| line.split(' ').next() == Some(help.verb));
        let used: HashSet<String> = lines.flat_map(|line| keys(line)).collect();
        let told = keys(&help.usage);
        assert!(used.is_subset(&told), "{}: {used:?} but usage has {told:?}", help.verb);
        assert!(!help.tooltip.is_empty());
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let far = "add ellipsoid at=1,2,3 half=4 turn=99999999999999999999,0,0,1";
    let Ok(Command::Construct { primitive, .. }) = far.parse() else { panic!("{far}") };
    assert!(primitive.rotation.is_normalized());
    let cases = [
        ("", "the line has no command"),
        ("carve", "unknown command `carve`; the commands are new, open, "),
        ("new", "`new` needs `dims=`"),
        ("new dims=4,5", "dims=4,5: must be 3 numbers separated by commas"),
        ("new dims=4,5,-6", "dims=4,5,-6: `-6` is not a valid number"),
        ("new dims=4,5,6 colour=7", "colour=7: must be 0, 8, 16 or 24 bits"),
        ("new dims=4,5,6 fill=full", "fill=full: must be solid or empty"),
        (
            "spray smooth eye=1,2,3 aim=1,0,0 across=0,1,0 down=0,0,1 radius=3 around=2 strength=1",
            "`around=` stands instead of `strength=`",
        ),
        ("new dims=4,5,6 dims=4,5,6", "`dims=` is given twice"),
        ("open", "`open` needs a file name"),
        ("open a b", "`open` does not take `b`"),
        ("open \"a", "a quoted text has no closing `\"`"),
        ("open \"a\\", "a quoted text has no closing `\"`"),
        ("open \"a\"b", "a space is missing after a closing `\"`"),
        ("open e\"a", "a quoted text has no closing `\"`"),
        ("open e\"a\\", "a quoted text has no closing `\"`"),
        (
            "open e\"C:\\dir\"",
            "`\\d` means nothing in an e\"...\" text; write `\\\\` for a backslash",
        ),
        ("begin e\"\\x4\"", "`\\x4\"` must have two hexadecimal digits"),
        ("begin e\"\\xff\"", "[255] is not UTF-8"),
        ("clear color=#000000", "`clear` does not take `colour=`"),
        ("fill color=#000000 colour=#000000", "`colour=` is given twice"),
        ("end now", "`end` does not take `now`"),
        ("clear x=1", "`clear` does not take `x=`"),
        (
            "add",
            "`add` needs ellipsoid, cuboid, pyramid, cylinder, cone, torus, capsule, rounded-cuboid, half-space, ring, tube, lathe or extrusion",
        ),
        (
            "add ball at=1,2,3",
            "`ball` is not a solid; use ellipsoid, cuboid, pyramid, cylinder, cone, torus, capsule, rounded-cuboid, half-space, ring, tube, lathe or extrusion",
        ),
        ("add cuboid half=1 colour=#000000", "`add` needs `at=`"),
        ("recolour cuboid at=1,2,3 half=1", "`recolour` needs `colour=`"),
        ("subtract cuboid at=1,2,3 half=1 colour=#000000", "`subtract` does not take `colour=`"),
        ("subtract cuboid at=1,2,nan half=1", "at=1,2,nan: `nan` is not a valid number"),
        ("subtract cuboid at=1,2,3 half=1e99", "half=1e99: `1e99` is not a valid number"),
        (
            "subtract cuboid at=1,2,3 half=1 turn=1,2",
            "turn=1,2: must be three angles in degrees or a quaternion of four numbers",
        ),
        (
            "subtract cuboid at=1,2,3 half=1 turn=0,0,0,0",
            "turn=0,0,0,0: must not be a quaternion of length 0",
        ),
        ("fill colour=red", "colour=red: `red` is not a colour; write it as #rrggbb"),
        ("clear all", "`all` is not an area; use grid, selection or marker"),
        (
            "texture bark.png",
            "`texture` needs ellipsoid, cuboid, pyramid, cylinder, cone, torus, capsule or rounded-cuboid",
        ),
        ("gradient from=0,0,0 colour=#ffffff end=#000000", "`gradient` needs `to=`"),
        ("noise size=3", "`noise` needs `colour=`"),
        ("flood at=-1.5,2,3 colour=#ffffff", "at=-1.5,2,3: `-1.5` is not a valid number"),
        ("mark at=0,0,0 size=1,0,1", "size=1,0,1: must be at least 1"),
        ("mark at=0,0,0 size=1,3000000000,1", "size=1,3000000000,1: is too large"),
        ("mark at=0.5,0,0 size=1,1,1", "at=0.5,0,0: `0.5` is not a valid number"),
        ("select all", "`all` is not valid; use add, subtract, drop or clear"),
        ("limit", "`limit` needs on or off"),
        ("symmetry x=on", "x=on: must be off, even or odd"),
        ("paste", "`paste` needs `at=`"),
        ("move axes=x,x,y", "axes=x,x,y: must be the three axes in some order, such as x,-z,y"),
        ("array count=-1 step=1,0,0", "count=-1: `-1` is not a valid number"),
        ("thicken", "`thicken` needs `to=`"),
        ("drain toward=up", "toward=up: must be down or nearest"),
        ("remove-islands keep=all", "keep=all: must be standing or largest"),
        ("fill-cavities smaller=-1", "smaller=-1: `-1` is not a valid number"),
        ("surface", "`surface` needs smooth or cubes"),
        ("surface round", "`round` is not a surface; use smooth or cubes"),
        ("orient", "`orient` needs either `upright=` or `axes=`"),
        ("orient upright=z axes=x,y,z", "`orient` needs either `upright=` or `axes=`"),
        ("orient upright=up", "upright=up: must be the axis that points up: x, y, z, -x, -y or -z"),
        ("open a.pvm upright=w", "upright=w: must be the axis that points up"),
        ("undo some", "`some` is neither a number of steps nor `all`"),
    ];
    for (line, message) in cases {
        let error = line.parse::<Command>().expect_err(line).to_string();
        assert!(error.starts_with(message), "{line}\n  says    {error}\n  not     {message}");
    }
    let error = parse_script("clear\n\n# fine\n carve all\n").unwrap_err();
    assert!(error.to_string().starts_with("line 4: unknown command `carve`"), "{error}");
}
