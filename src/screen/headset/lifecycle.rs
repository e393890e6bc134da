//! The state machine of a session: its state, the required responses to new states, and whether
//! frames are shown and hands are read. Pure: states in, responses out.
//!
//! The states are those of the OpenXR specification, section "Session Lifecycle".

use openxr::SessionState;

/// The response to a new state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Answer {
    Nothing,
    /// Begin the session: frames from now on.
    Begin,
    /// End the session: no frames from now on.
    End,
    /// Destroy the session; `again`: another attempt is allowed.
    Leave {
        again: bool,
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
    pub fn enter(&mut self, state: SessionState) -> Answer {
        self.state = state;
        match state {
            SessionState::READY if !self.running => {
                self.running = true;
                Answer::Begin
            }
            SessionState::STOPPING if self.running => {
                self.running = false;
                Answer::End
            }
            SessionState::EXITING => Answer::Leave { again: false },
            SessionState::LOSS_PENDING => Answer::Leave { again: true },
            _ => Answer::Nothing,
        }
    }

    /// Whether frames are waited for, begun and ended, shown or not.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Whether the program has the input focus: it has not while the runtime's own menu is open.
    pub fn is_focused(&self) -> bool {
        self.state == SessionState::FOCUSED
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use SessionState as S;

    #[test]
    fn a_whole_life_begins_and_ends_once() {
        let mut life = Lifecycle::default();
        let way = [
            (S::IDLE, Answer::Nothing, false),
            (S::READY, Answer::Begin, true),
            (S::SYNCHRONIZED, Answer::Nothing, true),
            (S::VISIBLE, Answer::Nothing, true),
            (S::FOCUSED, Answer::Nothing, true),
            (S::VISIBLE, Answer::Nothing, true),
            (S::SYNCHRONIZED, Answer::Nothing, true),
            (S::STOPPING, Answer::End, false),
            (S::IDLE, Answer::Nothing, false),
            // Taken off and put on again.
            (S::READY, Answer::Begin, true),
            (S::STOPPING, Answer::End, false),
            (S::IDLE, Answer::Nothing, false),
            (S::EXITING, Answer::Leave { again: false }, false),
        ];
        for (state, answer, running) in way {
            assert_eq!(life.enter(state), answer, "{state:?}");
            assert_eq!(life.is_running(), running, "{state:?}");
            assert_eq!(life.is_focused(), state == S::FOCUSED);
        }
    }

    #[test]
    fn what_is_said_twice_or_out_of_order_is_not_done_twice() {
        let mut life = Lifecycle::default();
        assert_eq!(life.enter(S::STOPPING), Answer::Nothing, "not running");
        assert_eq!(life.enter(S::READY), Answer::Begin);
        assert_eq!(life.enter(S::READY), Answer::Nothing);
        assert_eq!(life.enter(S::LOSS_PENDING), Answer::Leave { again: true });
        assert_eq!(life.enter(S::from_raw(77)), Answer::Nothing, "a state of the future");
    }
}
