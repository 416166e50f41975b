//! Checks of the same variant under one heading: `20 cells: load`, `20 cells: slip` become `load` and
//! `slip` under `20 cells`; their order is kept.

use verification::Check;

/// Checks that follow one another and share the beginning of their names.
#[derive(Debug)]
pub struct Group<'a> {
    /// What they share; nothing for checks that stand alone.
    pub heading: Option<&'a str>,
    /// What is left of the names, and the checks.
    pub checks: Vec<(&'a str, &'a Check)>,
}

/// The checks in groups.
pub fn groups<'a>(checks: &'a [Check]) -> Vec<Group<'a>> {
    let mut groups: Vec<Group<'a>> = Vec::new();
    for run in checks.chunk_by(|a, b| split(&a.name).0 == split(&b.name).0) {
        let heading = split(&run[0].name).0.filter(|_| run.len() > 1);
        let name = |check: &'a Check| match heading {
            Some(_) => split(&check.name).1,
            None => &check.name,
        };
        let named = run.iter().map(|check| (name(check), check));
        match groups.last_mut() {
            Some(last) if last.heading.is_none() && heading.is_none() => last.checks.extend(named),
            _ => groups.push(Group {
                heading,
                checks: named.collect(),
            }),
        }
    }
    groups
}

/// A name as what comes before the first colon, and the rest.
fn split(name: &str) -> (Option<&str>, &str) {
    name.split_once(": ")
        .map_or((None, name), |(heading, rest)| (Some(heading), rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::Kind;

    #[test]
    fn neighbours_with_the_same_beginning_stand_together() {
        let check = |name: &&str| Check::new(*name, (0.0, "1"), Kind::AtMost, (0.0, 0.0), "");
        let names = ["a", "b: c", "d: e", "d: f: g", "h", "d: i"];
        let checks: Vec<Check> = names.iter().map(check).collect();
        let shown: Vec<String> = groups(&checks)
            .iter()
            .map(|group| {
                let names: Vec<&str> = group.checks.iter().map(|(name, _)| *name).collect();
                format!("{}[{}]", group.heading.unwrap_or("-"), names.join(", "))
            })
            .collect();
        assert_eq!(shown, ["-[a, b: c]", "d[e, f: g]", "-[h, d: i]"]);
    }
}
