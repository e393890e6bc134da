//! A message for the person, as a value: what the editor, the viewpoint and the controls return
//! where they have something to say. Knows no interface; `app` shows it.

/// Something to tell the person.
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
