//! Owns the address of a camera on the network.

use std::fmt;

/// What follows `http://`: host, port, path and, if the camera wants it, name and password.
#[derive(Clone, PartialEq, Eq)]
pub struct Url {
    /// A name, an IPv4 address, or an IPv6 address without its brackets.
    pub host: String,
    pub port: u16,
    /// With its query, from the first slash.
    pub path: String,
    /// Name and password, `name:password`.
    pub login: Option<String>,
}

impl fmt::Debug for Url {
    /// Leaves the password out, for it may end in a log.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Url({self})")
    }
}

impl fmt::Display for Url {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "http://{}{}", self.authority(), self.path)
    }
}

impl Url {
    /// Parses `[name:password@]host[:port][/path]`.
    pub fn parse(text: &str) -> Result<Url, String> {
        // Anything else could end the request line and start another.
        if let Some(odd) = text.chars().find(|c| !c.is_ascii_graphic()) {
            return Err(format!("it contains {odd:?}; write it as %XX"));
        }
        let text = text.split('#').next().unwrap_or_default();
        let end = text.find(['/', '?']).unwrap_or(text.len());
        let (authority, path) = text.split_at(end);
        let path = if path.starts_with('/') { path.to_owned() } else { format!("/{path}") };
        let (login, place) = match authority.rsplit_once('@') {
            Some((login, place)) => (Some(percent_decoded(login)?), place),
            None => (None, authority),
        };
        let (host, port) = if let Some(rest) = place.strip_prefix('[') {
            let (host, port) = rest.split_once(']').ok_or("its [ has no ]")?;
            (host, port)
        } else {
            place.split_at(place.find(':').unwrap_or(place.len()))
        };
        let port = match port.strip_prefix(':') {
            Some(digits) => digits.parse().map_err(|_| format!("{digits:?} is not a port"))?,
            None if port.is_empty() => 80,
            None => return Err(format!("{port:?} after the host is not a port")),
        };
        if host.is_empty() {
            return Err("it names no host".into());
        }
        Ok(Url { host: host.into(), port, path, login })
    }

    /// Host and port as a request names them.
    pub fn authority(&self) -> String {
        let host = &self.host;
        match (host.contains(':'), self.port) {
            (true, port) => format!("[{host}]:{port}"),
            (false, 80) => host.clone(),
            (false, port) => format!("{host}:{port}"),
        }
    }

    /// The header that carries the login, RFC 7617.
    pub fn authorization(&self) -> Option<String> {
        self.login.as_ref().map(|login| format!("Basic {}", base64(login.as_bytes())))
    }
}

fn percent_decoded(text: &str) -> Result<String, String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, tail @ ..] = rest {
        let hex = |byte: u8| char::from(byte).to_digit(16);
        match (first, tail) {
            (b'%', [high, low, tail @ ..]) => {
                let code = hex(*high).zip(hex(*low)).map(|(h, l)| (h * 16 + l) as u8);
                bytes.push(code.ok_or("its login has a % without two digits")?);
                rest = tail;
            }
            (b'%', _) => return Err("its login has a % without two digits".into()),
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).map_err(|_| "its login is not UTF-8".into())
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
        assert_eq!((plain.host.as_str(), plain.port), ("10.0.0.2", 8080));
        assert_eq!(plain.path, "/video?x=1");
        assert_eq!(plain.authority(), "10.0.0.2:8080");
        assert_eq!((url("cam").port, url("cam").path.as_str()), (80, "/"));
        assert_eq!(url("cam?action=stream").path, "/?action=stream");
        assert_eq!(url("[::1]:81/a").authority(), "[::1]:81");
        let login = url("me:p%40ss@cam/");
        assert_eq!(login.login.as_deref(), Some("me:p@ss"));
        assert!(!format!("{login:?}{login}").contains("ss"));
        // The example of RFC 7617.
        let aladdin = url("Aladdin:open%20sesame@cam").authorization().unwrap();
        assert_eq!(aladdin, "Basic QWxhZGRpbjpvcGVuIHNlc2FtZQ==");
        for bad in ["", ":80", "/x", "cam:", "cam:99999", "[::1", "[::1]x", "a b", "a\r\nb", "é"] {
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
