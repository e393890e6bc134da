//! The table of all commands: verb, arguments and explanation of each, for menus, the palette and help.
//!
//! Knows no values of commands.

/// Name and explanation of a command, for menus, the palette and help.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CommandHelp {
    /// The command's first word in the text form.
    pub verb: &'static str,
    /// Arguments in the text form.
    pub usage: &'static str,
    /// What the command does, in one sentence.
    pub tooltip: &'static str,
}

/// Every command, in the order of the manual.
pub const COMMANDS: &[CommandHelp] = &[
    CommandHelp {
        verb: "new",
        usage: "dims=X,Y,Z [size=SX,SY,SZ] [colour=0|8|16|24] [base=#rrggbb] [fill=solid|empty]",
        tooltip: "Replace the sculpture with a new block of voxels",
    },
    CommandHelp {
        verb: "open",
        usage: "\"PATH\" [threshold=auto|N|N..N] [colouring=auto|none|grey|tissue|labels|packed] [colour=0|8|16|24] [upright=y|z|-z|-y|x|-x] [raw=LAYOUT] [channel=N] [time=N] [region=X,Y,Z..X,Y,Z] [cubic=no|finest|Nmm] [pieces=all|largest] [holes=open|filled] [mesh_size=VOXELS|Nmm] [mesh_fill=auto|solid|shell]",
        tooltip: "Replace the sculpture with the contents of a file",
    },
    CommandHelp {
        verb: "embed",
        usage: "\"PATH\" data=BASE64",
        tooltip: "Give an image, or a sculpture as .vsc, to the commands that follow and name it",
    },
    CommandHelp {
        verb: "save",
        usage: "\"PATH\" [form=auto|densities|rgba|packed] [mesh=smooth|faces|greedy] [triangles=N] [millimetres=X] [up=y|z] [vertices=joined|alone]",
        tooltip: "Write the sculpture to a file",
    },
    CommandHelp {
        verb: "begin",
        usage: "[\"LABEL\"]",
        tooltip: "Begin a stroke: all commands up to `end` are one undo step",
    },
    CommandHelp { verb: "end", usage: "", tooltip: "End the open stroke" },
    CommandHelp {
        verb: "cancel",
        usage: "",
        tooltip: "Cancel the open stroke and undo what it did",
    },
    CommandHelp {
        verb: "add",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=RX,RY,RZ | turn=X,Y,Z,W] [to=X,Y,Z] [colour=#rrggbb] | half-space at=X,Y,Z normal=X,Y,Z | ring at=X,Y,Z radius=R tube=R [turn=...] | tube points=X,Y,Z,R;X,Y,Z,R;... | lathe at=X,Y,Z profile=R,H;R,H;... [turn=...] | extrusion at=X,Y,Z depth=D outline=X,Y;X,Y;...[/X,Y;...] [turn=...]",
        tooltip: "Fill the voxels inside a solid (ellipsoid, cuboid, pyramid, cylinder, cone, torus, capsule, rounded-cuboid, or a half space, ring, tube, lathe or extrusion); new ones get the colour, or the base colour",
    },
    CommandHelp {
        verb: "subtract",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=...] [to=X,Y,Z] | half-space ... | ring ... | tube ... | lathe ... | extrusion ...",
        tooltip: "Remove the voxels inside a solid",
    },
    CommandHelp {
        verb: "recolour",
        usage: "SOLID at=X,Y,Z half=A[,B,C] [turn=...] [to=X,Y,Z] colour=#rrggbb | half-space ... | ring ... | tube ... | lathe ... | extrusion ...",
        tooltip: "Recolour the voxels inside a solid",
    },
    CommandHelp {
        verb: "spray",
        usage: "paintbrush|devourer|erosion|dilation|growth|smooth|clay|mask|unmask eye=X,Y,Z aim=X,Y,Z across=X,Y,Z down=X,Y,Z radius=RAYS [outline=round|square] [takes=rays|visible] [reach=VOXELS] [surface=now|stroke] [colour=#rrggbb] [cover=0..1] [bite=round|square] [threshold=1..26] [around=1..8|strength=0..1 [rounding=0..1]]",
        tooltip: "Use a brush where the rays under its footprint meet the surface",
    },
    CommandHelp {
        verb: "grab",
        usage: "at=X,Y,Z radius=VOXELS by=DX,DY,DZ [falloff=smooth|sharp|flat] [surface=now|stroke]",
        tooltip: "Pull at a ball of clay: what is in its middle goes all the way, what is at its rim stays",
    },
    CommandHelp {
        verb: "deform",
        usage: "inflate|flatten|scrape|fill|draw|crease|pinch|twist at=X,Y,Z radius=VOXELS [height=VOXELS] [normal=X,Y,Z] [strength=-1..1] [angle=DEGREES] [falloff=smooth|sharp|flat] [surface=now|stroke]",
        tooltip: "Move the surface in a ball: outwards by a height (inflate), to a plane through its middle, along a normal (draw, crease), or with the clay around it (pinch, twist)",
    },
    CommandHelp {
        verb: "texture",
        usage: "\"PICTURE\" SOLID at=X,Y,Z half=A[,B,C] [turn=...]",
        tooltip: "Paint the voxels inside a solid with a PNG or JPEG image",
    },
    CommandHelp {
        verb: "stencil",
        usage: "\"PICTURE\" eye=X,Y,Z aim=X,Y,Z across=X,Y,Z down=X,Y,Z radius=RAYS [takes=rays|visible] [colour=#rrggbb] [cover=0..1]",
        tooltip: "Paint the surface under a brush with a PNG or JPEG image, or with a colour through its bright parts",
    },
    CommandHelp {
        verb: "fill",
        usage: "[grid|selection|marker] [colour=#rrggbb]",
        tooltip: "Fill every voxel of an area",
    },
    CommandHelp {
        verb: "clear",
        usage: "[grid|selection|marker]",
        tooltip: "Delete every voxel of an area",
    },
    CommandHelp {
        verb: "dye",
        usage: "[grid|selection|marker] colour=#rrggbb",
        tooltip: "Recolour every voxel of an area",
    },
    CommandHelp {
        verb: "adjust",
        usage: "[grid|selection|marker] [hue=DEGREES] [saturation=FACTOR] [value=FACTOR]",
        tooltip: "Change hue, saturation and value of the colours of the area",
    },
    CommandHelp {
        verb: "gradient",
        usage: "[grid|selection|marker] from=X,Y,Z to=X,Y,Z colour=#rrggbb end=#rrggbb [strength=0..1]",
        tooltip: "Recolour the area from one colour to another along the way between two points",
    },
    CommandHelp {
        verb: "noise",
        usage: "[grid|selection|marker] colour=#rrggbb [size=VOXELS] [amount=0..1] [seed=N]",
        tooltip: "Blend a colour into the area by irregular patches of a size",
    },
    CommandHelp {
        verb: "flood",
        usage: "at=X,Y,Z colour=#rrggbb [tolerance=0..1]",
        tooltip: "Recolour the patch of one colour on the surface around a voxel: voxels with an empty one among their 26 neighbours, joined by faces",
    },
    CommandHelp {
        verb: "mask",
        usage: "add|subtract grid|selection|marker|SOLID at=X,Y,Z half=A[,B,C] [turn=...] [to=X,Y,Z]|half-space ...|ring ...|tube ...|lathe ...|extrusion ...|colour colour=#rrggbb [tolerance=0..1]|cavities [within=1..4] [depth=0..4]|patch at=X,Y,Z [tolerance=0..1|angle=DEGREES] [depth=0..4]|piece at=X,Y,Z | clear | invert | grow [by=VOXELS] | shrink [by=VOXELS] | smooth [around=1..8]",
        tooltip: "Protect voxels from all tools, or no longer: an area, what a solid contains, a colour, cavities of the surface, a patch of one colour or direction, or all that hangs together",
    },
    CommandHelp {
        verb: "mark",
        usage: "at=X,Y,Z size=A,B,C",
        tooltip: "Move and resize the marker: its lower corner and its size in voxels",
    },
    CommandHelp {
        verb: "select",
        usage: "add|subtract|drop|clear",
        tooltip: "Add the marker's box to the selection or subtract it, drop the last box, or clear all",
    },
    CommandHelp { verb: "limit", usage: "on|off", tooltip: "Limit all tools to the selection" },
    CommandHelp {
        verb: "symmetry",
        usage: "[x=off|even|odd] [y=off|even|odd] [z=off|even|odd] [plane=X,Y,Z normal=X,Y,Z] [radial=N about=X,Y,Z axis=X,Y,Z]",
        tooltip: "Mirror what tools do at planes through the grid's centre or at one anywhere, and repeat it around an axis",
    },
    CommandHelp { verb: "copy", usage: "", tooltip: "Copy the voxels in the marker" },
    CommandHelp {
        verb: "cut",
        usage: "",
        tooltip: "Cut the voxels in the marker to the clipboard",
    },
    CommandHelp {
        verb: "paste",
        usage: "at=X,Y,Z [axes=x,y,z]",
        tooltip: "Paste the clipboard, its axes exchanged or reversed if wanted, such as axes=y,-x,z",
    },
    CommandHelp {
        verb: "move",
        usage: "[by=X,Y,Z] [axes=x,y,z]",
        tooltip: "Move, rotate or mirror the marker's contents",
    },
    CommandHelp {
        verb: "array",
        usage: "count=N step=X,Y,Z",
        tooltip: "Repeat the last operation, each time with a further offset",
    },
    CommandHelp {
        verb: "orient",
        usage: "upright=y|z|-z|-y|x|-x | axes=x,y,z",
        tooltip: "Rotate the whole sculpture so that an axis points up, or exchange and reverse its axes, such as axes=x,-z,y",
    },
    CommandHelp {
        verb: "remove-islands",
        usage: "[keep=standing|largest] [smaller=VOXELS]",
        tooltip: "Remove the pieces that hang together with nothing, but for the largest, and for those on the bed unless only the largest is kept",
    },
    CommandHelp {
        verb: "fill-cavities",
        usage: "[smaller=VOXELS]",
        tooltip: "Fill empty places that do not reach the outside",
    },
    CommandHelp {
        verb: "thicken",
        usage: "to=VOXELS",
        tooltip: "Add voxels around walls that are thinner",
    },
    CommandHelp {
        verb: "drain",
        usage: "[diameter=VOXELS] [toward=down|nearest]",
        tooltip: "Drill a hole from each cavity to the outside",
    },
    CommandHelp {
        verb: "surface",
        usage: "smooth|cubes",
        tooltip: "Show near voxels as the smooth surface between them, or as cubes; exports propose the same",
    },
    CommandHelp { verb: "undo", usage: "[N|all]", tooltip: "Undo the last steps" },
    CommandHelp { verb: "redo", usage: "[N|all]", tooltip: "Redo undone steps" },
    CommandHelp {
        verb: "irreversible",
        usage: "on|off",
        tooltip: "Do steps that are too large to be undone, or refuse them",
    },
    CommandHelp {
        verb: "place",
        usage: "[turn=...] [move=X,Y,Z] [scale=S]",
        tooltip: "Rotate, move and scale the sculpture in the world",
    },
];
