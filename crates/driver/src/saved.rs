//! The state of a driver as a list of numbers, and back to the bit; not the file that holds them.

use crate::driver::{Driver, State};
use crate::error::ModelError;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::report::ContactRecord;
use crate::settings::Seam;
use crate::vector::directions::Directions;
use moreau_contact::ContactSolution;
use moreau_laws::{Local, Status};

/// A list of numbers, appended to or read from: one order serves both.
#[derive(Debug)]
pub enum Numbers<'a> {
    /// Values are appended.
    Written(&'a mut Vec<f64>),
    /// Values are replaced by those from here on.
    Read(&'a [f64]),
}

/// What is saved.
pub trait Saved: Clone {
    /// Hands every value to `numbers`, in an order that does not depend on whether they are written or read.
    ///
    /// # Errors
    /// [`ModelError::Saved`] and [`ModelError::OutOfRange`] for numbers of something else; part of the
    /// values may have been replaced then. None where they are written.
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError>;

    /// Appends what [`Saved::read`] needs.
    fn write(&self, out: &mut Vec<f64>) {
        // Only reading fails.
        let _ = self.clone().visit(&mut Numbers::Written(out));
    }

    /// Takes over what [`Saved::write`] left of the like; nothing has changed after an error.
    ///
    /// # Errors
    /// See [`Saved::visit`].
    fn read(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        let mut read = self.clone();
        read.visit(numbers)?;
        *self = read;
        Ok(())
    }
}

impl<'a> Numbers<'a> {
    /// What is left to read.
    fn left(&self) -> &'a [f64] {
        match self {
            Self::Read(left) => left,
            Self::Written(_) => &[],
        }
    }

    /// Values, as many as there are.
    ///
    /// # Errors
    /// [`ModelError::Saved`] if fewer are left.
    pub fn values(&mut self, values: &mut [f64]) -> Result<(), ModelError> {
        match self {
            Self::Written(out) => out.extend_from_slice(values),
            Self::Read(left) => {
                let Some((head, tail)) = left.split_at_checked(values.len()) else {
                    return Err(ModelError::Saved {
                        what: "numbers left",
                        found: left.len(),
                        expected: values.len(),
                    });
                };
                values.copy_from_slice(head);
                *left = tail;
            }
        }
        Ok(())
    }

    /// One value.
    ///
    /// # Errors
    /// See [`Numbers::values`].
    pub fn value(&mut self, value: &mut f64) -> Result<(), ModelError> {
        self.values(std::slice::from_mut(value))
    }

    /// A count.
    ///
    /// # Errors
    /// See [`Numbers::values`], and [`ModelError::OutOfRange`] for a number that is none.
    pub fn count(&mut self, count: &mut usize) -> Result<(), ModelError> {
        let mut value = *count as f64;
        self.value(&mut value)?;
        *count = counted(value)?;
        Ok(())
    }

    /// Yes or no.
    ///
    /// # Errors
    /// See [`Numbers::count`].
    pub fn flag(&mut self, flag: &mut bool) -> Result<(), ModelError> {
        let mut count = usize::from(*flag);
        self.count(&mut count)?;
        *flag = count == 1;
        Ok(())
    }

    /// Something that may be missing: `empty` is replaced by what is there.
    ///
    /// # Errors
    /// See [`Numbers::values`].
    pub fn option<T>(
        &mut self,
        option: &mut Option<T>,
        empty: impl FnOnce() -> T,
        visit: impl FnOnce(&mut T, &mut Self) -> Result<(), ModelError>,
    ) -> Result<(), ModelError> {
        let mut there = option.is_some();
        self.flag(&mut there)?;
        if !there {
            *option = None;
            return Ok(());
        }
        visit(option.get_or_insert_with(empty), self)
    }

    /// A list of any length, after its length.
    ///
    /// # Errors
    /// See [`Numbers::values`].
    pub fn list(&mut self, list: &mut Vec<f64>) -> Result<(), ModelError> {
        let mut count = list.len();
        self.count(&mut count)?;
        if let Self::Read(left) = self {
            // No room is made for more than there is.
            list.resize(count.min(left.len() + 1), 0.0);
        }
        self.values(list)
    }

    /// A list whose length is known, after that.
    ///
    /// # Errors
    /// [`ModelError::Saved`] if it is another.
    pub fn known(&mut self, what: &'static str, list: &mut [f64]) -> Result<(), ModelError> {
        self.length(what, list.len())?;
        self.values(list)
    }

    fn length(&mut self, what: &'static str, expected: usize) -> Result<(), ModelError> {
        let mut found = expected;
        self.count(&mut found)?;
        if found == expected {
            return Ok(());
        }
        Err(ModelError::Saved {
            what,
            found,
            expected,
        })
    }

    fn vectors<const D: usize>(&mut self, vectors: &mut [Local<D>]) -> Result<(), ModelError> {
        let mut vectors = vectors.iter_mut();
        vectors.try_for_each(|v| self.values(v.as_mut_slice()))
    }

    fn status(&mut self, status: &mut Status) -> Result<(), ModelError> {
        const STATUSES: [Status; 4] = [Status::Open, Status::Stick, Status::Slip, Status::Tied];
        let place = STATUSES.iter().position(|s| s == status);
        let mut number = place.unwrap_or_default();
        self.count(&mut number)?;
        let known = STATUSES.get(number);
        *status = *known.ok_or(ModelError::OutOfRange {
            what: "a saved contact status".into(),
            value: number as f64,
            expected: "0, 1, 2 or 3",
        })?;
        Ok(())
    }

    fn sparse<T>(&mut self, vector: &mut T) -> Result<(), ModelError>
    where
        T: Clone + IntoIterator<Item = (usize, f64)> + FromIterator<(usize, f64)>,
    {
        let pairs = vector.clone().into_iter();
        let mut list: Vec<f64> = pairs.flat_map(|(dof, v)| [dof as f64, v]).collect();
        self.list(&mut list)?;
        let pairs = list.chunks_exact(2);
        let pairs = pairs.map(|pair| Ok((counted(pair[0])?, pair[1])));
        *vector = pairs.collect::<Result<_, ModelError>>()?;
        Ok(())
    }
}

/// Counts up to which a number tells one from the next.
const COUNTED: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;

/// A number that is a count.
fn counted(value: f64) -> Result<usize, ModelError> {
    let is_count = (0.0..=COUNTED).contains(&value) && value.fract() == 0.0;
    is_count
        .then_some(value as usize)
        .ok_or(ModelError::OutOfRange {
            what: "a saved count".into(),
            value,
            expected: "a whole number that is not negative: these are numbers of another model",
        })
}

impl<const D: usize> Saved for Loading<D> {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        numbers.sparse(&mut self.displacement)?;
        let (dofs, along) = self.directions.numbers();
        let mut dofs: Vec<f64> = dofs.into_iter().map(f64::from).collect();
        let mut along = along;
        numbers.list(&mut dofs)?;
        numbers.list(&mut along)?;
        let dofs = dofs.into_iter().map(counted);
        let dofs = dofs.collect::<Result<Vec<_>, _>>()?;
        self.directions = Directions::from_numbers(D, dofs.into_iter(), &along);
        numbers.sparse(&mut self.force)?;
        numbers.sparse(&mut self.pressure)?;
        numbers.list(&mut self.temperature.0)?;
        numbers.sparse(&mut self.turn)?;
        numbers.sparse(&mut self.axle)
    }
}

impl<const D: usize> Saved for ContactRecord<D> {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        numbers.status(&mut self.status)?;
        numbers.flag(&mut self.held)?;
        numbers.value(&mut self.area)?;
        for vector in [&mut self.u, &mut self.t, &mut self.force, &mut self.spring] {
            numbers.values(vector.as_mut_slice())?;
        }
        Ok(())
    }
}

impl<const D: usize> Saved for State<D> {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        const DOFS: &str = "degrees of freedom";
        let (dofs, points) = (self.displacement.len(), self.contacts.len());
        numbers.count(&mut self.increment)?;
        numbers.value(&mut self.farthest)?;
        numbers.value(&mut self.largest_force)?;
        numbers.flag(&mut self.unstable)?;
        numbers.known(DOFS, &mut self.displacement)?;
        numbers.known(DOFS, &mut self.internal)?;
        numbers.sparse(&mut self.contact)?;
        self.loading.visit(numbers)?;
        let rest = || (vec![0.0; dofs], Loading::default());
        numbers.option(&mut self.last, rest, |(d_u, loading), numbers| {
            numbers.known(DOFS, d_u)?;
            loading.visit(numbers)
        })?;
        let straight = || (vec![0.0; dofs], 1.0);
        numbers.option(&mut self.bend, straight, |(bend, ratio), numbers| {
            numbers.known(DOFS, bend)?;
            numbers.value(ratio)
        })?;
        let energies = &mut self.energies;
        for energy in [
            &mut energies.external_work,
            &mut energies.stored,
            &mut energies.plastic_dissipation,
            &mut energies.friction_dissipation,
            &mut energies.penalty,
        ] {
            numbers.value(energy)?;
        }
        numbers.length("contact points", points)?;
        for contact in &mut self.contacts {
            contact.visit(numbers)?;
        }
        let open = || ContactSolution {
            displacement: vec![Local::zeros(); points],
            irreversible: vec![Local::zeros(); points],
            // Of the iteration that found it; the next begins where that has led.
            motion: vec![Local::zeros(); points],
            force: vec![Local::zeros(); points],
            status: vec![Status::Open; points],
            iterations: 0,
            residual: 0.0,
            exact: true,
        };
        numbers.option(&mut self.solution, open, |solution, numbers| {
            numbers.vectors(&mut solution.displacement)?;
            numbers.vectors(&mut solution.irreversible)?;
            numbers.vectors(&mut solution.force)?;
            for status in &mut solution.status {
                numbers.status(status)?;
            }
            numbers.count(&mut solution.iterations)?;
            numbers.value(&mut solution.residual)
        })
    }
}

/// What of a linear system decides the bits of the next increment: an elastic factor at hand is not
/// computed again.
#[derive(Debug, Clone, Copy, Default)]
struct Held {
    elastic: bool,
    tied: bool,
    pivot: Option<usize>,
}

/// A linear system that may be needed again: what decides the bits, and the nodes that each contact point
/// between bodies coupled.
#[derive(Debug)]
pub(crate) struct AtHand(Held, Vec<Vec<usize>>);

impl Held {
    fn of(system: &System) -> Self {
        Self {
            elastic: system.holds_elastic_factor(),
            tied: system.is_tied(),
            pivot: system.pivot,
        }
    }
}

impl Saved for Held {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        numbers.flag(&mut self.elastic)?;
        numbers.flag(&mut self.tied)?;
        numbers.option(&mut self.pivot, || 0, |node, numbers| numbers.count(node))
    }
}

impl<const D: usize> Driver<D> {
    /// Appends the committed state: all that [`Driver::read`] needs to go on as if nothing had
    /// happened.
    pub fn write(&self, out: &mut Vec<f64>) {
        self.state.write(out);
        for block in &self.blocks {
            let state = block.state();
            out.push(state.len() as f64);
            out.extend(state);
        }
        let held = self.system.as_ref().map(Held::of);
        out.push(f64::from(u8::from(held.is_some())));
        held.iter().for_each(|held| held.write(out));
    }

    /// Takes over a state that [`Driver::write`] left of a driver of the same model.
    ///
    /// # Errors
    /// [`ModelError::Saved`] and [`ModelError::OutOfRange`] for numbers of another model; the
    /// driver is then of no use.
    pub fn read(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        self.guessed = None;
        let given = numbers.left();
        self.state.read(numbers)?;
        let read = &given[..given.len() - numbers.left().len()];
        if let Some(at) = read.iter().position(|value| !value.is_finite()) {
            return Err(ModelError::OutOfRange {
                what: format!("number {at} of a saved state"),
                value: read[at],
                expected: "a finite number",
            });
        }
        let dofs = self.state.displacement.len();
        let contact = Loading::<D> {
            force: self.state.contact.clone(),
            ..Loading::default()
        };
        contact.check(&self.mesh, dofs)?;
        self.check_loading(&self.state.loading)?;
        for block in &mut self.blocks {
            let mut state = Vec::new();
            numbers.list(&mut state)?;
            let (found, expected) = (state.len(), block.restore(&state));
            if found != expected {
                return Err(ModelError::Saved {
                    what: "numbers of material states in a block",
                    found,
                    expected,
                });
            }
        }
        let mut held = None;
        numbers.option(&mut held, Held::default, Held::visit)?;
        self.system = held.map(|held| self.system_again(held)).transpose()?;
        Ok(())
    }

    /// What [`Driver::put_back`] needs.
    pub(crate) fn at_hand(&self) -> Option<AtHand> {
        let system = self.system.as_ref()?;
        Some(AtHand(Held::of(system), system.paired.clone()))
    }

    /// Makes the linear system that was at hand when nothing had happened since the last commit, for an
    /// increment that was interrupted to begin again.
    pub(crate) fn put_back(&mut self, at_hand: Option<AtHand>) -> Result<(), ModelError> {
        self.system = None;
        if let Some(AtHand(held, paired)) = at_hand {
            let mut system = self.system_again(held)?;
            // What the points stand on now may be more than what they stood on then.
            system.paired = paired;
            self.system = Some(system);
        }
        Ok(())
    }

    /// The linear system that was at hand.
    fn system_again(&mut self, held: Held) -> Result<System, ModelError> {
        let seam = if held.tied {
            Seam::Tied
        } else {
            Seam::Condensed
        };
        let nodes = self.mesh.nodes().len();
        let pivot = held.pivot.filter(|&node| node < nodes);
        let loading = self.state.loading.clone();
        let mut system = self.elastic_system(&loading, pivot, seam)?;
        if held.elastic {
            // The elastic stiffness was positive definite when it was first factorised.
            let _ = system.factorise(true);
        }
        Ok(system)
    }
}
