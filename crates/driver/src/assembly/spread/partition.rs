//! Which process holds which cell: by halving along the longest side, again and again; not what it does with it.

use moreau_mesh::Mesh;

/// The process of every cell, of so many: parts of equally many cells that lie together. The list of cells is cut
/// across the longest side of the box of their middles, in proportion to the processes on either side of the cut:
/// M. J. Berger and S. H. Bokhari, *A partitioning strategy for nonuniform problems on multiprocessors*, IEEE Trans.
/// Comput. C-36 (1987). It depends on nothing but the mesh.
pub(crate) fn partition<const D: usize>(mesh: &Mesh<D>, processes: usize) -> Vec<u32> {
    let middle = |cell: usize| -> [f64; D] {
        let nodes = mesh.cell_nodes(cell);
        let sum = |i: usize| nodes.iter().map(|&a| mesh.nodes()[a][i]).sum::<f64>();
        std::array::from_fn(|i| sum(i) / nodes.len() as f64)
    };
    let middles: Vec<[f64; D]> = (0..mesh.cell_count()).map(middle).collect();
    let mut process = vec![0; middles.len()];
    let mut cells: Vec<usize> = (0..middles.len()).collect();
    cut(&mut cells, &middles, (0, processes.max(1)), &mut process);
    process
}

/// Gives cells to the processes from the first on, so many.
fn cut<const D: usize>(
    cells: &mut [usize],
    middles: &[[f64; D]],
    (first, count): (usize, usize),
    process: &mut [u32],
) {
    if count == 1 {
        cells.iter().for_each(|&c| process[c] = first as u32);
        return;
    }
    let side = |i: usize| {
        let at = cells.iter().map(|&c| middles[c][i]);
        let ends = at.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        ends.1 - ends.0
    };
    let longest = (0..D).max_by(|&i, &j| side(i).total_cmp(&side(j)).then(j.cmp(&i)));
    let axis = longest.unwrap_or(0);
    // Those that lie alike come in their order.
    cells.sort_by(|&a, &b| {
        middles[a][axis]
            .total_cmp(&middles[b][axis])
            .then(a.cmp(&b))
    });
    let lower = count / 2;
    let (low, high) = cells.split_at_mut(cells.len() * lower / count);
    cut(low, middles, (first, lower), process);
    cut(high, middles, (first + lower, count - lower), process);
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_mesh::{CellKind, block2, uniform};

    #[test]
    fn parts_are_equally_large_and_lie_together() {
        let (x, y) = (uniform(0.0, 12.0, 12), uniform(0.0, 4.0, 4));
        let mesh = block2("block", CellKind::Quad4, &x, &y).expect("valid");
        for processes in 1..=7 {
            let of = partition(&mesh, processes);
            for process in 0..processes as u32 {
                let own: Vec<usize> = (0..48).filter(|&c| of[c] == process).collect();
                let fair = 48 / processes;
                assert!(own.len() >= fair && own.len() <= fair + 2, "{own:?}");
            }
        }
        let halves = partition(&mesh, 2);
        assert!(
            (0..48).all(|c| halves[c] == u32::from(mesh.nodes()[mesh.cell_nodes(c)[0]][0] >= 6.0))
        );
    }
}
