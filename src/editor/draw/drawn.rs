//! A finished drawing, whose commands become one step of the history.

use crate::command::Command;
use crate::editor::commands::CommandRunner;
use crate::editor::idle::{IdleTool, goes_beyond, may_add};
use crate::editor::tool::ToolState;
use crate::input::{DrawKind, ToolMode};

/// The commands that make a drawn solid.
#[derive(Clone, Debug)]
pub(in crate::editor) struct Drawn {
    pub kind: DrawKind,
    pub mode: ToolMode,
    pub commands: Vec<Command>,
    /// The letters that float because there is no surface under them.
    pub floating: Vec<char>,
}

impl Drawn {
    /// Executes the commands, and explains a lack of effect. `in_hand`: a hand in a headset holds the tool.
    pub fn carry_out(&self, runner: &mut CommandRunner, tool: &mut ToolState, in_hand: bool) {
        let Drawn { kind, mode, commands, floating } = self;
        let before = runner.voxels_changed();
        if matches!(mode, ToolMode::Add | ToolMode::Recolour) {
            tool.used_colour();
        }
        let done = match &commands[..] {
            [command] => runner.execute(command),
            _ => runner.execute_as_one(kind.name(), may_add(tool), commands),
        };
        if done && runner.voxels_changed() == before {
            runner.explain_idle(commands, IdleTool::of(tool, in_hand));
        } else if done {
            let document = runner.document();
            let beyond = commands.iter().any(|command| goes_beyond(document, command));
            runner.note_cut_off(beyond);
        }
        if !floating.is_empty() {
            let signs: Vec<String> = floating.iter().map(|sign| format!("“{sign}”")).collect();
            let verb = if signs.len() == 1 { "floats" } else { "float" };
            runner.note(format!("{} {verb}: there is no surface there", signs.join(", ")));
        }
    }
}
