//! Newton's method converges quadratically through plastic flow, friction and lift-off, as long as it
//! factorises: losing that is a failure; the answers themselves are tested elsewhere.

use verification::problems::Fallible;
use verification::problems::punched::Punched;

/// Ratio e₂/e₁² of two relative residuals in a row that quadratic convergence keeps bounded. Where
/// points and contacts still change their status it is of the order of one as well.
const BOUND: f64 = 100.0;

#[test]
fn punched_block_converges_quadratically() -> Fallible {
    for friction in [0.0, 0.1, 0.3] {
        let punched = Punched {
            friction,
            ..Punched::default()
        };
        let mut driver = punched.half()?;
        let reports = driver.run(&punched.press(0.2), 20, |_, _| {})?;
        let scale = driver
            .contacts()
            .iter()
            .map(|c| c.t.norm())
            .fold(0.0, f64::max);
        let mut pairs = 0;
        for report in &reports {
            assert_eq!(
                report.cuts, 0,
                "mu = {friction}: increment {}",
                report.increment
            );
            assert!(
                report.newton_iterations <= 8,
                "mu = {friction}: {} iterations in increment {}",
                report.newton_iterations,
                report.increment
            );
            // Steps that took the factor of the one before converge linearly, and are the last.
            let kept = report.newton_iterations - report.factorisations;
            assert!(kept <= 1, "mu = {friction}: {kept} steps without a factor");
            let own = &report.residuals[..report.residuals.len() - kept];
            let tail = &own[own.len().saturating_sub(2)..];
            if let &[before, after] = tail {
                let (before, after) = (before / scale, after / scale);
                let rounding = 1e-12;
                assert!(
                    after <= BOUND * before.powi(2) + rounding,
                    "mu = {friction}: {before:.1e}, then {after:.1e} in increment {}",
                    report.increment
                );
                pairs += 1;
            }
        }
        assert!(pairs >= 10, "hardly anything was nonlinear");
    }
    Ok(())
}
