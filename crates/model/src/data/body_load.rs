//! A body force that is affine in the place, or a remote stress, in the discrete problem: u = w + u_p, w without them.

use steklov_algebra::dot;
use steklov_bem_operators::{BoundaryField, Mesh, ParticularSolution, Space, Subdomain};
use steklov_elastic::plane;
use steklov_problem::Scene;
use steklov_quadrature::gauss_legendre;

use crate::data::parts::{Assembled, Piece};
use crate::energies::Energies;

/// Gauss points on curved elements beyond the degree.
const ON_CURVES: usize = 16;

/// The particular solutions of bodies; bodies without a force or a stress far away have none.
#[derive(Debug, Clone, Default)]
pub struct Particulars {
    /// The elements of each body with a particular solution, and that solution.
    bodies: Vec<(Vec<usize>, ParticularSolution)>,
}

impl Particulars {
    pub(crate) fn new(bodies: &[Assembled], particular: &[Option<Particular>]) -> Self {
        let of = |(body, own): (&Assembled, &Option<Particular>)| {
            Some((body.piece.part.elements.clone(), own.as_ref()?.solution))
        };
        Self { bodies: bodies.iter().zip(particular).filter_map(of).collect() }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The particular solution of an element's body.
    pub fn of(&self, e: usize) -> Option<&ParticularSolution> {
        self.bodies.iter().find(|(elements, _)| elements.contains(&e)).map(|(_, solution)| solution)
    }
}

/// The particular solution on the mesh of a body.
///
/// With U the nodal values of u_p and T = ∫ σ(u_p)n·φ, the functional of the nodal displacement u is
/// ½ uᵀSu - (f + S U - T)·u plus a constant.
pub(crate) struct Particular {
    /// u_p itself.
    pub(crate) solution: ParticularSolution,
    /// Whether the energies are those of w alone: u_p has none that is finite in an unbounded body.
    pub(crate) relative: bool,
    /// U.
    pub(crate) displacement: Vec<f64>,
    /// S U - T.
    pub(crate) load: Vec<f64>,
    /// S U.
    stiff: Vec<f64>,
    /// T.
    traction: Vec<f64>,
    /// T of the components that no side holds.
    loaded: Vec<f64>,
    /// a(u_p, u_p).
    energy: f64,
    /// ∫ b·u_p.
    work: f64,
}

impl Particular {
    /// The particular solution of a body of the scene; `stiffness` is the product with its S.
    pub(crate) fn of_body(
        scene: &Scene,
        body: usize,
        Piece { part: Subdomain { mesh, space, .. }, .. }: &Piece,
        stiffness: impl FnOnce(&[f64]) -> Vec<f64>,
    ) -> Option<Self> {
        let solution = scene.particular_solution(body)?;
        let held = |e: usize, i: usize| scene.problem.sides.get(mesh.side[e]).is_some_and(|side| side.holds(i));
        let unbounded = scene.problem.bodies[body].far.is_some();
        Some(Self::new(solution, unbounded, mesh, space, held, stiffness))
    }

    /// `held` says whether the side of an element holds a component; `unbounded`: the particular solution extends to infinity.
    fn new(
        solution: ParticularSolution,
        unbounded: bool,
        mesh: &Mesh,
        space: &Space,
        held: impl Fn(usize, usize) -> bool,
        stiffness: impl FnOnce(&[f64]) -> Vec<f64>,
    ) -> Self {
        let displacement = space.interpolate(|x| solution.displacement(x));
        let stiff = stiffness(&displacement);
        let traction = solution.traction_load(mesh, space);
        let loaded = solution.traction_load_of(mesh, space, |e, i| !held(e, i));
        let load = stiff.iter().zip(&traction).map(|(s, t)| s - t).collect();
        let (energy, work) = if unbounded { (0.0, 0.0) } else { solution.energies(mesh) };
        Self { solution, relative: unbounded, displacement, load, stiff, traction, loaded, energy, work }
    }
}

/// Energies of the nodal displacement u of a body, friction apart: `forces` = S u, `tractions` = f without the particular load,
/// `field` that of w.
///
/// ```text
/// ∫ b·u = ∮ t(w)·u_p - T·w + ∫ b·u_p                               (Betti), w = u - U
/// J = ½ wᵀ S w + T·w + ½ a(u_p,u_p) - f·u - ∫ b·u_p
/// ```
/// In an unbounded body those of w, whose traction on the boundary is what is given less σ_∞n; held sides are not loaded:
///
/// ```text
/// J = ½ wᵀ S w - (f - T)·w
/// ```
pub(crate) fn energies_of(
    displacement: &[f64],
    forces: &[f64],
    tractions: &[f64],
    particular: Option<&Particular>,
    field: &BoundaryField,
    Piece { part: Subdomain { mesh, space, .. }, .. }: &Piece,
) -> Energies {
    let traction_work = dot(tractions, displacement);
    let Some(p) = particular else {
        let strain = 0.5 * dot(displacement, forces);
        return Energies {
            total: strain - traction_work,
            strain,
            springs: 0.0,
            load_work: traction_work,
            friction_work: 0.0,
        };
    };
    let w: Vec<f64> = displacement.iter().zip(&p.displacement).map(|(u, p)| u - p).collect();
    let stiff: Vec<f64> = forces.iter().zip(&p.stiff).map(|(s, p)| s - p).collect();
    let traction = dot(&p.traction, &w);
    if p.relative {
        let (strain, load_work) = (0.5 * dot(&w, &stiff), dot(tractions, &w) - dot(&p.loaded, &w));
        return Energies { total: strain - load_work, strain, springs: 0.0, load_work, friction_work: 0.0 };
    }
    let crossed = crossed_work(field, &p.solution, mesh, space);
    let load_work = traction_work + crossed - traction + p.work;
    let elastic = 0.5 * dot(&w, &stiff) + traction + 0.5 * p.energy - traction_work - p.work;
    Energies { total: elastic, strain: elastic + load_work, springs: 0.0, load_work, friction_work: 0.0 }
}

/// ∮ t(w)·u_p with the traction of w of its own space.
fn crossed_work(field: &BoundaryField, particular: &ParticularSolution, mesh: &Mesh, space: &Space) -> f64 {
    let mut work = 0.0;
    for e in 0..mesh.len() {
        let rule = gauss_legendre(space.degree(e) + if mesh.is_line(e) { 2 } else { ON_CURVES });
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            let (traction, u) = (field.trace(e, t).traction, particular.displacement(mesh.point(e, t)));
            work += w * mesh.speed(e, t) * plane::dot(traction, u);
        }
    }
    work
}
