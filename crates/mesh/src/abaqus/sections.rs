//! Sections of an input file that say more than a mesh does, told by what they are about; none is read.

use super::keyword::Block;
use crate::read::Loss;
use std::collections::BTreeMap;

/// Keywords that are read, or say nothing that a mesh could lack.
const READ: [&str; 14] = [
    "NODE",
    "ELEMENT",
    "NSET",
    "ELSET",
    "SURFACE",
    "HEADING",
    "PREPRINT",
    "PART",
    "END PART",
    "ASSEMBLY",
    "END ASSEMBLY",
    "INSTANCE",
    "END INSTANCE",
    "PARAMETER",
];

/// What is inside of a step, whatever it is.
const STEPS: &str = "steps and all that is in them";

/// What a keyword outside of steps is about.
fn about(keyword: &str) -> &'static str {
    match keyword {
        "MATERIAL"
        | "ELASTIC"
        | "PLASTIC"
        | "DENSITY"
        | "CYCLIC HARDENING"
        | "HYPERELASTIC"
        | "EXPANSION"
        | "DRUCKER PRAGER"
        | "DRUCKER PRAGER HARDENING"
        | "USER MATERIAL"
        | "DEPVAR"
        | "DAMPING"
        | "CREEP"
        | "CONDUCTIVITY"
        | "SPECIFIC HEAT" => "materials",
        "SOLID SECTION" | "SHELL SECTION" | "BEAM SECTION" | "ORIENTATION" | "SECTION CONTROLS" => {
            "sections of cells"
        }
        "BOUNDARY" | "CLOAD" | "DLOAD" | "DSLOAD" | "AMPLITUDE" | "INITIAL CONDITIONS"
        | "TEMPERATURE" => "conditions and loads",
        "CONTACT PAIR"
        | "SURFACE INTERACTION"
        | "SURFACE BEHAVIOR"
        | "FRICTION"
        | "CONTACT"
        | "CONTACT INCLUSIONS"
        | "CONTACT PROPERTY ASSIGNMENT"
        | "CONTACT CONTROLS"
        | "CONTACT EXCLUSIONS"
        | "CLEARANCE"
        | "GAP"
        | "RIGID BODY" => "contacts and rigid bodies",
        "TIE" | "EQUATION" | "MPC" | "COUPLING" | "KINEMATIC" | "DISTRIBUTING"
        | "EMBEDDED ELEMENT" => "ties and equations",
        _ => "other sections",
    }
}

/// The losses of a file by what they are about, in the order of their first lines.
pub(super) fn losses(blocks: &[Block<'_>]) -> Vec<Loss> {
    let mut sections: BTreeMap<&str, (usize, BTreeMap<&str, usize>)> = BTreeMap::new();
    let mut stresses: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    let mut in_step = false;
    for block in blocks {
        in_step |= block.keyword == "STEP";
        if block.keyword == "ELEMENT"
            && let Some(name) = block.value("TYPE").map(str::to_uppercase)
            && name.starts_with("CPS")
        {
            let (_, count) = stresses.entry(name).or_insert((block.line, 0));
            // A line that ends in a comma goes on in the next.
            let ends = block.data.iter().filter(|(_, l)| !l.ends_with(','));
            *count += ends.count();
        }
        let about = match in_step {
            true => STEPS,
            false => about(&block.keyword),
        };
        if in_step || !READ.contains(&&*block.keyword) {
            let (_, keywords) = sections
                .entry(about)
                .or_insert((block.line, BTreeMap::new()));
            *keywords.entry(&block.keyword).or_insert(0) += 1;
        }
        in_step &= block.keyword != "END STEP";
    }
    let sections = sections.into_iter().map(|(about, (line, keywords))| {
        let keywords = keywords.into_iter().map(|(k, n)| (k.to_owned(), n));
        let keywords = keywords.collect();
        let loss = Loss::Sections {
            about,
            keywords,
            line,
        };
        (line, loss)
    });
    let stresses = stresses.into_iter().map(|(element, (line, elements))| {
        let loss = Loss::PlaneStress {
            element,
            elements,
            line,
        };
        (line, loss)
    });
    let mut all: Vec<(usize, Loss)> = sections.chain(stresses).collect();
    all.sort_by_key(|(line, _)| *line);
    all.into_iter().map(|(_, loss)| loss).collect()
}
