//! The address of a network camera: an `http://` URL with an optional name and password.
//!
//! Parsing is that of the WHATWG URL standard (crate `url`), narrowed to valid requests for a camera: ASCII without
//! spaces, and a named host. Knows no connection.

use std::fmt;

use percent_encoding::percent_decode_str;

/// The address of a camera, with the request and, if needed, name and password.
#[derive(Clone, PartialEq, Eq)]
pub struct Url(url::Url);

impl fmt::Debug for Url {
    /// Omits the login: this may be logged.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Url({self})")
    }
}

impl fmt::Display for Url {
    /// Omits the login: this is shown.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "http://{}{}", self.authority(), self.path())
    }
}

impl Url {
    /// Parses the text after `http://`: `[name:password@]host[:port][/path]`.
    pub fn parse(text: &str) -> Result<Url, String> {
        // The standard drops line ends and escapes spaces; a person who typed them meant something else.
        if let Some(odd) = text.chars().find(|c| !c.is_ascii_graphic()) {
            return Err(format!("it contains {odd:?}; write it as %XX"));
        }
        // The standard takes the host from behind any number of slashes.
        if text.starts_with(['/', '\\']) {
            return Err("it names no host".into());
        }
        let mut url = url::Url::parse(&format!("http://{text}")).map_err(|error| match error {
            url::ParseError::EmptyHost => "it names no host".to_owned(),
            error => error.to_string(),
        })?;
        url.set_fragment(None);
        let url = Url(url);
        url.login()?;
        Ok(url)
    }

    /// Returns a name, an IPv4 address, or an IPv6 address without its brackets.
    pub fn host(&self) -> &str {
        self.0.host_str().unwrap_or_default().trim_matches(['[', ']'])
    }

    pub fn port(&self) -> u16 {
        self.0.port_or_known_default().unwrap_or(80)
    }

    /// Returns path and query, as in a request.
    pub fn path(&self) -> &str {
        &self.0[url::Position::BeforePath..]
    }

    /// Returns host and port, as in a request.
    pub fn authority(&self) -> &str {
        &self.0[url::Position::BeforeHost..url::Position::AfterPort]
    }

    /// Returns the header that carries name and password (RFC 7617).
    pub fn authorization(&self) -> Option<String> {
        let login = self.login().ok().flatten()?;
        Some(format!("Basic {}", base64(login.as_bytes())))
    }

    /// Returns `name:password`, or the name alone if the address has no password; `None` without a name.
    fn login(&self) -> Result<Option<String>, String> {
        let decoded = |text: &str| {
            // The standard leaves a lone % unchanged; in a password it is probably a mistake.
            let escaped =
                |rest: &str| rest.bytes().take(2).filter(u8::is_ascii_hexdigit).count() == 2;
            if !text.split('%').skip(1).all(escaped) {
                return Err("its login has a % without two digits".to_owned());
            }
            let text = percent_decode_str(text).decode_utf8();
            text.map(String::from).map_err(|_| "its login is not UTF-8".to_owned())
        };
        let name = decoded(self.0.username())?;
        match self.0.password() {
            Some(password) => Ok(Some(format!("{name}:{}", decoded(password)?))),
            None if name.is_empty() => Ok(None),
            None => Ok(Some(name)),
        }
    }
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let value = (bits >> (18 - 6 * digit)) & 63;
            let used = digit <= group.len();
            text.push(if used { char::from(DIGITS[value as usize]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn url(text: &str) -> Url {
        Url::parse(text).unwrap()
    }

    #[test]
    fn parts_are_found() {
        let plain = url("10.0.0.2:8080/video?x=1#part");
        assert_eq!((plain.host(), plain.port()), ("10.0.0.2", 8080));
        assert_eq!(plain.path(), "/video?x=1");
        assert_eq!(plain.authority(), "10.0.0.2:8080");
        assert_eq!(plain.to_string(), "http://10.0.0.2:8080/video?x=1");
        assert_eq!((url("cam").port(), url("cam").path()), (80, "/"));
        assert_eq!((url("cam:80/a").authority(), url("cam:").port()), ("cam", 80));
        assert_eq!(url("cam?action=stream").path(), "/?action=stream");
        let v6 = url("[::1]:81/a");
        assert_eq!((v6.host(), v6.authority()), ("::1", "[::1]:81"));
        let login = url("me:p%40ss@cam/");
        assert_eq!(login.login().unwrap().as_deref(), Some("me:p@ss"));
        assert_eq!(login.authority(), "cam");
        assert!(!format!("{login:?}{login}").contains("ss"));
        assert_eq!(url("cam").authorization(), None);
        // The example of RFC 7617.
        let aladdin = url("Aladdin:open%20sesame@cam").authorization().unwrap();
        assert_eq!(aladdin, "Basic QWxhZGRpbjpvcGVuIHNlc2FtZQ==");
        for bad in
            ["", ":80", "/x", "\\x", "cam:x", "cam:99999", "[::1", "[::1]x", "a b", "a\r\nb", "é"]
        {
            assert!(Url::parse(bad).is_err(), "{bad:?}");
        }
        assert!(Url::parse("a%4@cam").is_err() && Url::parse("%ff@cam").is_err());
    }

    #[test]
    fn base64_of_the_standard() {
        // RFC 4648, section 10.
        let pairs =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")];
        for (plain, coded) in pairs {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }
}
