//! Scripts: lines of every command, as text and as they are executed on a small sculpture.

use sculpture_core::command::{COMMANDS, Command};

use super::{fuzz, small};
use sculpture_core::document::Limits;
use sculpture_core::session::Session;

const LINES: [&str; 59] = [
    "new dims=24,20,12 size=1,1,1 colour=24 base=#c8beaa fill=solid",
    "open \"/nonexistent/a.raw\" threshold=2..9 raw=8x6x5:u8:0 region=1,1,1..3,3,3 cubic=2mm mesh_size=9",
    "embed \"a\" data=iVZTQw0KGgoBAAAA",
    "begin \"a stroke\"",
    "add ellipsoid at=4,4,4 half=3,2,5 turn=0,0,0,1 colour=#20ff40",
    "subtract cuboid at=9,9,9 half=2",
    "recolour pyramid at=5,5,5 half=4 turn=10,20,30 colour=#204060",
    "spray clay eye=12,10,60 aim=0,0,-1 across=0.1,0,0 down=0,0.1,0 radius=4 colour=#ff0000 reach=2",
    "spray growth eye=12,10,60 aim=0,0,-1 across=0.1,0,0 down=0,0.1,0 radius=3 outline=square threshold=9",
    "subtract half-space at=4,15,6 normal=0.5,1,0",
    "add ring at=9,9,6 radius=6 tube=2 turn=30,0,0 colour=#204060",
    "add tube points=3,4,5,2;9,12,7,3;20,9,4,1",
    "add lathe at=12,2,6 profile=3,0;5,4;2,9",
    "recolour extrusion at=9,9,6 depth=5 outline=-4,-4;5,-3;0,6/-1,-1;1,-1;0,1 colour=#806040",
    "end",
    "texture \"a\" cuboid at=4,4,4 half=3",
    "deform fill at=9,9,6 radius=6 normal=0,1,0.5 strength=0.75",
    "deform inflate at=9,9,6 radius=6 height=3",
    "deform twist at=9,9,6 radius=6 normal=0,1,0.5 angle=70",
    "deform pinch at=9,9,6 radius=6 normal=0,1,0.5 strength=0.5",
    "deform draw at=9,9,6 radius=6 normal=0,1,0.5 height=3",
    "deform crease at=9,9,6 radius=6 normal=0,1,0.5 height=-3",
    "grab at=9,9,6 radius=5 by=3,-2,4 falloff=sharp",
    "mark at=1,2,3 size=5,5,5",
    "select add",
    "limit on",
    "stencil \"a.png\" eye=9,9,90 aim=0,0,-1 across=0.1,0,0 down=0,0.1,0 radius=9 colour=#102030 cover=0.5",
    "fill selection colour=#102030",
    "clear marker",
    "dye grid colour=#405060",
    "adjust grid hue=40 saturation=1.5 value=0.5",
    "gradient marker from=0,0,0 to=9,9,9 colour=#ff0000 end=#0000ff strength=0.75",
    "noise grid colour=#204060 size=4 amount=0.5 seed=3",
    "surface cubes",
    "flood at=9,9,0 colour=#ffff00 tolerance=0.25",
    "limit off",
    "mask add ellipsoid at=9,9,6 half=4",
    "mask add patch at=9,9,0 angle=30 depth=2",
    "mask subtract cavities within=2 depth=1",
    "mask add piece at=9,9,0",
    "mask grow by=2",
    "mask shrink by=1",
    "mask smooth around=2",
    "mask invert",
    "mask subtract colour colour=#102030 tolerance=0.1",
    "symmetry x=even y=odd z=off",
    "copy",
    "cut",
    "paste at=1,1,1 axes=y,-x,z",
    "move by=2,0,0 axes=x,z,-y",
    "canvas grow by=9 sides=x,-y",
    "array count=3 step=2,0,1",
    "orient axes=x,-z,y",
    "remove-islands keep=largest smaller=9",
    "thicken to=2",
    "drain diameter=3 toward=nearest",
    "undo 2",
    "resample half",
    "place turn=10,0,0 move=1,2,3 scale=2",
];

#[test]
fn damaged_scripts_do_no_harm() {
    if !trials::alone() {
        return;
    }
    let verb = |line: &str| line.split(' ').next().unwrap().to_string();
    for help in COMMANDS.iter() {
        let known = ["save", "redo", "cancel", "irreversible", "fill-cavities"];
        let there = LINES.iter().any(|line| verb(line) == help.verb);
        assert!(there || known.contains(&help.verb), "no line for {}", help.verb);
    }
    let new = "new dims=24,20,12 colour=24".parse().unwrap();
    let Command::New(new) = new else { panic!() };
    let limits = Limits { history_bytes: 4 << 20, ..small() };
    let seed = LINES.join("\n").into_bytes();
    fuzz(
        "script",
        400,
        &[seed],
        |_| {},
        |_, bytes| {
            let mut session = Session::new(&new, limits).unwrap();
            let mut executed = 0;
            for line in String::from_utf8_lossy(bytes).lines() {
                let Ok(command) = line.parse::<Command>() else { continue };
                // A command that was understood is written in a form that is understood again.
                assert_eq!(command.to_string().parse::<Command>().as_ref(), Ok(&command), "{line}");
                if !matches!(command, Command::Save { .. }) {
                    executed += usize::from(session.execute(&command, &()).is_ok());
                }
            }
            executed > 12
        },
    );
}
