//! The quantities of a scene as linear functionals J(u, ψ), in the order of their values.
//!
//! A force or moment by balance is Σ w·(Su - f) over nodes: its dual solution is the displacement that is w where something holds the body.
//! A length of contact has no functional here.

use steklov_bem_operators::{Enriched, Functional, Location, Trace};
use steklov_contact::Tip;
use steklov_coupling::MediumField;
use steklov_problem::{Friction, QuantityKind, Scene, Surfaces};

use crate::answer::probes::{invariants, slopes};
use crate::contact_length::extracts_ends;
use crate::data::on_mesh::OnMesh;
use crate::estimate::contact_ends::ContactEnd;
use crate::named::elements_at;
use crate::quantities;
use crate::reacting::{reacting, shared, works_alone};
use crate::solve::fields::Field;
use crate::solve::solution::Solved;

/// A linear functional of the solution of all bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct LinearFunctional {
    /// Of the fields of pieces: the number of the piece, and the functional.
    pub(crate) of_fields: Vec<(usize, Functional)>,
    /// w, two for each node; empty for none.
    pub(crate) of_forces: Vec<f64>,
    /// Of the displacements and bubbles of all, and of the top tractions of a piece.
    pub(crate) of_energy: Option<OfEnergy>,
    /// The traces that it weighs: element, reference coordinate, weights.
    pub(crate) traces: Vec<(usize, f64, Trace)>,
}

/// The slope of an energy.
#[derive(Debug, Clone)]
pub(crate) struct OfEnergy {
    /// The number of the piece.
    pub(crate) piece: usize,
    /// The load on nodes and bubbles of all.
    pub(crate) load: Enriched,
    /// The load on its top tractions.
    pub(crate) top: Vec<f64>,
    /// The nodal displacement of the piece whose forces the load is; empty if it is that of springs.
    pub(crate) of: Vec<f64>,
}

/// A trace of weights that are zero.
const NOTHING: Trace = Trace { displacement: [0.0; 2], traction: [0.0; 2], stress: [0.0; 3] };

impl LinearFunctional {
    fn part(&mut self, field: &Field, piece: usize) -> &mut Functional {
        let known = self.of_fields.iter().position(|(own, _)| *own == piece);
        let k = known.unwrap_or_else(|| {
            self.of_fields.push((piece, Functional::zero(field.of_piece(piece).elements())));
            self.of_fields.len() - 1
        });
        &mut self.of_fields[k].1
    }

    /// Adds the trace at the reference coordinate t of element e, times these weights.
    fn add(&mut self, field: &Field, (e, t): (usize, f64), by: &Trace) {
        self.traces.push((e, t, *by));
        let (piece, local) = field.place(e);
        self.part(field, piece).add_trace(field.of_piece(piece), (local, t), by);
    }
}

impl OnMesh<'_> {
    /// The functionals of all quantities, for fields of the degrees of `field`, without one those of forces alone; None for those that have
    /// none. The pressures are largest at `peaks`.
    pub(crate) fn functionals(
        &self,
        solved: &Solved,
        (field, around): (Option<&Field>, Option<&MediumField>),
        peaks: &[Option<(usize, f64)>],
    ) -> Vec<Option<LinearFunctional>> {
        let scene = self.scene;
        let along = |i: usize| [0, 1].map(|k| f64::from(u8::from(i == k)));
        let forces = quantities::forces(scene, &solved.reactions);
        let forces = forces.map(|(_, side)| vec![side]);
        let between = quantities::forces_between(scene).map(|(_, interface)| interface.sides.clone());
        // how much of a corner is whose is known to no dual problem; the forces of springs are no forces at nodes
        let of_sides = |sides: Vec<usize>| {
            let shared = shared(scene, &sides);
            let sprung = sides.iter().any(|&side| scene.problem.sides[side].springs.is_some());
            [0, 1].map(|i| (!shared[i] && !sprung).then(|| self.of_forces(&sides, |_| along(i))))
        };
        let forces = forces.chain(between).flat_map(of_sides);
        let Some(field) = field else { return forces.collect() };
        let mut all: Vec<Option<LinearFunctional>> = Vec::new();
        for &x in &scene.probe {
            match self.touches(x) {
                true => all.extend([const { None }; 8]),
                false => all.extend(self.at_point(solved, (field, around), x).map(Some)),
            }
        }
        all.extend(forces);
        for quantity in &scene.quantities {
            match quantity.kind {
                QuantityKind::PressureAt(x) => {
                    let place = scene.problem.pressed_at(x).ok();
                    all.push(place.map(|place| self.of_pressure(field, place)));
                }
                QuantityKind::MeanDisplacement(side) => all.extend(self.of_mean(field, side).map(Some)),
                QuantityKind::Moment { .. } | QuantityKind::WeightedForce { .. } => {
                    let balanced = quantity.kind.weighted_side();
                    let balanced = balanced.filter(|(side, w)| self.has_dual(*side) && works_alone(scene, *side, w));
                    all.push(balanced.map(|(side, w)| self.of_forces(&[side], w)));
                }
                QuantityKind::OpeningAt(x) => all.push(self.of_opening(field, x)),
            }
        }
        all.extend(peaks.iter().map(|peak| peak.map(|place| self.of_pressure(field, place))));
        all.extend(extracts_ends(scene).then_some(None));
        all
    }

    /// Whether a weighted force of a side is one of forces at nodes.
    fn has_dual(&self, side: usize) -> bool {
        self.is_balanced(side) && self.scene.problem.sides[side].springs.is_none()
    }

    /// Whether a point is on a side in contact: its displacement is the gap there, of which the spaces see polynomials alone.
    fn touches(&self, x: [f64; 2]) -> bool {
        let problem = &self.scene.problem;
        match problem.outline.contains(x) {
            Location::Boundary { edge, .. } => problem.contact(problem.outline.edges()[edge].side).is_some(),
            _ => false,
        }
    }

    /// Displacement, stress and the slopes of its invariants at a point.
    fn at_point(
        &self,
        solved: &Solved,
        (field, around): (&Field, Option<&MediumField>),
        x: [f64; 2],
    ) -> [LinearFunctional; 8] {
        let outline = &self.scene.problem.outline;
        let of_invariants = slopes(solved.probe(self.scene, x).stress, |stress| invariants(self.scene, x, stress));
        // weights of displacement and stress
        let unit = |k: usize| std::array::from_fn(|i| f64::from(u8::from(i == k)));
        let of_stress = |[xx, yy, xy]: [f64; 3]| [0.0, 0.0, xx, yy, xy];
        let weights: [[f64; 5]; 8] =
            std::array::from_fn(|k| if k < 5 { unit(k) } else { of_stress(of_invariants[k - 5]) });
        let mut all = [(); 8].map(|()| LinearFunctional::default());
        if let Location::Boundary { edge, s } = outline.contains(x) {
            let at = elements_at(self.mesh, edge, s);
            for (functional, weights) in all.iter_mut().zip(&weights) {
                let [u, v, xx, yy, xy] = weights.map(|w| w / at.len() as f64);
                let by = Trace { displacement: [u, v], stress: [xx, yy, xy], ..NOTHING };
                at.iter().for_each(|&place| functional.add(field, place, &by));
            }
            return all;
        }
        let (piece, own) = match (outline.contains(x), around) {
            // behind the bodies
            (Location::Outside, Some(around)) => (self.scene.problem.outline.bodies().len(), around.functionals_at(x)),
            _ => {
                let piece = field.piece_at(outline.body_at(x).unwrap_or(0), x);
                (piece, field.of_piece(piece).functionals_inside(x))
            }
        };
        for (functional, weights) in all.iter_mut().zip(&weights) {
            functional.of_fields.push((piece, Functional::sum(&own, weights)));
        }
        all
    }

    /// The von Mises stress at a point; None on a side in contact.
    pub(crate) fn of_von_mises(
        &self,
        solved: &Solved,
        (field, around): (&Field, Option<&MediumField>),
        x: [f64; 2],
    ) -> Option<LinearFunctional> {
        if self.touches(x) { None } else { self.at_point(solved, (field, around), x).into_iter().nth(5) }
    }

    /// Σ w·R over the nodes of sides.
    fn of_forces(&self, sides: &[usize], w: impl Fn([f64; 2]) -> [f64; 2]) -> LinearFunctional {
        LinearFunctional { of_forces: self.on_sides(sides, w), ..LinearFunctional::default() }
    }

    /// w at the nodes of sides, in the components in which each side reacts, two for each node; else zero.
    pub(crate) fn on_sides(&self, sides: &[usize], w: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
        let mut at_nodes = vec![0.0; self.space.dofs()];
        for &side in sides {
            let reacts = reacting(self.scene, side);
            for node in self.nodes_of(side) {
                let w = w(self.space.points[node]);
                (0..2).filter(|&i| reacts[i]).for_each(|i| at_nodes[2 * node + i] = w[i]);
            }
        }
        at_nodes
    }

    fn of_pressure(&self, field: &Field, (edge, s): (usize, f64)) -> LinearFunctional {
        let at = elements_at(self.mesh, edge, s);
        let mut functional = LinearFunctional::default();
        for &(e, t) in &at {
            let traction = self.mesh.normal(e, t).map(|n| -n / at.len() as f64);
            functional.add(field, (e, t), &Trace { traction, ..NOTHING });
        }
        functional
    }

    fn of_mean(&self, field: &Field, side: usize) -> [LinearFunctional; 2] {
        let mut both = [(); 2].map(|()| LinearFunctional::default());
        let length: f64 = self.elements_of(side).map(|e| self.mesh.length(e)).sum();
        for e in self.elements_of(side) {
            self.integrate(e, |t, ds| {
                for (i, functional) in both.iter_mut().enumerate() {
                    let mut by = NOTHING;
                    by.displacement[i] = ds / length;
                    functional.add(field, (e, t), &by);
                }
            });
        }
        both
    }

    fn of_opening(&self, field: &Field, x: [f64; 2]) -> Option<LinearFunctional> {
        let mut functional = LinearFunctional::default();
        let mut add = |(edge, s): (usize, f64), displacement: [f64; 2]| {
            let at = elements_at(self.mesh, edge, s);
            let displacement = displacement.map(|d| d / at.len() as f64);
            at.iter().for_each(|&at| functional.add(field, at, &Trace { displacement, ..NOTHING }));
        };
        match self.scene.problem.surfaces_at(x)? {
            Surfaces::Faces([a, b]) => {
                let n = self.scene.problem.outline.edges()[a.0].normal(a.1);
                add(b, n);
                add(a, n.map(|n| -n));
            }
            Surfaces::Contact(edge, s) => {
                let &(e, t) = elements_at(self.mesh, edge, s).first()?;
                let d = self.direction(e, t);
                add((edge, s), d.map(|d| -d));
                if let Some(seen) = self.seen(e, t) {
                    add((seen.edge, seen.s), d);
                }
            }
        }
        Some(functional)
    }
}

/// Whether the dual problems at frozen contact sets tell the errors: without friction, whose ends of stick change them, and where all ends of
/// contact were extracted.
pub(crate) fn has_duals(scene: &Scene, tips: &[Tip], ends: &[ContactEnd]) -> bool {
    let smooth = scene.contacts().all(|(_, contact)| matches!(contact.friction, Friction::None));
    smooth && ends.len() == tips.len()
}
