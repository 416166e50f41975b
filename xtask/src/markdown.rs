//! Text as Markdown has it, in a table or out of one; not the pages.

/// A text in which nothing is a mark of Markdown or ends a cell of a table.
pub fn cell(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for (i, part) in text.split('`').enumerate() {
        if i > 0 {
            shown.push('`');
        }
        // In code signs stand for themselves, but for what ends a cell.
        match i % 2 {
            0 => {
                shown += &part
                    .replace('<', "&lt;")
                    .replace('>', "&gt;")
                    .replace('*', "\\*")
            }
            _ => shown += part,
        }
    }
    let lines: Vec<&str> = shown.lines().filter(|line| !line.is_empty()).collect();
    lines.join(" ").replace('|', "\\|")
}

/// A text as code; nothing where there is none.
pub fn code(text: &str) -> String {
    match text {
        "" => String::new(),
        _ => format!("`{}`", text.replace('|', "\\|")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sign_ends_a_cell() {
        assert_eq!(
            cell("a < |b| of `x <y>`\n\n*"),
            "a &lt; \\|b\\| of `x <y>` \\*"
        );
        assert_eq!(code("a|b"), "`a\\|b`");
        assert_eq!(code(""), "");
    }
}
