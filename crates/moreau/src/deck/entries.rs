//! The typed content of a deck, each value with its place in the file; not yet a model.

use super::finding::At;
use super::formula;
use super::units::Units;
use crate::driver::Increments;
use crate::mesh::{CellKind, Integration, Skin};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

/// The modelling hypothesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Analysis {
    /// Plane strain.
    PlaneStrain,
    /// Plane stress.
    PlaneStress,
    /// Axial symmetry, x = radius, y = axis.
    Axisymmetric,
    /// Three-dimensional solid.
    Solid,
}

impl Analysis {
    /// Names in a deck, in the order of the variants.
    pub const NAMES: [&'static str; 4] = ["plane-strain", "plane-stress", "axisymmetric", "solid"];

    /// Name in a deck.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// 2 or 3.
    pub fn dimension(self) -> usize {
        if self == Self::Solid { 3 } else { 2 }
    }

    /// Whether a body is a slice that has a thickness.
    pub fn has_thickness(self) -> bool {
        matches!(self, Self::PlaneStrain | Self::PlaneStress)
    }
}

/// Grid lines of a block along one axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Grid {
    /// From, to, and the number of equal cells.
    Range([f64; 2], usize),
    /// The lines themselves.
    Lines(Vec<f64>),
}

impl Grid {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        match self {
            Self::Range(_, cells) => *cells,
            Self::Lines(lines) => lines.len().saturating_sub(1),
        }
    }

    /// The least coordinate; NaN without lines.
    pub fn first(&self) -> f64 {
        match self {
            Self::Range([a, _], _) => *a,
            Self::Lines(lines) => lines.first().copied().unwrap_or(f64::NAN),
        }
    }

    /// The lines.
    pub fn lines(&self) -> Vec<f64> {
        match self {
            Self::Range([a, b], cells) => crate::mesh::uniform(*a, *b, *cells),
            Self::Lines(lines) => lines.clone(),
        }
    }
}

/// `file` of `[mesh]`, or a `[[mesh.part]]`: a mesh file and where it is put.
#[derive(Debug, Clone, PartialEq)]
pub struct FileEntry {
    /// Path of the file.
    pub file: At<PathBuf>,
    /// What its groups are called by, before their own names; none: by these alone.
    pub name: Option<At<String>>,
    /// Factor of its coordinates.
    pub scale: f64,
    /// Turn about its origin.
    pub turn: Option<TurnEntry>,
    /// Where its origin is put, once it is stretched and turned.
    pub position: Vec<f64>,
}

impl FileEntry {
    /// A file that is taken as it is, with its groups.
    pub fn plain(file: At<PathBuf>, dimension: usize) -> Self {
        Self {
            file,
            name: None,
            scale: 1.0,
            turn: None,
            position: vec![0.0; dimension],
        }
    }
}

/// `[[mesh.block]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockEntry {
    /// Name of the body and its groups.
    pub name: At<String>,
    /// Element.
    pub element: At<CellKind>,
    /// Grid lines along x, y and, in 3D, z.
    pub grid: Vec<At<Grid>>,
}

/// What part of a group a new group takes.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// What lies between these limits, one entry a coordinate.
    Box(Vec<Option<[f64; 2]>>),
    /// The node nearest to a point.
    Nearest(Vec<f64>),
}

/// `[[mesh.group]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct GroupEntry {
    /// Name.
    pub name: At<String>,
    /// Group that it is a part of.
    pub on: At<String>,
    /// Which part.
    pub part: At<Part>,
}

/// Isotropic hardening, shown as it is written in a deck: a curve, and a linear part on top.
#[derive(Debug, Clone, PartialEq)]
pub struct Hardening {
    /// Modulus of the linear part.
    pub linear: f64,
    /// The curve; none: linear.
    pub curve: Option<Curve>,
}

/// A curve of isotropic hardening.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// Saturation and rate.
    Voce([f64; 2]),
    /// Strength, offset and exponent.
    Swift([f64; 3]),
    /// Plastic strain and stress.
    Table(Vec<At<[f64; 2]>>),
}

impl fmt::Display for Hardening {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{{ linear = {:?}", self.linear)?;
        match &self.curve {
            None => {}
            Some(Curve::Voce(given)) => write!(f, ", voce = {given:?}")?,
            Some(Curve::Swift(given)) => write!(f, ", swift = {given:?}")?,
            Some(Curve::Table(rows)) => {
                let rows: Vec<[f64; 2]> = rows.iter().map(|row| row.value).collect();
                write!(f, ", table = {rows:?}")?;
            }
        }
        write!(f, " }}")
    }
}

/// `[[material]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialEntry {
    /// Group of cells.
    pub on: At<String>,
    /// Young's modulus.
    pub young: At<f64>,
    /// Poisson's ratio.
    pub poisson: At<f64>,
    /// Initial yield stress; none: elastic.
    pub yield_stress: Option<At<f64>>,
    /// Isotropic hardening.
    pub isotropic: Option<At<Hardening>>,
    /// Modulus and recall of each term of kinematic hardening.
    pub kinematic: Vec<[At<f64>; 2]>,
    /// Strength of a soil, if it is one.
    pub soil: Option<SoilEntry>,
    /// What it has of axes, if it has them; Young's modulus is then the largest of all.
    pub axes: Option<AxesEntry>,
    /// Strain in every direction by a kelvin, if given.
    pub expansion: Option<At<f64>>,
    /// Quadrature, if given.
    pub quadrature: Option<At<Integration>>,
    /// Kinds of the cells that have it; known when the mesh is.
    pub kinds: Vec<CellKind>,
}

/// `[[initial]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialEntry {
    /// Group of cells.
    pub on: At<String>,
    /// Components xx, yy, zz, xy and, of a solid, yz and xz of the stress; none of no stress.
    pub stress: Vec<Option<At<FieldEntry>>>,
    /// Equivalent plastic strain, if given.
    pub p: Option<At<FieldEntry>>,
    /// Place of the entry.
    pub span: Range<usize>,
}

/// What a material with axes has of them.
#[derive(Debug, Clone, PartialEq)]
pub struct AxesEntry {
    /// Young's moduli, Poisson's ratios and shear moduli; none: elasticity is isotropic.
    pub elastic: Option<At<[[f64; 3]; 3]>>,
    /// Hill's criterion; none: von Mises'.
    pub hill: Option<At<HillEntry>>,
    /// Where the axes point; none: along those of space.
    pub directions: Option<At<DirectionsEntry>>,
}

/// Hill's criterion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HillEntry {
    /// F, G, H, L, M and N.
    Coefficients([f64; 6]),
    /// Lankford's ratios at 0°, 45° and 90°.
    Lankford([f64; 3]),
}

/// Directions of the axes of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DirectionsEntry {
    /// In the plane: the angle of the first one, in degrees.
    Angle(f64),
    /// In space: the first, and another in its plane with the second.
    Along([[f64; 3]; 2]),
}

impl DirectionsEntry {
    /// The axes in the columns of a rotation; `None` where they span no plane.
    pub fn rotation(&self) -> Option<Matrix3<f64>> {
        match self {
            Self::Angle(degrees) => {
                let (s, c) = degrees.to_radians().sin_cos();
                Some(Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0))
            }
            Self::Along(given) => {
                let unit = |v: Vector3<f64>| v.try_normalize(1e-9);
                let [a, b] = given.map(|v| unit(Vector3::from(v)));
                let first = a?;
                let third = unit(first.cross(&b?))?;
                Some(Matrix3::from_columns(&[first, third.cross(&first), third]))
            }
        }
    }
}

impl fmt::Display for DirectionsEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Angle(degrees) => write!(f, "{degrees:?}"),
            Self::Along(given) => write!(f, "{given:?}"),
        }
    }
}

impl fmt::Display for HillEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (names, values): (&[&str], &[f64]) = match self {
            Self::Coefficients(all) => (&["f", "g", "h", "l", "m", "n"], all),
            Self::Lankford(all) => (&["r0", "r45", "r90"], all),
        };
        let terms = names.iter().zip(values);
        let terms: Vec<String> = terms.map(|(name, v)| format!("{name} = {v:?}")).collect();
        write!(f, "{{ {} }}", terms.join(", "))
    }
}

/// A soil of Drucker and Prager, as Mohr and Coulomb's data.
#[derive(Debug, Clone, PartialEq)]
pub struct SoilEntry {
    /// Cohesion.
    pub cohesion: At<f64>,
    /// Friction angle in degrees.
    pub friction_angle: At<f64>,
    /// Dilatancy angle in degrees; where none is given the friction angle.
    pub dilatancy_angle: At<f64>,
}

impl MaterialEntry {
    /// Where it is said that the material yields; none: elastic.
    pub fn yields(&self) -> Option<&Range<usize>> {
        let soil = self.soil.as_ref().map(|s| &s.cohesion.span);
        self.yield_stress.as_ref().map(|y| &y.span).or(soil)
    }

    /// Where it is said that plastic flow of the material dilates; none: it keeps volumes.
    pub fn dilates(&self) -> Option<&Range<usize>> {
        let angle = self.soil.as_ref().map(|s| &s.dilatancy_angle);
        angle.filter(|a| a.value > 0.0).map(|a| &a.span)
    }
}

/// Surface of a tool.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A point and the normal out of the tool.
    Plane(Vec<f64>, Vec<f64>),
    /// Centre, radius and whether the tool is hollow; with the name that it was given by.
    Ball(Vec<f64>, f64, bool, &'static str),
    /// In space: point and direction of the axis, radius and whether the tool is hollow.
    Cylinder(Vec<f64>, Vec<f64>, f64, bool),
    /// In the plane: points with the tool on the right, and radii that round the corners between them, or none.
    Polyline(Vec<[f64; 2]>, Vec<f64>),
    /// In space: a closed surface of triangles.
    Triangles(SkinEntry),
}

/// `surface` of a `[[tool]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinEntry {
    /// Path of the file.
    pub file: PathBuf,
    /// Physical group of a file of Gmsh.
    pub group: Option<String>,
    /// Angle between triangles above which their edge is sharp \[degrees\].
    pub sharp: f64,
    /// Whether the tool is hollow.
    pub hollow: bool,
    /// What is in the file.
    pub skin: Skin,
}

/// `[[tool]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolEntry {
    /// Name.
    pub name: At<String>,
    /// Surface.
    pub shape: At<Shape>,
    /// What it turns about, if given.
    pub reference: Option<At<Vec<f64>>>,
}

/// Up to which gap or penetration nodes touch where they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Adjust {
    /// Up to a twentieth of the shortest side of the surface's cells.
    Near,
    /// Up to a distance.
    Within(f64),
}

/// Friction of a contact; shown as it is written in a deck.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionEntry {
    /// Coefficient of Coulomb friction.
    Coulomb(At<f64>),
    /// Limit of the shear.
    Tresca(At<f64>),
    /// Coefficient, and the limit of the shear.
    Limited(At<f64>, At<f64>),
    /// In space: coefficients along an axis and across, and the axis.
    Orthotropic(At<[f64; 2]>, At<Vec<f64>>),
    /// Rows of the pressure and the bound of the shear there.
    Table(At<Vec<At<[f64; 2]>>>),
}

impl FrictionEntry {
    /// Where the number is that decides whether there is friction at all.
    pub fn span(&self) -> &Range<usize> {
        match self {
            Self::Coulomb(given) | Self::Tresca(given) | Self::Limited(given, _) => &given.span,
            Self::Orthotropic(given, _) => &given.span,
            Self::Table(rows) => &rows.span,
        }
    }
}

impl fmt::Display for FrictionEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Coulomb(mu) => write!(f, "{:?}", mu.value),
            Self::Tresca(limit) => write!(f, "{{ tresca = {:?} }}", limit.value),
            Self::Limited(mu, limit) => {
                write!(
                    f,
                    "{{ coulomb = {:?}, tau-max = {:?} }}",
                    mu.value, limit.value
                )
            }
            Self::Orthotropic(mu, axis) => {
                write!(f, "{{ coulomb = {:?}, axis = {:?} }}", mu.value, axis.value)
            }
            Self::Table(rows) => {
                let rows: Vec<[f64; 2]> = rows.value.iter().map(|row| row.value).collect();
                write!(f, "{{ table = {rows:?} }}")
            }
        }
    }
}

/// `[[contact]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactEntry {
    /// Group of facets: that of the deck, or that of all of the parts.
    pub surface: At<String>,
    /// Groups of the deck that are one surface.
    pub parts: Vec<At<String>>,
    /// Tool.
    pub against: At<String>,
    /// Friction.
    pub friction: FrictionEntry,
    /// Distance from the tool at which the surface touches.
    pub gap_offset: Option<At<f64>>,
    /// Whether nodes near the tool touch where they are.
    pub adjust: Option<At<Adjust>>,
}

/// `[[tie]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct TieEntry {
    /// Group of facets: that of the deck, or that of all of the parts.
    pub surface: At<String>,
    /// Groups of the deck that are one surface.
    pub parts: Vec<At<String>>,
    /// Group of facets of the body that it is tied to.
    pub to: At<String>,
}

/// A condition of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct ConditionEntry {
    /// Group or tool.
    pub on: At<String>,
    /// What is put on it.
    pub action: Action,
    /// Rows of the time in the step and the share of the value that acts then.
    pub table: Option<At<Vec<[f64; 2]>>>,
    /// Place of the whole condition.
    pub span: Range<usize>,
}

impl ConditionEntry {
    /// Share of the value that acts at the end of the step.
    pub(crate) fn last_share(&self) -> f64 {
        let last = self.table.as_ref().and_then(|t| t.value.last());
        last.map_or(1.0, |row| row[1])
    }
}

/// A turn of a tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnEntry {
    /// Along the axis; the normal of the plane in a plane analysis.
    pub axis: [f64; 3],
    /// Angle in degrees.
    pub angle: f64,
}

impl TurnEntry {
    /// The turn as a matrix; `None` without an axis.
    pub fn rotation(&self) -> Option<Matrix3<f64>> {
        let axis = Vector3::from(self.axis).try_normalize(1e-9)?;
        Some(Rotation3::new(axis * self.angle.to_radians()).into_inner())
    }
}

/// A moment that turns a tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MomentEntry {
    /// Along the axis; the normal of the plane in a plane analysis.
    pub axis: [f64; 3],
    /// The moment, counter-clockwise about the axis.
    pub value: f64,
}

/// What a condition does.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Holds components of the displacement at zero.
    Fix(Vec<usize>),
    /// Holds the displacement along a direction of any length at zero.
    FixAlong(Vec<f64>),
    /// Prescribes components of the displacement.
    Move(Vec<(usize, f64)>),
    /// Prescribes the displacement along a direction of any length.
    MoveAlong(Vec<f64>, f64),
    /// Pressure.
    Pressure(f64),
    /// Traction.
    Traction(Vec<f64>),
    /// Force on a group.
    Force(Vec<f64>),
    /// Force per volume.
    BodyForce(Vec<f64>),
    /// Change of the temperature.
    Temperature(FieldEntry),
    /// Translation of a tool, and its turn; at least one of both.
    Tool(Option<Vec<f64>>, Option<TurnEntry>),
    /// Force on a tool, and its translation where no force drives it.
    Push(Vec<f64>, Option<Vec<f64>>),
    /// Moment on a tool.
    Moment(MomentEntry),
}

/// A number, or a formula of the position in the undeformed body.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldEntry {
    /// The same everywhere.
    Constant(f64),
    /// Arithmetic with x, y and z.
    Formula(String),
}

impl FieldEntry {
    /// The number at a position.
    pub fn at(&self, position: &[f64]) -> f64 {
        let coordinate = |name: &str| {
            let axis = ["x", "y", "z"].iter().position(|axis| *axis == name)?;
            position.get(axis).copied()
        };
        match self {
            Self::Constant(value) => *value,
            // It was read before.
            Self::Formula(text) => formula::value(text, &coordinate).unwrap_or(f64::NAN),
        }
    }
}

impl fmt::Display for FieldEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(value) => write!(f, "{value:?}"),
            Self::Formula(text) => write!(f, "\"={text}\""),
        }
    }
}

/// `[[step]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct StepEntry {
    /// Name.
    pub name: At<String>,
    /// Increments.
    pub increments: Increments,
    /// Whether its loads are to grow until the structure collapses.
    pub until_collapse: bool,
    /// Conditions.
    pub conditions: Vec<ConditionEntry>,
    /// Place of the step.
    pub span: Range<usize>,
}

/// Method for the contact problem.
#[derive(Debug, Clone, PartialEq)]
pub enum Method {
    /// The exact law, by a semismooth Newton method.
    Exact,
    /// The exact law, by Uzawa's projections.
    Uzawa,
    /// The exact law, one contact at a time.
    GaussSeidel,
    /// Springs, normal and tangential.
    Penalty(At<f64>, At<f64>),
    /// Springs such that a pressure of three times the yield stress penetrates by this part of the
    /// shortest side of the cells in contact.
    Penetration(At<f64>),
}

/// `[solver]`.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverEntry {
    /// Out-of-balance force at which an increment is accepted, over the largest nodal force.
    pub tolerance: f64,
    /// Method.
    pub method: Method,
    /// Whether the contact problem is solved around the nonlinear solve.
    pub outside: bool,
    /// Place of the method, or of the nesting that takes its place.
    pub chosen: Range<usize>,
    /// Threads; 0: all.
    pub threads: usize,
}

/// Of which increments something is written as VTU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vtu {
    /// All.
    All,
    /// The last that converged.
    Last,
    /// None.
    None,
}

impl Vtu {
    /// Names in a deck, in the order of the variants.
    pub const NAMES: [&'static str; 3] = ["all", "last", "none"];
}

/// `[expect]`: a final value.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// A column of `history.csv`, as in `force.punch.y`.
    pub column: At<String>,
    /// The value expected at the end.
    pub value: f64,
    /// Tolerance: relative to the value, absolute, or the larger of both.
    pub relative: Option<f64>,
    /// See `relative`.
    pub absolute: Option<f64>,
}

impl Expectation {
    /// Largest difference that is accepted.
    pub fn tolerance(&self) -> f64 {
        let relative = self.relative.unwrap_or(0.0) * self.value.abs();
        relative.max(self.absolute.unwrap_or(0.0))
    }
}

/// A deck: what one file says.
#[derive(Debug, Clone, PartialEq)]
pub struct Deck {
    /// Title; may be empty.
    pub title: String,
    /// Units.
    pub units: Units,
    /// Modelling hypothesis.
    pub analysis: Analysis,
    /// Whether strains are large.
    pub finite: Option<At<bool>>,
    /// Thickness of plane strain.
    pub thickness: At<f64>,
    /// Mesh files.
    pub mesh_files: Vec<FileEntry>,
    /// Checksum that the files it reads are to have.
    pub checksum: Option<At<String>>,
    /// That which they have, those of meshes and of the surfaces of tools; none without files.
    pub found_checksum: Option<String>,
    /// Blocks.
    pub blocks: Vec<BlockEntry>,
    /// Groups.
    pub groups: Vec<GroupEntry>,
    /// Whether all that the deck says of the mesh was understood.
    pub mesh_understood: bool,
    /// Materials.
    pub materials: Vec<MaterialEntry>,
    /// What bodies start with.
    pub initial: Vec<InitialEntry>,
    /// Tools.
    pub tools: Vec<ToolEntry>,
    /// Names of all tools, also of those that were not understood.
    pub tool_names: Vec<String>,
    /// Contacts.
    pub contacts: Vec<ContactEntry>,
    /// Ties.
    pub ties: Vec<TieEntry>,
    /// Steps.
    pub steps: Vec<StepEntry>,
    /// Solver.
    pub solver: SolverEntry,
    /// Directory of the results, if given.
    pub directory: Option<String>,
    /// Increments of which bodies and contact surfaces are written as VTU.
    pub vtu: Vtu,
    /// Increments of which the quadrature points are.
    pub points: Vtu,
    /// Increments between checkpoints; 0: none.
    pub checkpoint: usize,
    /// Groups whose forces and displacements are told beside those that conditions name.
    pub probes: Vec<At<String>>,
    /// Expectations.
    pub expectations: Vec<Expectation>,
}
