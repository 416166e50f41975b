//! How far a run is from the tables of an independent implementation; not the run.

use crate::problems::Fallible;
use crate::workspace;
use moreau::driver::{ContactRecord, Driver, IncrementReport};
use moreau::laws::Status;

/// A table of `tests/reference/finite`: a header, and rows of numbers and words.
struct Reference {
    header: Vec<String>,
    /// Column by column.
    words: Vec<Vec<String>>,
    numbers: Vec<Vec<f64>>,
}

impl Reference {
    /// The table of that name.
    fn read(name: &str) -> Fallible<Self> {
        let path = workspace::root().join(format!("tests/reference/finite/{name}.csv"));
        let text =
            std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let mut lines = text.lines();
        let header: Vec<String> = lines
            .next()
            .unwrap_or_default()
            .split(',')
            .map(str::to_owned)
            .collect();
        let mut words = vec![Vec::new(); header.len()];
        for line in lines {
            let cells = words.iter_mut().zip(line.split(','));
            cells.for_each(|(column, word)| column.push(word.to_owned()));
        }
        let number = |word: &String| word.parse().unwrap_or(f64::NAN);
        let numbers = words.iter().map(|c| c.iter().map(number).collect());
        Ok(Self {
            numbers: numbers.collect(),
            header,
            words,
        })
    }

    fn index(&self, column: &str) -> Option<usize> {
        self.header.iter().position(|name| name == column)
    }

    /// A column of numbers, NaN where it has none; empty if there is none of that name.
    fn column(&self, column: &str) -> &[f64] {
        self.index(column).map_or(&[], |i| &self.numbers[i])
    }

    /// A column of words.
    fn words(&self, column: &str) -> &[String] {
        self.index(column).map_or(&[], |i| &self.words[i])
    }
}

/// What a run is off by, at most in any increment.
#[derive(Debug, Clone, Default)]
pub struct Difference {
    /// The load, in parts.
    pub load: f64,
    /// The largest plastic strain, in parts.
    pub plastic_strain: f64,
    /// Positions, over the largest displacement.
    pub position: f64,
    /// Forces at contact points, over the largest.
    pub force: f64,
    /// Contact points of another status.
    pub statuses: usize,
    /// Newton iterations of an increment in which no status changed.
    pub iterations: usize,
}

/// The tables of a case, in `tests/reference/finite`.
pub struct Tables {
    history: Reference,
    boundary: Reference,
    contact: Option<Reference>,
}

impl Tables {
    /// Those of that name.
    ///
    /// # Errors
    /// Without a history and positions.
    pub fn read(name: &str) -> Fallible<Self> {
        let table = |what: &str| Reference::read(&format!("{name}_{what}"));
        Ok(Self {
            history: table("history")?,
            boundary: table("boundary")?,
            contact: table("contact").ok(),
        })
    }
}

fn in_parts(value: f64, reference: f64) -> f64 {
    (value / reference - 1.0).abs()
}

/// Rows of an increment in a table.
fn rows(table: &Reference, increment: usize) -> Vec<usize> {
    let all = table.column("inc");
    let of = |&k: &usize| all[k] == increment as f64;
    (0..all.len()).filter(of).collect()
}

fn is_at(x: &[f64; 2], table: &Reference, row: usize) -> bool {
    let [a, b] = ["X", "Y"].map(|c| table.column(c)[row]);
    (x[0] - a).abs() + (x[1] - b).abs() < 1e-6
}

impl Difference {
    /// Compares an increment: its load with a column of the history, positions, and forces and statuses of the
    /// contact points, where there is a table of them.
    ///
    /// # Panics
    /// Where the tables have not what is compared.
    pub fn compare(
        &mut self,
        (driver, report): (&Driver<2>, &IncrementReport),
        (load, column): (f64, &str),
        tables: &Tables,
    ) {
        let k = report.increment;
        let Some(&row) = rows(&tables.history, k).first() else {
            panic!("increment {k} is not one of the reference");
        };
        let expected = |column: &str| tables.history.column(column)[row];
        self.load = self.load.max(in_parts(load, expected(column)));
        let points = driver.points();
        let p = points.iter().map(|p| p.plastic_strain).fold(0.0, f64::max);
        if p > 0.0 || expected("p_max") > 0.0 {
            self.plastic_strain = self.plastic_strain.max(in_parts(p, expected("p_max")));
        }
        self.positions(driver, &tables.boundary, k);
        if let Some(contact) = &tables.contact {
            self.contacts(driver, contact, k);
        }
        // A contact problem whose statuses are right takes one iteration.
        if report.contact_iterations <= report.newton_iterations && k > 1 {
            self.iterations = self.iterations.max(report.newton_iterations);
        }
    }

    fn positions(&mut self, driver: &Driver<2>, table: &Reference, increment: usize) {
        let [x, y, x_now, y_now] = ["X", "Y", "x", "y"].map(|c| table.column(c));
        let (mut off, mut size) = (0.0f64, f64::MIN_POSITIVE);
        for k in rows(table, increment) {
            let mut nodes = driver.mesh().nodes().iter();
            let node = nodes
                .position(|n| is_at(n, table, k))
                .expect("a node there");
            let u = driver.displacement(node);
            let (dx, dy) = (x_now[k] - x[k], y_now[k] - y[k]);
            off = off.max((u[0] - dx).abs()).max((u[1] - dy).abs());
            size = size.max(dx.abs()).max(dy.abs());
        }
        self.position = self.position.max(off / size);
    }

    fn contacts(&mut self, driver: &Driver<2>, table: &Reference, increment: usize) {
        let [x, n, t] = ["X", "t_n", "t_t"].map(|c| table.column(c));
        let status = table.words("status");
        let of_now = rows(table, increment);
        let largest = of_now.iter().map(|&k| n[k]).fold(0.0, f64::max);
        for k in of_now {
            let at = |c: &&ContactRecord<2>| is_at(&c.position, table, k);
            let point = driver.contacts().iter().find(at).expect("a point there");
            // The reference takes the tangent the other way round.
            let along = (-point.t[1] - t[k]).abs();
            let difference = (point.t[0] - n[k]).abs().max(along);
            self.force = self.force.max(difference / largest);
            let same = match status[k].as_str() {
                "open" => point.status == Status::Open,
                "stick" => point.status == Status::Stick,
                "slip" => point.status == Status::Slip,
                _ => point.status != Status::Open,
            };
            // The node on the axis of a cylinder bears nothing: rounding decides.
            let decided = !(x[k] == 0.0 && n[k] <= 1e-2 * largest);
            self.statuses += usize::from(decided && !same);
        }
    }
}
