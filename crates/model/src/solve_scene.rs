//! The entry point for programs: a scene in, its numbers out.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

use steklov_elastic::plane::distance;
use steklov_problem::{ProbeLine, Scene};

use crate::answer::probes;
use crate::answer::singular_points::{is_among, singular_points};
use crate::error::SolveError;
use crate::grid::OnGrid;
use crate::run::adaptive_loop::{Event, Model, Progress, Run, run};
use crate::run::answer::summary_and_contact;
use crate::run::boundary_elements::BoundaryElements;
use crate::solve::contact_rows::{ContactRow, Trace};
use crate::solve::solution::TieRow;
use crate::stage::Stage;
use crate::stochastic::{self, Elsewhere, LastMesh, OutcomesWatch, StochasticResult};
use crate::summary::{LinePoint, LineProbe, SideProbe, Summary};

/// A scene that is solved.
pub struct Answer {
    /// Energies, the estimate and its doubts, contact with its force, length and ends, reactions, probes: the JSON object of the command.
    pub summary: Summary,
    /// Pressure, shear, gap and slip at every node of the sides in contact; empty without contact.
    pub contact: Vec<ContactRow>,
    /// All outcomes of random input, with mean, variance and quantiles of quantities; `None` if nothing is random, or the run ended before.
    pub outcomes: Option<StochasticResult>,
    /// The steps, and the last solution.
    pub run: AnyRun,
}

/// A run of either model; its matrices are released unless outcomes of random input need them.
pub enum AnyRun {
    /// Of boundary elements.
    BoundaryElements(Box<Run<BoundaryElements>>),
    /// Of finite elements on a grid.
    OnGrid(Box<Run<OnGrid>>),
}

impl AnyRun {
    /// The boundary of the last solution: its elements, their nodes and the displacement there.
    pub fn trace(&self) -> Trace<'_> {
        match self {
            Self::BoundaryElements(run) => run.last.trace(),
            Self::OnGrid(run) => run.last.trace(),
        }
    }

    /// The nodes of ties between bodies.
    pub fn ties(&self) -> &[TieRow] {
        match self {
            Self::BoundaryElements(run) => &run.last.ties,
            Self::OnGrid(_) => &[],
        }
    }
}

impl fmt::Debug for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Answer").field("summary", &self.summary).finish_non_exhaustive()
    }
}

impl Answer {
    /// Displacement and stress at points, those of the mean of random input, each with its distance from the first along them all; NaN
    /// where no body is. `scene` is the one that was solved.
    ///
    /// *Fails when* a point is nearer to the boundary than [`Polygon::tolerance`](steklov_bem_operators::Polygon::tolerance) and not meant
    /// to be on it: it has the values of the boundary. *Cost*: for each point an integral over the boundary, some microseconds an element.
    pub fn at(&self, scene: &Scene, points: &[[f64; 2]]) -> Vec<LinePoint> {
        let mut s = 0.0;
        let place = |k: usize| {
            s += if k > 0 { distance(points[k - 1], points[k]) } else { 0.0 };
            (s, points[k])
        };
        self.at_places(scene, (0..points.len()).map(place).collect())
    }

    /// The same along a line.
    pub fn along(&self, scene: &Scene, line: &ProbeLine) -> Vec<LinePoint> {
        self.at_places(scene, line.places())
    }

    fn at_places(&self, scene: &Scene, places: Vec<(f64, [f64; 2])>) -> Vec<LinePoint> {
        let points = match &self.run {
            AnyRun::BoundaryElements(run) => probes::points(scene, places, |spot, x| run.last.at(spot, x)),
            AnyRun::OnGrid(run) => probes::points(scene, places, |spot, x| OnGrid::at(&run.last, spot, x)),
        };
        let mut line = LineProbe { from: [0.0; 2], to: [0.0; 2], points };
        self.tell_unbounded(scene, std::slice::from_mut(&mut line), &mut []);
        line.points
    }

    /// Displacement, traction and stress along a side, by its number.
    ///
    /// # Panics
    /// If there is no such side.
    pub fn along_side(&self, scene: &Scene, side: usize) -> SideProbe {
        let mut sides = match &self.run {
            AnyRun::BoundaryElements(run) => BoundaryElements::along_sides(scene, &run.last, &[side]),
            AnyRun::OnGrid(run) => OnGrid::along_sides(scene, &run.last, &[side]),
        };
        self.tell_unbounded(scene, &mut [], &mut sides);
        sides.swap_remove(0)
    }

    /// Takes the stresses from points where they are infinite.
    fn tell_unbounded(&self, scene: &Scene, lines: &mut [LineProbe], sides: &mut [SideProbe]) {
        let exact = match &self.run {
            AnyRun::BoundaryElements(run) => BoundaryElements::is_exact(run),
            AnyRun::OnGrid(run) => OnGrid::is_exact(run),
        };
        if !exact {
            let singular = singular_points(scene, self.run.trace().mesh, &self.contact);
            probes::tell_unbounded(&mut [], lines, sides, is_among(scene, &singular));
        }
    }
}

/// Solves a scene as its method says: checks it, refines until the tolerance or a limit is reached, and solves for all
/// outcomes of its random input. Why it ended is [`Summary::reason`], how far the numbers can be trusted the estimate and its
/// doubts.
///
/// *Use when* numbers of one scene are wanted; to watch or stop a run, or for its matrices and fields, take
/// [`run`](crate::run::adaptive_loop::run). *Fails when* the data are impossible, a body can move freely under its loads, or the first
/// mesh has no solution. *Cost*: of a mesh with n displacement unknowns n³ operations and 24 to 72 n² bytes, and all meshes together
/// about twice the last one.
///
/// # Errors
/// [`SolveError::Data`] of what [`Scene::check`] finds, or of an outcome that is impossible; those of
/// [`run`](crate::run::adaptive_loop::run).
pub fn solve(scene: &Scene) -> Result<Answer, SolveError> {
    solve_watched(scene, &Watch { interrupts: &AtomicUsize::new(0), tell: &|_| {}, elsewhere: None })
}

/// Answers outcomes on the last mesh of a run, by their germs.
pub type OnLastMesh<'a> = dyn Fn(&LastMesh, &[Vec<f64>]) -> Result<Vec<stochastic::Answer>, SolveError> + Sync + 'a;

/// How a program stops a run and sees how far it is.
pub struct Watch<'a> {
    /// Counts the wishes to stop: after one the step that runs is finished and its answer given, after two the run ends at once.
    pub interrupts: &'a AtomicUsize,
    /// Gets what is done at the moment.
    pub tell: &'a (dyn Fn(Told) + Sync),
    /// Answers the outcomes of random input that are solved one by one, as an [`Elsewhere`](crate::stochastic::Elsewhere) that is handed the
    /// last mesh too; none: they are solved here.
    pub elsewhere: Option<&'a OnLastMesh<'a>>,
}

/// What a run is doing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Told {
    /// A step of the loop, its number from 0, the word of its part, and the share of the step that is done.
    Step(usize, &'static str, f64),
    /// Outcomes of random input: those that are solved, and how many there will be.
    Outcomes(usize, usize),
}

/// As [`solve`], watched.
///
/// # Errors
/// As [`solve`]; [`SolveError::Interrupted`] if it was stopped before there was anything to tell.
pub fn solve_watched(scene: &Scene, watch: &Watch<'_>) -> Result<Answer, SolveError> {
    scene.check()?;
    match scene.is_on_grid() {
        true => solve_from(scene, Progress::<OnGrid>::new(scene, Vec::new())?, watch, AnyRun::OnGrid),
        false => solve_from(scene, Progress::<BoundaryElements>::first(scene), watch, AnyRun::BoundaryElements),
    }
}

fn solve_from<M: Model>(
    scene: &Scene,
    first: Progress<M>,
    watch: &Watch<'_>,
    of: fn(Box<Run<M>>) -> AnyRun,
) -> Result<Answer, SolveError> {
    let mut run = run(scene, first, watch.interrupts, &mut |step, event| {
        if let Event::Stage(Stage::Progress(what, share)) = event {
            (watch.tell)(Told::Step(step, what, share));
        }
        Ok(())
    })?;
    let tell = |done, count| (watch.tell)(Told::Outcomes(done, count));
    let stopped = || watch.interrupts.load(Ordering::Relaxed) > 0;
    let dofs = watch.elsewhere.map_or(0, |_| M::report(scene, &run).trace.displacement.len());
    let checked = watch.elsewhere.map(|elsewhere| {
        let mesh = M::last_mesh(&run.step().layout);
        move |germs: &[Vec<f64>]| {
            let answers = elsewhere(&mesh, germs)?;
            let same = answers.len() == germs.len() && answers.iter().all(|answer| answer.displacement.len() == dofs);
            if same { Ok(answers) } else { Err(SolveError::Elsewhere) }
        }
    });
    let elsewhere = checked.as_ref().map(|checked| checked as &Elsewhere<'_>);
    let of_outcomes = OutcomesWatch { progress: &tell, stopped: &stopped, elsewhere };
    let outcomes = M::outcomes(scene, &mut run, &of_outcomes, &mut |_| Ok(()))?;
    let (summary, contact) = summary_and_contact(scene, &run, outcomes.as_ref());
    run.matrices = run.matrices.filter(|_| outcomes.is_some());
    Ok(Answer { summary, contact, outcomes, run: of(Box::new(run)) })
}
