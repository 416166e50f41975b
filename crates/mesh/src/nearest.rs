//! The name nearest to a misspelt one; not a fuzzy search.

/// The candidate at the least edit distance from `name`, for a "did you mean"; the first of
/// equals, `None` if there is no candidate.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    candidates
        .into_iter()
        .min_by_key(|candidate| edit_distance(name, candidate))
}

/// Levenshtein distance: least number of insertions, deletions and substitutions of characters.
pub(crate) fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_known_by_hand() {
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("abc", ""), 3);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("größe", "größen"), 1);
        assert_eq!(edit_distance("top", "top"), 0);
    }

    #[test]
    fn the_first_of_equally_near_names_wins() {
        assert_eq!(nearest("tap", ["top", "tip", "bottom"]), Some("top"));
        assert_eq!(nearest("tap", []), None);
    }
}
