//! Texts about a drawing that takes several presses: its progress, and the keys.
//!
//! Takes its [`Progress`] and the bindings in use; gives texts.

use crate::editor::draw::Progress;
use crate::input::Action;
use crate::input::trigger::Trigger;
use crate::ui::context::UiContext;

/// Returns the text for the line along the bottom: the height of a box, or the points of a curve, and the possible
/// actions.
pub fn line(drawn: Progress, context: &UiContext) -> String {
    let acts = acts(drawn, |action| keys(action, context)).join(" \u{b7} ");
    format!("{} \u{b7} {acts}", amount(drawn))
}

/// Returns the text for the options of the tool: the possible actions.
pub fn advice(drawn: Progress, context: &UiContext) -> String {
    let acts = acts(drawn, |action| keys(action, context)).join("; ");
    match drawn {
        Progress::Raised(_) => format!("Move the pointer to raise or lower the box. {acts}."),
        Progress::Points(_) => format!("Click to add points to the curve. {acts}."),
    }
}

/// Returns the keys for an action; empty in a headset.
fn keys(action: Action, context: &UiContext) -> Vec<String> {
    let table = context.bindings().filter(|_| !context.in_headset);
    let triggers = table.into_iter().flat_map(|table| table.triggers(action));
    let keys = triggers.filter(|trigger| matches!(trigger, Trigger::Key { .. }));
    keys.map(|key| key.to_string()).collect()
}

/// Returns the progress in words.
fn amount(drawn: Progress) -> String {
    match drawn {
        Progress::Raised(layers) if layers < 0 => format!("Depth {} vx", layers.unsigned_abs()),
        Progress::Raised(layers) => format!("Height {layers} vx"),
        Progress::Points(1) => "1 point".to_string(),
        Progress::Points(count) => format!("{count} points"),
    }
}

/// Returns the possible actions, each with its presses. An action without a press is skipped.
fn acts(drawn: Progress, keys: impl Fn(Action) -> Vec<String>) -> Vec<String> {
    let (press, goes_back) = match drawn {
        Progress::Raised(_) => ("Click", false),
        Progress::Points(_) => ("Double-click", true),
    };
    let done = [press.to_string()].into_iter().chain(keys(Action::Apply)).collect();
    let back = if goes_back { keys(Action::DropBox) } else { Vec::new() };
    [(done, "done"), (back, "undo point"), (keys(Action::Cancel), "cancel")]
        .into_iter()
        .filter_map(|(presses, what)| Some(format!("{}: {what}", either(&presses)?)))
        .collect()
}

/// Joins presses as `a, b or c`.
fn either(presses: &[String]) -> Option<String> {
    let (last, others) = presses.split_last()?;
    Some(match others {
        [] => last.clone(),
        _ => format!("{} or {last}", others.join(", ")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn height_and_depth_are_told_apart_and_points_counted() {
        let amounts =
            [Progress::Raised(7), Progress::Raised(-3), Progress::Points(1), Progress::Points(12)];
        assert_eq!(amounts.map(amount), ["Height 7 vx", "Depth 3 vx", "1 point", "12 points"]);
    }

    #[test]
    fn keys_are_those_of_the_table_and_left_out_where_there_are_none() {
        let named = |action: Action| match action {
            Action::Apply => vec!["Space".to_string(), "Enter".to_string()],
            _ => vec![action.help().name.to_string()],
        };
        assert_eq!(
            acts(Progress::Points(2), named),
            ["Double-click, Space or Enter: done", "drop-box: undo point", "cancel: cancel"]
        );
        assert_eq!(acts(Progress::Raised(1), |_| Vec::new()), ["Click: done"]);
    }
}
