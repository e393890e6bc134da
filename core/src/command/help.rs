//! The table of all commands: verb, arguments and explanation of each, for menus, the palette and help. The arguments
//! of brushes and solids come from their descriptions.
//!
//! Knows no values of commands.

use std::borrow::Cow;
use std::sync::LazyLock;

use super::text;
use crate::tools::drawn::DrawnSolid;
use crate::tools::solid::Solid;

/// Name and explanation of a command, for menus, the palette and help.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CommandHelp {
    /// The command's first word in the text form.
    pub verb: &'static str,
    /// Arguments in the text form.
    pub usage: Cow<'static, str>,
    /// Explains the command in one sentence.
    pub tooltip: Cow<'static, str>,
}

/// Every command, in the order of the manual.
pub static COMMANDS: LazyLock<Vec<CommandHelp>> = LazyLock::new(|| {
    let help = |row: &HelpRow| CommandHelp {
        verb: row.verb,
        usage: filled(row.usage, row.verb),
        tooltip: filled(row.tooltip, row.verb),
    };
    TABLE.iter().map(help).collect()
});

/// A placeholder in the table, and the function that returns its text for the row of a verb.
type Fill = (&'static str, fn(verb: &str) -> String);

/// The placeholders for texts from descriptions.
const FILLS: &[Fill] = &[
    ("{brushes}", text::usage_of_brushes),
    ("{drawn usages}", |_| DrawnSolid::ALL.map(text::usage_of_drawn_solid).join(" | ")),
    ("{drawn names}", |_| drawn_names(" | ")),
    ("{drawn names, close}", |_| drawn_names("|")),
    ("{drawn labels}", |_| text::alternatives(DrawnSolid::ALL.iter().map(|spec| spec.label))),
    ("{solid names}", |_| Solid::ALL.map(Solid::name).join(", ")),
];

fn filled(text: &'static str, verb: &str) -> Cow<'static, str> {
    let fills = FILLS.iter().filter(|(word, _)| text.contains(word));
    fills.fold(Cow::Borrowed(text), |text, (word, fill)| text.replace(word, &fill(verb)).into())
}

/// Returns the names of the drawn solids, whose arguments another row states.
fn drawn_names(between: &str) -> String {
    DrawnSolid::ALL.map(|spec| format!("{} ...", spec.name)).join(between)
}

struct HelpRow {
    verb: &'static str,
    usage: &'static str,
    tooltip: &'static str,
}

const TABLE: &[HelpRow] = &[
    HelpRow {
        verb: "new",
        usage: "dims=X,Y,Z [size=SX,SY,SZ] [colour=0|8|16|24] [base=#rrggbb] [fill=solid|empty] [room=VOXELS] [grow=on|off]",
        tooltip: "Replace the sculpture with a new block of voxels, with empty room around it",
    },
    HelpRow {
        verb: "open",
        usage: "\"PATH\" [threshold=auto|N|N..N] [colouring=auto|none|grey|tissue|labels|packed] [colour=0|8|16|24] [upright=y|z|-z|-y|x|-x] [raw=LAYOUT] [channel=N] [time=N] [region=X,Y,Z..X,Y,Z] [cubic=no|finest|Nmm] [pieces=all|largest] [holes=open|filled] [mesh_size=VOXELS|Nmm] [mesh_fill=auto|solid|shell]",
        tooltip: "Replace the sculpture with the contents of a file",
    },
    HelpRow {
        verb: "embed",
        usage: "\"PATH\" data=BASE64",
        tooltip: "Give an image, or a sculpture as .vsc, to the commands that follow and name it",
    },
    HelpRow {
        verb: "save",
        usage: "\"PATH\" [form=auto|densities|rgba|packed] [mesh=smooth|faces|greedy] [triangles=N] [millimetres=X] [up=y|z] [vertices=joined|alone]",
        tooltip: "Write the sculpture to a file",
    },
    HelpRow {
        verb: "begin",
        usage: "[\"LABEL\"]",
        tooltip: "Begin a stroke: all commands up to `end` are one undo step",
    },
    HelpRow { verb: "end", usage: "", tooltip: "End the open stroke" },
    HelpRow { verb: "cancel", usage: "", tooltip: "Cancel the open stroke and undo what it did" },
    HelpRow {
        verb: "add",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=RX,RY,RZ | turn=X,Y,Z,W] [to=X,Y,Z] [colour=#rrggbb] | {drawn usages}",
        tooltip: "Fill the voxels inside a solid ({solid names}, or a {drawn labels}); new ones get the colour, or the base colour",
    },
    HelpRow {
        verb: "subtract",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=...] [to=X,Y,Z] | {drawn names}",
        tooltip: "Remove the voxels inside a solid",
    },
    HelpRow {
        verb: "recolour",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=...] [to=X,Y,Z] colour=#rrggbb | {drawn names}",
        tooltip: "Recolour the voxels inside a solid",
    },
    HelpRow {
        verb: "spray",
        usage: "{brushes}",
        tooltip: "Use a brush where the rays under its footprint meet the surface",
    },
    HelpRow {
        verb: "grab",
        usage: "{brushes}",
        tooltip: "Pull at a ball of clay: what is in its middle goes all the way, what is at its rim stays",
    },
    HelpRow {
        verb: "deform",
        usage: "{brushes}",
        tooltip: "Move the surface in a ball: outwards by a height (inflate), to a plane through its middle, along a normal (draw, crease), or with the clay around it (pinch, twist)",
    },
    HelpRow {
        verb: "texture",
        usage: "\"PICTURE\" SOLID at=X,Y,Z half=A[,B,C] [turn=...]",
        tooltip: "Paint the voxels inside a solid with a PNG or JPEG image",
    },
    HelpRow {
        verb: "stencil",
        usage: "{brushes}",
        tooltip: "Paint the surface under a brush with a PNG or JPEG image, or with a colour through its bright parts",
    },
    HelpRow {
        verb: "fill",
        usage: "[grid|selection|marker] [colour=#rrggbb]",
        tooltip: "Fill every voxel of an area",
    },
    HelpRow {
        verb: "clear",
        usage: "[grid|selection|marker]",
        tooltip: "Delete every voxel of an area",
    },
    HelpRow {
        verb: "dye",
        usage: "[grid|selection|marker] colour=#rrggbb",
        tooltip: "Recolour every voxel of an area",
    },
    HelpRow {
        verb: "adjust",
        usage: "[grid|selection|marker] [hue=DEGREES] [saturation=FACTOR] [value=FACTOR]",
        tooltip: "Change hue, saturation and value of the colours of the area",
    },
    HelpRow {
        verb: "gradient",
        usage: "[grid|selection|marker] from=X,Y,Z to=X,Y,Z colour=#rrggbb end=#rrggbb [strength=0..1]",
        tooltip: "Recolour the area from one colour to another along the way between two points",
    },
    HelpRow {
        verb: "noise",
        usage: "[grid|selection|marker] colour=#rrggbb [size=VOXELS] [amount=0..1] [seed=N]",
        tooltip: "Blend a colour into the area by irregular patches of a size",
    },
    HelpRow {
        verb: "flood",
        usage: "at=X,Y,Z colour=#rrggbb [tolerance=0..1]",
        tooltip: "Recolour the patch of one colour on the surface around a voxel: voxels with an empty one among their 26 neighbours, joined by faces",
    },
    HelpRow {
        verb: "mask",
        usage: "add|subtract grid|selection|marker|SOLID at=X,Y,Z half=A[,B,C] [turn=...] [to=X,Y,Z]|{drawn names, close}|colour colour=#rrggbb [tolerance=0..1]|cavities [within=1..4] [depth=0..4]|patch at=X,Y,Z [tolerance=0..1|angle=DEGREES] [depth=0..4]|piece at=X,Y,Z | clear | invert | grow [by=VOXELS] | shrink [by=VOXELS] | smooth [around=1..8]",
        tooltip: "Protect voxels from all tools, or no longer: an area, what a solid contains, a colour, cavities of the surface, a patch of one colour or direction, or all that hangs together",
    },
    HelpRow {
        verb: "mark",
        usage: "at=X,Y,Z size=A,B,C",
        tooltip: "Move and resize the marker: its lower corner and its size in voxels",
    },
    HelpRow {
        verb: "select",
        usage: "add|subtract|drop|clear",
        tooltip: "Add the marker's box to the selection or subtract it, drop the last box, or clear all",
    },
    HelpRow { verb: "limit", usage: "on|off", tooltip: "Limit all tools to the selection" },
    HelpRow {
        verb: "symmetry",
        usage: "[x=off|even|odd] [y=off|even|odd] [z=off|even|odd] [plane=X,Y,Z normal=X,Y,Z] [radial=N about=X,Y,Z axis=X,Y,Z]",
        tooltip: "Mirror what tools do at planes through the grid's centre or at one anywhere, and repeat it around an axis",
    },
    HelpRow { verb: "copy", usage: "", tooltip: "Copy the voxels in the marker" },
    HelpRow { verb: "cut", usage: "", tooltip: "Cut the voxels in the marker to the clipboard" },
    HelpRow {
        verb: "paste",
        usage: "at=X,Y,Z [axes=x,y,z]",
        tooltip: "Paste the clipboard, its axes exchanged or reversed if wanted, such as axes=y,-x,z",
    },
    HelpRow {
        verb: "move",
        usage: "[by=X,Y,Z] [axes=x,y,z]",
        tooltip: "Move, rotate or mirror the marker's contents",
    },
    HelpRow {
        verb: "array",
        usage: "count=N step=X,Y,Z",
        tooltip: "Repeat the last operation, each time with a further offset",
    },
    HelpRow {
        verb: "orient",
        usage: "upright=y|z|-z|-y|x|-x | axes=x,y,z",
        tooltip: "Rotate the whole sculpture so that an axis points up, or exchange and reverse its axes, such as axes=x,-z,y",
    },
    HelpRow {
        verb: "canvas",
        usage: "size dims=X,Y,Z | grow by=VOXELS [sides=x,-x,y,-y,z,-z] | crop | auto on|off",
        tooltip: "Set the size of the sculpture's box, let it grow at some sides or all, crop it to the voxels in it, or let it grow with the tools",
    },
    HelpRow {
        verb: "resample",
        usage: "half|double|FACTOR | dims=X,Y,Z",
        tooltip: "Give the sculpture more or fewer voxels of another size, in the same shape and size in the world",
    },
    HelpRow {
        verb: "remove-islands",
        usage: "[keep=standing|largest] [smaller=VOXELS]",
        tooltip: "Remove the pieces that hang together with nothing, but for the largest, and for those on the bed unless only the largest is kept",
    },
    HelpRow {
        verb: "fill-cavities",
        usage: "[smaller=VOXELS]",
        tooltip: "Fill empty places that do not reach the outside",
    },
    HelpRow {
        verb: "thicken",
        usage: "to=VOXELS",
        tooltip: "Add voxels around walls that are thinner",
    },
    HelpRow {
        verb: "drain",
        usage: "[diameter=VOXELS] [toward=down|nearest]",
        tooltip: "Drill a hole from each cavity to the outside",
    },
    HelpRow {
        verb: "surface",
        usage: "smooth|cubes",
        tooltip: "Show near voxels as the smooth surface between them, or as cubes; exports propose the same",
    },
    HelpRow { verb: "undo", usage: "[N|all]", tooltip: "Undo the last steps" },
    HelpRow { verb: "redo", usage: "[N|all]", tooltip: "Redo undone steps" },
    HelpRow {
        verb: "irreversible",
        usage: "on|off",
        tooltip: "Do steps that are too large to be undone, or refuse them",
    },
    HelpRow {
        verb: "place",
        usage: "[turn=...] [move=X,Y,Z] [scale=S]",
        tooltip: "Rotate, move and scale the sculpture in the world",
    },
];
