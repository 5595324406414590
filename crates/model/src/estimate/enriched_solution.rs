//! The solution u₊ of the enriched spaces at the contact sets of u, with the data that u misses, and its field inside of bodies.
//!
//! ```text
//! S₊ u₊ = f₊,    u₊ = u + β + e:    β the bubbles of w = g - I_p g and u_D - I_p u_D,    S₊ e = r - S₊ β
//! ```
//! A number J of a solution, such as a displacement or a stress at a point, is J(u₊) with the traction that belongs to u₊. The force of
//! a side changes by ⟨S₊u₊ - S₊u, 1⟩ there, the sum over its nodes.

use std::collections::BTreeSet;

use steklov_bem_operators::{BoundaryField, Enriched, Inside, Raised};
use steklov_contact::{ContactBubble, Tip};
use steklov_coupling::MediumField;
use steklov_elastic::RigidMotion;
use steklov_elastic::plane::{dot, minus};
use steklov_problem::{Condition, NamedQuantity, Scene};

use crate::answer::interfaces::{force_of, sign_of};
use crate::answer::largest_stress::{is_bounded, largest_von_mises};
use crate::contact_length::length_of_contact;
use crate::data::body_load::Particulars;
use crate::data::on_mesh::OnMesh;
use crate::data::parts::Assembled;
use crate::data::springs::Springs;
use crate::error::SolveError;
use crate::estimate::contact_ends::ContactEnd;
use crate::estimate::dual::{Duals, LeftOver};
use crate::estimate::elastic::Elastic;
use crate::estimate::enriched_problem::{ENOUGH_FOR_QUANTITIES, Frame};
use crate::estimate::functionals::{LinearFunctional, OfEnergy, has_duals};
use crate::estimate::reaction_work::{has_friction_work, has_reaction_work};
use crate::estimate::strain_of_bodies::{has_strain_of_bodies, strain_of_bodies, work_on_jump};
use crate::quantities::{self, At, EstimatedQuantity, has_largest_stress};
use crate::reacting::{shared, works_alone};
use crate::solve::body::{Body, Factors};
use crate::solve::contact_rows::contact_rows;
use crate::solve::fields::{ElasticField, Field};
use crate::solve::free_bodies::Normalised;
use crate::solve::solution::Solved;

/// The quantities of a scene in their order, J(u), J(u₊) and dual weighted residuals, and the ends of contact at `tips`; empty where none are
/// asked for.
///
/// # Errors
/// Data that are not finite.
pub(crate) fn both(
    (data, tips): (&OnMesh<'_>, &[Tip]),
    solved: &Solved,
    factors: &Factors,
    duals: &Duals<'_>,
    bubbles: &[ContactBubble],
    right: &Enriched,
) -> Result<(Vec<EstimatedQuantity>, Vec<ContactEnd>), SolveError> {
    let (scene, &Duals { body, system, .. }) = (data.scene, duals);
    if !is_asked(scene, solved) {
        return Ok((Vec::new(), Vec::new()));
    }
    let solution = EnrichedSolution::new(data, (solved, factors), duals, bubbles, right)?;
    let EnrichedSolution { correction, change, missed, of_jump, field, around, rest } = &solution;
    let plus = field.as_ref().map(|field| ElasticField { field, ..solved.elastic_field() });
    let corrections = [&correction.base[..], &correction.extra].concat();
    let changes = Changes { forces: change, springs: system.springs, corrections: &corrections };
    let mut both = at_points(scene, solved, plus.as_ref(), around.as_ref());
    let fields = plus.as_ref().map(|plus| [solved.elastic_field(), *plus]);
    both.extend(forces(data, solved, &changes, fields.as_ref()));
    if let Some(fields) = &fields {
        let works = data.works_with(&solved.works, &changes, fields);
        both.extend(pairs(data.named(&fields[0], &solved.works), data.named(&fields[1], &works)));
    }
    let most_pressed = |peak| data.most_pressed(plus.as_ref()?, |side| quantities::is_of_peak(scene, peak, side));
    let peaks: Vec<Option<(usize, f64)>> = quantities::peaks(scene).into_iter().map(most_pressed).collect();
    for &peak in &peaks {
        let at = |field: &ElasticField<'_>| peak.map_or(f64::NAN, |place| data.pressure_on(field, place));
        both.push([at(&solved.elastic_field()), plus.as_ref().map_or(f64::NAN, at)]);
    }
    let mut ends = Vec::new();
    if let (Some(part), Some(plus)) = (&factors.contact, &plus) {
        ends = data.contact_ends(tips, part, [&solved.elastic_field(), plus]);
    }
    both.extend(length_of_contact(scene, tips, &ends));
    let nonconformity = plus
        .map(|plus| data.nonconformity(&body.joints, plus, bubbles).and(data.nonconformity_of_sides(plus, bubbles)));
    let left = plus.zip(nonconformity.as_ref().filter(|left| left.is_there()));
    // others still tell what frozen sets make of displacements that do not agree
    let with_duals = has_duals(scene, tips, &ends);
    let reversals = solved.contact.as_ref().map_or(Vec::new(), |contact| data.slip_reversals(solved, contact));
    let is_weighed = with_duals || left.is_some() || !reversals.is_empty();
    let left = LeftOver { rest, missed, nonconformity: left, reversals: &reversals };
    let mut functionals =
        if is_weighed { data.functionals(solved, (field.as_ref(), around.as_ref()), &peaks) } else { Vec::new() };
    functionals.resize(both.len(), None);
    let of_energies = energies((data, solved, factors), duals, bubbles, (correction, &changes), of_jump.as_ref())?;
    for (values, slope) in of_energies {
        both.push(values);
        functionals.push(slope.filter(|_| is_weighed));
    }
    if has_largest_stress(scene) {
        let largest = plus.as_ref().and_then(|plus| largest_stress(scene, solved, plus));
        both.push(largest.map_or([f64::NAN; 2], |(own, _)| own));
        let known = largest.filter(|_| is_weighed).zip(field.as_ref());
        functionals.push(known.and_then(|((_, x), field)| data.of_von_mises(solved, (field, around.as_ref()), x)));
    }
    let all = both.iter().zip(functionals).map(|(&[value, enriched], functional)| {
        let weighted = functional.and_then(|functional| duals.weighted(&functional, left, &ends));
        let of_rest = weighted.as_ref().map_or(0.0, |weighted| weighted.of_rest);
        EstimatedQuantity {
            value,
            enriched: enriched + of_rest,
            weighted: weighted.filter(|_| with_duals).map(|weighted| [weighted.sum, weighted.of_ends]),
        }
    });
    Ok((all.collect(), ends))
}

/// u₊ of a solved mesh.
struct EnrichedSolution {
    /// u₊ - u, on nodes and bubbles.
    correction: Enriched,
    /// S₊u₊ - S u on the nodes.
    change: Vec<f64>,
    /// What u₊ leaves of the load on the nodes.
    rest: Vec<f64>,
    /// β on the bubbles.
    missed: Vec<f64>,
    /// The number of a medium and the bubbles of the jump between it and a body.
    of_jump: Option<(usize, Vec<f64>)>,
    /// The field in the bodies, and in the medium around one; None without tractions.
    field: Option<Field>,
    around: Option<MediumField>,
}

impl EnrichedSolution {
    fn new(
        data: &OnMesh<'_>,
        (solved, factors): (&Solved, &Factors),
        &Duals { body, system, ref normalised, .. }: &Duals<'_>,
        bubbles: &[ContactBubble],
        right: &Enriched,
    ) -> Result<Self, SolveError> {
        let missed =
            Enriched { base: vec![0.0; right.base.len()], extra: missed(data, solved, system.frames, bubbles)? };
        let mut residual = right.clone();
        let medium = system.elastic.medium(body);
        let of_jump = medium.map(|medium| Ok::<_, SolveError>((medium, data.missed_of_jump()?))).transpose()?;
        if let Some((medium, bubbles)) = &of_jump {
            residual.add(1.0, &system.elastic.forces_of_medium(*medium, bubbles));
        }
        if missed.extra.iter().any(|bubble| *bubble != 0.0) {
            residual.add(-1.0, &system.multiply(&missed));
        }
        let (_, mut correction, rest) = system.correction(&residual, ENOUGH_FOR_QUANTITIES);
        correction.add(1.0, &missed);
        for Normalised { motion, on_nodes, on_bubbles } in normalised {
            let of = |m: &[f64], u: &[f64]| m.iter().zip(u).map(|(m, u)| m * u).sum::<f64>();
            let part = of(on_nodes, &correction.base) + of(on_bubbles, &correction.extra);
            correction.base.iter_mut().zip(motion).for_each(|(u, r)| *u -= part * r);
        }
        let mut change = system.multiply(&correction).base;
        change.iter_mut().zip(&right.base).for_each(|(force, r)| *force -= r);
        let field = field(body, (solved, factors), system.elastic, &correction);
        let around =
            of_jump.as_ref().and_then(|(_, jump)| medium_field(body, factors, system.elastic, (&correction, jump)));
        Ok(Self { correction, change, rest: rest.base, missed: missed.extra, of_jump, field, around })
    }
}

/// The values of u and of u₊, in pairs.
fn pairs(value: Vec<f64>, plus: Vec<f64>) -> impl Iterator<Item = [f64; 2]> {
    value.into_iter().zip(plus).map(|(value, plus)| [value, plus])
}

/// The numbers at points of u and of u₊, in a body and in a medium around it; none without the field of u₊.
fn at_points(
    scene: &Scene,
    solved: &Solved,
    plus: Option<&ElasticField<'_>>,
    around: Option<&MediumField>,
) -> Vec<[f64; 2]> {
    let Some(plus) = plus else { return Vec::new() };
    let medium = solved.around.as_ref();
    let before = medium.map(|medium| |x: [f64; 2]| medium.at(x));
    let after = medium.zip(around).map(|(medium, field)| {
        |x: [f64; 2]| {
            let Inside { displacement, stress, .. } = field.at(x);
            medium.with_remote(x, displacement, stress)
        }
    });
    let value = quantities::at_points(scene, &solved.elastic_field(), before.as_ref().map(|at| at as &At<'_>));
    pairs(value, quantities::at_points(scene, plus, after.as_ref().map(|at| at as &At<'_>))).collect()
}

/// What the enriched spaces change.
struct Changes<'a> {
    /// The forces at nodes.
    forces: &'a [f64],
    springs: &'a Springs,
    /// The displacements of nodes and bubbles, which springs follow.
    corrections: &'a [f64],
}

impl Changes<'_> {
    /// The change of the force of springs on sides, if there are any.
    fn of_springs(&self, data: &OnMesh<'_>, sides: &[usize]) -> Option<[f64; 2]> {
        let all = self.springs.reactions(data.mesh, data.space, self.corrections);
        let own = all.into_iter().filter(|(side, _)| sides.contains(side)).map(|(_, force)| force);
        own.reduce(|a, b| [a[0] + b[0], a[1] + b[1]])
    }
}

/// The forces of sides and of interfaces between bodies, of u and of u₊.
fn forces(
    data: &OnMesh<'_>,
    solved: &Solved,
    changes: &Changes<'_>,
    fields: Option<&[ElasticField<'_>; 2]>,
) -> Vec<[f64; 2]> {
    let scene = data.scene;
    let with_change = |force: [f64; 2], sign: f64, sides: &[usize]| {
        let of_springs = changes.of_springs(data, sides);
        let gained = of_springs.unwrap_or_else(|| data.change_of_force(sides, changes.forces, fields));
        [0, 1].map(|i| [force[i], force[i] + sign * gained[i]])
    };
    let of_sides = quantities::forces(scene, &solved.reactions).map(|(force, side)| with_change(force, 1.0, &[side]));
    let between = quantities::forces_between(scene)
        .map(|(_, interface)| with_change(force_of(scene, interface, solved), sign_of(interface), &interface.sides));
    of_sides.chain(between).flatten().collect()
}

/// A value of u and of u₊, and its slope where that is known.
type WithSlope = ([f64; 2], Option<LinearFunctional>);

/// The works of reactions and against friction, the strain energies of bodies and that of springs, of u and of u₊, with their slopes where
/// these are known; `of_jump` are the number of a medium and the bubbles of the jump between it and a body.
fn energies(
    (data, solved, factors): (&OnMesh<'_>, &Solved, &Factors),
    duals: &Duals<'_>,
    bubbles: &[ContactBubble],
    (correction, changes): (&Enriched, &Changes<'_>),
    of_jump: Option<&(usize, Vec<f64>)>,
) -> Result<Vec<WithSlope>, SolveError> {
    let scene = data.scene;
    let mut all = Vec::new();
    if has_reaction_work(scene) {
        let of_jump = of_jump.map_or(Ok(None), |(_, jump)| work_on_jump(data, solved, duals, (correction, jump)))?;
        let (works, slope) = match of_jump {
            Some(own) => own,
            None => {
                let prescribed = data.prescribed(solved, duals.body);
                let works = data.reaction_work((solved, factors), bubbles, &prescribed, changes.forces)?;
                (works, LinearFunctional { of_forces: prescribed, ..LinearFunctional::default() })
            }
        };
        all.push((works, Some(slope)));
    }
    if has_friction_work(scene) {
        all.push((data.friction_work((solved, factors), bubbles, correction, changes.forces)?, None));
    }
    if has_strain_of_bodies(scene) {
        let own = strain_of_bodies(data, solved, duals, correction).into_iter();
        all.extend(own.map(|(strain, slope)| (strain, Some(slope))));
    }
    if scene.problem.has_springs() {
        let at = |u: &[f64]| changes.springs.pull(data.space, correction.extra.len() / 2, u);
        let (pull, of_correction) = (at(&solved.displacement), at(changes.corrections));
        let energy = solved.energies.springs;
        let enriched = energy + correction.dot(&pull) + 0.5 * correction.dot(&of_correction);
        let of_energy = Some(OfEnergy { piece: 0, load: pull, top: Vec::new(), of: Vec::new() });
        let slope = LinearFunctional { of_energy, ..LinearFunctional::default() };
        all.push(([energy, enriched], Some(slope)));
    }
    Ok(all)
}

/// The largest von Mises stress of u and that of u₊ at its place, and the place; None where it is infinite, and beside a medium.
fn largest_stress(scene: &Scene, solved: &Solved, plus: &ElasticField<'_>) -> Option<([f64; 2], [f64; 2])> {
    let rows = solved.contact.as_ref().map_or(Vec::new(), |contact| contact_rows(solved.trace(), contact));
    // in a medium it may be larger than in the body
    let known = has_largest_stress(scene) && solved.around.is_none() && is_bounded(scene, &solved.mesh, &rows);
    let largest = known.then(|| largest_von_mises(scene, &solved.elastic_field()))??;
    Some(([largest.value, largest.of(scene, plus)], largest.point))
}

/// Whether quantities are asked for.
fn is_asked(scene: &Scene, solved: &Solved) -> bool {
    let of_forces = quantities::forces(scene, &solved.reactions).next().is_some();
    let of_bodies = quantities::forces_between(scene).next().is_some() || has_strain_of_bodies(scene);
    quantities::needs_tractions(scene) || of_forces || of_bodies || has_reaction_work(scene)
}

/// β, two for each element: along the directions in which the data hold it.
fn missed(
    data: &OnMesh<'_>,
    solved: &Solved,
    frames: &[Frame],
    bubbles: &[ContactBubble],
) -> Result<Vec<f64>, SolveError> {
    let mut missed = vec![0.0; 2 * frames.len()];
    for (e, direction, bubble) in data.missed_bubbles(&solved.particular)? {
        missed[2 * e + direction] += bubble;
    }
    for bubble in bubbles {
        let Frame { directions: [n, _], free } = frames[bubble.element];
        if !free[0] {
            (0..2).for_each(|i| missed[2 * bubble.element + i] += bubble.gap * n[i]);
        }
    }
    Ok(missed)
}

/// The motion that springs carry in u, which the nodal values of an estimate are without.
fn carried_by_springs(solved: &Solved, assembled: &Assembled) -> Option<RigidMotion> {
    assembled.carried.as_ref()?;
    let part = &assembled.piece.part;
    let mut own = part.own(&solved.displacement);
    if let Some(p) = solved.particular.of(part.elements[0]) {
        let nodal = part.space.points.iter().flat_map(|&x| p.displacement(x));
        own.iter_mut().zip(nodal).for_each(|(u, p)| *u -= p);
    }
    assembled.settle(&mut own)
}

/// The field of u₊, by the correction of the displacement; None without tractions.
fn field<'b>(
    body: &'b Body,
    (solved, factors): (&Solved, &Factors),
    elastic: &Elastic<'_>,
    correction: &Enriched,
) -> Option<Field> {
    let nodal: Vec<f64> = factors.homogeneous.iter().zip(&correction.base).map(|(u, e)| u + e).collect();
    let of = |(k, assembled): (usize, &'b Assembled)| {
        let part = &assembled.piece.part;
        let mut own = part.own(&nodal);
        let carried = RigidMotion::sum(assembled.settle(&mut own), carried_by_springs(solved, assembled));
        let motion = assembled.motion(&own);
        if let Some(motion) = &motion {
            own.iter_mut().zip(motion.nodal(&part.space.points)).for_each(|(u, r)| *u -= r);
        }
        let displacement = Enriched { base: own, extra: elastic.bubbles_of(k, &correction.extra) };
        let enriched = elastic.enriched(k);
        let mut traction = enriched.traction(&assembled.traction_map, &displacement)?;
        let constant = enriched.at_infinity(&assembled.traction_map, &displacement, &traction);
        traction.base.iter_mut().chain(&mut traction.extra).for_each(|t| *t *= assembled.modulus);
        let Raised { mesh, space, displacement, traction } =
            Raised::new(&part.mesh, &part.space, &displacement, &traction);
        let field =
            BoundaryField::new(&mesh, &space, &assembled.piece.material, &displacement, &traction, assembled.length);
        Some((part, field.tending_to(constant).moved(RigidMotion::sum(carried, motion))))
    };
    let pieces: Option<Vec<_>> = body.pieces.iter().enumerate().map(of).collect();
    Some(Field::new(pieces?, body.cuts.clone(), body.mesh.len()))
}

/// The field of ξ₊ = u₊ - u0 in the medium around a body, by the correction of the displacement and the bubbles of the jump u0; None
/// without tractions.
fn medium_field(
    body: &Body,
    factors: &Factors,
    elastic: &Elastic<'_>,
    (correction, jump): (&Enriched, &[f64]),
) -> Option<MediumField> {
    let (medium, outside) = (elastic.medium(body)?, body.outside.as_ref()?);
    let sum = |a: &[f64], b: &[f64], factor: f64| a.iter().zip(b).map(|(a, b)| a + factor * b).collect::<Vec<f64>>();
    let displacement = Enriched {
        base: sum(factors.outside.as_ref()?, &correction.base, 1.0),
        extra: sum(&elastic.bubbles_of(medium, &correction.extra), jump, -1.0),
    };
    let enriched = elastic.enriched(medium);
    let traction = enriched.traction(&outside.traction_map, &displacement)?;
    let constant = enriched.at_infinity(&outside.traction_map, &displacement, &traction);
    let Raised { mesh, space, displacement, traction } = Raised::new(&body.mesh, &body.space, &displacement, &traction);
    let of = (&displacement[..], &traction[..], constant);
    Some(MediumField::new(&mesh, &space, &outside.material, outside.length, of))
}

impl OnMesh<'_> {
    /// The nodes of a side.
    pub(crate) fn nodes_of(&self, side: usize) -> BTreeSet<usize> {
        self.elements_of(side).flat_map(|e| self.space.element_nodes(e)).collect()
    }

    /// The change of the force of sides by that of the nodal forces; of components of which other sides have a part at a corner by that of the
    /// tractions between two fields, NaN without them.
    fn change_of_force(&self, sides: &[usize], change: &[f64], fields: Option<&[ElasticField<'_>; 2]>) -> [f64; 2] {
        let (on_sides, shared) = (self.on_sides(sides, |_| [1.0; 2]), shared(self.scene, sides));
        let of_tractions = |i: usize| {
            let along = |_| [0, 1].map(|k| f64::from(u8::from(i == k)));
            fields.map_or(f64::NAN, |fields| self.change_of_tractions(fields, sides, along))
        };
        let of_nodes = |i: usize| on_sides.chunks_exact(2).zip(change.chunks_exact(2)).map(|(w, f)| w[i] * f[i]).sum();
        [0, 1].map(|i| if shared[i] { of_tractions(i) } else { of_nodes(i) })
    }

    /// ∫ w·(t₊ - t) over sides, of the tractions of two fields.
    fn change_of_tractions(
        &self,
        [field, plus]: &[ElasticField<'_>; 2],
        sides: &[usize],
        w: impl Fn([f64; 2]) -> [f64; 2],
    ) -> f64 {
        let mut work = 0.0;
        for e in sides.iter().flat_map(|&side| self.elements_of(side)) {
            self.integrate(e, |t, ds| {
                let (own, more) = (field.traction(e, t), plus.traction(e, t));
                work += ds * dot(w(self.mesh.point(e, t)), minus(more, own));
            });
        }
        work
    }

    /// The moments and weighted forces of u₊.
    fn works_with(&self, works: &[f64], changes: &Changes<'_>, fields: &[ElasticField<'_>; 2]) -> Vec<f64> {
        let Changes { forces, springs, corrections } = *changes;
        let mut works = works.iter().copied();
        let with = |quantity: &NamedQuantity| {
            let (side, w) = quantity.kind.weighted_side()?;
            let work = works.next()?;
            if !self.is_balanced(side) {
                return Some(work);
            }
            let of_nodes = || self.on_sides(&[side], &w).iter().zip(forces).map(|(w, f)| w * f).sum();
            let gained: f64 = if self.scene.problem.sides[side].springs.is_some() {
                springs.work(self, corrections, side, &w)
            } else if works_alone(self.scene, side, &w) {
                of_nodes()
            } else {
                self.change_of_tractions(fields, &[side], &w)
            };
            Some(work + gained)
        };
        self.scene.quantities.iter().filter_map(with).collect()
    }

    /// The coefficients of the bubbles in held displacements less their interpolants: element, component, value.
    fn missed_bubbles(&self, particular: &Particulars) -> Result<Vec<(usize, usize, f64)>, SolveError> {
        let mut found = Vec::new();
        for (index, side) in self.scene.problem.sides.iter().enumerate() {
            let Condition::Displacement { values, .. } = &side.condition else { continue };
            let body = self.particular_of_side(particular, index);
            for (component, expression) in values.iter().enumerate() {
                let Some(expression) = expression else { continue };
                if expression.constant().is_some() && body.is_none() {
                    continue;
                }
                let direction = if component == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
                let function = self.less_particular(expression, body, |_| direction);
                for e in (0..self.mesh.len()).filter(|&e| self.mesh.side[e] == index) {
                    let bubble = steklov_contact::missed(self.mesh, self.space, e, &function.datum("displacement"))?;
                    found.push((e, component, bubble));
                }
            }
        }
        Ok(found)
    }
}
