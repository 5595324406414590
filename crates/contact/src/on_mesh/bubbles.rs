//! Contact on the displacement bubbles: the directions that the state of an element leaves free, and the part of its data that
//! the nodes miss.

use std::sync::OnceLock;

use steklov_bem_operators::{Datum, Mesh, Site, Space};
use steklov_quadrature::{Rule, gauss_legendre, legendre_p, project};

use crate::on_mesh::sides::from_within;
use crate::{ContactBoundary, ContactError, LinePoint, Sets};

/// The bubble b = (P_(p+1) - P_(p-1))/(2p+1) of a contact element, its components along n and t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactBubble {
    /// Element of the mesh.
    pub element: usize,
    /// Whether the solution may move along n and along t: not where all nodes are closed, not where all stick.
    pub free: [bool; 2],
    /// Contact forces -∫λ b along n and t (force/thickness): those of the bound if all nodes inside the element slip one way
    /// (for degree 1: its ends, or the end that does not stick), else 0.
    pub load: [f64; 2],
    /// ±μ in the middle of an element that is closed and slips so under Coulomb's law: ∫λ_t b is that times ∫λ_n b, which
    /// the bubble's own equilibrium along n gives. Else 0.
    pub coupling: f64,
    /// ‖w‖ ‖dw/ds‖ of w = g - I_p g in L2 of the element (length²), 0 where it is open.
    pub oscillation: f64,
    /// The coefficient of b in w where the element is closed (length), else 0.
    pub gap: f64,
}

/// The state of contact at a node of an element.
#[derive(Clone, Copy)]
struct State {
    closed: bool,
    /// As [`Sets::slip`].
    slip: Option<i8>,
    /// Whether a support holds the node along n and along t: it then has no multiplier there.
    held: [bool; 2],
}

impl State {
    const HELD: Self = Self { closed: false, slip: None, held: [true; 2] };

    fn new(boundary: &ContactBoundary, sets: &Sets, at: &LinePoint) -> Self {
        let condition = &boundary.contact[at.node].conditions[at.condition];
        // a node without friction may have no tangential multiplier either
        let free = boundary.nodes[at.node].frame.is_some();
        let held = [condition.normal_weight, condition.tangent_weight].map(|weight| weight == 0.0 && !free);
        Self { closed: sets.closed(at.index), slip: sets.slip(at.index), held }
    }
}

/// Gauss points on an element.
const POINTS: usize = 40;

/// The bubbles of all contact elements. `gap(side)`, `bound(side)` and `coefficient(side)` are the data of a side of the mesh;
/// bound and coefficient are none without Tresca's and without Coulomb's friction.
///
/// An element is closed when all its nodes are, open when none inside it is and at most one at its ends; any other element
/// keeps all its bubbles, without load. A held node does not count along the directions in which it is held.
/// # Errors
/// [`ContactError::Data`] where a datum is not finite.
pub fn contact_bubbles<'d>(
    mesh: &Mesh,
    space: &Space,
    boundary: &ContactBoundary,
    sets: &Sets,
    gap: &dyn Fn(usize) -> Datum<'d>,
    bound: &dyn Fn(usize) -> Option<Datum<'d>>,
    coefficient: &dyn Fn(usize) -> Option<Datum<'d>>,
) -> Result<Vec<ContactBubble>, ContactError> {
    let mut bubbles = Vec::new();
    for element in boundary.elements(mesh, space) {
        let e = element.element;
        let p = space.degree(e);
        let states: Vec<State> =
            element.points.iter().map(|at| at.map_or(State::HELD, |at| State::new(boundary, sets, &at))).collect();
        let inner = if p > 1 { &states[1..p] } else { &states };
        let count = states.iter().filter(|s| s.closed).count();
        let closed = count > 0 && states.iter().all(|s| s.closed || s.held[0]);
        let open = count == 0 || p > 1 && count <= 1 && inner.iter().all(|s| !s.closed);
        let sticks = |s: &State| s.slip == Some(0);
        let stick = states.iter().any(sticks) && states.iter().all(|s| sticks(s) || s.held[1]);
        let turns: Vec<i8> = inner.iter().filter_map(|s| s.slip).filter(|&s| p > 1 || s != 0).collect();
        let sum: i32 = turns.iter().map(|&s| i32::from(s)).sum();
        let sliding = !turns.is_empty() && sum.unsigned_abs() as usize == turns.len();
        let mut load = [0.0; 2];
        if let Some(bound) = bound(mesh.side[e])
            && sliding
        {
            load[1] = -f64::from(sum.signum()) * against_bubble(mesh, space, e, &bound)?;
        }
        let mut coupling = 0.0;
        if let Some(coefficient) = coefficient(mesh.side[e])
            && sliding
            && closed
        {
            coupling = f64::from(sum.signum()) * coefficient.at(mesh, &Site::new(mesh, e, 0.0))?;
        }
        let oscillation = if open { 0.0 } else { oscillation(mesh, space, e, &gap(mesh.side[e]))? };
        let gap = if closed { missed(mesh, space, e, &gap(mesh.side[e]))? } else { 0.0 };
        bubbles.push(ContactBubble { element: e, free: [!closed, !stick], load, coupling, oscillation, gap });
    }
    Ok(bubbles)
}

/// ∫ f b ds over an element.
fn against_bubble(mesh: &Mesh, space: &Space, e: usize, f: &Datum<'_>) -> Result<f64, ContactError> {
    let p = space.degree(e);
    let mut legendre = vec![0.0; p + 2];
    let mut sum = 0.0;
    let rule = rule();
    for (&t, &w) in rule.points.iter().zip(&rule.weights) {
        legendre_p(t, &mut legendre);
        let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
        sum += w * mesh.speed(e, t) * bubble * f.at(mesh, &Site::new(mesh, e, t))?;
    }
    Ok(sum)
}

/// ‖w‖ ‖dw/ds‖ of w = f - I_p f, with the nodal interpolant I_p, in L2 of an element.
///
/// E*/2 times this is the energy of w as a displacement of the boundary; 0 where f is a polynomial of degree p up to
/// rounding.
/// # Errors
/// [`ContactError::Data`] where f is not finite.
pub fn oscillation(mesh: &Mesh, space: &Space, e: usize, f: &Datum<'_>) -> Result<f64, ContactError> {
    let basis = space.basis(e);
    let nodal: Vec<f64> = basis
        .nodes
        .iter()
        .map(|&t| f.at(mesh, &Site::new(mesh, e, from_within(mesh, e, t))))
        .collect::<Result<_, _>>()?;
    let largest = nodal.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let mut ends: Vec<f64> = (f.kinks)(e).into_iter().filter(|t| t.abs() < 1.0 - mesh.resolution(e)).collect();
    ends.extend([-1.0, 1.0]);
    ends.sort_by(f64::total_cmp);
    // two functions in one expression may have the same kink up to rounding
    ends.dedup_by(|b, a| *b - *a <= mesh.resolution(e));
    let mut phi = vec![0.0; basis.degree + 1];
    let rule = rule();
    let (mut values, mut slopes, mut worst) = (0.0, 0.0, 0.0f64);
    for piece in ends.windows(2) {
        let (middle, half) = ((piece[0] + piece[1]) / 2.0, (piece[1] - piece[0]) / 2.0);
        let mut w = Vec::with_capacity(POINTS);
        for &x in &rule.points {
            let t = middle + half * x;
            basis.evaluate(t, &mut phi);
            let interpolant: f64 = phi.iter().zip(&nodal).map(|(p, v)| p * v).sum();
            w.push(f.at(mesh, &Site::new(mesh, e, t))? - interpolant);
        }
        worst = w.iter().fold(worst, |m, w| m.max(w.abs()));
        let mut values_here = w.iter().copied();
        let series = project(|_| values_here.next().unwrap_or(0.0), POINTS - 1, rule);
        values += half * series.norm().powi(2);
        slopes += series.derivative().norm().powi(2) / half;
    }
    // both norms in t: the half lengths of the element cancel in their product
    Ok(if worst <= 1e-13 * largest { 0.0 } else { (values * slopes).sqrt() })
}

/// The coefficient of the bubble b in w = f - I_p f, the leading term of w for smooth f: ∫ w b / ∫ b² over the reference
/// element.
/// # Errors
/// [`ContactError::Data`] where f is not finite.
pub fn missed(mesh: &Mesh, space: &Space, e: usize, f: &Datum<'_>) -> Result<f64, ContactError> {
    let basis = space.basis(e);
    let p = basis.degree;
    let at = |t: f64| f.at(mesh, &Site::new(mesh, e, from_within(mesh, e, t)));
    let nodal: Vec<f64> = basis.nodes.iter().map(|&t| at(t)).collect::<Result<_, _>>()?;
    let (mut phi, mut legendre) = (vec![0.0; p + 1], vec![0.0; p + 2]);
    let rule = rule();
    let (mut product, mut square) = (0.0, 0.0);
    for (&t, &weight) in rule.points.iter().zip(&rule.weights) {
        basis.evaluate(t, &mut phi);
        legendre_p(t, &mut legendre);
        let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
        let interpolant: f64 = phi.iter().zip(&nodal).map(|(phi, value)| phi * value).sum();
        product += weight * (at(t)? - interpolant) * bubble;
        square += weight * bubble * bubble;
    }
    Ok(product / square)
}

/// The Gauss rule on an element.
fn rule() -> &'static Rule {
    static RULE: OnceLock<Rule> = OnceLock::new();
    RULE.get_or_init(|| gauss_legendre(POINTS))
}
