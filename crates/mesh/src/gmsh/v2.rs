//! Nodes and elements of MSH 2.2; not of 4.1.

use super::input::{Coding, Input, Least};
use super::{Element, File, Owner, element_kind};
use crate::read::ReadError;

/// `$Nodes`: a number and three coordinates each.
pub(super) fn nodes(input: &mut Input<'_>, file: &mut File) -> Result<(), ReadError> {
    let least = Least {
        ints: 1,
        reals: 3,
        ..Least::default()
    };
    let count = header(input, "nodes", least)?;
    file.nodes.reserve(count);
    for _ in 0..count {
        let number = input.number("the number of a node")?;
        file.nodes.push((number, input.point()?));
    }
    Ok(())
}

/// `$Elements`: number, type, tags (the physical one first) and nodes; in binary, runs of elements
/// of one type and number of tags.
pub(super) fn elements(input: &mut Input<'_>, file: &mut File) -> Result<(), ReadError> {
    // The shortest element is a point without tags; runs have the type and the tags in common.
    let ints = match input.coding {
        Coding::Text => 4,
        Coding::Binary { .. } => 2,
    };
    let least = Least {
        ints,
        ..Least::default()
    };
    let count = header(input, "elements", least)?;
    file.elements.reserve(count);
    let mut left = count;
    while left > 0 {
        let (mut number, mut run) = (None, 1);
        if input.coding == Coding::Text {
            number = Some(input.number("the number of an element")?);
        }
        let kind = element_kind(input)?;
        if input.coding != Coding::Text {
            let at = input.at();
            let found = input.int("the number of elements of a run")?;
            run = usize::try_from(found)
                .ok()
                .filter(|&run| run <= left)
                .ok_or_else(|| input.wrong(at, found, "the number of elements of a run"))?;
        }
        let tags = input.number("the number of tags")?;
        left -= run;
        for _ in 0..run {
            let number = match number {
                Some(number) => number,
                None => input.number("the number of an element")?,
            };
            let mut physical = 0;
            for i in 0..tags {
                let tag = input.int("a tag")?;
                if i == 0 {
                    // A negative tag stands for the group turned round.
                    physical = tag.unsigned_abs();
                }
            }
            let nodes = (0..kind.nodes)
                .map(|_| input.number("the number of a node"))
                .collect::<Result<_, _>>()?;
            file.elements.push(Element {
                number,
                kind,
                owner: Owner::Physical(physical),
                nodes,
            });
        }
    }
    Ok(())
}

/// The count of a list, a line of text in both codings.
fn header(input: &mut Input<'_>, what: &'static str, least: Least) -> Result<usize, ReadError> {
    let (at, expected) = (input.at(), "a count");
    let count = input.text_int(expected)?;
    let count = u64::try_from(count).map_err(|_| input.wrong(at, count, expected))?;
    input.end_of_header()?;
    input.checked(count, what, least)
}
