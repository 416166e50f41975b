//! What a run gives reason to doubt although it converged, gathered as it goes: of each kind the worst, with
//! numbers and place; not what is wrong with a deck.

use crate::deck::{Deck, Units};
use crate::driver::{Between, Buckling, ContactRecord, Deformation, Driver, Energies, Extent};
use crate::driver::{IncrementReport, ModelError, Numbers, Saved};
use crate::numbers::{place, shown};
use crate::simulation::ends::End;

/// What may be doubtful about a converged state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Strains that are no longer small.
    Strain,
    /// Rotations that are no longer small.
    Rotation,
    /// Cells turned inside out.
    Inverted,
    /// A tool within a surface between its nodes.
    Between,
    /// A body within a tool beside the surface that touches it.
    Beside,
    /// Stresses near to, or beyond, those of buckling.
    Buckling,
    /// Nodes that are held inside of what they are in contact with.
    Held,
    /// Nodes at sharp corners of tools.
    Corner,
    /// Rigid motions that nothing resists.
    Free,
    /// An equilibrium that is unstable.
    Unstable,
    /// A limit of the load, beyond which it falls.
    Limit,
    /// Cells distorted by large strains.
    Distorted,
    /// A body that has come to rest far from where it was.
    Leap,
    /// A tool that bears on a node which it does not reach.
    Ahead,
    /// Bodies that have moved into each other where nothing joins them.
    Through,
    /// A round tool that bears on one node, being narrower than a facet.
    Narrow,
    /// Contact points that press without the shear that acts where bodies press.
    Shearless,
    /// A tool that goes farther over a surface in an increment than its facets are long.
    Stride,
    /// Strains too large for one increment.
    Strained,
    /// Slips that change their direction within an increment.
    Swing,
    /// Nodes that bear on a tool beyond the ends of its line.
    End,
}

const KINDS: [Kind; 21] = [
    Kind::Strain,
    Kind::Rotation,
    Kind::Inverted,
    Kind::Between,
    Kind::Beside,
    Kind::Buckling,
    Kind::Held,
    Kind::Corner,
    Kind::Free,
    Kind::Unstable,
    Kind::Limit,
    Kind::Distorted,
    Kind::Leap,
    Kind::Ahead,
    Kind::Through,
    Kind::Narrow,
    Kind::Shearless,
    Kind::Stride,
    Kind::Strained,
    Kind::Swing,
    Kind::End,
];

/// Quality below which a cell is distorted: that of a rectangle 1 : 20, or of a square sheared by 4.2.
const DISTORTED: f64 = 0.1;

/// And in parts of that of the undeformed mesh, which may be of flat cells.
const HALF: f64 = 0.5;

/// Strain that a tenth of the body may have in one increment: a billet that is upset to half of its height in increments of
/// 0.14, 0.23 and 0.40 takes a force that is 0.7, 1.6 and 6 % too small.
const STRAINED: f64 = 0.2;

/// Part of a facet that a tool may go in an increment where its force is to be right to a few percent.
const PART_OF_A_FACET: f64 = 0.25;

/// Angle by which a slip may be beside what it is at the end of its increment, and with it the friction against it: a sixth of
/// that acts across \[rad\].
const SWUNG: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Where a doubt is worst.
#[derive(Debug, Clone, PartialEq, Default)]
struct Worst {
    /// The cell, node or contact.
    index: usize,
    position: Vec<f64>,
    /// The increment; of a buckling, the step from 0.
    when: usize,
    /// By which it is the worst; then what belongs to it.
    numbers: Vec<f64>,
}

/// Digits of coordinates.
const DIGITS: usize = 4;

/// Part of the work, or of the volume, that may be beyond the limits of small strains and rotations: what is
/// strained at the corners of a punch.
const LOCAL: f64 = 0.1;

/// Part of what is stored and dissipated by which the balance of energies may be out. Under small strains friction
/// counts its slip at the last pressure, which is twice too much where it first slips: a tenth in a dozen increments.
const CLOSED: f64 = 0.2;

/// The balance of energies where it is worst.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Balance {
    /// Imbalance after the last increment.
    last: f64,
    /// The largest so far, with the external work and what was stored and dissipated then.
    worst: [f64; 3],
    /// The most that was ever stored and dissipated.
    most: f64,
    /// The largest change in one increment, and that increment.
    change: f64,
    increment: usize,
    /// The work that what was left out of balance may have done so far.
    rounding: f64,
}

impl Balance {
    /// Takes note of the energies after an increment, of which so much is the work of rounding. That of the increments
    /// before stays in the balance: what an early one left may be more than all that follows.
    fn add(&mut self, energies: &Energies, increment: usize, rounding: f64) {
        self.rounding += rounding;
        let imbalance = energies.imbalance();
        let change = imbalance - self.last;
        if change.abs() > self.change.abs() {
            (self.change, self.increment) = (change, increment);
        }
        if imbalance.abs() > self.worst[0].abs().max(self.rounding) {
            self.worst = [imbalance, energies.external_work, energies.taken()];
        }
        self.last = imbalance;
        self.most = self.most.max(energies.taken());
    }

    /// Whether all that was ever stored or dissipated is rounding.
    fn is_idle(&self) -> bool {
        self.most <= self.rounding
    }

    fn sentence(&self, units: Units) -> Option<String> {
        let unit = units.energy();
        let [imbalance, work, taken] = self.worst.map(|v| shown(v, 4));
        let differ = self.worst[0].abs() > CLOSED * self.most;
        differ.then(|| {
            format!(
                "the energies do not balance: {work} {unit} are the external work, {taken} {unit} are stored or \
                 dissipated, which differ by {imbalance} {unit}, {} {unit} of it from increment {}: too much \
                 happens in that one to count what it took; take smaller increments there, and bring tools \
                 to the surface in a step of their own",
                shown(self.change, 4),
                self.increment
            )
        })
    }
}

/// Warnings of a run.
#[derive(Debug, Clone)]
pub(super) struct Warnings {
    worst: [Option<Worst>; KINDS.len()],
    balance: Balance,
    /// The part of the step at hand that is done.
    done: f64,
}

impl Warnings {
    pub(super) fn new() -> Self {
        Self {
            worst: Default::default(),
            balance: Balance::default(),
            done: 0.0,
        }
    }

    /// Takes note of a converged increment. On the way to collapse displacements grow as far as it takes to
    /// know the load, and their size says nothing.
    pub(super) fn add<const D: usize>(
        &mut self,
        (driver, deck): (&Driver<D>, &Deck),
        report: &IncrementReport,
        to_collapse: bool,
    ) {
        // No more than what is out of balance or rounds at every node, along the longest way.
        let way = driver.displacements().iter();
        let way = way.fold(0.0, |most: f64, u| most.max(u.abs()));
        let force = report.out_of_balance.max(driver.rounding_of_forces());
        let rounding = driver.mesh().nodes().len() as f64 * force * way;
        self.balance
            .add(&report.energies, report.increment, rounding);
        if !(to_collapse || driver.has_large_strains()) {
            self.deformed(&driver.deformation(), report.increment);
        }
        if driver.has_large_strains() {
            self.distorted(driver, report.increment);
        }
        if !to_collapse {
            self.within_tools(driver, report.increment);
        }
        if let Some(ahead) = driver.bears_ahead() {
            let numbers = vec![ahead.distance, ahead.pressed, ahead.contact as f64];
            let at = (ahead.node, ahead.position.to_vec());
            self.note(Kind::Ahead, numbers, at, report.increment);
        }
        if let Some(narrow) = driver.narrow_tools() {
            let ratio = narrow.beside / narrow.radius;
            let numbers = vec![ratio, narrow.radius, narrow.beside, narrow.contact as f64];
            let at = (narrow.node, narrow.position.to_vec());
            self.note(Kind::Narrow, numbers, at, report.increment);
        }
        if !to_collapse {
            self.coarse(driver, report);
        }
        if let Some(end) = End::farthest(driver, deck) {
            let last = f64::from(u8::from(end.is_last));
            let numbers = vec![end.beyond, end.count as f64, end.contact as f64, last];
            self.note(
                Kind::End,
                numbers,
                (end.node, end.position),
                report.increment,
            );
        }
        self.done = report.fraction;
        self.undecided(driver, report);
    }

    /// Takes note of what tools reach behind the surfaces that touch them.
    fn within_tools<const D: usize>(&mut self, driver: &Driver<D>, when: usize) {
        if let Some(Between {
            contact,
            node,
            depth,
            facet,
            position,
            pressed,
        }) = driver.between_nodes()
        {
            let mut numbers = vec![depth, facet, pressed];
            numbers.extend(node.map(|node| node as f64));
            let at = (contact, position.to_vec());
            self.note(Kind::Between, numbers, at, when);
        }
        if let Some(beside) = driver.beside_contacts() {
            let numbers = vec![beside.depth, beside.count as f64, beside.contact as f64];
            let at = (beside.node, beside.position.to_vec());
            self.note(Kind::Beside, numbers, at, when);
        }
    }

    /// Takes note of what is too much for one increment, with how many of its step would do.
    fn coarse<const D: usize>(&mut self, driver: &Driver<D>, report: &IncrementReport) {
        let when = report.increment;
        // Along a path on which loads fall no number of increments decides how long they are.
        let length = report.fraction - self.done;
        let is_known = length > 0.0 && self.worst[Kind::Limit as usize].is_none();
        let enough = |parts: f64| f64::from(u8::from(is_known)) * (parts / length).ceil();
        if let Some(swing) = driver.swings().filter(|swing| swing.angle > SWUNG) {
            let enough = enough(2.0 * swing.angle / SWUNG);
            let numbers = vec![enough, swing.angle, swing.turn, swing.contact as f64];
            let at = (swing.node, swing.position.to_vec());
            self.note(Kind::Swing, numbers, at, when);
        }
        if report.plastic_fraction == 0.0 {
            return;
        }
        if let Some(stride) = driver.strides() {
            let enough = enough(stride.way / (PART_OF_A_FACET * stride.facet));
            let numbers = vec![enough, stride.way, stride.facet, stride.contact as f64];
            let at = (stride.node, stride.position.to_vec());
            self.note(Kind::Stride, numbers, at, when);
        }
        if driver.has_large_strains()
            && let strain = driver.strain_of_increment()
            && strain > STRAINED
        {
            let numbers = vec![enough(2.0 * strain / STRAINED), strain];
            self.note(Kind::Strained, numbers, (0, Vec::new()), when);
        }
    }

    /// Takes note of what contact has no say in, or not the only one.
    fn undecided<const D: usize>(&mut self, driver: &Driver<D>, report: &IncrementReport) {
        let when = report.increment;
        // What carries a force may be inside by the springs of a penalty.
        let inside = |c: &&ContactRecord<D>| c.u[0] < -driver.rounding_of_gaps() && c.t[0] == 0.0;
        let held = driver.contacts().iter().filter(inside);
        if let Some(deepest) = held.clone().min_by(|a, b| a.u[0].total_cmp(&b.u[0])) {
            let numbers = vec![-deepest.u[0], held.count() as f64, deepest.contact as f64];
            let at = (deepest.node, deepest.position.to_vec());
            self.note(Kind::Held, numbers, at, when);
        }
        if let Some(&first) = report.corners.first() {
            let point = &driver.contacts()[first];
            let numbers = vec![report.corners.len() as f64, point.contact as f64];
            let at = (point.node, point.position.to_vec());
            self.note(Kind::Corner, numbers, at, when);
        }
        let pressing = report.shearless.iter().map(|&k| &driver.contacts()[k]);
        if let Some(most) = pressing.max_by(|a, b| a.t[0].total_cmp(&b.t[0])) {
            let numbers = vec![
                most.t[0],
                report.shearless.len() as f64,
                most.contact as f64,
            ];
            let at = (most.node, most.position.to_vec());
            self.note(Kind::Shearless, numbers, at, when);
        }
        // The tangent of an increment that strains far is not that of the body at its end.
        let far = report.plastic_fraction > 0.0
            && driver.has_large_strains()
            && driver.strain_of_increment() > STRAINED;
        let is_known = self.worst[Kind::Unstable as usize].is_some();
        if report.negative_eigenvalues > 0 && !is_known && !far {
            let (at, direction) = most_moved(driver, report.mode.as_deref());
            let numbers = [vec![report.negative_eigenvalues as f64], direction].concat();
            self.note(Kind::Unstable, numbers, at, when);
        }
        if let Some(limit) = report.limit
            && self.worst[Kind::Limit as usize].is_none()
        {
            let (at, direction) = most_moved(driver, report.mode.as_deref());
            self.note(Kind::Limit, [vec![limit], direction].concat(), at, when);
        }
        if let Some((node, moved)) = report.leap {
            let at = driver.mesh().nodes()[node].iter().copied().collect();
            self.note(Kind::Leap, vec![moved], (node, at), when);
        }
        let free = match report.free_motions.len() {
            0 => driver.pushed_motions().len(),
            some => some,
        };
        if free > 0 {
            let numbers = vec![free as f64];
            self.note(Kind::Free, numbers, (0, Vec::new()), when);
        }
    }

    fn deformed<const D: usize>(&mut self, deformation: &Deformation<D>, when: usize) {
        let Deformation {
            strain, rotation, ..
        } = deformation;
        for (kind, extent) in [(Kind::Strain, strain), (Kind::Rotation, rotation)] {
            let Extent {
                largest,
                cell,
                position,
                beyond,
            } = *extent;
            if beyond > LOCAL {
                let numbers = vec![largest, beyond];
                self.note(kind, numbers, (cell, position.to_vec()), when);
            }
        }
        if let Some(&(cell, position)) = deformation.inverted.first() {
            let count = deformation.inverted.len() as f64;
            match &mut self.worst[Kind::Inverted as usize] {
                // Where it begins is what counts.
                Some(worst) => worst.numbers[0] = worst.numbers[0].max(count),
                None => self.note(Kind::Inverted, vec![count], (cell, position.to_vec()), when),
            }
        }
    }

    /// Takes note of the worst cell if it is distorted, and of the increments in which one first was, and first was turned
    /// inside out at a corner: at its points of integration none is.
    fn distorted<const D: usize>(&mut self, driver: &Driver<D>, when: usize) {
        let (quality, cell, position) = driver.worst_quality();
        let virgin = || driver.mesh().worst_quality(driver.mesh().nodes()).0;
        let (first, first_inverted) = match &self.worst[Kind::Distorted as usize] {
            Some(worst) => (worst.number(1), worst.number(2)),
            None => (when as f64, 0.0),
        };
        if quality < DISTORTED && quality < HALF * virgin() {
            let inverted = match quality < 0.0 && first_inverted == 0.0 {
                true => when as f64,
                false => first_inverted,
            };
            let numbers = vec![1.0 - quality, first, inverted];
            self.note(Kind::Distorted, numbers, (cell, position.to_vec()), when);
        }
    }

    /// Takes note of the state at the end of a step: loads grow up to there.
    pub(super) fn end_of_step<const D: usize>(
        &mut self,
        driver: &mut Driver<D>,
        (stage, to_collapse): (usize, bool),
    ) {
        self.done = 0.0;
        if !to_collapse {
            self.through(driver, stage);
        }
        // Large strains see it themselves.
        if driver.has_large_strains() {
            return;
        }
        if let Some(buckling) = driver.buckling()
            && buckling.load_factor < Buckling::<D>::NEAR
        {
            let mut numbers = vec![1.0 / buckling.load_factor];
            numbers.extend(buckling.direction);
            let at = (buckling.node, buckling.position.to_vec());
            self.note(Kind::Buckling, numbers, at, stage);
        }
    }

    /// Takes note of bodies that have moved into each other where neither a contact nor a tie is between them.
    fn through<const D: usize>(&mut self, driver: &Driver<D>, stage: usize) {
        let within = driver.unjoined_since();
        if let Some(deepest) = within.iter().max_by(|a, b| a.depth.total_cmp(&b.depth)) {
            let cells = deepest.cells.map(|cell| cell as f64);
            let numbers = vec![deepest.depth, within.len() as f64, cells[0], cells[1]];
            let at = driver.mesh().nodes()[deepest.node].to_vec();
            self.note(Kind::Through, numbers, (deepest.node, at), stage);
        }
    }

    fn note(
        &mut self,
        kind: Kind,
        numbers: Vec<f64>,
        (index, position): (usize, Vec<f64>),
        when: usize,
    ) {
        let worst = &mut self.worst[kind as usize];
        if worst.as_ref().is_none_or(|w| numbers[0] > w.numbers[0]) {
            *worst = Some(Worst {
                index,
                position,
                when,
                numbers,
            });
        }
    }

    /// One sentence a kind.
    pub(super) fn sentences<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> Vec<String> {
        let of = |kind: Kind| {
            let worst = self.worst[kind as usize].as_ref()?;
            let told = match kind {
                Kind::Free if self.balance.is_idle() => worst.pushed(driver),
                _ => None,
            };
            Some(told.unwrap_or_else(|| worst.sentence(kind, driver, deck)))
        };
        let kinds = KINDS.into_iter().filter_map(of);
        kinds.chain(self.balance.sentence(deck.units)).collect()
    }
}

impl Saved for Warnings {
    fn visit(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        for worst in &mut self.worst {
            numbers.option(worst, Worst::default, |worst, numbers| {
                numbers.count(&mut worst.index)?;
                numbers.count(&mut worst.when)?;
                numbers.list(&mut worst.position)?;
                numbers.list(&mut worst.numbers)
            })?;
        }
        numbers.value(&mut self.done)?;
        let b = &mut self.balance;
        for value in [&mut b.last, &mut b.most, &mut b.change, &mut b.rounding] {
            numbers.value(value)?;
        }
        numbers.count(&mut b.increment)?;
        numbers.values(&mut b.worst)
    }
}

fn percent(v: f64) -> String {
    format!("{} %", shown(100.0 * v, 3))
}

impl Worst {
    fn sentence<const D: usize>(&self, kind: Kind, driver: &Driver<D>, deck: &Deck) -> String {
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        match kind {
            Kind::Strain => format!(
                "strains are no longer small: they reach {} in cell {index} at {at} in increment {when}, and \
                 exceed {} in parts of the body that have {} of the work or of the volume; the analysis is \
                 linear in strains, and off by about as much as they are: move less, or take this as an \
                 estimate",
                percent(self.number(0)),
                percent(Deformation::<D>::STRAIN),
                percent(self.number(1))
            ),
            Kind::Rotation => format!(
                "rotations are no longer small: they reach {}° in cell {index} at {at} in increment {when}, and \
                 exceed {}° in parts of the body that have {} of the work or of the volume; the analysis is \
                 one of small rotations, in the undeformed position: move less, or take this as an estimate",
                shown(self.number(0).to_degrees(), 3),
                shown(Deformation::<D>::ROTATION.to_degrees(), 3),
                percent(self.number(1))
            ),
            Kind::Inverted => format!(
                "cells are turned inside out by their displacements: cell {index} at {at} in increment {when} is \
                 the first, {} are at most; from there on the result means nothing: move less",
                shown(self.number(0), 9)
            ),
            Kind::Between => self.between(driver, deck),
            Kind::Beside => self.beside(driver, deck),
            Kind::Held => self.held(driver, deck),
            Kind::Corner => self.corner(driver),
            Kind::Shearless => self.shearless(driver, deck),
            Kind::Stride => self.stride(driver, deck),
            Kind::Swing => self.swing(driver),
            Kind::End => self.end(driver, deck),
            Kind::Strained => format!(
                "strains are large for one increment: in increment {when} a tenth of the body is strained by {} or more, and its \
                 law goes straight from one state to the other, which makes forces wrong by percents; use {} \
                 in that step",
                percent(self.number(1)),
                self.more_increments()
            ),
            Kind::Free => self.free(driver),
            Kind::Unstable => format!(
                "the equilibrium is unstable from increment {when} on: with what may touch held, its tangent has {} \
                 negative there, so that a limit point or a bifurcation has been passed, and what follows is one path \
                 among several{}; take the load there as critical, or follow another path from a slightly crooked part",
                match self.number(0) as usize {
                    1 => "an eigenvalue that is".to_owned(),
                    n => format!("{n} eigenvalues that are"),
                },
                self.giving_way(&at)
            ),
            Kind::Limit => format!(
                "the load passes its limit in increment {when}, after {} of the step, the largest load that was in \
                 balance: what follows is the path of \
                 equilibria under loads that fall and rise again, which a body under its full load leaves at once, \
                 snapping to where that load is balanced again{}",
                shown(self.number(0), 6),
                self.giving_way(&at)
            ),
            Kind::Distorted if self.number(2) > 0.0 => format!(
                "cells are turned inside out at their corners: the quality of cell {index} at {at} is {} in increment {when}, where 1 is \
                 best and 0 is flat, and the first was turned so in increment {}; around them the result means nothing from there on; \
                 a new mesh was due from increment {} on, or smaller cells where the body folds",
                shown(1.0 - self.number(0), 2),
                shown(self.number(2), 9),
                shown(self.number(1), 9)
            ),
            Kind::Distorted => format!(
                "cells are distorted: cell {index} at {at} has a quality of {} in increment {when}, where 1 is \
                 best; a new mesh is due from increment {} on, in which one first was below {}: what follows is \
                 less accurate; begin with cells that are longer across the direction in which they are drawn",
                shown(1.0 - self.number(0), 2),
                shown(self.number(1), 9),
                shown(DISTORTED, 2)
            ),
            Kind::Ahead => self.ahead(driver, deck),
            Kind::Leap => format!(
                "the body leaps in increment {when}, the node at {at} by {} {}, far more than what moves it: that has lost its \
                 hold, and what follows is an equilibrium at rest far from the one before, not where a body in motion would \
                 come to rest",
                shown(self.number(0), 3),
                deck.units.length()
            ),
            Kind::Buckling => self.buckling(deck),
            Kind::Through => self.through(driver, deck),
            Kind::Narrow => self.narrow(driver, deck),
        }
    }

    fn number(&self, k: usize) -> f64 {
        self.numbers.get(k).copied().unwrap_or(0.0)
    }

    fn between<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let length = deck.units.length();
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(index);
        if let Some(node) = self.numbers.get(3) {
            return format!(
                "node {node} of \"{tool}\" is {} {length} within \"{surface}\" between its nodes, at {at} in increment {when}, on a \
                 facet {} {length} long whose surface is pressed in by {} {length} at its nodes: contact keeps the nodes of \
                 \"{surface}\" out of \"{tool}\" and not those the other way, which makes forces too small; exchange the two, so \
                 that `surface` is the side with the finer facets and the corners, or use facets of a fifth of that length there",
                shown(self.number(0), 3),
                shown(self.number(1), 3),
                shown(self.number(2), 3)
            );
        }
        format!(
            "the tool \"{tool}\" is {} {length} within \"{surface}\" between its nodes, at {at} in \
             increment {when}, on a facet {} {length} long whose surface is pressed in by {} {length} at \
             its nodes: contact acts at nodes, and what is smaller than a facet passes between them; \
             use facets of a fifth of that length, or less, where \"{tool}\" touches",
            shown(self.number(0), 3),
            shown(self.number(1), 3),
            shown(self.number(2), 3)
        )
    }

    fn beside<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let length = deck.units.length();
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(2) as usize);
        format!(
            "{} nodes beside \"{surface}\" are within the tool \"{tool}\", node {index} at {at} by {} {length} in increment \
             {when}: only the surface that is given touches, and what comes to lie on \"{tool}\" beside it passes through, \
             which makes forces too small; add those sides, as in surface = [\"{surface}\", …]",
            self.number(1),
            shown(self.number(0), 3)
        )
    }

    fn held<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let length = deck.units.length();
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, opposite) = driver.contact_name(self.number(2) as usize);
        format!(
            "{} nodes of \"{surface}\" are held inside of \"{opposite}\", node {index} at {at} by {} \
             {length} in increment {when}: displacement conditions put them there, and contact cannot \
             push them out; release them, or move \"{opposite}\"",
            shown(self.number(1), 9),
            shown(self.number(0), 4)
        )
    }

    fn ahead<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let length = deck.units.length();
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(2) as usize);
        format!(
            "\"{tool}\" bears on node {index} of \"{surface}\" at {at} in increment {when} from {} {length} away, where the \
             nodes of the surface are pressed in by {} {length}: the sides of facets with nodes between corners, which \
             have one gap with those, are too long there for what their curve and that of the tool differ by; use facets of half that \
             length, or linear cells",
            shown(self.number(0), 3),
            shown(self.number(1), 3)
        )
    }

    fn through<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let (index, at) = (self.index, place(&self.position, DIGITS));
        let step = deck.steps.get(self.when);
        let step = step.map_or("", |s| s.name.value.as_str());
        let [own, other] = [2, 3].map(|k| driver.body_in_words(self.number(k) as usize));
        format!(
            "{} nodes have moved into another body at the end of step \"{step}\", as node {index} of {own}, at {at} in the \
             mesh, by {} {} into {other}: neither a contact nor a tie is between them there, and bodies pass through each \
             other where no contact is given; add one of their surfaces there",
            shown(self.number(1), 9),
            shown(self.number(0), 3),
            deck.units.length()
        )
    }

    fn narrow<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let length = deck.units.length();
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(3) as usize);
        format!(
            "\"{tool}\", of a radius of {} {length} there, bears on node {index} of \"{surface}\" at {at} and on none beside it \
             in increment {when}, where the nearest is {} {length} away: contact acts at nodes, and a node is pressed in with \
             all of the facets around it, which makes forces too large; use facets of a fifth of that radius, or less, where \
             \"{tool}\" touches",
            shown(self.number(1), 3),
            shown(self.number(2), 3)
        )
    }

    fn corner<const D: usize>(&self, driver: &Driver<D>) -> String {
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(1) as usize);
        format!(
            "node {index} of \"{surface}\" at {at} is at a sharp corner of \"{tool}\" in increment {when}: \
             the normal there is any between those of both faces, and a finer mesh gives another stress; \
             give the corner a radius of a few facets"
        )
    }

    fn shearless<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(2) as usize);
        format!(
            "node {index} of \"{surface}\" at {at} presses \"{tool}\" by {} {} in increment {when} without the shear that \
             its friction gives at any pressure, {} nodes at most: under that shear it opens, without it it presses, and \
             neither is in balance; the force along the surface lacks what these nodes give it, less with finer cells",
            shown(self.number(0), 3),
            deck.units.force(),
            shown(self.number(1), 9)
        )
    }

    /// How many increments would do, if that is known.
    fn more_increments(&self) -> String {
        match self.number(0) > 0.0 {
            true => format!("increments = {} or more", self.number(0)),
            false => "smaller increments".into(),
        }
    }

    fn stride<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let length = deck.units.length();
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(3) as usize);
        format!(
            "\"{tool}\" goes {} {length} along \"{surface}\" in increment {when}, at node {index} at {at}, over facets {} {length} \
             long, while the body yields: contact acts at the ends of increments, and what the tool passes between them it does \
             not press in, which makes forces too small; use {} in that step, of a quarter of a facet each",
            shown(self.number(1), 3),
            shown(self.number(2), 3),
            self.more_increments()
        )
    }

    fn swing<const D: usize>(&self, driver: &Driver<D>) -> String {
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(3) as usize);
        format!(
            "\"{tool}\" turns by {}° in increment {when}, and \"{surface}\" slips along it, at node {index} at {at}, in directions \
             that change within the increment: friction acts against what they add up to, {}° beside the slip at the end; use \
             {} in that step",
            shown(self.number(2).to_degrees(), 3),
            shown(self.number(1).to_degrees(), 3),
            self.more_increments()
        )
    }

    fn end<const D: usize>(&self, driver: &Driver<D>, deck: &Deck) -> String {
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let (surface, tool) = driver.contact_name(self.number(2) as usize);
        let which = if self.number(3) > 0.0 {
            "last"
        } else {
            "first"
        };
        format!(
            "\"{surface}\" bears on \"{tool}\" beyond the {which} of its points, where its line only goes on straight: by {} {} \
             at node {index} at {at} in increment {when}, {} nodes in all; give the line the points that the tool has there, \
             or one where it ends",
            shown(self.number(0), 3),
            deck.units.length(),
            shown(self.number(1), 9)
        )
    }

    fn free<const D: usize>(&self, driver: &Driver<D>) -> String {
        let when = self.when;
        let mut now = driver.free_motions();
        if now.is_empty() {
            now = driver.pushed_motions();
        }
        let now = match now.is_empty() {
            true => String::new(),
            false => format!(" (at the end: {})", now.join(", ")),
        };
        format!(
            "in increment {when} neither conditions nor contact decide where a body is: {} rigid motions \
             are free{now}; forces and stresses are what they are, positions are the nearest to those \
             before; fix what symmetry fixes if they matter",
            shown(self.number(0), 9)
        )
    }

    /// That contacts push a body along which nothing holds on its other side, where no force has done any work; `None` if none
    /// has moved.
    fn pushed<const D: usize>(&self, driver: &Driver<D>) -> Option<String> {
        let motions = driver.pushed_motions();
        (!motions.is_empty()).then(|| {
            format!(
                "a body is pushed and not held: nothing resists the {}, and since increment {} what touches it only moves it \
                 along, without any force; nothing has been stored or dissipated in the whole run, which tells nothing of the \
                 body: the support on its other side is missing, as a plane of symmetry that is to be fixed",
                motions.join(", the "),
                self.when
            )
        })
    }

    /// How the body gives way, if that is known.
    fn giving_way(&self, at: &str) -> String {
        match self.numbers.get(1..).unwrap_or_default() {
            [] => String::new(),
            direction => format!(
                "; it gives way with node {} at {at} moving most, along {}, as \"mode\" in the VTU files shows",
                self.index,
                place(direction, 2)
            ),
        }
    }

    fn buckling(&self, deck: &Deck) -> String {
        let (index, when, at) = (self.index, self.when, place(&self.position, DIGITS));
        let step = deck.steps.get(when).map_or("", |s| s.name.value.as_str());
        let factor = 1.0 / self.number(0);
        let direction = place(self.numbers.get(1..).unwrap_or_default(), 2);
        let what = match factor < 1.0 {
            true => "the structure has buckled before, and the result is not what happens".into(),
            false => format!(
                "deflections that go with it are larger by about {}",
                percent(1.0 / (factor - 1.0))
            ),
        };
        format!(
            "buckling, which small displacements do not see: it begins, if not earlier by plastic flow or by pressures \
             and tools that turn with the surface, at {} times the stresses at the end of step \"{step}\", with node {index} at {at} moving \
             most, along {direction}; {what}: load less, or hold it against that motion",
            shown(factor, 3)
        )
    }
}

/// The node that a mode moves most, with its position, and the direction; no direction without a mode.
fn most_moved<const D: usize>(
    driver: &Driver<D>,
    mode: Option<&[f64]>,
) -> ((usize, Vec<f64>), Vec<f64>) {
    let nodes = mode.unwrap_or_default().chunks_exact(D).enumerate();
    let size = |v: &[f64]| v.iter().fold(0.0, |l: f64, x| l.hypot(*x));
    match nodes.max_by(|a, b| size(a.1).total_cmp(&size(b.1))) {
        Some((node, direction)) => {
            let position = driver.mesh().nodes()[node].to_vec();
            ((node, position), direction.to_vec())
        }
        None => ((0, Vec::new()), Vec::new()),
    }
}
