//! Prandtl's punch driven by a force that its block does not carry; not its indentation, which is a
//! case of the report.

use crate::close;
use moreau::driver::{Axis, Settings};
use moreau::mesh::Integration;
use verification::paper::{prandtl, prandtl_load, prandtl_punch_load, prandtl_step};
use verification::problems::Fallible;
use verification::problems::limit::collapse_of;

/// The force ends where the motion of the punch leads to, above the limit load and below the bound of
/// its mechanism. This coarse mesh creeps on to displacements of its size: loads are compared at
/// equal depths.
#[test]
fn a_force_beyond_the_limit_load_ends_on_the_plateau() -> Fallible {
    // P/P_Prandtl at 0.4 mm by an independent code, where the curve still creeps up a little.
    for (rule, at_0_4) in [
        (Integration::Reduced, 1.068046824),
        (Integration::Full, 1.124531545),
    ] {
        let mut pushed = prandtl(1, rule, Settings::default())?;
        let force = 1.25 * prandtl_load();
        let step = prandtl_step(0.0).push("punch", Axis::Y, -0.5 * force);
        let found = collapse_of(&mut pushed, &step, 20)?;
        let load = 1.25 * found.load_factor;
        close(
            "load of the punch",
            prandtl_punch_load(&pushed)?,
            load * prandtl_load(),
            1e-5,
        );
        // Moved to the same depth: evenly at first, then each increment as long as all before it.
        let depth = -pushed.tool_displacement("punch")?[1];
        let mut moved = prandtl(1, rule, Settings::default())?;
        let mut done = 0;
        for k in (0..16).rev() {
            let travel = depth * 0.5f64.powi(k);
            if travel > 0.05 {
                let increments = if done == 0 { 20 } else { 1 };
                moved.run(&prandtl_step(travel), increments, |_, _| {})?;
                done += 1;
            }
        }
        let plateau = prandtl_punch_load(&moved)? / prandtl_load();
        close("plateau", load, plateau, 1e-4);
        // Nor does the load of perfect plasticity ever fall.
        assert!(load > at_0_4, "{load} {at_0_4}");
        let bound = found.upper_bound.ok_or("von Mises has a bound")?;
        assert!(!bound.coulomb, "the punch is smooth");
        assert!(bound.load_factor >= found.load_factor && 1.25 * bound.load_factor > 1.0);
        close("bound", bound.load_factor, found.load_factor, 1e-3);
    }
    Ok(())
}
