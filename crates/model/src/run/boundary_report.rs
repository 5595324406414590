//! The report of boundary elements on a solution.

use steklov_contact::Located;
use steklov_coupling::Radiation;
use steklov_elastic::plane::norm;
use steklov_problem::{Multiplier, Scene};

use crate::answer::interfaces;
use crate::answer::largest_stress::largest_von_mises;
use crate::answer::probes;
use crate::answer::report::located;
use crate::bars::Bars;
use crate::data::on_mesh::OnMesh;
use crate::estimate::error_estimate::Estimate;
use crate::estimate::residual::estimator;
use crate::estimators::Estimators;
use crate::run::adaptive_loop::Model as _;
use crate::run::boundary_elements::BoundaryElements;
use crate::run::report::Report;
use crate::solve::contact_rows::contact_rows;
use crate::solve::medium::Around;
use crate::solve::solution::Solved;
use crate::summary::{BodySummary, MediumSummary};

/// Part of the forces on the boundary below which their resultant counts as none.
const BALANCED: f64 = 1e-6;

/// The report of boundary elements.
pub(crate) fn report<'a>(
    scene: &Scene,
    solved: &'a Solved,
    (estimate, bars): (Option<&Estimate>, Bars),
    (transitions, off): (&'a [Located], Option<Vec<f64>>),
) -> Report<'a> {
    let located = located(scene, transitions);
    let data = OnMesh { scene, mesh: &solved.mesh, space: &solved.space };
    let (mut interfaces, mut reach) = (Vec::new(), Vec::new());
    if scene.problem.has_several_bodies() {
        let rows = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(solved.trace(), c));
        // a mesh that was solved has them
        let joints = data.joints(|_| false).unwrap_or_default();
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
        estimators: scene.method.has_residuals().then(|| estimators(scene, solved, estimate)),
        trace: solved.trace(),
        contact: solved.contact.as_ref(),
        located,
        off,
        reactions: &solved.reactions,
        probe: scene.probe.iter().map(|&x| solved.probe(scene, x)).collect(),
        named: data.named(&solved.elastic_field(), &solved.works),
        near: data.near_transitions(transitions),
        largest_stress: bars.know_largest_stress().then(|| largest_von_mises(scene, &solved.elastic_field())).flatten(),
        bars,
        over_outcomes: None,
        lines: probes::lines(scene, |spot, x| solved.at(spot, x)),
        sides: BoundaryElements::along_sides(scene, solved, &scene.probe_sides),
        grid: None,
        around: solved.around.as_ref(),
        exterior: solved.around.as_ref().map(Around::summary).or_else(|| exterior_summary(scene, solved)),
        bodies: bodies(scene, solved, estimate),
        interfaces,
        reach,
    }
}

/// The residual estimator of the solution, that of stabilised multipliers or the other one; none for a mesh without residuals.
fn estimators(scene: &Scene, solved: &Solved, estimate: Option<&Estimate>) -> Estimators {
    let known = estimate.filter(|estimate| !estimate.residuals.is_empty());
    let own = known.map(|estimate| estimator(&estimate.residuals, solved));
    match scene.method.multiplier {
        Multiplier::Biorthogonal => Estimators { contact: own, ..Estimators::default() },
        Multiplier::Stabilised => Estimators { stabilised: own, ..Estimators::default() },
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

/// The behaviour of an unbounded medium with a boundary of its own far away; none without one.
fn exterior_summary(scene: &Scene, solved: &Solved) -> Option<MediumSummary> {
    let parts = scene.problem.outline.bodies().len();
    let (body, radiation) = (0..parts).find_map(|body| Some((body, scene.problem.radiation(body)?)))?;
    let Solved { mesh, space, field, .. } = solved;
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
        constant: field.of_piece(body).at_infinity(),
        length: mesh.part(field.elements(body)).diameter(),
    })
}
