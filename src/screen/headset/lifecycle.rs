//! The state machine of a session: its state, the required responses to new states, and whether
//! frames are shown and hands are read. Pure: states in, responses out.
//!
//! The states are those of the OpenXR specification, section "Session Lifecycle".

use openxr::SessionState;

/// The program's step on a new state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Transition {
    None,
    /// Begin the session: frames start.
    Begin,
    /// End the session: frames stop.
    End,
    /// Destroy the session; `retry`: the program may connect again.
    Destroy {
        retry: bool,
    },
}

/// The state of a session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Lifecycle {
    state: SessionState,
    /// Between begin and end.
    running: bool,
}

impl Default for Lifecycle {
    fn default() -> Self {
        Lifecycle { state: SessionState::UNKNOWN, running: false }
    }
}

impl Lifecycle {
    /// Enters a new state.
    pub fn enter(&mut self, state: SessionState) -> Transition {
        self.state = state;
        match state {
            SessionState::READY if !self.running => {
                self.running = true;
                Transition::Begin
            }
            SessionState::STOPPING if self.running => {
                self.running = false;
                Transition::End
            }
            SessionState::EXITING => Transition::Destroy { retry: false },
            SessionState::LOSS_PENDING => Transition::Destroy { retry: true },
            _ => Transition::None,
        }
    }

    /// Returns whether the frame loop runs: frames are waited for, begun and ended, visible or not.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Returns whether the program has the input focus: not while the runtime's own menu is open.
    pub fn is_focused(&self) -> bool {
        self.state == SessionState::FOCUSED
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use SessionState as S;

    #[test]
    fn each_running_period_begins_and_ends_once() {
        let mut lifecycle = Lifecycle::default();
        let states = [
            (S::IDLE, Transition::None, false),
            (S::READY, Transition::Begin, true),
            (S::SYNCHRONIZED, Transition::None, true),
            (S::VISIBLE, Transition::None, true),
            (S::FOCUSED, Transition::None, true),
            (S::VISIBLE, Transition::None, true),
            (S::SYNCHRONIZED, Transition::None, true),
            (S::STOPPING, Transition::End, false),
            (S::IDLE, Transition::None, false),
            // Taken off and put on again.
            (S::READY, Transition::Begin, true),
            (S::STOPPING, Transition::End, false),
            (S::IDLE, Transition::None, false),
            (S::EXITING, Transition::Destroy { retry: false }, false),
        ];
        for (state, transition, running) in states {
            assert_eq!(lifecycle.enter(state), transition, "{state:?}");
            assert_eq!(lifecycle.is_running(), running, "{state:?}");
            assert_eq!(lifecycle.is_focused(), state == S::FOCUSED);
        }
    }

    #[test]
    fn repeated_and_unexpected_states_have_no_effect() {
        let mut lifecycle = Lifecycle::default();
        assert_eq!(lifecycle.enter(S::STOPPING), Transition::None, "not running");
        assert_eq!(lifecycle.enter(S::READY), Transition::Begin);
        assert_eq!(lifecycle.enter(S::READY), Transition::None);
        assert_eq!(lifecycle.enter(S::LOSS_PENDING), Transition::Destroy { retry: true });
        assert_eq!(
            lifecycle.enter(S::from_raw(77)),
            Transition::None,
            "a state of a later version"
        );
    }
}
