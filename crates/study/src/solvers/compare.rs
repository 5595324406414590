//! Iterations and seconds of contact solvers on uniform meshes.

use std::time::Instant;

use steklov_contact::{Problem, Solution, active_set, interior_point, kkt, newton_watched, uzawa};
use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Event, Progress, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::stage::Stage;
use steklov_problem::{Multiplier, Scene};

use crate::supported::{contact_sides, uniform};
use crate::table::Column;
use crate::watch::Watch;

/// A solver; the error says in words why it has no answer.
type Solver = fn(&Problem) -> Result<Solution, String>;
/// Solvers and their names.
pub const SOLVERS: [(&str, Solver); 4] = [
    ("Uzawa", |p| uzawa(p, None, None).map_err(|e| e.to_string())),
    ("active set", |p| active_set(p, None).map_err(|e| e.to_string())),
    ("interior point", |p| interior_point(p).map_err(|e| e.to_string())),
    ("semi-smooth Newton", newton_alone),
];

/// The semi-smooth Newton method; it fails if the active set method had to replace it.
fn newton_alone(problem: &Problem) -> Result<Solution, String> {
    let mut steps = 0;
    let solution = newton_watched(problem, None, &mut |_| steps += 1).map_err(|e| e.to_string())?;
    gave_way(steps, &solution).map_or(Ok(solution), Err)
}

/// The failure of the method to converge after this number of iterates, if so: the history of the answer then continues
/// with the active set method.
pub(super) fn gave_way(iterates: usize, solution: &Solution) -> Option<String> {
    let last = iterates.saturating_sub(1);
    (iterates < solution.history.len()).then(|| format!("it gave way to active sets after {last} steps"))
}

/// The value of the solver's own relative measure at which iterations are counted.
pub const TOLERANCE: f64 = 1e-10;
/// The meshes: multiples of the scene's number of elements.
const TIMES: [usize; 5] = [1, 2, 4, 8, 16];
/// Largest number of multipliers: Uzawa's iteration has a full matrix of that size, and its number of steps grows with
/// the mesh.
const MULTIPLIERS: usize = 600;

/// A solver on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Number in [`SOLVERS`].
    pub solver: usize,
    /// Elements of the uniform mesh.
    pub elements: usize,
    /// Displacement unknowns.
    pub dofs: usize,
    /// Contact multipliers.
    pub multipliers: usize,
    /// Iterations until its measure stays below 1e-10; NaN if it never does.
    pub iterations: f64,
    /// The worst measure of the answer in the check of its conditions.
    pub kkt: f64,
    /// Wall seconds to its own tolerance.
    pub seconds: f64,
    /// Its measure by iteration.
    pub history: Vec<f64>,
    /// Why there is no answer.
    pub failure: Option<String>,
}

/// Columns of the solvers.
pub(crate) const METHODS: [Column<Method>; 6] = [
    ("elements", "1", "elements of the uniform mesh, degree of the scene", |m| m.elements as f64),
    ("dofs", "1", "displacement unknowns", |m| m.dofs as f64),
    ("multipliers", "1", "contact multipliers", |m| m.multipliers as f64),
    ("iterations", "1", "iterations until the solver's measure is below 1e-10; NaN if it never is", |m| m.iterations),
    ("kkt", "1", "worst relative violation of equilibrium and contact conditions by the answer", |m| m.kkt),
    ("seconds", "seconds", "wall time to the solver's own tolerance", |m| m.seconds),
];

/// The cost of solvers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solvers {
    /// Methods by mesh and solver.
    pub methods: Vec<Method>,
}

impl Solvers {
    /// The meshes of a solver.
    pub fn of(&self, solver: usize) -> impl Iterator<Item = &Method> {
        self.methods.iter().filter(move |m| m.solver == solver)
    }

    /// All solvers on the finest mesh.
    pub fn finest(&self) -> impl Iterator<Item = &Method> {
        let elements = self.methods.iter().map(|m| m.elements).max();
        self.methods.iter().filter(move |m| Some(m.elements) == elements)
    }
}

/// A condensed contact problem and its mesh.
pub(crate) struct OnMesh {
    pub(crate) elements: usize,
    pub(crate) dofs: usize,
    pub(crate) problem: Problem,
}

/// The condensed contact problems on uniform meshes; random input has its mean. After a request to stop no more meshes
/// are done.
///
/// # Errors
/// The errors of assembly on the meshes.
pub(crate) fn problems(
    scene: &Scene,
    watch: &mut Watch<'_>,
    call: &mut dyn FnMut(OnMesh, &Watch<'_>),
) -> Result<(), SolveError> {
    for times in TIMES {
        let mut scene = uniform(scene, times, scene.method.degree);
        scene.method.multiplier = Multiplier::Biorthogonal;
        let progress = Progress::<BoundaryElements>::first(&scene);
        let dofs = progress.next.dofs();
        if times > 1 && dofs > scene.method.max_dofs() || watch.stopped() {
            break;
        }
        watch.tell("contact solvers", &format!("{dofs} dofs"));
        let mut condensed = None;
        let run = run(&scene, progress, watch.interrupts, &mut |_, event| {
            if let Event::Stage(Stage::Contact(problem, _)) = event {
                condensed = Some(problem.clone());
            }
            Ok(())
        });
        let elements = match run {
            Err(SolveError::Interrupted) => break,
            run => run?.last.mesh.len(),
        };
        let Some(problem) = condensed.filter(|problem| times == 1 || multipliers(problem) <= MULTIPLIERS) else {
            break;
        };
        call(OnMesh { elements, dofs, problem }, watch);
    }
    Ok(())
}

fn multipliers(problem: &Problem) -> usize {
    2 * problem.nodes.iter().map(|n| n.conditions.len()).sum::<usize>()
}

/// Solves the condensed contact problems on uniform meshes; none without contact.
///
/// # Errors
/// The errors of assembly on the meshes. A solver that fails is reported in its place.
pub fn solvers(scene: &Scene, watch: &mut Watch<'_>) -> Result<Option<Solvers>, SolveError> {
    if contact_sides(scene).is_empty() {
        return Ok(None);
    }
    let mut solvers = Solvers::default();
    problems(scene, watch, &mut |on_mesh, watch| solvers.add(&on_mesh, watch))?;
    Ok(Some(solvers))
}

impl Solvers {
    /// Adds the results of each solver on a mesh.
    pub(crate) fn add(&mut self, OnMesh { elements, dofs, problem }: &OnMesh, watch: &Watch<'_>) {
        for solver in (0..SOLVERS.len()).take_while(|_| !watch.stopped()) {
            let method = Method::new(solver, problem);
            self.methods.push(Method { elements: *elements, dofs: *dofs, multipliers: multipliers(problem), ..method });
        }
    }
}

impl Method {
    fn new(solver: usize, problem: &Problem) -> Self {
        let clock = Instant::now();
        let solution = SOLVERS[solver].1(problem);
        let seconds = clock.elapsed().as_secs_f64();
        let nothing = Self {
            solver,
            elements: 0,
            dofs: 0,
            multipliers: 0,
            iterations: f64::NAN,
            kkt: f64::NAN,
            seconds,
            history: Vec::new(),
            failure: None,
        };
        match solution {
            Err(why) => Self { failure: Some(why), ..nothing },
            Ok(solution) => {
                let kkt = kkt(problem, &solution).worst();
                Self { iterations: iterations(&solution.history), kkt, history: solution.history, ..nothing }
            }
        }
    }
}

/// Iterations until the measure stays below the tolerance.
fn iterations(history: &[f64]) -> f64 {
    match history.iter().rposition(|m| m.is_nan() || *m > TOLERANCE) {
        None => history.len().min(1) as f64,
        Some(last) if last + 1 < history.len() => (last + 2) as f64,
        Some(_) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::iterations;

    #[test]
    fn iterations_are_counted_until_the_measure_stays_small() {
        assert_eq!(iterations(&[1.0, 1e-5, 1e-11]), 3.0);
        assert_eq!(iterations(&[1.0, 1e-11, 1e-5, 1e-10, 0.0]), 4.0);
        assert_eq!(iterations(&[0.0]), 1.0);
        assert_eq!(iterations(&[]), 0.0);
        assert!(iterations(&[1.0, 1e-9]).is_nan() && iterations(&[f64::NAN]).is_nan());
    }
}
