//! A message for the person, as a value returned by the editor, the viewpoint and the controls. Knows no interface;
//! `app` shows it.

/// A message for the person.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Notice {
    Note(String),
    Error(String),
}

impl Notice {
    pub fn note(text: impl Into<String>) -> Notice {
        Notice::Note(text.into())
    }

    pub fn error(text: impl Into<String>) -> Notice {
        Notice::Error(text.into())
    }
}
