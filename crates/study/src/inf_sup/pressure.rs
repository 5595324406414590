//! The pressure of an unstable pair, with stabilisation and with almost none. Without it λ is determined only up to
//! parts that do no work on any displacement, and oscillates.

use steklov_bem_operators::PairCache;
use steklov_contact::{MultiplierDegree, MultiplierMesh};
use steklov_model::error::SolveError;
use steklov_model::solve::contact_rows::{ContactRow, contact_rows};
use steklov_model::solve::one_mesh::solve;
use steklov_problem::{Contact, Friction, Law, Multiplier, Scene};

use crate::supported::uniform_mesh;
use crate::table::Column;
use crate::watch::Watch;

/// The mesh: the first of these multiples of the scene's number of elements that the scene allows, and its degree.
const TIMES: [usize; 3] = [4, 2, 1];
const DEGREE: usize = 2;
/// Largest number of unknowns of the mesh.
const DOFS: usize = 400;
/// γ₀ over its critical value, in place of no stabilisation.
const NONE: f64 = 1e-5;

/// A solution of the scene with multipliers of degree p on halved elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressure {
    /// γ₀ (1/stress).
    pub gamma: f64,
    /// The critical γ₀ of this mesh.
    pub critical: f64,
    /// Whether the solver of contact reached its criterion.
    pub converged: bool,
    /// Contact at the nodes of the multipliers; empty if there is no solution.
    pub rows: Vec<ContactRow>,
    /// Why there is no solution.
    pub failure: Option<String>,
}

/// The solutions on one mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressures {
    /// Elements of the displacements.
    pub elements: usize,
    /// Their degree.
    pub degree: usize,
    /// The solution with the scene's γ, then the one with almost none; fewer after a request to stop.
    pub solutions: Vec<Pressure>,
}

impl Pressure {
    /// Largest pressure.
    pub fn largest(&self) -> f64 {
        self.rows.iter().fold(0.0, |m: f64, r| m.max(r.pressure))
    }

    /// Sum of all rises and falls of the pressure along the contact sides: twice the largest one if there is one peak.
    pub fn variation(&self) -> f64 {
        let pairs = self.rows.windows(2).filter(|r| r[0].side == r[1].side);
        pairs.map(|r| (r[1].pressure - r[0].pressure).abs()).sum()
    }
}

/// Columns of a solution.
pub(super) const ROWS: [Column<ContactRow>; 6] = [
    ("x", "length", "node of the multipliers", |r| r.point[0]),
    ("y", "length", "node of the multipliers", |r| r.point[1]),
    ("side", "1", "index of the side", |r| r.side as f64),
    ("pressure", "stress", "lambda_n, positive in compression", |r| r.pressure),
    ("shear", "stress", "lambda_t", |r| r.shear),
    ("weight", "length", "length that the node stands for", |r| r.weight),
];

/// Solves the scene with too many multipliers for its displacements; no solutions if the mesh has too many unknowns.
/// Coulomb friction is left out. After a request to stop nothing more is solved.
///
/// # Errors
/// As [`solve`] with the scene's own γ; failures with almost no γ or because Coulomb friction is left out are reported
/// in their place.
pub fn pressures(scene: &Scene, watch: &mut Watch<'_>) -> Result<Pressures, SolveError> {
    let dofs = |times: &usize| 2 * DEGREE * uniform_mesh(scene, *times, DEGREE).len();
    let fitting = TIMES.into_iter().find(|t| dofs(t) <= scene.method.max_dofs().min(DOFS));
    let mesh = uniform_mesh(scene, fitting.unwrap_or(1), DEGREE);
    let mut scene = scene.clone();
    scene.method.multiplier = Multiplier::Stabilised;
    (scene.method.multiplier_mesh, scene.method.multiplier_degree) =
        (MultiplierMesh::Finer(2), MultiplierDegree::Relative(0));
    // with a bound that oscillates with the pressure the solver would not converge
    let mut coulomb = false;
    for law in scene.problem.laws_mut() {
        if let Law::Contact(Contact { friction: friction @ Friction::Coulomb(_), .. }) = law {
            *friction = Friction::None;
            coulomb = true;
        }
    }
    let mut all = Pressures { elements: mesh.len(), degree: DEGREE, solutions: Vec::new() };
    for stable in [true, false] {
        if fitting.is_none() || watch.stopped() {
            break;
        }
        watch.tell("pressure", if stable { "stabilised" } else { "not stabilised" });
        if let Some(first) = all.solutions.first() {
            scene.method.gamma = Some(NONE * first.critical);
        }
        match (
            solve(&scene, (mesh.clone(), None), false, &mut PairCache::default(), &mut |_| Ok(())),
            all.solutions.first(),
        ) {
            (Ok((solved, ..)), _) => {
                let Some(contact) = &solved.contact else { continue };
                let Some(s) = &contact.stabilised else { continue };
                all.solutions.push(Pressure {
                    gamma: s.gamma,
                    critical: s.critical,
                    converged: s.solution.converged(),
                    rows: contact_rows(solved.trace(), contact),
                    failure: None,
                });
            }
            (Err(error), None) if !coulomb => return Err(error),
            (Err(error), None) => {
                let why = format!("without Coulomb friction {error}");
                let unknown = f64::NAN;
                let (gamma, critical, rows) = (unknown, unknown, Vec::new());
                all.solutions.push(Pressure { gamma, critical, converged: false, rows, failure: Some(why) });
                break;
            }
            (Err(error), Some(&Pressure { critical, .. })) => all.solutions.push(Pressure {
                gamma: NONE * critical,
                critical,
                converged: false,
                rows: Vec::new(),
                failure: Some(error.to_string()),
            }),
        }
    }
    Ok(all)
}
