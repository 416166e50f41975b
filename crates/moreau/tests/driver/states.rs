//! States that laws bring along: where bodies start from, and fields of their own; not the laws.

use moreau_driver::{Axis, Driver, Model, ModelError, Settings, Step};
use moreau_laws::{Elastic, LawError, VonMises, VonMisesState};
use moreau_mandel::Sym2;
use moreau_mesh::{Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, block2, uniform};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn column(cells: usize) -> Fallible<Mesh<2>> {
    let (x, y) = (uniform(0.0, 4.0, 2), uniform(0.0, 10.0, cells));
    Ok(block2("column", CellKind::Quad8, &x, &y)?)
}

fn steel() -> Result<VonMises, LawError> {
    VonMises::new(210e3, 0.3, 300.0)?.with_kinematic(10e3)
}

/// The stress of a column under its own weight γ and a pressure on its top, with a horizontal stress
/// that no load explains but the walls.
fn geostatic(y: f64) -> Sym2 {
    let vertical = -20.0 - 3.0 * (10.0 - y);
    Sym2::from([0.5 * vertical, vertical, 0.4 * vertical, 0.0, 0.0, 0.0])
}

/// A column that starts under the stress of its weight does not move when its weight is applied; one
/// that starts without does.
#[test]
fn a_stress_that_loads_balance_moves_nothing() -> Fallible<()> {
    let law = steel()?;
    let state = |x: &[f64; 2]| VonMisesState {
        elastic_strain: law.elastic().strain(&geostatic(x[1])),
        ..VonMisesState::default()
    };
    let virgin = |_: &[f64; 2]| VonMisesState::default();
    let settled = |stressed: bool| -> Fallible<(Driver<2>, f64)> {
        let model = Model::new(column(4)?, PlaneStrain::default());
        let model = match stressed {
            true => model.material_from("column", law.clone(), Integration::Reduced, state)?,
            false => model.material_from("column", law.clone(), Integration::Reduced, virgin)?,
        };
        let mut driver = Driver::new(model, Settings::default())?;
        let weight = Step::new("weight")
            .fix("column.bottom", &[Axis::Y])
            .fix("column.left", &[Axis::X])
            .fix("column.right", &[Axis::X])
            .pressure("column.top", 20.0)
            .body_force("column", [0.0, -3.0]);
        driver.run(&weight, 3, |_, _| {})?;
        let moved = (0..driver.mesh().nodes().len()).map(|n| driver.displacement(n).norm());
        let moved = moved.fold(0.0, f64::max);
        Ok((driver, moved))
    };
    let (driver, moved) = settled(true)?;
    assert!(moved < 1e-15, "moved by {moved:e}");
    for p in driver.points() {
        assert!(
            (p.stress - geostatic(p.position[1])).norm() < 1e-10,
            "{p:?}"
        );
    }
    // The floor carries the pressure and the weight: 4 mm · (20 + 3 · 10) N/mm².
    let floor = driver.reaction("column.bottom")?[1];
    assert!((floor - 200.0).abs() < 1e-10, "{floor}");
    assert!(settled(false)?.1 > 1e-4);
    Ok(())
}

/// A stress at the start has its energy and its forces before anything is applied: a column under
/// tension that is let go shortens by what the tension had stretched it.
#[test]
fn a_stress_that_nothing_balances_is_released() -> Fallible<()> {
    let law = Elastic::new(1000.0, 0.0)?;
    let tension = Sym2::from([0.0, 5.0, 0.0, 0.0, 0.0, 0.0]);
    let stretched = law.strain(&tension);
    let model = Model::new(column(3)?, PlaneStrain::default());
    let model = model.material_from("column", law, Integration::Reduced, |_| stretched)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let stored = driver.energies().stored;
    assert!(
        (stored - 40.0 * 0.5 * 25.0 / 1000.0).abs() < 1e-12,
        "{stored}"
    );
    let release = Step::new("release")
        .fix("column.bottom", &[Axis::Y])
        .fix("column.left", &[Axis::X]);
    driver.run(&release, 4, |driver, _| {
        // What the stress stored comes back as work on the forces that held it.
        let energies = driver.energies();
        assert!((energies.taken() - energies.external_work).abs() < 1e-12);
    })?;
    let top = driver.mesh().node_group("column.top")?.to_vec();
    for node in top {
        let u = driver.displacement(node)[1];
        assert!((u + 0.05).abs() < 1e-12, "{u}");
    }
    assert!(driver.energies().stored < 1e-15);
    Ok(())
}

/// Fields of laws come in the order of the points; a law without a field has no number there.
#[test]
fn fields_of_laws_are_those_of_their_points() -> Fallible<()> {
    let upper = block2(
        "rubber",
        CellKind::Quad4,
        &uniform(0.0, 4.0, 2),
        &uniform(12.0, 14.0, 1),
    )?;
    let mesh = column(2)?.joined(upper)?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material("rubber", Elastic::new(1.0, 0.3)?, Integration::BBar)?
        .material("column", steel()?, Integration::Reduced)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let pull = Step::new("pull")
        .fix("column.bottom", &[Axis::X, Axis::Y])
        .fix("rubber", &[Axis::X, Axis::Y])
        .displace("column.top", Axis::Y, 0.05);
    driver.run(&pull, 1, |_, _| {})?;
    let (points, fields) = (driver.points(), driver.fields());
    assert_eq!(fields.len(), 1);
    let field = &fields[0];
    assert_eq!((field.name.as_str(), field.components), ("back_stress", 6));
    assert_eq!(field.values.len(), 6 * points.len());
    for (p, x) in points.iter().zip(field.values.chunks_exact(6)) {
        let x = Sym2::from_column_slice(x);
        if p.position[1] > 11.0 {
            assert!(x.iter().all(|c| c.is_nan()));
        } else {
            // X = ⅔ H eᵖ from a monotonic path: its size is that of p.
            assert!((1.5f64.sqrt() * x.norm() - 10e3 * p.plastic_strain).abs() < 0.01 * x.norm());
            assert!(p.plastic_strain > 1e-3);
        }
    }
    Ok(())
}

/// A stress outside of the yield surface is refused with the cell and how far it is outside; one on it is not.
#[test]
fn a_stress_that_the_law_does_not_bear_is_refused() -> Fallible<()> {
    let law = steel()?;
    let start = |tension: f64, p: f64| {
        let of = |x: &[f64; 2]| VonMisesState {
            elastic_strain: law.elastic().strain(&Sym2::from([
                tension * f64::from(u8::from(x[1] > 5.0)),
                0.0,
                0.0,
                0.0,
                0.0,
                0.0,
            ])),
            p,
            ..VonMisesState::default()
        };
        let model = Model::new(column(4)?, PlaneStrain::default());
        Ok::<_, Box<dyn std::error::Error>>(model.material_from(
            "column",
            law.clone(),
            Integration::Reduced,
            of,
        ))
    };
    match start(330.0, 0.0)? {
        Err(ModelError::Overstressed {
            cell,
            position,
            stress,
            borne,
        }) => {
            assert_eq!(cell, 4);
            assert!(position[1] > 5.0 && position[1] < 7.5);
            assert!((stress[0] - 330.0).abs() < 1e-9 && (stress[1] - 110.0).abs() < 1e-9);
            // It hardens on the way back.
            assert!((borne[0] - 303.0).abs() < 2.0 && (borne[1] - 110.0).abs() < 1e-9);
        }
        other => panic!("{:?}", other.err()),
    }
    assert!(start(300.0, 0.0)?.is_ok());
    for (tension, p) in [(f64::NAN, 0.0), (0.0, -1e-3), (0.0, f64::INFINITY)] {
        let refused = start(tension, p)?.err();
        assert!(
            matches!(refused, Some(ModelError::OutOfRange { .. })),
            "{refused:?}"
        );
    }
    Ok(())
}

/// A bar that starts under the tension of its walls stays as it is, whatever the increments, under small strains and large
/// ones; where a wall goes, its force has gone with the step.
#[test]
fn a_bar_between_walls_keeps_its_tension() -> Fallible<()> {
    let law = Elastic::new(1000.0, 0.3)?;
    let pulled = law.strain(&Sym2::from([0.0, 5.0, 0.0, 0.0, 0.0, 0.0]));
    for large in [false, true] {
        let model = match large {
            true => Model::with_large_strains(column(2)?, Axisymmetric),
            false => Model::new(column(2)?, Axisymmetric),
        };
        let model = model.material_from("column", law, Integration::Reduced, |_| pulled)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let area = std::f64::consts::PI * 16.0;
        let walls = Step::new("hold").fix("column.bottom", &[Axis::Y]);
        driver.run(&walls.clone().fix("column.top", &[Axis::Y]), 3, |_, _| {})?;
        let moved = driver
            .displacements()
            .iter()
            .fold(0.0f64, |m, u| m.max(u.abs()));
        assert!(moved < 1e-14, "{moved:e}");
        let wall = driver.reaction("column.top")?[1];
        assert!((wall - 5.0 * area).abs() < 1e-9, "{wall}");
        driver.run(&walls, 2, |_, _| {})?;
        let largest = driver
            .points()
            .iter()
            .map(|p| p.stress.norm())
            .fold(0.0, f64::max);
        assert!(largest < 1e-7, "{largest:e}");
        let top = driver.mesh().node_group("column.top")?[0];
        let expected = if large {
            10.0 * (-5e-3f64).exp_m1()
        } else {
            -0.05
        };
        assert!((driver.displacement(top)[1] - expected).abs() < 1e-10);
    }
    Ok(())
}
