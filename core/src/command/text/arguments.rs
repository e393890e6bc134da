//! A parsed line of the text form: a verb, words and `key=value` pairs, which commands take one by one.
//!
//! A word in double quotes is the text between them, backslashes included, so that `"C:\dir\new.vsc"` names that file.
//! A word with double quotes, line ends or bytes that are not text is written `e"..."`; in it, `\"`, `\\`, `\n`, `\r`,
//! `\t` and `\xNN` (one byte, in hexadecimal) stand for the bytes that they name. American spellings of keys are also
//! read. Knows no command.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::fmt;
use std::path::{Path, PathBuf};

use super::ParseError;

/// A parsed line.
pub struct Arguments {
    /// The first word of the line.
    pub verb: String,
    words: VecDeque<Word>,
    pairs: Vec<(String, String)>,
}

/// A word that is a value by itself. Quoted words may hold any bytes.
type Word = Vec<u8>;

impl Arguments {
    /// Splits a line into its verb and its arguments.
    pub fn parse(line: &str) -> Result<Arguments, ParseError> {
        let mut words = VecDeque::new();
        let mut pairs: Vec<(String, String)> = Vec::new();
        let mut rest = line.trim_start();
        while !rest.is_empty() {
            let plain = rest.strip_prefix('"').map(unquote);
            let quoted = plain.or_else(|| rest.strip_prefix("e\"").map(unescape));
            if let Some(quoted) = quoted {
                let (word, after) = quoted?;
                words.push_back(word);
                rest = after.trim_start();
                if rest.len() == after.len() && !rest.is_empty() {
                    return Err(ParseError("a space is missing after a closing `\"`".into()));
                }
                continue;
            }
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            let (token, after) = rest.split_at(end);
            match token.split_once('=') {
                Some((key, value)) => {
                    let key = british(key);
                    if pairs.iter().any(|(k, _)| *k == key) {
                        return Err(ParseError(format!("`{key}=` is given twice")));
                    }
                    pairs.push((key, value.to_string()));
                }
                None => words.push_back(token.into()),
            }
            rest = after.trim_start();
        }
        let verb =
            words.pop_front().ok_or_else(|| ParseError("the line has no command".to_string()))?;
        Ok(Arguments { verb: british(&text(verb)?), words, pairs })
    }

    /// Takes the next word, which `what` describes.
    pub fn word(&mut self, what: &str) -> Result<String, ParseError> {
        self.optional_word()?.ok_or_else(|| self.lacks(what))
    }

    /// Takes the next word without a key, if there is one.
    pub(crate) fn optional_word(&mut self) -> Result<Option<String>, ParseError> {
        self.words.pop_front().map(text).transpose()
    }

    /// Takes the next word as a file name, with any bytes that the system allows.
    pub fn path(&mut self) -> Result<PathBuf, ParseError> {
        let word = self.words.pop_front().ok_or_else(|| self.lacks("a file name"))?;
        path_from_bytes(word).map(PathBuf::from)
    }

    fn lacks(&self, what: &str) -> ParseError {
        ParseError(format!("`{}` needs {what}", self.verb))
    }

    /// Takes and parses the value of `key`; returns an error if it is missing.
    pub fn required<T>(
        &mut self,
        key: &str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<T, ParseError> {
        self.optional(key, parse)?.ok_or_else(|| self.lacks(&format!("`{key}=`")))
    }

    /// Takes and parses the value of `key`, if there is one.
    pub(crate) fn optional<T>(
        &mut self,
        key: &str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, ParseError> {
        let Some(at) = self.pairs.iter().position(|(k, _)| k == key) else { return Ok(None) };
        let (_, value) = self.pairs.swap_remove(at);
        parse(&value).map(Some).map_err(|error| ParseError(format!("{key}={value}: {error}")))
    }

    /// Returns an error if arguments are left.
    pub fn finish(self) -> Result<(), ParseError> {
        let pair = self.pairs.first().map(|(key, _)| format!("{key}="));
        let word = || self.words.front().map(|w| String::from_utf8_lossy(w).into_owned());
        match pair.or_else(word) {
            Some(extra) => Err(ParseError(format!("`{}` does not take `{extra}`", self.verb))),
            None => Ok(()),
        }
    }
}

fn text(word: Word) -> Result<String, ParseError> {
    String::from_utf8(word)
        .map_err(|error| ParseError(format!("{:?} is not UTF-8", error.into_bytes().as_slice())))
}

/// Returns a verb or a key in British spelling: `color`, `coloring` and `recolor` are also read.
fn british(word: &str) -> String {
    match word {
        "color" | "coloring" | "recolor" => word.replace("color", "colour"),
        _ => word.to_string(),
    }
}

/// Reads a text without escapes up to the closing quote. Returns the word and the text after it.
fn unquote(text: &str) -> Result<(Word, &str), ParseError> {
    match text.split_once('"') {
        Some((word, after)) => Ok((word.into(), after)),
        None => Err(unclosed()),
    }
}

fn unclosed() -> ParseError {
    ParseError("a quoted text has no closing `\"`".to_string())
}

/// Reads a text with escapes up to the closing quote. Returns the word and the text after it.
fn unescape(text: &str) -> Result<(Word, &str), ParseError> {
    let mut word = Vec::new();
    let mut rest = text;
    loop {
        let at = rest.find(['"', '\\']).ok_or_else(unclosed)?;
        word.extend_from_slice(&rest.as_bytes()[..at]);
        let escape = rest[at..].strip_prefix('\\');
        let Some(escape) = escape else { return Ok((word, &rest[at + 1..])) };
        let mut chars = escape.chars();
        word.push(match chars.next() {
            Some('n') => b'\n',
            Some('r') => b'\r',
            Some('t') => b'\t',
            Some('"') => b'"',
            Some('\\') => b'\\',
            Some('x') => {
                let digits: String = chars.by_ref().take(2).collect();
                let byte = u8::from_str_radix(&digits, 16).ok();
                let sound = digits.len() == 2 && digits.bytes().all(|d| d.is_ascii_hexdigit());
                byte.filter(|_| sound).ok_or_else(|| {
                    ParseError(format!("`\\x{digits}` must have two hexadecimal digits"))
                })?
            }
            Some(other) => {
                return Err(ParseError(format!(
                    "`\\{other}` means nothing in an e\"...\" text; write `\\\\` for a backslash"
                )));
            }
            None => return Err(unclosed()),
        });
        rest = chars.as_str();
    }
}

/// Text in double quotes, as [`Arguments::parse`] reads it.
pub struct Quoted<'a>(pub &'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_quoted(f, self.0.as_bytes())
    }
}

/// A path in double quotes, as [`Arguments::parse`] reads it.
pub struct QuotedPath<'a>(pub &'a Path);

impl fmt::Display for QuotedPath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_quoted(f, self.0.as_os_str().as_encoded_bytes())
    }
}

/// Writes a word unchanged if it can be read back so, otherwise with escapes.
fn write_quoted(f: &mut fmt::Formatter<'_>, word: &[u8]) -> fmt::Result {
    let plain = std::str::from_utf8(word).ok();
    if let Some(plain) = plain.filter(|text| !text.contains(['"', '\n', '\r', '\t'])) {
        return write!(f, "\"{plain}\"");
    }
    write!(f, "e\"")?;
    for chunk in word.utf8_chunks() {
        write_escaped(f, chunk.valid())?;
        for byte in chunk.invalid() {
            write!(f, "\\x{byte:02x}")?;
        }
    }
    write!(f, "\"")
}

fn write_escaped(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    for c in text.chars() {
        match c {
            '"' => write!(f, "\\\"")?,
            '\\' => write!(f, "\\\\")?,
            '\n' => write!(f, "\\n")?,
            '\r' => write!(f, "\\r")?,
            '\t' => write!(f, "\\t")?,
            c => write!(f, "{c}")?,
        }
    }
    Ok(())
}

#[cfg(unix)]
fn path_from_bytes(bytes: Vec<u8>) -> Result<OsString, ParseError> {
    use std::os::unix::ffi::OsStringExt;
    Ok(OsString::from_vec(bytes))
}

#[cfg(not(unix))]
fn path_from_bytes(bytes: Vec<u8>) -> Result<OsString, ParseError> {
    text(bytes).map(OsString::from)
}
