//! A plate between a die and a punch, contact wherever they may touch, beside the same plate moved
//! without contact: what an iteration, a run and their memory cost.

use std::error::Error;
use std::time::Instant;

use moreau::contact::{Ball, Obstacle, Plane};
use moreau::driver::{Axis, Driver, Model, Settings, Step, StepReport};
use moreau::laws::{Coulomb, Elastic, VonMises};
use moreau::mesh::{CellKind, Integration, Mesh, Solid, block3, uniform};
use nalgebra::SVector;
use serde::Serialize;

use super::{forget_peak, memory};

/// A quarter of the plate: half its side and its thickness \[mm\].
const SIDE: f64 = 50.0;
const THICKNESS: f64 = 4.0;

/// How far the punch goes down \[mm\].
const TRAVEL: f64 = 0.02;

/// Radius of the round punch \[mm\].
const RADIUS: f64 = 200.0;

/// Half the side of the flat one \[mm\].
const HALF: f64 = 25.0;

/// What presses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Punch {
    /// On a quarter of the top
    Flat,
    /// A sphere of 200 mm
    Sphere,
}

/// What is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Law {
    /// Of steel
    Elastic,
    /// Yields at 300 MPa
    VonMises,
}

/// A flat punch with vertical sides, the quarter of it that is there.
struct Stamp;

impl Obstacle<3> for Stamp {
    fn distance(&self, x: &SVector<f64, 3>) -> f64 {
        let out = self.out(x);
        if out.norm() > 0.0 {
            out.norm()
        } else {
            THICKNESS - x[1]
        }
    }

    fn normal(&self, x: &SVector<f64, 3>) -> SVector<f64, 3> {
        let out = self.out(x);
        if out.norm() > 0.0 {
            out.normalize()
        } else {
            -SVector::y()
        }
    }
}

impl Stamp {
    /// How far beside it a point is.
    fn out(&self, x: &SVector<f64, 3>) -> SVector<f64, 3> {
        let beyond = |x: f64| (x - HALF - 1e-3).max(0.0);
        SVector::from([beyond(x[0]), 0.0, beyond(x[2])])
    }
}

/// One of the runs.
#[derive(Debug, Clone, Copy)]
struct Case {
    cells: usize,
    punch: Punch,
    friction: f64,
    law: Law,
    increments: usize,
}

/// What one run took; times in seconds.
#[derive(Debug, Clone, Serialize)]
struct Figures {
    unknowns: usize,
    contacts: usize,
    newton: usize,
    contact: usize,
    factorisations: usize,
    /// Solves with a factor for the contact problem.
    solves: usize,
    seconds: f64,
    /// Of a Newton iteration, without the ordering.
    iteration: f64,
    peak_memory: Option<f64>,
    cuts: usize,
    load: f64,
}

fn mesh(n: usize) -> Result<Mesh<3>, Box<dyn Error>> {
    let (side, height) = (uniform(0.0, SIDE, n), uniform(0.0, THICKNESS, 2));
    let mut mesh = block3("plate", CellKind::Hex20, &side, &height, &side)?;
    mesh.node_group_where("pressed", "plate.top", |x| x[0] <= HALF && x[2] <= HALF)?;
    Ok(mesh)
}

impl Case {
    fn model(&self, touches: bool) -> Result<Model<3, Solid>, Box<dyn Error>> {
        let model = Model::new(mesh(self.cells)?, Solid);
        let model = match self.law {
            Law::Elastic => {
                model.material("plate", Elastic::new(210e3, 0.3)?, Integration::Reduced)?
            }
            Law::VonMises => model.material(
                "plate",
                VonMises::new(210e3, 0.3, 300.0)?,
                Integration::Reduced,
            )?,
        };
        if !touches {
            return Ok(model);
        }
        let friction = Coulomb::new(self.friction)?;
        let model = model.tool("die", Plane::new([0.0; 3], [0.0, 1.0, 0.0])?)?;
        let model = match self.punch {
            Punch::Flat => model.tool("punch", Stamp)?,
            Punch::Sphere => {
                model.tool("punch", Ball::new([0.0, THICKNESS + RADIUS, 0.0], RADIUS)?)?
            }
        };
        Ok(model.contact("plate.bottom", "die", friction)?.contact(
            "plate.top",
            "punch",
            friction,
        )?)
    }

    fn step(&self, touches: bool) -> Step<3> {
        let step = Step::new("press")
            .fix("plate.left", &[Axis::X])
            .fix("plate.back", &[Axis::Z]);
        let travel = TRAVEL * self.increments as f64 / 4.0;
        match touches {
            true => step.tool("punch", [0.0, -travel, 0.0]),
            false => step
                .fix("plate.bottom", &[Axis::Y])
                .displace("pressed", Axis::Y, -travel),
        }
    }

    fn measure(&self, touches: bool) -> Result<Figures, Box<dyn Error>> {
        forget_peak();
        let before = memory("VmRSS:");
        let clock = Instant::now();
        let mut driver = Driver::new(self.model(touches)?, Settings::default())?;
        let reports = driver.run(&self.step(touches), self.increments, |_, _| {})?;
        let seconds = clock.elapsed().as_secs_f64();
        let sum = |f: fn(&StepReport) -> usize| reports.iter().map(f).sum::<usize>();
        let newton = sum(|r| r.newton_iterations);
        let timings = driver.timings();
        Ok(Figures {
            unknowns: driver.unknowns(),
            contacts: driver.contacts().len(),
            newton,
            contact: sum(|r| r.contact_iterations),
            factorisations: sum(|r| r.factorisations),
            solves: sum(|r| r.linear_iterations),
            seconds,
            iteration: (seconds - timings.ordering.as_secs_f64()) / newton.max(1) as f64,
            peak_memory: memory("VmHWM:")
                .zip(before)
                .map(|(peak, before)| peak - before),
            cuts: sum(|r| r.cuts),
            load: match touches {
                true => driver.tool_force("punch")?[1],
                false => driver.reaction("pressed")?[1],
            },
        })
    }
}

/// What to run.
pub(super) struct Family<'a> {
    pub(super) sizes: &'a [usize],
    pub(super) punches: &'a [Punch],
    pub(super) frictions: &'a [f64],
    pub(super) laws: &'a [Law],
    pub(super) increments: &'a [usize],
}

/// Prints a line a case; false if one did not converge.
pub(super) fn run(family: &Family<'_>) -> Result<bool, Box<dyn Error>> {
    println!(
        "{:>3} {:>6} {:>5} {:>9} {:>4} {:>8} {:>8} │ {:>6} {:>7} {:>6} {:>6} {:>4} {:>8} │ {:>6} {:>6} {:>8} │ \
         {:>9} {:>6} {:>6} {:>12}",
        "n",
        "punch",
        "μ",
        "law",
        "inc.",
        "unknowns",
        "contacts",
        "Newton",
        "contact",
        "fact.",
        "solves",
        "cuts",
        "time s",
        "Newton",
        "fact.",
        "time s",
        "iteration",
        "run",
        "memory",
        "load N"
    );
    let mut all = true;
    for &cells in family.sizes {
        for &law in family.laws {
            for &increments in family.increments {
                // The plate without contact is the same for all that follow.
                let mut free = None;
                for &punch in family.punches {
                    for &friction in family.frictions {
                        let case = Case {
                            cells,
                            punch,
                            friction,
                            law,
                            increments,
                        };
                        let free = match &free {
                            Some(free) => free,
                            None => free.insert(case.measure(false)?),
                        };
                        all &= case.line(free);
                    }
                }
            }
        }
    }
    Ok(all)
}

impl Case {
    /// Prints what the case takes beside the same plate moved without contact.
    fn line(&self, free: &Figures) -> bool {
        let name = format!(
            "{:>3} {:>6} {:>5} {:>9} {:>4}",
            self.cells,
            format!("{:?}", self.punch).to_lowercase(),
            self.friction,
            match self.law {
                Law::Elastic => "elastic",
                Law::VonMises => "von Mises",
            },
            self.increments
        );
        let own = match self.measure(true) {
            Ok(own) => own,
            Err(error) => {
                println!("{name} {error}");
                return false;
            }
        };
        let memory = own
            .peak_memory
            .zip(free.peak_memory)
            .map(|(own, free)| own / free);
        println!(
            "{name} {:>8} {:>8} │ {:>6} {:>7} {:>6} {:>6} {:>4} {:>8.3} │ {:>6} {:>6} {:>8.3} │ \
             {:>9.2} {:>6.2} {:>6} {:>12.4}",
            own.unknowns,
            own.contacts,
            own.newton,
            own.contact,
            own.factorisations,
            own.solves,
            own.cuts,
            own.seconds,
            free.newton,
            free.factorisations,
            free.seconds,
            own.iteration / free.iteration,
            own.seconds / free.seconds,
            memory.map_or("–".into(), |m| format!("{m:.2}")),
            own.load
        );
        true
    }
}
