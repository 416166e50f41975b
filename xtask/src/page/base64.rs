//! Bytes as text, by RFC 4648.

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// The bytes in base 64, filled up with `=`.
pub(super) fn encoded(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * k)) as usize & 63];
            text.push(if k > three.len() { '=' } else { digit.into() });
        }
    }
    text
}

/// The bytes of a text in base 64; what is no digit is left aside.
pub(super) fn decoded(text: &str) -> Vec<u8> {
    let digits = text
        .bytes()
        .filter_map(|c| DIGITS.iter().position(|d| *d == c));
    let digits: Vec<usize> = digits.collect();
    let mut bytes = Vec::with_capacity(digits.len() * 3 / 4);
    for four in digits.chunks(4) {
        let digit = |k: usize| four.get(k).copied().unwrap_or(0);
        let bits = digit(0) << 18 | digit(1) << 12 | digit(2) << 6 | digit(3);
        bytes.extend((1..four.len()).map(|k| (bits >> (24 - 8 * k)) as u8));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::{decoded, encoded};

    /// The examples of the RFC.
    #[test]
    fn what_lacks_is_filled_up() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(encoded(bytes.as_bytes()), text);
            assert_eq!(decoded(text), bytes.as_bytes());
        }
        assert_eq!(encoded(&[0xfb, 0xff]), "+/8=");
    }
}
