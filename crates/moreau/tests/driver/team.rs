//! Cells on several processes, which here are threads: the same results as on one, and the same states.

use moreau_algebra::{
    Cost, ENGINE, Either, Engine, EngineError, Inertia, Parcel, Pattern, Share, SharedTeam, Team,
    TooLarge, Unpacked,
};
use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, Model, Numbers, Seam, Settings, Step};
use moreau_laws::{Coulomb, VonMises};
use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use nalgebra::DMatrix;
use std::collections::BTreeSet;
use std::io::Write;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

/// A process that is a thread.
#[derive(Debug, Clone)]
struct Thread(Arc<Links>);

#[derive(Debug)]
struct Links {
    rank: usize,
    to: Vec<Sender<Vec<u8>>>,
    from: Vec<Mutex<Receiver<Vec<u8>>>>,
}

/// All of a team.
fn threads(count: usize) -> Vec<SharedTeam> {
    let mut to: Vec<Vec<Sender<Vec<u8>>>> = vec![Vec::new(); count];
    let mut from: Vec<Vec<Mutex<Receiver<Vec<u8>>>>> = (0..count).map(|_| Vec::new()).collect();
    for sender in 0..count {
        for receiver in &mut from {
            let (send, receive) = channel();
            to[sender].push(send);
            receiver.push(Mutex::new(receive));
        }
    }
    let pairs = to.into_iter().zip(from).enumerate();
    let thread =
        |(rank, (to, from))| Arc::new(Thread(Arc::new(Links { rank, to, from }))) as SharedTeam;
    pairs.map(thread).collect()
}

const PLACES: usize = 1;
const VALUES: usize = 2;

impl Team for Thread {
    fn rank(&self) -> usize {
        self.0.rank
    }

    fn size(&self) -> usize {
        self.0.to.len()
    }

    fn send(&self, to: usize, bytes: &[u8]) {
        self.0.to[to].send(bytes.to_vec()).expect("a thread");
    }

    fn receive(&self, from: usize) -> Vec<u8> {
        let from = self.0.from[from].lock().expect("no panic");
        from.recv().unwrap_or_default()
    }

    fn engine(
        &self,
        pattern: &Pattern,
        memory: Option<u64>,
        _is_definite: bool,
    ) -> Result<Box<dyn Engine>, TooLarge> {
        let mut places: Vec<Vec<(u32, u32)>> = vec![
            (0..pattern.size())
                .flat_map(|j| pattern.range(j).map(move |k| (j as u32, pattern.rows()[k])))
                .collect(),
        ];
        self.order(Parcel::order(ENGINE).count(PLACES).bytes());
        for from in 1..self.size() {
            let told = Unpacked::new(&self.receive(from)).indices();
            places.push(told.chunks_exact(2).map(|at| (at[0], at[1])).collect());
        }
        let all: BTreeSet<(u32, u32)> = places.iter().flatten().copied().collect();
        let (mut start, mut rows) = (vec![0], Vec::new());
        for j in 0..pattern.size() as u32 {
            rows.extend(all.range((j, 0)..(j + 1, 0)).map(|&(_, i)| i));
            start.push(rows.len() as u32);
        }
        let whole = Pattern::new(start, rows).expect("sorted");
        let whole = whole.keeping(pattern.kept()).expect("so many");
        let slot = |&(j, i): &(u32, u32)| whole.slot(i, j).expect("there") as usize;
        let slots = places
            .iter()
            .map(|p| p.iter().map(slot).collect())
            .collect();
        let inner = Either::analyse(&whole, memory)?;
        Ok(Box::new(Gathering {
            team: self.clone(),
            slots,
            inner,
        }))
    }

    fn assist(&self, order: &[u8], share: Share<'_>) {
        let (_, mut order) = Unpacked::order(order);
        let pattern = share.pattern.expect("cells");
        if order.count() == PLACES {
            let of = |j: usize| pattern.range(j).map(move |k| (share.rows[j], k));
            let all = (0..share.rows.len()).flat_map(of);
            let all = all.flat_map(|(j, k)| [j, share.rows[pattern.rows()[k] as usize]]);
            let all: Vec<u32> = all.collect();
            self.send(0, Parcel::default().indices(&all).bytes());
        } else {
            self.send(0, Parcel::default().reals(share.values).bytes());
        }
    }
}

/// An engine of the first process that gathers all entries.
#[derive(Debug)]
struct Gathering {
    team: Thread,
    /// Where the entries of each process are.
    slots: Vec<Vec<usize>>,
    inner: Either,
}

impl Engine for Gathering {
    fn analyse(_: &Pattern, _: Option<u64>) -> Result<Self, TooLarge> {
        let (entries, room) = (0.0, 0.0);
        Err(TooLarge { entries, room })
    }
    fn size(&self) -> usize {
        self.inner.size()
    }
    fn kept(&self) -> usize {
        self.inner.kept()
    }
    fn cost(&self) -> Cost {
        self.inner.cost()
    }
    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError> {
        self.team.order(Parcel::order(ENGINE).count(VALUES).bytes());
        let mut parts = vec![values.to_vec()];
        for from in 1..self.team.size() {
            parts.push(Unpacked::new(&self.team.receive(from)).reals());
        }
        let last = self.slots.iter().flatten().max();
        let mut sum = vec![0.0; last.map_or(0, |last| last + 1)];
        for (slots, values) in self.slots.iter().zip(&parts) {
            assert_eq!(slots.len(), values.len());
            slots.iter().zip(values).for_each(|(&at, v)| sum[at] += v);
        }
        self.inner.factorise(&sum)
    }
    fn least_pivot(&self) -> f64 {
        self.inner.least_pivot()
    }
    fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.inner.solve(x)
    }
    fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.inner.condense(x)
    }
    fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError> {
        self.inner.expand(x)
    }
    fn schur(&self) -> Result<DMatrix<f64>, EngineError> {
        self.inner.schur()
    }
}

/// A block of two materials pressed by a tool and dragged, on a team or alone.
fn driver(team: Option<SharedTeam>, (seam, large, memory): (Seam, bool, Option<u64>)) -> Driver<2> {
    let (x, y) = (uniform(0.0, 8.0, 8), uniform(0.0, 4.0, 4));
    let mut mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
    let (soft, firm) = (0..mesh.cell_count()).partition(|c| c % 8 < 3);
    mesh.add_cell_group("soft", soft).expect("cells");
    mesh.add_cell_group("firm", firm).expect("cells");
    mesh.node_group_where("grip", "block.right", |x| x[1] > 0.1)
        .expect("nodes");
    let model = match large {
        true => Model::with_large_strains(mesh, PlaneStrain::default()),
        false => Model::new(mesh, PlaneStrain::default()),
    };
    let model = match team {
        Some(team) => model.on_team(team),
        None => model,
    };
    let law = |limit: f64| VonMises::new(210e3, 0.3, limit).and_then(|law| law.with_isotropic(2e3));
    let model = model
        .material("soft", law(200.0).expect("valid"), Integration::Reduced)
        .and_then(|m| m.material("firm", law(300.0).expect("valid"), Integration::Reduced))
        .and_then(|m| m.tool("punch", Plane::new([0.0, 4.0], [0.0, -1.0]).expect("valid")))
        .and_then(|m| m.contact("block.top", "punch", Coulomb::new(0.2).expect("valid")));
    let model = model.and_then(|m| m.expansion("firm", 1e-5));
    let settings = Settings {
        seam,
        memory,
        ..Settings::default()
    };
    Driver::new(model.expect("valid"), settings).expect("valid")
}

fn steps() -> [Step<2>; 2] {
    let held = |name: &str| Step::new(name).fix("block.bottom", &[Axis::X, Axis::Y]);
    [
        held("press").tool("punch", [0.0, -0.02]),
        held("drag")
            .pressure("block.left", 5.0)
            .temperature("firm", |x| 50.0 * x[0])
            .displace_along("grip", [0.6, 0.8], 0.002)
            .tool("punch", [0.02, -0.02]),
    ]
}

/// Forces of the tool and energies after each increment, stresses and fields after the last; numbers of the state; iterations of
/// conjugate gradients.
fn course(mut driver: Driver<2>) -> (Vec<f64>, Vec<f64>, usize) {
    let mut told = Vec::new();
    let mut iterations = 0;
    for step in steps() {
        let run = driver.run(&step, 2, |driver, report| {
            let force = driver.tool_force("punch").expect("a tool");
            told.extend(force.iter());
            told.extend([report.energies.stored, report.energies.plastic_dissipation]);
            iterations += report.linear_iterations;
        });
        run.expect("converges");
    }
    for point in driver.points() {
        told.extend(point.stress.iter().map(|s| s * 1e-2));
    }
    for field in driver.fields() {
        told.extend(field.values);
    }
    let mut state = Vec::new();
    driver.write(&mut state);
    // What one has written another reads, and goes on from.
    let mut numbers = Numbers::Read(&state);
    driver.read(&mut numbers).expect("its own");
    let mut again = Vec::new();
    driver.write(&mut again);
    assert_eq!(state, again);
    (told, state, iterations)
}

/// The same on a number of threads.
fn course_on(count: usize, of: (Seam, bool, Option<u64>)) -> (Vec<f64>, Vec<f64>, usize) {
    std::thread::scope(|scope| {
        let mut team = threads(count).into_iter();
        let first = team.next();
        for other in team {
            scope.spawn(move || driver(Some(other), of).serve());
        }
        let outcome = course(driver(first.clone(), of));
        first.expect("one").order(&[]);
        outcome
    })
}

#[test]
fn results_do_not_depend_on_the_number_of_processes() {
    for of in [
        (Seam::Condensed, false, None),
        (Seam::Tied, false, None),
        (Seam::Cheaper, true, None),
    ] {
        let (expected, _, steps) = course(driver(None, of));
        // None are of conjugate gradients; under large strains some are of pressures, whose stiffness is not symmetric.
        assert_eq!(steps > 0, of.1);
        let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        for count in [1, 2, 3, 5] {
            let (found, _, iterations) = course_on(count, of);
            assert_eq!(found.len(), expected.len());
            assert_eq!(iterations, steps);
            for (a, b) in expected.iter().zip(&found) {
                assert!(
                    (a - b).abs() < 1e-9 * size,
                    "{count} of {of:?}: {a} and {b}"
                );
            }
        }
    }
}

/// Where its factor has no room, the coarse space is that of all processes: sweeps in another order take about as many
/// iterations, and lead to the same.
#[test]
fn conjugate_gradients_are_those_of_all_processes() {
    let with_room = (Seam::Condensed, false, None);
    let (direct, ..) = course(driver(None, with_room));
    let mut own = driver(None, with_room);
    own.run(&steps()[0], 1, |_, _| {}).expect("converges");
    let short = 8 * own.factor_entries() as u64 - 8;
    let of = (Seam::Condensed, false, Some(short));
    let (.., alone) = course(driver(None, of));
    assert!(alone > 0, "the factor has room");
    let size = direct.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for count in [1, 2, 3, 5] {
        let (found, _, iterations) = course_on(count, of);
        for (a, b) in direct.iter().zip(&found) {
            assert!((a - b).abs() < 1e-8 * size, "{count}: {a} and {b}");
        }
        assert!(
            10 * iterations.abs_diff(alone) < 3 * alone,
            "{count}: {iterations} and {alone}"
        );
        let told = format!("{count} processes: {iterations} iterations, alone {alone}");
        let _ = writeln!(std::io::stderr(), "{told}");
    }
}
