//! Base64 (RFC 4648, the standard alphabet) <-> bytes; reading skips white space.

/// Decodes at most `most` bytes from the front of `text`. `None` if it contains an invalid character.
pub fn decode(text: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(most.min(text.len() / 4 * 3 + 3));
    let (mut bits, mut count) = (0u32, 0);
    for &c in text.iter().filter(|c| !c.is_ascii_whitespace()) {
        if out.len() >= most || c == b'=' {
            break;
        }
        bits = bits << 6 | value(c)?;
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    Some(out)
}

/// Encodes bytes, with padding and without line ends.
pub fn encode(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(characters(bytes.len()));
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let six = ALPHABET[(bits >> (18 - 6 * i)) as usize & 63];
            text.push(if i <= chunk.len() { char::from(six) } else { '=' });
        }
    }
    text
}

/// Returns the number of characters that `bytes` bytes take, with their padding.
pub fn characters(bytes: usize) -> usize {
    bytes.div_ceil(3) * 4
}

fn value(c: u8) -> Option<u32> {
    Some(
        match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        }
        .into(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_the_rfc() {
        for (plain, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9v\n YmFy"),
        ] {
            assert_eq!(decode(text.as_bytes(), 99).as_deref(), Some(plain.as_bytes()));
            let short = plain.len().min(2);
            assert_eq!(decode(text.as_bytes(), 2).as_deref(), Some(&plain.as_bytes()[..short]));
        }
        assert_eq!(decode(b"+/+/", 9), Some(vec![0xFB, 0xFF, 0xBF]));
        assert_eq!(decode(b"Zm9*", 9), None);
        assert_eq!([characters(0), characters(1), characters(3), characters(4)], [0, 4, 4, 8]);
    }
}
