//! Laws that answer for many points at once: the bits of those of points, and what comes of answers that are none.

use moreau_contact::Plane;
use moreau_driver::{
    Analysis, Axis, Driver, IncrementError, IncrementReport, LawFault, Model, ModelError, Settings,
    Step,
};
use moreau_laws::{
    BulkLaw, Coulomb, DruckerPrager, ElasticDruckerPrager, NoAnswer, Panel, PanelLaw, PointByPoint,
    VonMises,
};
use moreau_mandel::Sym2;
use moreau_mesh::{CellKind, Integration, Mesh, PlaneStrain, block2, uniform};
use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

const RULE: Integration = Integration::Reduced;

fn steel() -> VonMises {
    let steel = VonMises::new(210e3, 0.3, 300.0).and_then(|law| law.with_isotropic(2e3));
    steel.expect("valid")
}

fn mesh(cells: [usize; 2]) -> Mesh<2> {
    let (x, y) = (uniform(0.0, 50.0, cells[0]), uniform(0.0, 20.0, cells[1]));
    let mut mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
    mesh.node_group_where("punch", "block.top", |x| x[0] <= 25.0 + 1e-9)
        .expect("not empty");
    mesh
}

/// The block of the paper on its foundation.
fn on_foundation<H: Analysis<2>>(model: Model<2, H>) -> Driver<2> {
    let floor = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid");
    let model = model
        .tool("floor", floor)
        .and_then(|m| m.contact("block.bottom", "floor", Coulomb::new(0.3).expect("valid")));
    Driver::new(model.expect("valid"), Settings::default()).expect("valid")
}

fn empty(cells: [usize; 2]) -> Model<2, PlaneStrain> {
    Model::new(mesh(cells), PlaneStrain::default())
}

fn points<L: BulkLaw>(cells: [usize; 2], law: L) -> Driver<2> {
    on_foundation(empty(cells).material("block", law, RULE).expect("valid"))
}

fn panels(cells: [usize; 2], law: impl PanelLaw + 'static) -> Driver<2> {
    let law: Arc<dyn PanelLaw> = Arc::new(law);
    let model = empty(cells).panel_material("block", &law, RULE);
    on_foundation(model.expect("valid"))
}

fn press(depth: f64) -> Step<2> {
    Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -depth)
}

fn run(driver: &mut Driver<2>, depth: f64, increments: usize) -> Vec<IncrementReport> {
    let reports = driver.run(&press(depth), increments, |_, _| {});
    reports.expect("converges")
}

fn bits(driver: &Driver<2>) -> Vec<u64> {
    let of = |x: &f64| x.to_bits();
    let mut all: Vec<u64> = driver.displacements().iter().map(of).collect();
    let stresses = driver.points();
    all.extend(stresses.iter().flat_map(|p| p.stress.iter().map(of)));
    all
}

#[test]
fn a_law_of_panels_has_the_bits_of_that_of_points() {
    // More points than in one panel, and more cells than are worth a thread.
    for cells in [[10, 2], [60, 40]] {
        let (depth, increments) = if cells[0] > 10 { (0.05, 2) } else { (0.2, 8) };
        let mut own = points(cells, steel());
        let expected = run(&mut own, depth, increments);
        let threads = if cells[0] > 10 { vec![1, 3] } else { vec![1] };
        for threads in threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                let mut other = panels(cells, PointByPoint(steel()));
                let reports = run(&mut other, depth, increments);
                assert_eq!(bits(&other), bits(&own));
                for (a, b) in reports.iter().zip(&expected) {
                    assert_eq!(a.residuals, b.residuals);
                    assert_eq!(a.plastic_fraction, b.plastic_fraction);
                }
            });
        }
    }
}

/// Energies and p are read off stresses: those of a law without hardening, whose plastic work is all dissipated.
#[test]
fn what_is_stored_dissipated_and_plastic_is_that_of_the_law_of_points() {
    let perfect = || VonMises::new(210e3, 0.3, 300.0).expect("valid");
    let (mut own, mut other) = (
        points([10, 2], perfect()),
        panels([10, 2], PointByPoint(perfect())),
    );
    let expected = run(&mut own, 0.2, 8);
    let reports = run(&mut other, 0.2, 8);
    let near = |a: f64, b: f64, size: f64| assert!((a - b).abs() <= 1e-10 * size, "{a} {b}");
    for (a, b) in reports.iter().zip(&expected) {
        let size = b.energies.stored + b.energies.plastic_dissipation;
        near(a.energies.stored, b.energies.stored, size);
        near(
            a.energies.plastic_dissipation,
            b.energies.plastic_dissipation,
            size,
        );
    }
    for (a, b) in other.points().iter().zip(own.points()) {
        assert_eq!((a.cell, a.position), (b.cell, b.position));
        near(a.plastic_strain, b.plastic_strain, 1.0);
    }
}

#[test]
fn a_tangent_that_is_not_symmetric_serves_as_that_of_a_law_of_points() {
    let law = || {
        let plastic = DruckerPrager::mohr_coulomb(20.0, 25.0, 5.0).expect("valid");
        ElasticDruckerPrager::new(2e4, 0.3, plastic).expect("valid")
    };
    let (mut own, mut other) = (points([10, 2], law()), panels([10, 2], PointByPoint(law())));
    run(&mut own, 0.15, 5);
    let reports = run(&mut other, 0.15, 5);
    let fraction = reports[4].plastic_fraction;
    assert!(fraction > 0.1, "{fraction}");
    for (a, b) in other.displacements().iter().zip(own.displacements()) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
}

#[test]
fn a_state_is_written_and_read_back() {
    let mut driver = panels([10, 2], PointByPoint(steel()));
    run(&mut driver, 0.1, 4);
    let mut numbers = Vec::new();
    driver.write(&mut numbers);
    let mut other = panels([10, 2], PointByPoint(steel()));
    let read = other.read(&mut moreau_driver::Numbers::Read(&numbers));
    read.expect("of the same model");
    assert_eq!(bits(&other), bits(&driver));
    run(&mut driver, 0.2, 4);
    run(&mut other, 0.2, 4);
    assert_eq!(bits(&other), bits(&driver));
    let mut native = points([10, 2], steel());
    let refused = native.read(&mut moreau_driver::Numbers::Read(&numbers));
    assert!(
        matches!(refused, Err(ModelError::Saved { .. })),
        "{refused:?}"
    );
}

type Spoil = dyn Fn(usize, &mut Panel<'_>) -> Result<(), NoAnswer> + Send + Sync;

/// The law of steel with answers that are spoilt, by the number of the call.
struct Spoilt(AtomicUsize, Mutex<Box<Spoil>>);

impl Spoilt {
    fn new(
        spoil: impl Fn(usize, &mut Panel<'_>) -> Result<(), NoAnswer> + Send + Sync + 'static,
    ) -> Self {
        Self(AtomicUsize::new(0), Mutex::new(Box::new(spoil)))
    }
}

impl fmt::Debug for Spoilt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Spoilt")
    }
}

impl PanelLaw for Spoilt {
    fn initial(&self) -> Vec<f64> {
        PointByPoint(steel()).initial()
    }

    fn fields(&self) -> Vec<(String, usize)> {
        let sizes = [("elastic_strain", 6), ("plastic_strain", 6)];
        sizes.map(|(name, size)| (name.to_owned(), size)).to_vec()
    }

    fn respond(&self, mut panel: Panel<'_>) -> Result<(), NoAnswer> {
        PointByPoint(steel()).respond(Panel {
            d_eps: panel.d_eps,
            old: panel.old,
            stress: &mut *panel.stress,
            tangent: &mut *panel.tangent,
            new: &mut *panel.new,
        })?;
        let call = self.0.fetch_add(1, Ordering::Relaxed);
        self.1.lock().expect("one thread")(call, &mut panel)
    }
}

/// Wherever a law refuses, in whatever part of whatever increment: nothing has changed, the increment is not cut, and
/// the next call ends with the bits that there are without a refusal.
#[test]
fn an_increment_that_a_law_refuses_changes_nothing() {
    let mut undisturbed = panels([6, 2], PointByPoint(steel()));
    run(&mut undisturbed, 0.2, 3);
    let mut calls = 0;
    for refused in 1.. {
        let mut driver = panels(
            [6, 2],
            Spoilt::new(move |call, _| match call == refused {
                true => Err(NoAnswer("no more".into())),
                false => Ok(()),
            }),
        );
        let mut ramp = driver.begin(&press(0.2), 3).expect("valid");
        let mut refusals = 0;
        while !ramp.is_done() {
            let (before, committed) = (ramp.clone(), bits(&driver));
            match driver.proceed(&mut ramp, &mut |_| ControlFlow::Continue(())) {
                Ok(report) => assert_eq!(report.cuts, 0),
                Err(error) => {
                    let problem = "no more".into();
                    assert_eq!(error, IncrementError::Law(LawFault::NoAnswer { problem }));
                    assert!(error.is_broken_off() && error.to_string().contains("no more"));
                    assert_eq!((&ramp, bits(&driver)), (&before, committed));
                    refusals += 1;
                }
            }
        }
        assert_eq!(bits(&driver), bits(&undisturbed), "call {refused}");
        if refusals == 0 {
            break;
        }
        assert_eq!(refusals, 1, "call {refused}");
        calls = refused;
    }
    assert!(calls > 10, "{calls} calls");
}

/// A strain that a law does not reach is one to turn back from: the increment is cut until it is small enough.
#[test]
fn where_a_law_answers_no_number_the_increment_is_cut() {
    let mut driver = panels(
        [6, 2],
        Spoilt::new(|_, panel| {
            for (d_eps, stress) in panel.d_eps.iter().zip(&mut *panel.stress) {
                if d_eps.norm() > 4e-3 {
                    *stress = Sym2::repeat(f64::NAN);
                }
            }
            Ok(())
        }),
    );
    let reports = run(&mut driver, 0.2, 1);
    assert!(reports.len() > 1 && reports.iter().any(|r| r.cuts > 0));

    // Where it never is, the place is told.
    let mut driver = panels(
        [6, 2],
        Spoilt::new(|call, panel| {
            if call > 0 {
                panel.stress[13][2] = f64::INFINITY;
            }
            Ok(())
        }),
    );
    let before = bits(&driver);
    let stopped = driver.run(&press(0.2), 1, |_, _| {});
    let Err(IncrementError::Stopped { cause, .. }) = &stopped else {
        panic!("{stopped:?}");
    };
    let IncrementError::Law(LawFault::NotFinite { what, place }) = cause.as_ref() else {
        panic!("{cause}");
    };
    assert_eq!((*what, place.cell, place.point), ("stress", 3, 1));
    assert_eq!(place.position, driver.points()[13].position);
    assert_eq!(bits(&driver), before);
    assert!(stopped.is_err_and(|e| e.to_string().contains("at point 1 of cell 3")));
}

#[test]
fn an_answer_that_is_none_tells_its_place() {
    type Answer = fn(&mut Panel<'_>);
    let answers: [(Answer, &str); 3] = [
        (
            |panel| panel.tangent[5][(2, 4)] += 1e3,
            "off symmetry by 1.000e3 MPa at point 1 of cell 1",
        ),
        (
            |panel| panel.tangent[5][(2, 4)] = f64::NAN,
            "the tangent of the law of a material is no number",
        ),
        (
            |panel| panel.new[13 * 5 + 12] = f64::NAN,
            "the state of the law of a material is no number",
        ),
    ];
    for (answer, told) in answers {
        let law = Spoilt::new(move |call, panel| {
            if call > 0 {
                answer(panel);
            }
            Ok(())
        });
        let mut driver = panels([6, 2], law);
        let before = bits(&driver);
        let error = driver
            .run(&press(0.2), 1, |_, _| {})
            .expect_err("no answer");
        assert!(error.to_string().contains(told), "{error}");
        assert!(
            error.to_string().contains("at point 1 of cell 1, ["),
            "{error}"
        );
        assert_eq!(bits(&driver), before);
    }
}

#[test]
fn a_law_that_is_none_at_rest_makes_no_model() {
    let refused = |law: Spoilt| {
        let law: Arc<dyn PanelLaw> = Arc::new(law);
        empty([6, 2]).panel_material("block", &law, RULE).err()
    };
    let problem = "nothing".to_owned();
    let error = refused(Spoilt::new(|_, _| Err(NoAnswer("nothing".into()))));
    assert_eq!(error, Some(ModelError::Law(LawFault::NoAnswer { problem })));
    let error = refused(Spoilt::new(|_, panel| {
        panel.tangent[0][(3, 3)] = 0.0;
        Ok(())
    }));
    assert_eq!(error, Some(ModelError::Law(LawFault::NotElastic)));
    let error = refused(Spoilt::new(|_, panel| {
        panel.stress[0][1] = f64::NAN;
        Ok(())
    }));
    let Some(ModelError::Law(LawFault::NotFinite { place, .. })) = error else {
        panic!("{error:?}");
    };
    assert_eq!((place.cell, place.point), (0, 0));
}

#[test]
fn large_strains_are_refused() {
    let law: Arc<dyn PanelLaw> = Arc::new(PointByPoint(steel()));
    let model = Model::with_large_strains(mesh([6, 2]), PlaneStrain::default());
    let refused = model.panel_material("block", &law, RULE).err();
    let group = "block".into();
    assert_eq!(refused, Some(ModelError::SmallStrainsOnly { group }));
}

#[test]
fn the_numbers_of_a_state_that_have_names_are_fields() {
    let mut driver = panels([6, 2], Spoilt::new(|_, _| Ok(())));
    run(&mut driver, 0.2, 2);
    let fields = driver.fields();
    let named: Vec<_> = fields.iter().map(|f| (&*f.name, f.components)).collect();
    assert_eq!(named, [("elastic_strain", 6), ("plastic_strain", 6)]);
    let elastic = fields[0].values.chunks_exact(6);
    let stresses = driver.points();
    assert_eq!(elastic.len(), stresses.len());
    for (elastic, point) in elastic.zip(&stresses) {
        let stress = steel().elastic_tangent() * Sym2::from_column_slice(elastic);
        assert!((stress - point.stress).norm() < 1e-9);
    }
}
