//! From the estimate of one mesh to the next mesh.

use steklov_bem_operators::{Grading, Mark, Mesh, Piece, SAME_PLACE, Shape, Subdivision, doerfler, legendre_decay};
use steklov_contact::{Decided, Located, Tip, relocate, unlocated};
use steklov_elastic::plane;
use steklov_expression::Turn;
use steklov_problem::{Refine, Scene};

use crate::doubt::Doubt;
use crate::error::SolveError;
use crate::estimate::error_estimate::{Bubble, Estimate};
use crate::estimate::multiplier_difference::{limited_by_multipliers, multiplier_indicators};
use crate::estimate::penetration::Unseen;
use crate::mesh::automatic_cuts::is_smooth;
use crate::mesh::first_mesh::{coarse_elements, singular_points};
use crate::mesh::layout::Layout;
use crate::refine::asperities::{Cuts, MARKED, cut_at_turns, gap_turns, obstacles, part_to_mark};
use crate::refine::transitions::unlocated_energy;
use crate::refine::translates::join_marks;
use crate::solve::body::Factors;
use crate::solve::solution::Solved;

/// Degree from which the decay of Legendre coefficients tells whether a solution is smooth.
const TELLING: usize = 4;
/// The same on cuts, which are far from all singular points that are known.
const TELLING_ON_CUTS: usize = 8;
/// Degree from which an element whose data are not resolved is halved.
const RESOLVING: usize = 3;

/// The elements with more than a small part of the loads that degrees do not resolve.
fn unresolved_loads(unresolved: &[f64]) -> Vec<usize> {
    let total: f64 = unresolved.iter().sum();
    (0..unresolved.len()).filter(|&e| unresolved[e] > 0.01 * total).collect()
}

/// An element of a cut.
struct OnCut {
    /// Squared indicator.
    squared: f64,
    /// How fast the Legendre coefficients of the displacement decay.
    decay: Option<f64>,
    degree: usize,
}

/// The data of a solved mesh for marking its elements.
struct Marking<'a> {
    scene: &'a Scene,
    solved: &'a Solved,
    /// The contact problem with its solution, where there is one.
    state: Option<steklov_contact::Solved<'a>>,
    estimate: Option<&'a Estimate>,
    /// Squared indicators of the elements, those of their multipliers included.
    squared: Vec<f64>,
    /// The part of the multipliers.
    apart: Vec<f64>,
    /// Elements whose loads are not resolved.
    unresolved: Vec<usize>,
    /// Whether the degrees that elements lack are foreseen, several at a time.
    foresees: bool,
    /// The elements of cuts.
    on_cuts: Vec<OnCut>,
}

impl<'a> Marking<'a> {
    fn new(
        scene: &'a Scene,
        layout: &Layout,
        solved: &'a Solved,
        factors: &'a Factors,
        estimate: Option<&'a Estimate>,
        unseen: &Unseen,
        decided: Option<&'a Decided>,
    ) -> Self {
        let state = match (&solved.contact, &factors.contact, decided) {
            (Some(contact), Some(part), Some(decided)) => Some(part.solved(&contact.solution, decided)),
            _ => None,
        };
        let mut squared = estimate.map_or(vec![0.0; solved.mesh.len()], |e| e.squared(scene.method.indicator));
        let apart = multiplier_indicators(solved, factors.difference);
        squared.iter_mut().zip(&apart).for_each(|(all, part)| *all += part);
        let unresolved = match estimate {
            Some(estimate) if estimate.doubts.contains(&Doubt::Data) => unresolved_loads(&unseen.unresolved),
            _ => Vec::new(),
        };
        let of_cuts = estimate.iter().flat_map(|estimate| &estimate.of_cuts).map(Bubble::total);
        let pieces = layout.cuts.iter().flat_map(|cuts| cuts.elements.iter().flatten());
        let on_cuts = of_cuts
            .zip(factors.decay_on_cuts.iter().zip(pieces))
            .map(|(squared, (&decay, piece))| OnCut { squared, decay, degree: piece.degree })
            .collect();
        let foresees = is_smooth(scene);
        Self { scene, solved, state, estimate, squared, apart, unresolved, foresees, on_cuts }
    }

    /// How fast the Legendre coefficients of the solution on an element decay.
    fn decay(&self, e: usize) -> Option<f64> {
        legendre_decay(&self.solved.mesh, &self.solved.space, e, &self.solved.displacement)
    }

    /// The marks of all elements, those of cuts last, with a part of the squared indicators.
    fn marked(&self, part: f64) -> Vec<Option<f64>> {
        let all: Vec<f64> = self.squared.iter().copied().chain(self.on_cuts.iter().map(|e| e.squared)).collect();
        doerfler(&all, self.scene.method.marking.unwrap_or(part))
    }

    /// The marks of the elements of cuts: these are halved where the displacement is not smooth.
    fn marks_on_cuts(&self, part: f64) -> Vec<Mark> {
        let marked = self.marked(part);
        let number = marked.iter().flatten().count();
        let mark = |(excess, on_cut): (&Option<f64>, &OnCut)| {
            let Some(excess) = *excess else { return Mark::Keep };
            let unsmooth = on_cut.decay.is_some_and(|decay| decay > self.scene.method.smoothness);
            let rough = unsmooth && (on_cut.degree >= TELLING_ON_CUTS || !self.foresees);
            let mut mark = Mark::refine(rough, excess);
            let lacking = || self.lacking_degrees(on_cut.squared, on_cut.decay, on_cut.degree, number);
            if let (Mark::Refine { rough: false, degrees, .. }, Some(lacking)) =
                (&mut mark, self.foresees.then(lacking).flatten())
            {
                *degrees = lacking;
            }
            mark
        };
        marked[self.squared.len()..].iter().zip(&self.on_cuts).map(mark).collect()
    }

    /// The elements with a part of the squared indicators, and those with unresolved loads.
    fn marks(&self, part: f64, rough: &dyn Fn(usize) -> bool) -> Vec<Mark> {
        let method = &self.scene.method;
        let mut marked = self.marked(part);
        marked.truncate(self.squared.len());
        let limited = |e: usize| limited_by_multipliers(self.scene, self.apart[e], self.squared[e]);
        let mark = |(e, excess): (usize, Option<f64>)| match excess {
            None => Mark::Keep,
            Some(excess) if method.refine == Refine::Hp => Mark::refine(rough(e) || limited(e), excess),
            Some(_) => Mark::refine(rough(e) || limited(e), 1.0), // one cut or degree at a time
        };
        let mut marks: Vec<Mark> = marked.into_iter().enumerate().map(mark).collect();
        for &e in &self.unresolved {
            if marks[e] == Mark::Keep {
                marks[e] = Mark::refine(rough(e), 1.0);
            }
        }
        marks
    }

    /// Whether an element is halved by the hp strategy rather than raised, away from singular points.
    fn rough(&self, e: usize) -> bool {
        let degree = self.solved.mesh.degree[e];
        let unsmooth = || self.decay(e).is_some_and(|d| d > self.scene.method.smoothness);
        degree >= TELLING && unsmooth() || degree >= RESOLVING && (self.unresolved.contains(&e) || self.oscillates(e))
    }

    fn is_curved(&self) -> bool {
        self.solved.mesh.shape.iter().any(|s| *s != Shape::Line)
    }

    /// Number of degrees that an element lacks until its squared error is its share of half of the tolerated one, from the decay of its
    /// coefficients; at least one. In a smooth scene the `marked` elements share, and an element gets at most its degree; else all
    /// elements, and it gets half of that. Only for meshes with curves, which degrees alone resolve: beside corners of straight
    /// sides layers do this, and the error of the next element changes with each of them.
    fn lacking_degrees(&self, squared: f64, decay: Option<f64>, degree: usize, marked: usize) -> Option<usize> {
        let decay = decay.filter(|&decay| decay < 1.0)?;
        if !self.is_curved() || degree < TELLING {
            return None;
        }
        let (sharing, most) = match self.foresees {
            true => (marked, degree),
            false => (self.squared.len() + self.on_cuts.len(), degree / 2),
        };
        let whole = self.squared.iter().chain(self.on_cuts.iter().map(|e| &e.squared)).sum::<f64>();
        let excess = squared / whole / (0.5 * self.tolerated()? / sharing as f64);
        let lacking = (0.5 * excess.ln() / -decay.ln()).ceil();
        Some((lacking as usize).clamp(1, most))
    }

    /// The tolerated squared error over the estimated one.
    fn tolerated(&self) -> Option<f64> {
        Some((self.scene.method.tolerance() / self.estimate?.relative).powi(2))
    }

    /// Whether most of an element's indicator is that of its data.
    fn oscillates(&self, e: usize) -> bool {
        let of = |bubble: &Bubble| bubble.oscillation > 0.5 * bubble.total();
        self.estimate.is_some_and(|all| of(&all.indicators[e]))
    }

    /// The same for the element that begins at or contains the start of a piece of an edge.
    fn oscillates_at(&self, edge: usize, piece: &Piece) -> bool {
        let mesh = &self.solved.mesh;
        let inside = |e: &usize| {
            let [a, b] = mesh.span[*e];
            mesh.edge[*e] == edge && a.min(b) <= piece.start && piece.start < a.max(b)
        };
        (0..mesh.len()).find(inside).is_some_and(|e| self.oscillates(e))
    }

    /// The marks of the hp strategy: all of the error except a small part, and all elements too coarse to show their own.
    fn of_hp(
        &self,
        tips: &[Tip],
        singular: &[Vec<f64>],
        turns: &[Vec<Turn>],
    ) -> Result<(Vec<Mark>, Vec<Mark>), SolveError> {
        let mesh = &self.solved.mesh;
        // on curves the elements left alone have at most half of the tolerated squared error
        let tolerated = self.tolerated().filter(|&part| part < 1.0 && self.is_curved());
        let mut part = match tolerated {
            Some(part) if self.foresees => 1.0 - 0.5 * part,
            Some(part) => MARKED.min(1.0 - 0.5 * part),
            None => MARKED,
        };
        if let (Some(state), true) = (self.state, turns.iter().flatten().any(|t| t.maximum)) {
            let mut whole = Subdivision::new(mesh, &vec![Mark::Keep; mesh.len()]);
            let located = relocate(&mut tips.to_vec(), &mut whole, state, singular, (&obstacles(turns), &[]))?;
            let goal = self.estimate.map_or(0.0, |all| self.scene.method.tolerance() / all.relative);
            part = part_to_mark(&self.squared, &located, unlocated_energy(self.scene, &located), goal);
        }
        let mut marks = self.marks(part, &|e| self.rough(e));
        let number = self.marked(part).iter().flatten().count();
        for (e, mark) in marks.iter_mut().enumerate().filter(|(e, _)| !self.unresolved.contains(e)) {
            if let (Mark::Refine { rough: false, degrees, .. }, Some(lacking)) =
                (mark, self.lacking_degrees(self.squared[e], self.decay(e), mesh.degree[e], number))
            {
                *degrees = lacking;
            }
        }
        let lopsided = match (self.scene.problem.has_several_bodies(), self.is_curved()) {
            (true, _) => lopsided_elements(mesh, singular, LOPSIDED_BODIES),
            (false, true) => lopsided_elements(mesh, singular, LOPSIDED),
            (false, false) => Vec::new(),
        };
        for e in lopsided {
            if marks[e] == Mark::Keep {
                marks[e] = Mark::refine(true, 1.0);
            }
        }
        for e in coarse_elements(mesh, singular) {
            if marks[e] == Mark::Keep {
                marks[e] = Mark::refine(true, 1.0);
            }
        }
        Ok((marks, self.marks_on_cuts(part)))
    }
}

/// Elements at a singular point that are longer than `ratio` times another one there, of the same body or of one that it faces: by
/// chance the one bubble of an element of low degree may show nothing of the error there, and bodies whose meshes are not
/// both graded to the end of an interface are together in the mean over too long a part of it.
fn lopsided_elements(mesh: &Mesh, singular: &[Vec<f64>], ratio: f64) -> Vec<usize> {
    let at = |e: usize, s: f64| singular[mesh.edge[e]].iter().any(|p| (p - s).abs() < SAME_PLACE);
    let near = 1e-9 * mesh.diameter();
    // point, shortest length, elements
    let mut points: Vec<([f64; 2], f64, Vec<usize>)> = Vec::new();
    for e in 0..mesh.len() {
        for (x, _) in mesh.ends(e).into_iter().zip(mesh.span[e]).filter(|(_, s)| at(e, *s)) {
            let length = mesh.length(e);
            match points.iter_mut().find(|(y, ..)| plane::distance(*y, x) <= near) {
                Some((_, shortest, elements)) => {
                    *shortest = shortest.min(length);
                    elements.push(e);
                }
                None => points.push((x, length, vec![e])),
            }
        }
    }
    let long = |(_, shortest, elements): ([f64; 2], f64, Vec<usize>)| {
        elements.into_iter().filter(move |&e| mesh.length(e) > ratio * shortest)
    };
    points.into_iter().flat_map(long).collect()
}

/// Ratio of the lengths of two elements that meet at a singular point beyond which the longer one is cut: for a body with
/// curves, and for several bodies.
const LOPSIDED: f64 = 100.0;
const LOPSIDED_BODIES: f64 = 10.0;

/// A vertex closer than this part of its piece is moved to a tip.
const SNAP: f64 = 0.2;

/// Gives the point that faces a transition on another body a vertex too, which moves with it: both meshes are graded to it.
fn follow_beyond(
    scene: &Scene,
    before: &[Tip],
    tips: &[Tip],
    subdivision: &mut Subdivision,
    singular: &mut [Vec<f64>],
) {
    let edges = scene.problem.outline.edges();
    let beyond = |tip: &Tip| {
        let interface = scene.problem.joint(edges[tip.edge].side)?;
        scene.problem.seen(interface, tip.edge, tip.s).map(|seen| (seen.edge, seen.s))
    };
    let mut left: Vec<(usize, f64)> = before.iter().filter_map(beyond).collect();
    for (edge, s) in tips.iter().filter_map(beyond) {
        let fixed = singular[edge].clone();
        let distance = |at: &(usize, f64)| if at.0 == edge { (at.1 - s).abs() } else { f64::INFINITY };
        let nearest = (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b])));
        if let Some(k) = nearest.filter(|&k| distance(&left[k]).is_finite()) {
            let (_, from) = left.swap_remove(k);
            // no vertex passes a point that stays, or moves to an end of its edge
            let between = |f: &f64| from.min(s) - SAME_PLACE < *f && *f < from.max(s) + SAME_PLACE;
            if (from - s).abs() > SAME_PLACE && !fixed.iter().chain(&[0.0, 1.0]).any(between) {
                subdivision.shift(edge, from, s, &fixed);
            }
        }
        subdivision.insert(edge, s, &fixed, SNAP);
        singular[edge].push(s);
    }
}

impl Layout {
    /// The layout to solve next, and where the transitions of this one are believed to be: those that are `decided`.
    ///
    /// # Errors
    /// A decomposition that fails.
    ///
    /// Source: Issaoui (2014), algorithm 2.2; Houston and Süli (2005) for the choice between degree and length.
    pub fn next(
        &self,
        scene: &Scene,
        solved: &Solved,
        factors: &Factors,
        estimate: Option<&Estimate>,
        unseen: &Unseen,
        decided: Option<&Decided>,
    ) -> Result<(Self, Vec<Located>), SolveError> {
        let marking = Marking::new(scene, self, solved, factors, estimate, unseen, decided);
        let mesh = &solved.mesh;
        let all = |rough: bool| vec![Mark::refine(rough, 1.0); mesh.len()];
        let marks = match scene.method.refine {
            Refine::Hp => return self.next_hp(&marking, unseen),
            Refine::None => vec![Mark::Keep; mesh.len()],
            Refine::UniformH => all(true),
            Refine::UniformP => all(false),
            Refine::H => marking.marks(0.5, &|_| true),
            Refine::HpDecay => {
                let corners = singular_points(scene, false);
                let touches = |e: usize| {
                    corners[mesh.edge[e]].iter().any(|c| mesh.span[e].iter().any(|s| (s - c).abs() < SAME_PLACE))
                };
                let rough = |e: usize| marking.decay(e).map_or(touches(e), |d| d > scene.method.smoothness);
                marking.marks(0.5, &rough)
            }
        };
        let high = Grading { max_degree: Mesh::MAX_DEGREE, ..Grading::default() };
        let subdivision = Subdivision::new(mesh, &marks).refined_by_mark(&high);
        let layout = Self { subdivision, tips: Vec::new(), cuts: self.cuts.clone() }.with_equal_cuts(&scene.problem);
        Ok((layout, marking.state.map_or(Vec::new(), unlocated)))
    }

    /// [`Self::next`] of the hp strategy: graded towards singular points, with vertices at transitions and asperities.
    fn next_hp(&self, marking: &Marking<'_>, unseen: &Unseen) -> Result<(Self, Vec<Located>), SolveError> {
        let Marking { scene, solved: Solved { mesh, space, .. }, .. } = *marking;
        let mut singular = singular_points(scene, true);
        let turns = gap_turns(scene);
        let (mut marks, mut on_cuts) = marking.of_hp(&self.tips, &singular, &turns)?;
        if let Some(cuts) = &self.cuts {
            marks.append(&mut on_cuts);
            join_marks(cuts, mesh, space, &mut marks);
            on_cuts = marks.split_off(mesh.len());
        }
        let cuts = Cuts::new(mesh, &turns, &unseen.overlaps);
        cuts.elements().for_each(|e| marks[e] = Mark::Keep);
        let mut subdivision = Subdivision::new(mesh, &marks);
        cuts.insert(&mut subdivision, mesh, &turns);
        cut_at_turns(&mut subdivision, &turns, &|edge, piece| marking.oscillates_at(edge, piece));
        let mut tips = self.tips.clone();
        let located = match marking.state {
            Some(state) => {
                // vertices at the ends of cuts stay
                let mut fixed = singular.clone();
                let ends = self.cuts.iter().flat_map(|cuts| cuts.cuts.ends());
                ends.for_each(|(edge, s)| fixed[edge].push(s));
                let known: Vec<_> = unseen.ends.iter().map(|end| (end.edge, end.s, end.enriched)).collect();
                relocate(&mut tips, &mut subdivision, state, &fixed, (&obstacles(&turns), &known))?
            }
            None => Vec::new(),
        };
        follow_beyond(scene, &self.tips, &tips, &mut subdivision, &mut singular);
        tips.iter().for_each(|tip| singular[tip.edge].push(tip.s));
        let cuts = self.cuts.as_ref().map(|cuts| cuts.refined(&on_cuts));
        let layout = Self { subdivision: subdivision.refined(&singular, &Grading::default()), tips, cuts };
        Ok((layout.with_equal_cuts(&scene.problem), located))
    }
}
