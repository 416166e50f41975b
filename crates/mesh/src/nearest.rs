//! The name nearest to a misspelt one; not a fuzzy search.

/// The candidate at the least edit distance from `name`, for a "did you mean", of those that have it as one of their
/// words if there are any: `yield` is for `yield-stress`, not for `hill`. Letters in another case are the same, but where
/// candidates differ in nothing else. The first of equals, `None` if there is no candidate.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    candidates.into_iter().min_by_key(|candidate| {
        let other = candidate.to_lowercase();
        let has_as_word = other.split(['-', '_', '.', ' ']).any(|word| word == lower);
        let distances = (
            edit_distance(&lower, &other),
            edit_distance(name, candidate),
        );
        (!has_as_word, distances)
    })
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

    #[test]
    fn letters_in_another_case_are_the_same() {
        assert_eq!(nearest("b.Z1", ["b.x1", "b.z1"]), Some("b.z1"));
        assert_eq!(nearest("TOP", ["tip", "block.top"]), Some("block.top"));
        assert_eq!(nearest("Top", ["top", "Top1", "TOP"]), Some("top"));
        assert_eq!(nearest("ToP", ["top", "TOP"]), Some("TOP"));
    }

    #[test]
    fn a_name_that_has_it_as_a_word_is_nearer_than_one_of_other_letters() {
        assert_eq!(
            nearest("yield", ["hill", "yield-stress"]),
            Some("yield-stress")
        );
        assert_eq!(nearest("top", ["tip", "block.top"]), Some("block.top"));
        assert_eq!(
            nearest("block.tob", ["block", "block.top"]),
            Some("block.top")
        );
    }
}
