//! Large strains against an independent implementation: upsetting, the ring, the neck; not one point
//! of material.

use moreau::driver::{Analysis, Axis, Driver, Step};
use moreau::laws::Status;
use moreau::mesh::{Axisymmetric, CellKind, Integration, PlaneStrain};
use verification::problems::Fallible;
use verification::problems::large::{Billet, Reference};

/// Largest distance of nodes from where the reference has them, over the largest displacement.
fn distance(driver: &Driver<2>, boundary: &Reference, increment: usize) -> f64 {
    let [inc, x, y, x_now, y_now] = ["inc", "X", "Y", "x", "y"].map(|c| boundary.column(c));
    let nodes = driver.mesh().nodes();
    let (mut off, mut size) = (0.0f64, 0.0f64);
    let mut seen = 0;
    for k in (0..inc.len()).filter(|&k| inc[k] == increment as f64) {
        let at = |n: &[f64; 2]| (n[0] - x[k]).abs() + (n[1] - y[k]).abs() < 1e-6;
        let node = nodes.iter().position(at).expect("a node there");
        let u = driver.displacement(node);
        let (dx, dy) = (x_now[k] - x[k], y_now[k] - y[k]);
        off = off.max((u[0] - dx).abs()).max((u[1] - dy).abs());
        size = size.max(dx.abs()).max(dy.abs());
        seen += 1;
    }
    assert!(seen > 10, "no table of increment {increment}");
    off / size
}

/// What a run is off by, at most in any increment.
#[derive(Debug, Default)]
struct Off {
    /// Loads and largest plastic strain, in parts.
    load: f64,
    plastic_strain: f64,
    /// Nodes, over the largest displacement, and contact forces, over the largest.
    nodes: f64,
    forces: f64,
    /// Contact points with another status.
    statuses: usize,
    /// Most Newton iterations in an increment.
    iterations: usize,
}

impl Off {
    fn check(&self, what: &str) {
        println!("{what}: {self:?}");
        assert!(
            self.load < 1e-9 && self.plastic_strain < 1e-9,
            "{what}: {self:?}"
        );
        assert!(self.nodes < 1e-9 && self.forces < 1e-8, "{what}: {self:?}");
        assert!(self.statuses == 0, "{what}: {self:?}");
    }
}

fn in_parts(value: f64, reference: f64) -> f64 {
    (value / reference - 1.0).abs()
}

fn plastic_strain(driver: &Driver<2>) -> f64 {
    let all = driver.points();
    all.iter().map(|p| p.plastic_strain).fold(0.0, f64::max)
}

/// Increments of a table.
fn increments(table: &Reference) -> Vec<usize> {
    let mut all: Vec<usize> = table.column("inc").iter().map(|&k| k as usize).collect();
    all.dedup();
    all
}

/// Compares contact points: forces over the largest, and statuses.
fn compare_contacts(driver: &Driver<2>, table: &Reference, increment: usize, off: &mut Off) {
    let hypothesis_is_axisymmetric = table.words("status").contains(&"none");
    let [inc, x, y, n, t] = ["inc", "X", "Y", "t_n", "t_t"].map(|c| table.column(c));
    let status = table.words("status");
    let rows = || (0..inc.len()).filter(|&k| inc[k] == increment as f64);
    let largest = rows().map(|k| n[k]).fold(0.0, f64::max);
    for k in rows() {
        let near = |c: &&moreau::driver::ContactRecord<2>| {
            (c.position[0] - x[k]).abs() + (c.position[1] - y[k]).abs() < 1e-6
        };
        let point = driver
            .contacts()
            .iter()
            .find(near)
            .expect("a contact point there");
        // The tangent of a platen that looks down points to the left.
        let difference = (point.t[0] - n[k]).abs().max((point.force[0] - t[k]).abs());
        if difference / largest > 1e-8 {
            println!(
                "inc {increment} {} {} : {:?} {:?} ref {} {} {}",
                x[k], y[k], point.t, point.status, n[k], t[k], status[k]
            );
        }
        off.forces = off.forces.max(difference / largest);
        let same = match status[k] {
            // The node on the axis bears nothing: its status is rounding.
            _ if (x[k] == 0.0 && hypothesis_is_axisymmetric) => true,
            "open" => point.status == Status::Open,
            "stick" => point.status == Status::Stick,
            "slip" => point.status == Status::Slip,
            "closed" | "symmetry" => point.status != Status::Open,
            other => panic!("{other}"),
        };
        off.statuses += usize::from(!same);
    }
}

fn squeezed<H: Analysis<2>>(
    billet: Billet<'_>,
    hypothesis: H,
    (hardening, friction): (f64, f64),
    (travel, count): (f64, usize),
    name: &str,
) -> Fallible<Off> {
    let mut driver = billet.driver(hypothesis, hardening, Some(friction))?;
    let history = Reference::read(&format!("{name}_history"))?;
    let boundary = Reference::read(&format!("{name}_boundary"))?;
    let contact = Reference::read(&format!("{name}_contact"))?;
    let (force, p) = (history.column("tool0_Fy"), history.column("p_max"));
    let mut off = Off::default();
    driver.run(&billet.squeezed(travel), count, |driver, report| {
        let k = report.increment - 1;
        if k >= count {
            return;
        }
        let load = driver.tool_force("platen").expect("a tool")[1];
        off.load = off.load.max(in_parts(load, force[k]));
        off.plastic_strain = off
            .plastic_strain
            .max(in_parts(plastic_strain(driver), p[k]));
        off.iterations = off.iterations.max(report.newton_iterations);
        println!(
            "{k} {load} {} it {} short {} cuts {} {:?}",
            force[k],
            report.newton_iterations,
            report.shortened_steps,
            report.cuts,
            report.residuals
        );
        if increments(&boundary).contains(&report.increment) {
            off.nodes = off.nodes.max(distance(driver, &boundary, report.increment));
        }
        if increments(&contact).contains(&report.increment) {
            compare_contacts(driver, &contact, report.increment, &mut off);
        }
    })?;
    Ok(off)
}

const QUAD8: (CellKind, Integration) = (CellKind::Quad8, Integration::Reduced);
const QUAD4: (CellKind, Integration) = (CellKind::Quad4, Integration::BBar);

#[test]
fn a_block_is_upset_by_a_platen() -> Fallible {
    for (kind, tag) in [(QUAD8, "Q8"), (QUAD4, "Q4md")] {
        for (hardening, mu) in [
            (500.0, 0.0),
            (500.0, 0.1),
            (500.0, 0.3),
            (500.0, 1.0),
            (0.0, 0.0),
            (0.0, 0.1),
            (0.0, 0.3),
            (0.0, 1.0),
        ] {
            let name = format!("F2_{tag}_8x8_mu{mu}_H{hardening}");
            if Reference::read(&format!("{name}_history")).is_err() {
                continue;
            }
            let billet = Billet {
                x: [0.0, 10.0],
                height: 10.0,
                cells: [8, 8],
                kind,
                touching: &["top", "right"],
            };
            println!("== {name}");
            match squeezed(
                billet,
                PlaneStrain::default(),
                (hardening, mu),
                (4.0, 40),
                &name,
            ) {
                Ok(off) => println!("{name} {off:?}"),
                Err(e) => println!("{name} {e}"),
            }
        }
    }
    Ok(())
}

#[test]
fn a_cylinder_is_upset() -> Fallible {
    for mu in [0.0, 0.1, 0.3] {
        let billet = Billet {
            x: [0.0, 10.0],
            height: 15.0,
            cells: [8, 12],
            kind: QUAD8,
            touching: &["top", "right"],
        };
        let name = format!("F3cyl_Q8_8x12_mu{mu}");
        println!("== {name}");
        match squeezed(billet, Axisymmetric, (500.0, mu), (7.5, 50), &name) {
            Ok(off) => println!("{name} {off:?}"),
            Err(e) => println!("{name} {e}"),
        }
    }
    Ok(())
}

#[test]
fn a_ring_is_squeezed() -> Fallible {
    for (kind, tag) in [(QUAD8, "Q8"), (QUAD4, "Q4md")] {
        for mu in [0.0, 0.05, 0.1, 0.2, 0.4] {
            let billet = Billet {
                x: [4.5, 9.0],
                height: 3.0,
                cells: [12, 8],
                kind,
                touching: &["top", "left", "right"],
            };
            let name = format!("F3ring_{tag}_12x8_mu{mu}_H500");
            if Reference::read(&format!("{name}_history")).is_err() {
                continue;
            }
            println!("== {name}");
            match squeezed(billet, Axisymmetric, (500.0, mu), (1.5, 50), &name) {
                Ok(off) => println!("{name} {off:?}"),
                Err(e) => println!("{name} {e}"),
            }
        }
    }
    Ok(())
}

fn bonded<H: Analysis<2>>(hypothesis: H, name: &str) -> Fallible {
    let billet = Billet {
        x: [0.0, 10.0],
        height: 10.0,
        cells: [8, 8],
        kind: (CellKind::Quad8, Integration::Reduced),
        touching: &[],
    };
    let mut driver = billet.driver(hypothesis, 500.0, None)?;
    let step = Step::new("upset")
        .fix("block.left", &[Axis::X])
        .fix("block.bottom", &[Axis::Y])
        .fix("block.top", &[Axis::X])
        .displace("block.top", Axis::Y, -2.0);
    let history = Reference::read(&format!("{name}_history"))?;
    let boundary = Reference::read(&format!("{name}_boundary"))?;
    let (force, p) = (history.column("driven_force"), history.column("p_max"));
    let mut worst = (0.0f64, 0.0f64);
    driver.run(&step, 20, |driver, report| {
        let k = report.increment - 1;
        let load = driver.reaction("block.top").expect("a group")[1];
        worst.0 = worst.0.max((load / force[k] - 1.0).abs());
        let found = driver
            .points()
            .iter()
            .map(|p| p.plastic_strain)
            .fold(0.0, f64::max);
        worst.1 = worst.1.max((found / p[k] - 1.0).abs());
        println!(
            "{k} {load} {} {} {:?} {:?}",
            force[k], report.newton_iterations, report.shortened_steps, report.residuals
        );
    })?;
    println!("{worst:?} {}", distance(&driver, &boundary, 20));
    assert!(worst.0 < 1e-9 && worst.1 < 1e-9 && distance(&driver, &boundary, 20) < 1e-9);
    Ok(())
}

#[test]
fn a_block_is_upset_between_platens_that_hold_it() -> Fallible {
    bonded(PlaneStrain::default(), "F2bond_Q8_8x8_H500")?;
    bonded(Axisymmetric, "F2bondax_Q8_8x8_H500")
}

#[test]
fn explore() -> Fallible {
    let billet = Billet {
        x: [0.0, 10.0],
        height: 10.0,
        cells: [8, 8],
        kind: QUAD8,
        touching: &["top", "right"],
    };
    let mut driver = billet.driver(PlaneStrain::default(), 0.0, Some(0.0))?;
    let mut ramp = driver.begin(&billet.squeezed(4.0), 40)?;
    for _ in 0..6 {
        let report = driver.proceed(&mut ramp, &mut |i| {
            let s: String = i
                .status
                .iter()
                .map(|s| match s {
                    Status::Open => 'o',
                    Status::Stick => '=',
                    Status::Slip => 's',
                    _ => '?',
                })
                .collect();
            println!(
                "{} {} it {} ci {} res {:.3e} scale {:.3e} {s}",
                i.increment, i.cuts, i.newton, i.contact_iterations, i.out_of_balance, i.scale
            );
        })?;
        println!("{:?}", report.shortened_steps);
    }
    Ok(())
}
