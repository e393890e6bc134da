//! Owns the life of a session as the runtime tells it: which state it is in, what has to be
//! answered, and whether pictures are made and hands heard. Pure: states in, answers out.
//!
//! The states are those of the OpenXR specification, section "Session Lifecycle".

use openxr::SessionState;

/// What the program has to do about a new state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Answer {
    Nothing,
    /// Begin the session: frames from now on.
    Begin,
    /// End the session: no frames from now on.
    End,
    /// Give the session up; `again` says whether another may be tried for.
    Leave {
        again: bool,
    },
}

/// Where a session stands.
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
    /// Hears of a new state.
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

    /// Whether the person's hands are meant for this program: with the runtime's own menu in
    /// front they are not.
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
