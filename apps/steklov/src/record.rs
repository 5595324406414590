//! Everything about a result that is stored and shown.

use std::path::Path;

use rayon::prelude::*;
use steklov_bem_operators::{BoundaryField, Inside, Location, Mesh, ParticularSolution, Polygon};
use steklov_contact::Kkt;
use steklov_coupling::Radiation;
use steklov_io::vtkhdf::{Field, Grid};

use crate::around::{Around, Window, add_medium, window};
use crate::body::Body;
use crate::estimate::{Doubt, ROUNDOFF};
use crate::grid::GridRecord;
use crate::large::is_large;
use crate::plan::Plan;
use crate::report::{ContactRow, contact_rows, contact_summary, located};
use crate::run::{Run, Step};
use crate::solve::Solved;
use crate::stochastic::{self, StochasticResult};
use crate::store::Stored;
use crate::summary::{Audit, MediumSummary, Probe, SecondsSummary, Summary, peak_memory_bytes};
use crate::triangulate::{Triangulation, triangulate};
use crate::vertices::tell_unbounded;
use steklov_problem::Scene;

/// A result: the arrays of the result file and the numbers of its summary.
#[derive(Debug, Clone)]
pub struct Record {
    /// The numbers.
    pub summary: Summary,
    /// What was modelled.
    pub plan: Plan,
    /// The last mesh.
    pub mesh: Mesh,
    /// Nodal points.
    pub points: Vec<[f64; 2]>,
    /// Nodal displacement.
    pub displacement: Vec<[f64; 2]>,
    /// p Gauss points of each element.
    pub traction_points: Vec<[f64; 2]>,
    /// The element of each.
    pub traction_element: Vec<usize>,
    /// Traction σ(u)n there.
    pub traction: Vec<[f64; 2]>,
    /// Rows of the contact table.
    pub contact: Vec<ContactRow>,
    /// The steps.
    pub steps: Vec<Step>,
    /// Boundary lines and the triangulated body with displacement, stress and von Mises stress.
    pub grid: Grid,
    /// All outcomes of random input.
    pub stochastic: Option<StochasticResult>,
    /// The grid of finite elements.
    pub on_grid: Option<GridRecord>,
    /// The medium around the body, and a window of it.
    pub around: Option<(Around, Window)>,
}

/// Points of the triangulated body, about.
const BODY_POINTS: usize = 800;

/// Points of the triangulated window around the holes of an unbounded body, about.
const WINDOW_POINTS: usize = 2500;

/// Part of the forces on the boundary below which their resultant counts as none.
const BALANCED: f64 = 1e-6;

impl Record {
    /// Gathers a run. `file` is the name of the result file, `total` the seconds since the command began.
    pub fn new(
        scene: &Scene,
        plan: Plan,
        run: Run,
        stochastic: Option<StochasticResult>,
        file: &Path,
        reading: f64,
    ) -> Self {
        let clock = std::time::Instant::now();
        let solved = &run.last;
        let mut grid = body_grid(scene, solved, stochastic.as_ref().zip(run.body.as_ref()));
        let around = solved.around.clone().map(|around| {
            let window = window(&scene.polygon, &around);
            (around, window)
        });
        if let Some((around, window)) = &around {
            add_medium(&mut grid, around, window);
        }
        let (mut traction_points, mut traction_element, mut traction) = (Vec::new(), Vec::new(), Vec::new());
        for e in 0..solved.mesh.len() {
            let rule = steklov_quadrature::gauss_legendre(solved.space.degree(e));
            for &t in &rule.points {
                traction_points.push(solved.mesh.point(e, t));
                traction_element.push(e);
                traction.push(solved.traction(e, t));
            }
        }
        let contact = solved.contact.as_ref().map_or(Vec::new(), |c| contact_rows(solved.trace(), c));
        let mut summary = summary(scene, &run, &contact, file);
        summary.stochastic =
            scene.random.as_ref().zip(stochastic.as_ref()).map(|(random, result)| stochastic::json(random, result));
        if stochastic.as_ref().is_some_and(|result| result.is_doubtful()) {
            summary.estimate_doubts.push(Doubt::Outcomes.word().to_owned());
        }
        if is_large(scene, solved.trace()) {
            summary.estimate_doubts.push("large".to_owned());
        }
        summary.seconds.write = clock.elapsed().as_secs_f64();
        summary.seconds.total = reading + run.clock.elapsed().as_secs_f64();
        let Run { last: solved, progress, .. } = run;
        Self {
            summary,
            plan,
            points: solved.space.points.clone(),
            displacement: solved.displacement.chunks_exact(2).map(|u| [u[0], u[1]]).collect(),
            traction_points,
            traction_element,
            traction,
            contact,
            steps: progress.steps,
            grid,
            mesh: solved.mesh,
            stochastic,
            on_grid: None,
            around,
        }
    }
}

impl Record {
    /// The part of the record that a stored file gives back.
    pub fn stored(self) -> Stored {
        Stored {
            summary: self.summary,
            plan: self.plan,
            mesh: self.mesh,
            points: self.points,
            displacement: self.displacement,
            traction_points: self.traction_points,
            traction: self.traction,
            contact: self.contact,
            grid: self.grid,
            stochastic: self.stochastic,
            on_grid: self.on_grid,
        }
    }
}

fn summary(scene: &Scene, run: &Run, rows: &[ContactRow], file: &Path) -> Summary {
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
        file: file.display().to_string(),
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
    let exterior = scene.exterior.as_ref().filter(|_| scene.is_cavity())?;
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
        radiation: match exterior.radiation {
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

/// Displacement and stress at a point: on the boundary those of the body.
pub(crate) fn probe(scene: &Scene, solved: &Solved, x: [f64; 2]) -> Probe {
    let (displacement, stress) = match (scene.polygon.contains(x), &solved.around) {
        (Location::Boundary { edge, s }, _) => solved.on_edge(edge, s),
        (Location::Outside, Some(around)) => around.at(x),
        _ => solved.inside(x),
    };
    Probe { point: x, displacement, stress, stress_unbounded: false }
}

impl Solved {
    fn elastic(&self) -> Elastic<'_> {
        Elastic { mesh: &self.mesh, field: &self.field, particular: self.particular.as_ref() }
    }

    /// Displacement and stress at a point inside the body.
    pub fn inside(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        self.elastic().inside(x)
    }

    /// Displacement and stress on the boundary, at the reference coordinate t of element e.
    pub fn on_boundary(&self, e: usize, t: f64) -> ([f64; 2], [f64; 3]) {
        self.elastic().on_boundary(e, t)
    }

    /// Traction at the reference coordinate t of element e.
    pub fn traction(&self, e: usize, t: f64) -> [f64; 2] {
        let traction = self.field.trace(e, t).traction;
        let extra = self.particular.map_or([0.0; 2], |b| b.traction(self.mesh.point(e, t), self.mesh.normal(e)));
        [traction[0] + extra[0], traction[1] + extra[1]]
    }

    /// Displacement and stress at the edge parameter s of an edge of the polygon; at a corner or another vertex, where
    /// stresses of the elements beside it differ, their mean.
    pub fn on_edge(&self, edge: usize, s: f64) -> ([f64; 2], [f64; 3]) {
        self.elastic().on_edge(edge, s)
    }
}

/// A field of a body, inside and on its boundary.
#[derive(Clone, Copy)]
struct Elastic<'a> {
    mesh: &'a Mesh,
    field: &'a BoundaryField,
    particular: Option<&'a ParticularSolution>,
}

impl Elastic<'_> {
    fn inside(&self, x: [f64; 2]) -> ([f64; 2], [f64; 3]) {
        let Inside { displacement: mut u, mut stress, .. } = self.field.inside(x);
        if let Some(p) = self.particular {
            let (v, sigma) = (p.displacement(x), p.stress(x));
            (0..2).for_each(|i| u[i] += v[i]);
            (0..3).for_each(|i| stress[i] += sigma[i]);
        }
        (u, stress)
    }

    fn on_boundary(&self, e: usize, t: f64) -> ([f64; 2], [f64; 3]) {
        let trace = self.field.trace(e, t);
        let (mut u, mut stress) = (trace.displacement, trace.stress);
        if let Some(p) = self.particular {
            let x = self.mesh.point(e, t);
            let (v, sigma) = (p.displacement(x), p.stress(x));
            (0..2).for_each(|i| u[i] += v[i]);
            (0..3).for_each(|i| stress[i] += sigma[i]);
        }
        (u, stress)
    }

    fn on_edge(&self, edge: usize, s: f64) -> ([f64; 2], [f64; 3]) {
        let within = |e: &usize| {
            let [a, b] = self.mesh.span[*e];
            self.mesh.edge[*e] == edge && a.min(b) <= s && s <= a.max(b)
        };
        let e = (0..self.mesh.len()).find(within).unwrap_or(0);
        let [a, b] = self.mesh.span[e];
        let t = (2.0 * (s - a) / (b - a) - 1.0).clamp(-1.0, 1.0);
        let (displacement, stress) = self.on_boundary(e, t);
        // at a vertex the mean of the stresses of its two elements
        let other = match t {
            1.0 => self.on_boundary(self.mesh.next[e], -1.0).1,
            -1.0 => {
                (0..self.mesh.len()).find(|&f| self.mesh.next[f] == e).map_or(stress, |f| self.on_boundary(f, 1.0).1)
            }
            _ => stress,
        };
        (displacement, [0, 1, 2].map(|i| (stress[i] + other[i]) / 2.0))
    }
}

/// The edges of a window around the holes of an unbounded body, counter-clockwise: their bounding box and one and a half
/// diameters on each side.
fn frame(polygon: &Polygon) -> Vec<([f64; 2], [f64; 2], usize)> {
    let margin = 1.5 * polygon.diameter();
    let coordinates = |i: usize| polygon.edges().iter().map(move |e| e.start[i]);
    let low = [0, 1].map(|i| coordinates(i).fold(f64::INFINITY, f64::min) - margin);
    let high = [0, 1].map(|i| coordinates(i).fold(f64::NEG_INFINITY, f64::max) + margin);
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    (0..4).map(|k| (corners[k], corners[(k + 1) % 4], 0)).collect()
}

/// The body with its fields, of an unbounded one a window; without triangles where the outline cannot be triangulated.
fn body_grid(scene: &Scene, solved: &Solved, outcomes: Option<(&StochasticResult, &Body)>) -> Grid {
    let polygon = &scene.polygon;
    let order: Vec<usize> = (0..polygon.loops().len()).flat_map(|l| polygon.traversal(l)).collect();
    let (frame, count) = if polygon.is_bounded() { (Vec::new(), BODY_POINTS) } else { (frame(polygon), WINDOW_POINTS) };
    let sides = frame.len();
    // the window is the loop before those of the holes
    let loops = order.iter().map(|&k| &polygon.edges()[k]).map(|e| (e.start, e.end, e.loop_index + sides));
    let edges: Vec<_> = frame.into_iter().chain(loops).collect();
    let mut body = triangulate(&edges, count).unwrap_or_else(|_| Triangulation {
        points: edges.iter().map(|e| e.0).collect(),
        triangles: Vec::new(),
        boundary: (0..edges.len()).map(|k| Some((k, 0.0))).collect(),
        outline: Vec::new(),
    });
    body.boundary.iter_mut().for_each(|at| *at = at.and_then(|(k, s)| Some((k.checked_sub(sides)?, s))));
    body.outline.retain(|line| line.iter().all(|&i| body.boundary[i].is_some()));
    let at_points = |elastic: Elastic<'_>| -> Vec<([f64; 2], [f64; 3])> {
        let at = |i: usize| match body.boundary[i] {
            Some((k, s)) => {
                let edge = &polygon.edges()[order[k]];
                elastic.on_edge(order[k], if edge.reversed { 1.0 - s } else { s })
            }
            None => elastic.inside(body.points[i]),
        };
        (0..body.points.len()).into_par_iter().map(at).collect()
    };
    let values = at_points(solved.elastic());
    let field = |name: &str, unit: &str, components: usize, values: Vec<f64>| Field {
        name: name.into(),
        unit: unit.into(),
        components,
        values,
    };
    let displacements = |values: &[([f64; 2], [f64; 3])]| values.iter().flat_map(|(u, _)| [u[0], u[1], 0.0]).collect();
    let stresses = |values: &[([f64; 2], [f64; 3])]| values.iter().flat_map(|(_, s)| *s).collect();
    let mut point_data = vec![
        field("displacement", "length", 3, displacements(&values)),
        field("stress", "stress", 3, stresses(&values)),
        field("von_mises", "stress", 1, values.iter().map(|(_, s)| scene.material.von_mises(*s)).collect()),
    ];
    // the particular solution depends on the outcome: without its mean there are no mean fields
    if let Some((result, matrices)) = outcomes.filter(|_| solved.particular.is_none()) {
        let mean = |displacement: &[f64]| {
            let field = matrices.field(displacement, &matrices.traction_map.apply(displacement));
            at_points(Elastic { mesh: &matrices.mesh, field: &field, particular: None })
        };
        point_data.push(field("mean_displacement", "length", 3, displacements(&mean(&result.displacement.mean))));
        point_data.push(field("mean_stress", "stress", 3, stresses(&mean(&result.stress_displacement))));
    }
    Grid { point_data, points: body.points, lines: body.outline, triangles: body.triangles, ..Grid::default() }
}
