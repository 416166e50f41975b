//! A plate between a die and a punch, contact wherever they may touch, beside the same plate moved
//! without contact: what an iteration, a run and their memory cost.

use std::error::Error;
use std::process::Command;
use std::time::Instant;

use moreau::contact::{Ball, Obstacle, Plane};
use moreau::driver::{Axis, ContactRecord, Driver, IncrementReport, Model, Seam, Settings, Step};
use moreau::laws::{Coulomb, Elastic, VonMises};
use moreau::mesh::{CellKind, Integration, Mesh, Solid, block3, uniform};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use super::{forget_peak, memory};

/// A quarter of the plate: half its side and its thickness \[mm\].
const SIDE: f64 = 50.0;
const THICKNESS: f64 = 4.0;

/// How far the punch goes down \[mm\].
const TRAVEL: f64 = 0.02;

/// Radius of the round punch \[mm\].
const RADIUS: f64 = 200.0;

/// Half the side of what it presses \[mm\].
const HALF: f64 = 25.0;

/// What presses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Punch {
    /// On a quarter of the top, its edge between two lines of nodes
    Flat,
    /// The same with its edge on a line of nodes: those that slide off and those that stick are both in balance,
    /// so that an increment has several solutions
    Edge,
    /// A sphere of 200 mm
    Sphere,
}

/// What is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Law {
    /// Of steel
    Elastic,
    /// Yields at 300 MPa
    VonMises,
}

/// A flat punch with vertical sides, the quarter of it that is there.
struct Stamp {
    /// Half its side \[mm\].
    half: f64,
}

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
    /// One that reaches so far beyond the last line of nodes under it \[mm\].
    fn reaching(beyond: f64) -> Self {
        Self {
            half: HALF + beyond,
        }
    }

    /// How far beside it a point is.
    fn out(&self, x: &SVector<f64, 3>) -> SVector<f64, 3> {
        let beyond = |x: f64| (x - self.half).max(0.0);
        SVector::from([beyond(x[0]), 0.0, beyond(x[2])])
    }
}

/// One of the runs.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Case {
    cells: usize,
    punch: Punch,
    friction: f64,
    law: Law,
    increments: usize,
    /// Not moved by prescribed displacements alone.
    touches: bool,
}

impl std::str::FromStr for Case {
    type Err = serde_json::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        serde_json::from_str(text)
    }
}

/// What one run took; times in seconds.
#[derive(Debug, Clone, Serialize, Deserialize)]
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
    fn model(&self) -> Result<Model<3, Solid>, Box<dyn Error>> {
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
        if !self.touches {
            return Ok(model);
        }
        let friction = Coulomb::new(self.friction)?;
        let model = model.tool("die", Plane::new([0.0; 3], [0.0, 1.0, 0.0])?)?;
        let model = match self.punch {
            // Nodes of hex20 are half a cell apart.
            Punch::Flat => model.tool("punch", Stamp::reaching(0.25 * SIDE / self.cells as f64))?,
            Punch::Edge => model.tool("punch", Stamp::reaching(1e-3))?,
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

    fn step(&self) -> Step<3> {
        let step = Step::new("press")
            .fix("plate.left", &[Axis::X])
            .fix("plate.back", &[Axis::Z]);
        let travel = TRAVEL * self.increments as f64 / 4.0;
        match self.touches {
            true => step.tool("punch", [0.0, -travel, 0.0]),
            false => step
                .fix("plate.bottom", &[Axis::Y])
                .displace("pressed", Axis::Y, -travel),
        }
    }

    /// The contacts of the whole run by a seam.
    fn contacts(&self, seam: Seam) -> Result<Vec<ContactRecord<3>>, Box<dyn Error>> {
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(self.model()?, settings)?;
        driver.run(&self.step(), self.increments, |_, _| {})?;
        Ok(driver.contacts().to_vec())
    }

    /// Largest difference of a contact force by both seams over the largest force, and how many of the
    /// statuses differ.
    fn difference(&self) -> Result<(f64, usize), Box<dyn Error>> {
        let (a, b) = (self.contacts(Seam::Condensed)?, self.contacts(Seam::Tied)?);
        let scale = a.iter().map(|c| c.t.norm()).fold(0.0, f64::max);
        let apart = a.iter().zip(&b).map(|(a, b)| (a.t - b.t).norm());
        let other = a.iter().zip(&b).filter(|(a, b)| a.status != b.status);
        Ok((apart.fold(0.0, f64::max) / scale, other.count()))
    }

    fn measure(&self) -> Result<Figures, Box<dyn Error>> {
        forget_peak();
        let before = memory("VmRSS:");
        let clock = Instant::now();
        let mut driver = Driver::new(self.model()?, Settings::default())?;
        let reports = driver.run(&self.step(), self.increments, |_, _| {})?;
        let seconds = clock.elapsed().as_secs_f64();
        let sum = |f: fn(&IncrementReport) -> usize| reports.iter().map(f).sum::<usize>();
        let newton = sum(|r| r.newton_iterations);
        let ordering = driver.timings().ordering.as_secs_f64();
        Ok(Figures {
            unknowns: driver.unknowns(),
            contacts: driver.contacts().len(),
            newton,
            contact: sum(|r| r.contact_iterations),
            factorisations: sum(|r| r.factorisations),
            solves: sum(|r| r.contact_solves),
            seconds,
            iteration: (seconds - ordering) / newton.max(1) as f64,
            peak_memory: memory("VmHWM:")
                .zip(before)
                .map(|(peak, before)| peak - before),
            cuts: sum(|r| r.cuts),
            load: match self.touches {
                true => driver.tool_force("punch")?[1],
                false => driver.reaction("pressed")?[1],
            },
        })
    }

    /// Measured in a process of its own: what a run leaves to the next is no memory of the next.
    fn measured_alone(&self) -> Result<Figures, Box<dyn Error>> {
        let case = serde_json::to_string(self)?;
        let output = Command::new(std::env::current_exe()?)
            .args(["bench", "--case", &case])
            .output()?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).trim().into());
        }
        Ok(serde_json::from_slice(&output.stdout)?)
    }
}

/// Measures one case and writes it as JSON.
pub(super) fn alone(case: &Case) -> Result<bool, Box<dyn Error>> {
    println!("{}", serde_json::to_string(&case.measure()?)?);
    Ok(true)
}

/// What to run.
pub(super) struct Family<'a> {
    pub(super) sizes: &'a [usize],
    pub(super) punches: &'a [Punch],
    pub(super) frictions: &'a [f64],
    pub(super) laws: &'a [Law],
    pub(super) increments: &'a [usize],
    /// Whether both seams are compared.
    pub(super) compare: bool,
}

/// Prints a line a case; false if one did not converge.
pub(super) fn run(family: &Family<'_>) -> Result<bool, Box<dyn Error>> {
    println!(
        "{:>3} {:>6} {:>4} {:>9} {:>4} {:>8} {:>8} │ {:>6} {:>7} {:>5} {:>6} {:>4} {:>8} │ {:>6} {:>5} {:>8} │ \
         {:>9} {:>5} {:>6} {:>13}",
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
                let case = Case {
                    cells,
                    punch: Punch::Flat,
                    friction: 0.0,
                    law,
                    increments,
                    touches: false,
                };
                // The plate without contact is the same for all that follow.
                let free = case.measured_alone()?;
                for &punch in family.punches {
                    for &friction in family.frictions {
                        let case = Case {
                            punch,
                            friction,
                            touches: true,
                            ..case
                        };
                        all &= case.line(&free, family.compare)?;
                    }
                }
            }
        }
    }
    Ok(all)
}

impl Case {
    /// Prints what the case takes beside the same plate moved without contact.
    fn line(&self, free: &Figures, compare: bool) -> Result<bool, Box<dyn Error>> {
        let name = format!(
            "{:>3} {:>6} {:>4} {:>9} {:>4}",
            self.cells,
            format!("{:?}", self.punch).to_lowercase(),
            self.friction,
            match self.law {
                Law::Elastic => "elastic",
                Law::VonMises => "von Mises",
            },
            self.increments
        );
        let own = match self.measured_alone() {
            Ok(own) => own,
            Err(error) => {
                println!("{name} {error}");
                return Ok(false);
            }
        };
        let memory = own.peak_memory.zip(free.peak_memory);
        println!(
            "{name} {:>8} {:>8} │ {:>6} {:>7} {:>5} {:>6} {:>4} {:>8.3} │ {:>6} {:>5} {:>8.3} │ \
             {:>9.2} {:>5.2} {:>6} {:>13.4}",
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
            memory.map_or("–".into(), |(own, free)| format!("{:.2}", own / free)),
            own.load
        );
        if compare {
            let (apart, statuses) = self.difference()?;
            println!("    condensed: forces {apart:.1e} of the largest apart, {statuses} statuses");
        }
        Ok(true)
    }
}
