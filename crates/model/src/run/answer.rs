//! The numbers of a run.

use steklov_contact::Kkt;
use steklov_coupling::Radiation;
use steklov_elastic::plane::norm;
use steklov_problem::{Scene, Solver, facets};

use crate::answer::interfaces;
use crate::answer::report::{contact_summary, located};
use crate::answer::singular_points::tell_unbounded;
use crate::answer::small_strain::is_large;
use crate::data::on_mesh::OnMesh;
use crate::doubt::Doubt;
use crate::estimate::error_estimate::{Estimate, ROUNDOFF};
use crate::run::adaptive_loop::{Model, Reason, Run};
use crate::run::expect::expected;
use crate::run::report::Report;
use crate::solve::contact::ContactResult;
use crate::solve::contact_rows::{ContactRow, contact_rows};
use crate::solve::medium::Around;
use crate::solve::solution::Solved;
use crate::stochastic::{self, StochasticResult};
use crate::summary::{Audit, BodySummary, ContactSummary, MediumSummary, SecondsSummary, Summary, peak_memory_bytes};

/// Part of the forces on the boundary below which their resultant counts as none.
const BALANCED: f64 = 1e-6;

/// The numbers of a run with all outcomes of its random input; `report` is that of its last solution, `rows` are those of the
/// contact table.
pub fn answer<M: Model>(
    scene: &Scene,
    run: &Run<M>,
    report: Report<'_>,
    rows: &[ContactRow],
    outcomes: Option<&StochasticResult>,
) -> Summary {
    let Report { energies, contact, mut probe, exterior, .. } = report;
    tell_unbounded(scene, rows, &mut probe, report.exact);
    let mut doubts = report.doubts;
    doubts.extend(exterior.iter().filter_map(MediumSummary::doubt));
    if outcomes.is_some_and(|result| result.is_doubtful()) {
        doubts.push(Doubt::Outcomes);
    }
    if is_large(scene, report.trace) {
        doubts.push(Doubt::Large);
    }
    if !facets(&scene.problem.outline).is_empty() {
        doubts.push(Doubt::Facets);
    }
    let mut summary = Summary {
        title: scene.title.clone(),
        model: scene.model().word().into(),
        file: String::new(),
        converged: run.converged(),
        reason: run.reason.word().into(),
        failure: run.error.as_ref().map(ToString::to_string).or_else(|| {
            let solver = run.reason == Reason::Solver;
            solver.then(|| unsolved(scene, contact, outcomes.map_or(0, |result| result.unconverged)))
        }),
        dofs: run.step().dofs,
        steps: run.progress.steps.len(),
        energy: energies.total,
        energy_extrapolated: report.energy.map(|[energy, _]| energy),
        energy_uncertainty: report.energy.map(|[_, uncertainty]| uncertainty),
        strain_energy: energies.strain,
        load_work: energies.load_work,
        friction_work: energies.friction_work,
        estimate: report.error.map(|[error, _]| error),
        estimate_relative: report.error.map(|[_, relative]| relative),
        estimate_doubts: doubts.iter().map(|doubt| doubt.word().to_owned()).collect(),
        iterations: contact.map_or(0, |c| c.reported().iterations),
        contact: contact.map(|c| {
            let told = contact_summary(scene, report.trace, c, rows, report.located);
            // of several interfaces nothing says which end is whose
            let several = scene.problem.interfaces().len() > 1 && scene.problem.has_several_bodies();
            ContactSummary { ends: told.ends.filter(|_| !several), ..told }
        }),
        bodies: report.bodies,
        interfaces: report.interfaces,
        reach: report.reach,
        audit: contact.map(|c| audit_summary(&c.audit)),
        reactions: report.reactions.iter().cloned().collect(),
        probe,
        stochastic: scene.random.as_ref().zip(outcomes).map(|(random, result)| stochastic::json(random, result)),
        grid: report.grid,
        exterior,
        seconds: SecondsSummary::of_steps(run.seconds()),
        peak_memory_bytes: peak_memory_bytes(),
        expect: Vec::new(),
    };
    summary.expect = expected(scene, &summary);
    summary
}

/// What the solver left undone, and what to do about it.
fn unsolved(scene: &Scene, contact: Option<&ContactResult>, outcomes: usize) -> String {
    let nearer = "bring lengths, gaps, loads and Young's modulus nearer to each other";
    let Some(contact) = contact else {
        return format!("the forces balance to few digits only: {nearer}");
    };
    if contact.converged() && outcomes > 0 {
        return format!("contact of {outcomes} outcomes is not solved: solve one of them alone to see why");
    }
    let Kkt { equilibrium, penetration, tension, complementarity, friction } = contact.audit;
    let remedy = match scene.method.solver {
        Solver::Auto if contact.converged() => format!("the forces balance only as far as that, {nearer}"),
        Solver::Auto if contact.coulomb.is_some() => {
            "no solution under Coulomb's law was found on this mesh: lower the friction coefficients, or try another number of \
             method.elements"
                .to_owned()
        }
        Solver::Auto => format!("the contact conditions hold only as far as that, {nearer}"),
        _ => "the solver that method.solver names did not reach its criterion: leave that at \"auto\"".to_owned(),
    };
    format!(
        "after {} iterations equilibrium is off by {equilibrium:.1e}, penetration {penetration:.1e}, tension {tension:.1e}, \
         complementarity {complementarity:.1e}, friction {friction:.1e}: {remedy}",
        contact.reported().iterations
    )
}

/// What boundary elements tell.
pub(crate) fn report_of_boundary<'a>(scene: &Scene, run: &'a Run) -> Report<'a> {
    let solved = &run.last;
    let estimate = run.step().estimate.as_ref();
    let (mut interfaces, mut reach) = (Vec::new(), Vec::new());
    if scene.problem.has_several_bodies() {
        let rows = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(solved.trace(), c));
        let data = OnMesh { scene, mesh: &solved.mesh, space: &solved.space };
        // a mesh that was solved has them
        let joints = data.joints().unwrap_or_default();
        let located = located(scene, &run.step().layout.located);
        interfaces = interfaces::interfaces(scene, solved, &joints, &rows, located);
        let error = estimate.map_or(scene.method.tolerance(), |e| e.relative.max(scene.method.tolerance()));
        reach = interfaces::reach(scene, solved, &joints, error);
    }
    let doubts = estimate.iter().flat_map(|e| &e.doubts).copied();
    Report {
        energies: solved.energies,
        energy: estimate.map(|e| [e.energy, e.uncertainty]),
        error: estimate.map(|e| [e.error, e.relative]),
        doubts: doubts.chain(interfaces::doubts(scene, solved, &interfaces, &reach)).collect(),
        exact: estimate.is_some_and(|e| e.relative < ROUNDOFF),
        trace: solved.trace(),
        contact: solved.contact.as_ref(),
        located: located(scene, &run.step().layout.located),
        reactions: &solved.reactions,
        probe: scene.probe.iter().map(|&x| solved.probe(scene, x)).collect(),
        grid: None,
        around: solved.around.as_ref(),
        exterior: solved.around.as_ref().map(Around::summary).or_else(|| exterior_summary(scene, run)),
        bodies: bodies(scene, solved, estimate),
        interfaces,
        reach,
    }
}

/// The bodies, if there are several: unknowns, energy, and the part of the estimate that is theirs.
fn bodies(scene: &Scene, solved: &Solved, estimate: Option<&Estimate>) -> Vec<BodySummary> {
    if !scene.problem.has_several_bodies() {
        return Vec::new();
    }
    let edges = scene.problem.outline.edges();
    let body_of = |e: usize| scene.problem.outline.body_of_loop(edges[solved.mesh.edge[e]].loop_index);
    let of = |(body, strain): (usize, &f64)| {
        let own: Vec<usize> = (0..solved.mesh.len()).filter(|&e| body_of(e) == body).collect();
        let part = |estimate: &Estimate| {
            let all: f64 = estimate.indicators.iter().map(|i| i.total()).sum();
            let here: f64 = own.iter().map(|&e| estimate.indicators[e].total()).sum();
            if all > 0.0 { estimate.error * (here / all).sqrt() } else { 0.0 }
        };
        BodySummary {
            name: scene.problem.bodies[body].name.clone(),
            dofs: 2 * own.iter().map(|&e| solved.space.degree(e)).sum::<usize>(),
            strain_energy: *strain,
            estimate: estimate.map(part),
        }
    };
    solved.strain_of_bodies.iter().enumerate().map(of).collect()
}

/// What an unbounded medium with a boundary of its own does far away; none without one.
fn exterior_summary(scene: &Scene, run: &Run) -> Option<MediumSummary> {
    let parts = scene.problem.outline.bodies().len();
    let (body, radiation) = (0..parts).find_map(|body| Some((body, scene.problem.radiation(body)?)))?;
    let Solved { mesh, space, field, .. } = &run.last;
    let (mut resultant, mut sum) = ([0.0; 2], 0.0);
    for e in field.elements(body) {
        let rule = steklov_quadrature::gauss_legendre(space.degree(e));
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            let force = field.trace(e, t).traction.map(|v| w * mesh.speed(e, t) * v);
            resultant = [resultant[0] + force[0], resultant[1] + force[1]];
            sum += norm(force);
        }
    }
    Some(MediumSummary {
        radiation: match radiation {
            Radiation::Decaying => "decaying".into(),
            Radiation::Bounded => "bounded".into(),
        },
        resultant,
        balanced: norm(resultant) <= BALANCED * sum,
        constant: field.of_body(body).at_infinity(),
        length: mesh.part(field.elements(body)).diameter(),
    })
}

/// The judge's measures as they are told.
pub(crate) fn audit_summary(audit: &Kkt) -> Audit {
    Audit {
        equilibrium: audit.equilibrium,
        penetration: audit.penetration,
        tension: audit.tension,
        complementarity: audit.complementarity,
        friction: audit.friction,
    }
}
