//! Entities, nodes and elements of MSH 4.1; not of 2.2.

use super::input::{Input, Least};
use super::{Element, File, Owner, element_kind};
use crate::read::ReadError;

/// `$Entities` or `$PartitionedEntities`: the physical groups that each point, curve, surface and
/// volume belongs to.
pub(super) fn entities(
    input: &mut Input<'_>,
    file: &mut File,
    partitioned: bool,
) -> Result<(), ReadError> {
    if partitioned {
        input.size("the number of partitions")?;
        for _ in 0..input.size("the number of ghost entities")? {
            input.int("the tag of a ghost entity")?;
            input.int("a partition")?;
        }
    }
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = input.size("a number of entities")?;
    }
    for (dimension, count) in (0..).zip(counts) {
        for _ in 0..count {
            let tag = input.int("the tag of an entity")?;
            if partitioned {
                input.int("the dimension of the parent")?;
                input.int("the tag of the parent")?;
                for _ in 0..input.size("a number of partitions")? {
                    input.int("a partition")?;
                }
            }
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                input.real("a bound of an entity")?;
            }
            let mut physicals = Vec::new();
            for _ in 0..input.size("a number of physical groups")? {
                // A negative tag stands for the group turned round.
                physicals.push(input.int("a physical group")?.unsigned_abs());
            }
            physicals.sort_unstable();
            physicals.dedup();
            if dimension > 0 {
                for _ in 0..input.size("a number of bounding entities")? {
                    input.int("the tag of an entity")?;
                }
            }
            file.entities.insert((dimension, tag), physicals);
        }
    }
    Ok(())
}

/// `$Nodes`: blocks of numbers followed by as many coordinates; parameters on the entity, if
/// there are any, are skipped.
pub(super) fn nodes(input: &mut Input<'_>, file: &mut File) -> Result<(), ReadError> {
    let blocks = totals(input)?;
    for _ in 0..blocks {
        let at = input.at();
        let dimension = input.int("the dimension of an entity")?;
        let dimension = usize::try_from(dimension)
            .ok()
            .filter(|&dimension| dimension <= 3)
            .ok_or_else(|| input.wrong(at, dimension, "a dimension from 0 to 3"))?;
        input.int("the tag of an entity")?;
        let parameters = match input.int("0 or 1 for parameters")? {
            0 => 0,
            _ => dimension,
        };
        let least = Least {
            sizes: 1,
            reals: 3 + parameters,
            ..Least::default()
        };
        let count = input.size("the number of nodes of a block")?;
        let count = input.checked(count, "nodes", least)?;
        let mut numbers = Vec::with_capacity(count);
        for _ in 0..count {
            numbers.push(input.size("the number of a node")?);
        }
        file.nodes.reserve(count);
        for number in numbers {
            file.nodes.push((number, input.point()?));
            for _ in 0..parameters {
                input.real("a parameter of a node")?;
            }
        }
    }
    Ok(())
}

/// `$Elements`: blocks of one type on one entity, each element a number and its nodes.
pub(super) fn elements(input: &mut Input<'_>, file: &mut File) -> Result<(), ReadError> {
    let blocks = totals(input)?;
    for _ in 0..blocks {
        let dimension = input.int("the dimension of an entity")?;
        let entity = input.int("the tag of an entity")?;
        let kind = element_kind(input)?;
        let least = Least {
            sizes: 1 + kind.nodes,
            ..Least::default()
        };
        let count = input.size("the number of elements of a block")?;
        let count = input.checked(count, "elements", least)?;
        file.elements.reserve(count);
        for _ in 0..count {
            let number = input.size("the number of an element")?;
            let nodes = (0..kind.nodes)
                .map(|_| input.size("the number of a node"))
                .collect::<Result<_, _>>()?;
            file.elements.push(Element {
                number,
                kind,
                owner: Owner::Entity(dimension, entity),
                nodes,
            });
        }
    }
    Ok(())
}

/// Number of blocks; then the number of items and their least and greatest number, which the
/// blocks say as well.
fn totals(input: &mut Input<'_>) -> Result<u64, ReadError> {
    let blocks = input.size("a number of blocks")?;
    for expected in ["a count", "the least number", "the greatest number"] {
        input.size(expected)?;
    }
    Ok(blocks)
}
