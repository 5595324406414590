//! The layout of the result file.

use std::collections::{BTreeMap, VecDeque};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use steklov_bem_operators::{Mesh, Space};
use steklov_document::Source;
use steklov_io::{
    File, Group, IoError, create_group, invalid, label, load, load_integers, load_points, load_text, load_texts,
    load_vector, open, open_group, save, save_integers, save_number, save_points, save_text, save_texts, save_vector,
    vtkhdf, write_integer_attribute, write_text_attribute,
};
use steklov_model::error::SolveError;
use steklov_model::estimators::{Estimator, Estimators};
use steklov_model::run::adaptive_loop::Step;
use steklov_model::solve::contact_rows::ContactRow;
use steklov_model::solve::solution::TieRow;
use steklov_model::stochastic::{BodyMoments, StochasticResult};
use steklov_model::summary::Summary;
use steklov_plan::Plan;

use crate::grid::store as grid;
use crate::keep::Keep;
use crate::medium;
use crate::outcomes;
use crate::probes;
use crate::record::Record;
use crate::stages::{groups, step_group, stochastic, unlink};
use crate::steps;

/// Why a stored run has no result.
pub struct Unsolved(pub SolveError);

impl From<SolveError> for Unsolved {
    fn from(error: SolveError) -> Self {
        Self(error)
    }
}

impl From<IoError> for Unsolved {
    fn from(error: IoError) -> Self {
        Self(observed(error))
    }
}

/// The error of a run whose observer stores it and failed.
pub fn observed(error: IoError) -> SolveError {
    SolveError::Observer(Box::new(error))
}

/// Queue of steps to write into a new file, in their order, each by a thread that has nothing else to do.
pub struct StepQueue<'a, M: Keep> {
    file: &'a File,
    waiting: Mutex<VecDeque<Step<M>>>,
    written: Mutex<Result<usize, IoError>>,
}

impl<'a, M: Keep> StepQueue<'a, M> {
    /// No step yet.
    pub fn new(file: &'a File) -> Self {
        Self { file, waiting: Mutex::default(), written: Mutex::new(Ok(0)) }
    }

    /// Adds the next step of the run. One call of [`Self::write_next`] must follow.
    pub fn push(&self, step: Step<M>) {
        lock(&self.waiting).push_back(step);
    }

    /// Writes the first waiting step; nothing after an error.
    pub fn write_next(&self) {
        let mut written = lock(&self.written); // locked first: steps are written in the order of the queue
        let Some(step) = lock(&self.waiting).pop_front() else { return };
        if let Ok(number) = *written {
            *written = step_group(self.file, number).and_then(|at| M::save_step(&at, &step)).map(|()| number + 1);
        }
    }

    /// Checks that all steps were written.
    ///
    /// # Errors
    /// When the file could not be written.
    pub fn finish(self) -> Result<(), IoError> {
        self.written.into_inner().unwrap_or_else(PoisonError::into_inner).map(|_| ())
    }
}

/// A thread that panicked ends the program, so nobody reads its partial data.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes everything else of a record into the file that has its steps.
///
/// # Errors
/// When the file cannot be written.
pub fn write(file: &File, record: &Record, source: &Source) -> Result<(), IoError> {
    write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
    write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
    save_text(file, "scene", &source.text, "text of the scene file")?;
    save_texts(file, "overrides", &source.overrides, "keys changed on the command line, KEY=VALUE", "override")?;
    save_text(file, "summary", &json(&record.summary), "the JSON object of solve --json")?;
    save_text(file, "plan", &json(&record.plan), "what was modelled, what was left out and why, as JSON")?;
    let count = record.summary.steps;
    let last = format!("/steps/{}", steps::name(count.saturating_sub(1)));
    match &record.on_grid {
        None => file.link_hard(&format!("{last}/mesh"), "/mesh").map_err(|e| invalid(file, "mesh", e.to_string()))?,
        Some(grid) => {
            save(file, "mesh", &record.mesh)?;
            grid::write(file, grid)?;
        }
    }
    if let Some(estimators) = &record.summary.estimators {
        save_estimators(&create_group(file, "estimators")?, estimators)?;
    }
    save_solution(&create_group(file, "solution")?, record)?;
    if record.summary.contact.is_some() {
        save_contact(&create_group(file, "contact")?, &record.contact)?;
    }
    save_bodies(file, record)?;
    save_interfaces(file, record)?;
    if let Some((around, window)) = &record.around {
        medium::write(file, around, window)?;
    }
    match &record.stochastic {
        Some(result) => outcomes::write(&stochastic(file)?, result)?,
        // saved outcomes of a run that was stopped
        None => unlink(file, "stochastic")?,
    }
    // saved stages of a step that was stopped
    unlink(file, &format!("/steps/{}", steps::name(count)))?;
    for name in groups().filter(|name| file.link_exists(&format!("{last}/{name}"))) {
        let of_step = format!("{last}/{name}");
        file.link_hard(&of_step, &format!("/{name}")).map_err(|e| invalid(file, name, e.to_string()))?;
    }
    vtkhdf::write(file, &record.grid)
}

fn json<T: serde::Serialize>(value: &T) -> String {
    serde_json::to_string_pretty(value).unwrap_or_else(|e| unreachable!("plain data has a JSON text: {e}"))
}

fn save_solution(at: &Group, record: &Record) -> Result<(), IoError> {
    let node = &["node", "component"];
    save_points(at, "points", &record.points, &label("length", "displacement nodes", node))?;
    save_points(at, "displacement", &record.displacement, &label("length", "nodal displacement", node))?;
    let point = &["point", "component"];
    let place = label("length", "p Gauss points of each element", point);
    save_points(at, "traction_points", &record.traction_points, &place)?;
    let element = label("1", "element of each traction point", &["point"]);
    save_integers(at, "traction_element", &record.traction_element, &element)?;
    save_points(at, "traction", &record.traction, &label("stress", "traction sigma(u) n", point))?;
    let prescribed = label("stress", "the components of it that the scene prescribes; NaN for the others", point);
    save_points(at, "traction_prescribed", &record.prescribed, &prescribed)?;
    let reactions = create_group(at, "reactions")?;
    for (side, force) in &record.summary.reactions {
        let meaning = format!("force on the body from side {side}");
        save_vector(
            &reactions,
            &unused_name(&reactions, side),
            force,
            &label("force/thickness", &meaning, &["component"]),
        )?;
    }
    probes::save(at, &record.summary)?;
    save_quantities(at, &record.summary)
}

/// The numbers with error bars, and those that the scene asks for by names; nothing without any.
fn save_quantities(at: &Group, summary: &Summary) -> Result<(), IoError> {
    let mut told: BTreeMap<String, [f64; 2]> =
        summary.quantities.iter().map(|(path, told)| (path.clone(), [told.value, told.uncertainty])).collect();
    for (path, value) in summary.named.numbers() {
        told.entry(path).or_insert([value, f64::NAN]);
    }
    if told.is_empty() {
        return Ok(());
    }
    let at = create_group(at, "quantities")?;
    let paths: Vec<String> = told.keys().cloned().collect();
    save_texts(&at, "paths", &paths, "paths of the numbers in the JSON object", "quantity")?;
    let column = |k: usize| told.values().map(|pair| pair[k]).collect::<Vec<_>>();
    save_vector(&at, "values", &column(0), &label("as each", "the numbers", &["quantity"]))?;
    let meaning = "how far the exact number may be from it, to both sides; NaN where that is not known";
    save_vector(&at, "uncertainties", &column(1), &label("as each", meaning, &["quantity"]))
}

/// A name for a side in a group, different from all names in it.
pub(crate) fn unused_name(at: &Group, side: &str) -> String {
    // in HDF5 a slash separates a path and a point is the group itself
    let mut name = if side == "." { "_".into() } else { side.replace('/', "_") };
    while at.link_exists(&name) {
        name.push('_');
    }
    name
}

/// A group for each residual estimator that applies.
fn save_estimators(at: &Group, estimators: &Estimators) -> Result<(), IoError> {
    let norm = "(force*length/thickness)^(1/2)";
    for (name, estimator) in estimators.named() {
        let Some(Estimator { value, relative, parts }) = estimator else { continue };
        let of = create_group(at, name)?;
        save_number(&of, "value", *value, norm, "eta, root of the sum of the squared parts")?;
        save_number(&of, "relative", *relative, "1", "eta over (2 strain energy)^(1/2)")?;
        let of = create_group(&of, "parts")?;
        for (part, value) in parts {
            save_number(&of, part, *value, norm, "root of the sum over all elements")?;
        }
    }
    Ok(())
}

/// `/bodies/NAME`: the part of mesh and solution of each of several bodies.
fn save_bodies(file: &File, record: &Record) -> Result<(), IoError> {
    if record.summary.bodies.is_empty() {
        return Ok(());
    }
    let at = create_group(file, "bodies")?;
    let space = Space::new(&record.mesh);
    let name_of = |e: usize| record.mesh.side_names[record.mesh.side[e]].split('.').next().unwrap_or_default();
    for body in &record.summary.bodies {
        let own: Vec<usize> = (0..record.mesh.len()).filter(|&e| name_of(e) == body.name).collect();
        let (Some(&first), Some(&last)) = (own.first(), own.last()) else { continue };
        let group = create_group(&at, &body.name.replace('/', "_"))?;
        save(&group, "mesh", &record.mesh.part(first..last + 1))?;
        let solution = create_group(&group, "solution")?;
        let nodes = space.offset[first]..space.offset[last + 1];
        let node = &["node", "component"];
        save_points(&solution, "points", &record.points[nodes.clone()], &label("length", "displacement nodes", node))?;
        let meaning = label("length", "nodal displacement", node);
        save_points(&solution, "displacement", &record.displacement[nodes], &meaning)?;
    }
    Ok(())
}

/// `/interfaces/NAME`: the contact table of its sides, or the tractions of a tie.
fn save_interfaces(file: &File, record: &Record) -> Result<(), IoError> {
    if record.summary.interfaces.is_empty() {
        return Ok(());
    }
    let at = create_group(file, "interfaces")?;
    for interface in &record.summary.interfaces {
        let group = create_group(&at, &interface.name.replace('/', "_"))?;
        let on_side = |side: usize| interface.sides[0].contains(&record.mesh.side_names[side]);
        let rows: Vec<ContactRow> = record.contact.iter().filter(|row| on_side(row.side)).copied().collect();
        if interface.kind == "contact" {
            save_contact(&group, &rows)?;
            continue;
        }
        let ties: Vec<&TieRow> = record.ties.iter().filter(|tie| tie.name == interface.name).collect();
        let plane = &["tied node", "component"];
        let points: Vec<[f64; 2]> = ties.iter().map(|tie| tie.point).collect();
        save_points(&group, "points", &points, &label("length", "tied nodes", plane))?;
        let traction: Vec<[f64; 2]> = ties.iter().map(|tie| tie.traction).collect();
        let meaning = label("stress", "traction on the body whose side carries the multipliers", plane);
        save_points(&group, "traction", &traction, &meaning)?;
        let weight: Vec<f64> = ties.iter().map(|tie| tie.weight).collect();
        save_vector(&group, "weight", &weight, &label("length", "length that the node stands for", &["tied node"]))?;
    }
    Ok(())
}

/// The rows of all ties.
fn load_ties(file: &File, summary: &Summary) -> Result<Vec<TieRow>, IoError> {
    let mut ties = Vec::new();
    for interface in summary.interfaces.iter().filter(|interface| interface.kind == "tied") {
        let at = open_group(&open_group(file, "interfaces")?, &interface.name.replace('/', "_"))?;
        let (points, tractions) = (load_points(&at, "points")?, load_points(&at, "traction")?);
        let weights = load_vector(&at, "weight")?;
        if points.len() != tractions.len() || points.len() != weights.len() {
            return Err(invalid(&at, "traction", "points and tractions of the tie differ in number"));
        }
        let name = &interface.name;
        ties.extend(points.into_iter().zip(tractions).zip(weights).map(|((point, traction), weight)| TieRow {
            name: name.clone(),
            point,
            weight,
            traction,
        }));
    }
    Ok(ties)
}

/// Columns of the contact table that are numbers: name, unit, meaning, value.
type Column = (&'static str, &'static str, &'static str, fn(&ContactRow) -> f64);
const COLUMNS: [Column; 7] = [
    ("gap", "length", "weighted gap g_i", |r| r.gap),
    ("normal_displacement", "length", "u_n", |r| r.normal_displacement),
    ("tangential_displacement", "length", "u_t, along the normal turned by +90 degrees", |r| r.tangential_displacement),
    ("pressure", "stress", "lambda_n,i, positive in compression", |r| r.pressure),
    ("shear", "stress", "lambda_t,i", |r| r.shear),
    ("bound", "stress", "friction bound F_i", |r| r.bound),
    ("weight", "length", "length that the node stands for, the integral of its multiplier function", |r| r.weight),
];

fn save_contact(at: &Group, rows: &[ContactRow]) -> Result<(), IoError> {
    let plane = &["contact node", "component"];
    let points: Vec<_> = rows.iter().map(|r| r.point).collect();
    let normals: Vec<_> = rows.iter().map(|r| r.normal).collect();
    save_points(at, "points", &points, &label("length", "contact nodes", plane))?;
    save_points(at, "normal", &normals, &label("1", "normal out of the body", plane))?;
    for (name, unit, meaning, value) in COLUMNS {
        let values: Vec<f64> = rows.iter().map(value).collect();
        save_vector(at, name, &values, &label(unit, meaning, &["contact node"]))?;
    }
    let status: Vec<usize> = rows.iter().map(|r| r.status).collect();
    let meaning = "0 apart, 1 stick, 2 slip along +t, 3 slip along -t";
    save_integers(at, "status", &status, &label("1", meaning, &["contact node"]))?;
    let side: Vec<usize> = rows.iter().map(|r| r.side).collect();
    save_integers(at, "side", &side, &label("1", "index into /mesh/side_names", &["contact node"]))
}

fn load_contact(at: &Group) -> Result<Vec<ContactRow>, IoError> {
    let points = load_points(at, "points")?;
    let normals = load_points(at, "normal")?;
    let mut columns = Vec::new();
    for (name, ..) in COLUMNS {
        columns.push(load_vector(at, name)?);
    }
    let (status, side) = (load_integers(at, "status")?, load_integers(at, "side")?);
    let n = points.len();
    let lengths = columns.iter().map(Vec::len).chain([normals.len(), status.len(), side.len()]);
    if lengths.into_iter().any(|l| l != n) {
        return Err(invalid(at, "points", "the columns of the contact table have different lengths"));
    }
    let row = |i: usize| ContactRow {
        point: points[i],
        normal: normals[i],
        gap: columns[0][i],
        normal_displacement: columns[1][i],
        tangential_displacement: columns[2][i],
        pressure: columns[3][i],
        shear: columns[4][i],
        bound: columns[5][i],
        weight: columns[6][i],
        status: status[i],
        side: side[i],
    };
    Ok((0..n).map(row).collect())
}

/// Why the run of a result file ended before it was done; None if it was done, or if the file is no result file.
pub fn unfinished(path: &Path) -> Option<String> {
    let summary: Summary = parse(&open(path).ok()?, "summary").ok()?;
    (!summary.converged).then_some(summary.reason)
}

/// Reads the record that `show` needs, and checks that its parts fit.
///
/// # Errors
/// A file that is not one of this program's, truncated or altered.
pub fn read(file: &File) -> Result<Record, IoError> {
    let summary: Summary = parse(file, "summary")?;
    let plan: Plan = parse(file, "plan")?;
    let mesh: Mesh = load(file, "mesh")?;
    load_text(file, "scene")?;
    load_texts(file, "overrides")?;
    let solution = open_group(file, "solution")?;
    let points = load_points(&solution, "points")?;
    let displacement = load_points(&solution, "displacement")?;
    let traction_points = load_points(&solution, "traction_points")?;
    let traction_element = load_integers(&solution, "traction_element")?;
    let traction = load_points(&solution, "traction")?;
    let prescribed = match solution.link_exists("traction_prescribed") {
        true => load_points(&solution, "traction_prescribed")?,
        false => vec![[f64::NAN; 2]; traction.len()], // older files
    };
    let lengths = [traction_points.len(), traction_element.len(), prescribed.len()];
    if points.len() != displacement.len() || lengths != [traction.len(); 3] {
        return Err(invalid(&solution, "displacement", "its points and values differ in number"));
    }
    let contact = if summary.contact.is_some() { load_contact(&open_group(file, "contact")?)? } else { Vec::new() };
    if let Some(row) = contact.iter().find(|r| r.side >= mesh.side_names.len()) {
        let why = format!("side {} of {}", row.side, mesh.side_names.len());
        return Err(invalid(file, "contact/side", why));
    }
    let ties = load_ties(file, &summary)?;
    let grid = vtkhdf::read(file)?;
    medium::check(file, summary.exterior.as_ref(), &grid)?;
    let stochastic = match file.link_exists("stochastic") {
        true => {
            let estimator = summary.estimators.as_ref().and_then(|all| all.stochastic.clone());
            let result = read_stochastic(file, points.len(), contact.len())?;
            result.in_body.iter().try_for_each(|moments| check_in_body(file, moments, &grid))?;
            if result.moduli.iter().any(|moduli| moduli.len() != grid.quads.len()) {
                return Err(invalid(file, "stochastic/moduli", "they are not those of the cells of the grid"));
            }
            Some(StochasticResult { estimator, ..result })
        }
        false => None,
    };
    let on_grid = match summary.grid.is_some() || file.link_exists("multiscale") {
        true => Some(grid::read(file, &grid)?),
        false => None,
    };
    Ok(Record {
        summary,
        plan,
        mesh,
        points,
        displacement,
        traction_points,
        traction_element,
        traction,
        prescribed,
        contact,
        ties,
        grid,
        stochastic,
        on_grid,
        around: None,
    })
}

/// Whether the moments in a body are those of its points and cells.
fn check_in_body(file: &File, moments: &BodyMoments, grid: &vtkhdf::Grid) -> Result<(), IoError> {
    let BodyMoments { displacement, stress, young } = moments;
    let (points, cells) = (grid.points.len(), grid.quads.len());
    match [displacement, stress, young].map(|m| m.mean.len()) == [2 * points, 3 * cells, cells] {
        true => Ok(()),
        false => Err(invalid(file, "stochastic/body", "its fields are not those of the points and cells of the grid")),
    }
}

fn read_stochastic(file: &File, nodes: usize, conditions: usize) -> Result<StochasticResult, IoError> {
    let result = outcomes::read(&open_group(file, "stochastic")?)?;
    // a family of grids has no fields
    if !result.levels.is_empty() {
        return Ok(result);
    }
    let stressed = &result.stress_displacement;
    let fits = stressed.len() == 2 * nodes || stressed.is_empty() && result.in_body.is_some();
    if result.displacement.mean.len() != 2 * nodes || !fits {
        return Err(invalid(file, "stochastic/displacement", "it does not have two numbers for each node"));
    }
    if result.pressure.mean.len() != conditions {
        return Err(invalid(file, "stochastic/pressure", "it does not have a number for each contact node"));
    }
    Ok(result)
}

/// Whether a file holds the result of a scene with this text. `differing` takes the stored overrides and names a key in
/// which their scene differs, other than the tolerance and the limits.
///
/// # Errors
/// The result of another scene.
pub fn check_scene(file: &File, text: &str, differing: impl Fn(&[String]) -> Option<String>) -> Result<(), IoError> {
    if load_text(file, "scene")? != text {
        return Err(invalid(file, "scene", "it holds the result of another scene, or the scene has been edited since"));
    }
    if let Some(key) = differing(&load_texts(file, "overrides")?) {
        let why = format!(
            "it was solved with other overrides, which differ in {key}; only method.tolerance, max_dofs and max_steps may change"
        );
        return Err(invalid(file, "overrides", why));
    }
    Ok(())
}

fn parse<T: serde::de::DeserializeOwned>(file: &File, name: &str) -> Result<T, IoError> {
    serde_json::from_str(&load_text(file, name)?).map_err(|e| invalid(file, name, e.to_string()))
}
