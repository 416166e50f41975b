//! Rust text as tokens with their lines, without comments; not a parser, and lenient: what it cannot
//! read it takes for punctuation.

/// Sort of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A word: identifier, keyword or lifetime.
    Word,
    /// A string, character or number.
    Literal,
    /// One character, or `::`.
    Mark,
}

/// A token.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// Sort.
    pub kind: Kind,
    /// As it is written.
    pub text: String,
    /// Line of its beginning, from 1.
    pub line: usize,
}

/// The tokens of a text.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let (mut rest, mut line) = (text, 1);
    while let Some(first) = rest.chars().next() {
        let (kind, length) = next(rest, first);
        let (token, after) = rest.split_at(length);
        if let Some(kind) = kind {
            tokens.push(Token {
                kind,
                text: token.to_owned(),
                line,
            });
        }
        line += token.matches('\n').count();
        rest = after;
    }
    tokens
}

/// Kind and length of what a text begins with; no kind for blanks and comments.
fn next(text: &str, first: char) -> (Option<Kind>, usize) {
    if first.is_whitespace() {
        return (None, first.len_utf8());
    }
    if text.starts_with("//") {
        return (None, text.find('\n').unwrap_or(text.len()));
    }
    if text.starts_with("/*") {
        return (None, block_comment(text));
    }
    if let Some(length) = string(text) {
        return (Some(Kind::Literal), length);
    }
    if first == '\'' {
        return quote(text);
    }
    if first.is_ascii_digit() {
        return (Some(Kind::Literal), number(text));
    }
    if is_word(first) {
        return (Some(Kind::Word), word(text));
    }
    let length = if text.starts_with("::") {
        2
    } else {
        first.len_utf8()
    };
    (Some(Kind::Mark), length)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word(text: &str) -> usize {
    // r#type is one word.
    let raw = if text.starts_with("r#") { 2 } else { 0 };
    raw + text[raw..]
        .find(|c| !is_word(c))
        .unwrap_or(text.len() - raw)
}

/// Digits, point and suffix; the sign of an exponent is left to be a mark.
fn number(text: &str) -> usize {
    let digits = text.find(|c| !is_word(c)).unwrap_or(text.len());
    let fraction = text[digits..].strip_prefix('.');
    match fraction.and_then(|rest| rest.chars().next()) {
        Some(c) if c.is_ascii_digit() => {
            let from = digits + 1;
            from + text[from..]
                .find(|c| !is_word(c))
                .unwrap_or(text.len() - from)
        }
        _ => digits,
    }
}

/// Length of a comment that may hold others.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0_usize, 0);
    while at < text.len() {
        let rest = &text.as_bytes()[at..];
        if rest.starts_with(b"/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with(b"*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    text.len()
}

/// Length of the string that a text begins with, prefix and quotes included.
fn string(text: &str) -> Option<usize> {
    let prefix = text.find(|c| !"bcr".contains(c)).unwrap_or(0);
    let hashes = text[prefix..].find(|c| c != '#')?;
    let quoted = text[prefix + hashes..].strip_prefix('"')?;
    let start = prefix + hashes + 1;
    if text[..prefix].ends_with('r') {
        let end = format!("\"{}", "#".repeat(hashes));
        return Some(
            quoted
                .find(&end)
                .map_or(text.len(), |at| start + at + end.len()),
        );
    }
    if hashes > 0 {
        return None;
    }
    let mut escaped = false;
    for (at, c) in quoted.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return Some(start + at + 1),
            _ => {}
        }
    }
    Some(text.len())
}

/// A character such as `'a'` or `'\n'`, or a lifetime such as `'a`.
fn quote(text: &str) -> (Option<Kind>, usize) {
    let inner = &text[1..];
    let mut chars = inner.chars();
    let closing = match (chars.next(), chars.next()) {
        (Some('\\'), Some(c)) => {
            let from = 1 + c.len_utf8();
            inner[from..].find('\'').map(|at| from + at)
        }
        (Some(c), Some('\'')) => Some(c.len_utf8()),
        _ => None,
    };
    match closing {
        Some(at) => (Some(Kind::Literal), at + 2),
        None => (Some(Kind::Word), 1 + word(inner)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<(String, usize)> {
        tokens(text)
            .into_iter()
            .filter(|token| token.kind == Kind::Word)
            .map(|token| (token.text, token.line))
            .collect()
    }

    #[test]
    fn comments_are_no_tokens() {
        let text = "//! unsafe\na /* b /* c */ d\n*/ e // f\n/// g\nh";
        let expected = [("a", 2), ("e", 3), ("h", 5)].map(|(word, line)| (word.to_owned(), line));
        assert_eq!(words(text), expected);
    }

    #[test]
    fn strings_are_single_tokens() {
        for literal in [
            r#""a \" // b""#,
            r##"r#"a " b"#"##,
            "b\"a\"",
            "'x'",
            r"'\''",
            r"'\u{1F600}'",
            "'\"'",
        ] {
            let list = tokens(&format!("({literal})"));
            assert_eq!(list.len(), 3, "{literal}: {list:?}");
            assert_eq!(
                (list[1].kind, list[1].text.as_str()),
                (Kind::Literal, literal)
            );
        }
    }

    #[test]
    fn lines_go_on_after_a_string_of_many_lines() {
        assert_eq!(words("\"a\nb\n\" c"), [("c".to_owned(), 3)]);
    }

    #[test]
    fn lifetimes_and_raw_words_are_words() {
        let list: Vec<String> = words("&'a r#type b\u{3bb}")
            .into_iter()
            .map(|(w, _)| w)
            .collect();
        assert_eq!(list, ["'a", "r#type", "b\u{3bb}"]);
    }

    #[test]
    fn paths_and_numbers() {
        let list: Vec<String> = tokens("a::b[0..1.5e3f64]")
            .into_iter()
            .map(|t| t.text)
            .collect();
        assert_eq!(list, ["a", "::", "b", "[", "0", ".", ".", "1.5e3f64", "]"]);
    }

    #[test]
    fn unfinished_text_is_read_to_its_end() {
        for text in ["\"a", "/* a", "'", "r#\"a", "r", "b#", "'\\"] {
            tokens(text);
        }
    }
}
