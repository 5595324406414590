//! The numbers of a run.

use steklov_contact::Kkt;
use steklov_coupling::Radiation;
use steklov_problem::Scene;

use crate::around::Around;
use crate::estimate::{Doubt, ROUNDOFF};
use crate::fields::probe;
use crate::large::is_large;
use crate::report::{ContactRow, contact_summary, located};
use crate::run::Run;
use crate::solve::Solved;
use crate::stochastic::{self, StochasticResult};
use crate::summary::{Audit, MediumSummary, Probe, SecondsSummary, Summary, peak_memory_bytes};
use crate::vertices::tell_unbounded;

/// Part of the forces on the boundary below which their resultant counts as none.
const BALANCED: f64 = 1e-6;

/// The numbers of a run with all outcomes of its random input; `rows` are those of the contact table.
pub fn answer(scene: &Scene, run: &Run, rows: &[ContactRow], outcomes: Option<&StochasticResult>) -> Summary {
    let mut summary = summary(scene, run, rows);
    summary.stochastic = scene.random.as_ref().zip(outcomes).map(|(random, result)| stochastic::json(random, result));
    if outcomes.is_some_and(|result| result.is_doubtful()) {
        summary.estimate_doubts.push(Doubt::Outcomes.word().to_owned());
    }
    if is_large(scene, run.last.trace()) {
        summary.estimate_doubts.push("large".to_owned());
    }
    summary
}

fn summary(scene: &Scene, run: &Run, rows: &[ContactRow]) -> Summary {
    let solved = &run.last;
    let contact = solved.contact.as_ref();
    let estimate = run.step().estimate.as_ref();
    let part = |k: usize| run.progress.steps.iter().map(|s| s.seconds[k]).sum::<f64>();
    let mut probe: Vec<Probe> = scene.probe.iter().map(|&x| probe(scene, solved, x)).collect();
    tell_unbounded(scene, rows, &mut probe, estimate.is_some_and(|e| e.relative < ROUNDOFF));
    let exterior = solved.around.as_ref().map(Around::summary).or_else(|| exterior_summary(scene, run));
    let of_estimate = estimate.iter().flat_map(|e| &e.doubts).map(|d| d.word().to_owned());
    Summary {
        title: scene.title.clone(),
        model: "bem".into(),
        file: String::new(),
        converged: run.converged(),
        reason: run.reason.word().into(),
        failure: run.error.as_ref().map(ToString::to_string),
        dofs: solved.space.dofs(),
        steps: run.progress.steps.len(),
        energy: solved.energies.total,
        energy_extrapolated: estimate.map(|e| e.energy),
        energy_uncertainty: estimate.map(|e| e.uncertainty),
        strain_energy: solved.energies.strain,
        load_work: solved.energies.load_work,
        friction_work: solved.energies.friction_work,
        estimate: estimate.map(|e| e.error),
        estimate_relative: estimate.map(|e| e.relative),
        estimate_doubts: of_estimate.chain(exterior.iter().filter_map(MediumSummary::doubt)).collect(),
        iterations: contact.map_or(0, |c| c.reported().iterations),
        contact: contact.map(|c| contact_summary(scene, solved.trace(), c, rows, located(scene, run.step()))),
        audit: contact.map(|c| audit_summary(&c.audit)),
        reactions: solved.reactions.iter().cloned().collect(),
        probe,
        stochastic: None,
        grid: None,
        exterior,
        seconds: SecondsSummary {
            set_up: part(0),
            assemble: part(1),
            factorise: part(2),
            solve: part(3),
            estimate: part(4),
            ..Default::default()
        },
        peak_memory_bytes: peak_memory_bytes(),
    }
}

/// What a hole in an unbounded medium does far away; none of another body.
fn exterior_summary(scene: &Scene, run: &Run) -> Option<MediumSummary> {
    let far = scene.body().far.as_ref()?;
    let Solved { mesh, space, field, .. } = &run.last;
    let (mut resultant, mut sum) = ([0.0; 2], 0.0);
    for e in 0..mesh.len() {
        let rule = steklov_quadrature::gauss_legendre(space.degree(e));
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            let force = field.trace(e, t).traction.map(|t| w * mesh.length(e) / 2.0 * t);
            resultant = [resultant[0] + force[0], resultant[1] + force[1]];
            sum += force[0].hypot(force[1]);
        }
    }
    Some(MediumSummary {
        radiation: match far.radiation {
            Radiation::Decaying => "decaying".into(),
            Radiation::Bounded => "bounded".into(),
        },
        resultant,
        balanced: resultant[0].hypot(resultant[1]) <= BALANCED * sum,
        constant: field.at_infinity(),
        length: run.last.mesh.diameter(),
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
