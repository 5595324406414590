//! β of pairs of displacements and multipliers on uniform meshes.
//!
//! ```text
//! β² = min_μ  μᵀ G μ / μᵀ G' μ,    G = B S⁻¹ Bᵀ, or with stabilisation E (S - B_γ)⁻¹ Eᵀ + D
//! ```
//! G' = B S⁻¹ Bᵀ of displacements on every element in four parts, three degrees higher: the norm of μ, the H^-1/2 norm
//! in the energy of the body. Biorthogonal and continuous multipliers have the values T at the nodes of the
//! discontinuous ones, and the form Tᵀ G T.

use faer::Mat;
use steklov_bem_operators::Mesh;
use steklov_contact::{
    ContactError, MultiplierDegree, MultiplierMesh, MultiplierSpace, StabilisedForms, dual_form, inf_sup, pairing,
};
use steklov_model::data::on_mesh::OnMesh;
use steklov_model::error::SolveError;
use steklov_model::solve::stabilised::SAFE;
use steklov_problem::Scene;

use super::subspace::{biorthogonal, continuous, restricted};
use crate::supported::{Supported, contact_sides, each, uniform_mesh};
use crate::table::Column;
use crate::watch::Watch;

/// The multipliers of W_Hq in a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// All.
    All,
    /// The ψ̃_i of contact conditions.
    Biorthogonal,
    /// The traces of displacements.
    Continuous,
}

/// A pair: displacements of degree p, and multipliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Name of the multipliers.
    pub name: &'static str,
    /// Their mesh.
    pub mesh: MultiplierMesh,
    /// Their degree.
    pub degree: MultiplierDegree,
    /// The multipliers of that mesh and degree in the pair.
    pub part: Part,
}

const SAME: MultiplierDegree = MultiplierDegree::Relative(0);

/// The pairs of the study; neighbours of one mesh and degree share their forms.
pub const PAIRS: [Pair; 7] = [
    Pair { name: "biorthogonal", mesh: MultiplierMesh::Same, degree: SAME, part: Part::Biorthogonal },
    Pair { name: "continuous P_p", mesh: MultiplierMesh::Same, degree: SAME, part: Part::Continuous },
    Pair { name: "discontinuous P_p", mesh: MultiplierMesh::Same, degree: SAME, part: Part::All },
    Pair {
        name: "discontinuous P_(p-1)",
        mesh: MultiplierMesh::Same,
        degree: MultiplierDegree::Relative(-1),
        part: Part::All,
    },
    Pair { name: "P_p, halved elements", mesh: MultiplierMesh::Finer(2), degree: SAME, part: Part::All },
    Pair { name: "P_p, joined elements", mesh: MultiplierMesh::Coarser(2), degree: SAME, part: Part::All },
    Pair { name: "P_p, shifted elements", mesh: MultiplierMesh::Shifted, degree: SAME, part: Part::All },
];

/// Meshes: multiples of the scene's number of elements, and degrees.
const MESHES: [(&[usize], usize); 6] =
    [(&[1, 2, 4, 8], 1), (&[1, 2, 4, 8], 2), (&[1, 2, 4, 8], 3), (&[1], 4), (&[1], 5), (&[1], 6)];
/// Largest number of unknowns of a reference space.
const REFERENCE_DOFS: usize = 3200;
/// The number of parts of an element in that space is 2 to this power; its degrees are this much higher.
const HALVINGS: usize = 2;
const RAISED: usize = 3;

/// A pair on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Number of the pair in [`PAIRS`].
    pub pair: usize,
    /// Elements of the displacements.
    pub elements: usize,
    /// Their degree.
    pub degree: usize,
    /// Displacement unknowns, held ones included.
    pub dofs: usize,
    /// Multiplier unknowns.
    pub multipliers: usize,
    /// β without stabilisation; NaN if unknown.
    pub plain: f64,
    /// β with stabilisation.
    pub stabilised: f64,
    /// Why one of both is unknown.
    pub failure: Option<String>,
}

/// Columns of the points.
pub(super) const POINTS: [Column<Point>; 6] = [
    ("elements", "1", "elements of the uniform displacement mesh", |p| p.elements as f64),
    ("degree", "1", "their degree p", |p| p.degree as f64),
    ("dofs", "1", "displacement unknowns", |p| p.dofs as f64),
    ("multipliers", "1", "multiplier unknowns", |p| p.multipliers as f64),
    ("beta", "1", "inf-sup constant without stabilisation; NaN where it is not known", |p| p.plain),
    ("beta_stabilised", "1", "inf-sup constant with γ₀ half of the critical one", |p| p.stabilised),
];

/// β of all pairs on a few uniform meshes. Meshes with more unknowns than the scene or a quick study allows are left
/// out. After a request to stop no more meshes are done.
///
/// # Errors
/// Prescribed displacements or data of contact that are not finite, operators that cannot be made.
pub fn pairs(scene: &Scene, watch: &mut Watch<'_>) -> Result<Vec<Point>, SolveError> {
    let mut points: Vec<Point> = Vec::new();
    for (times, degree) in each(&MESHES) {
        let mesh = uniform_mesh(scene, times, degree);
        let dofs = 2 * mesh.degree.iter().sum::<usize>();
        let reference_dofs = 2 * (mesh.len() << HALVINGS) * (degree + RAISED);
        let done = points.iter().any(|p| (p.elements, p.degree) == (mesh.len(), degree));
        if done || dofs > scene.method.max_dofs() || reference_dofs > REFERENCE_DOFS {
            continue;
        }
        if watch.stopped() {
            break;
        }
        watch.tell("inf-sup constants", &format!("{} elements of degree {degree}", mesh.len()));
        points.extend(on_mesh(scene, mesh, degree)?);
    }
    Ok(points)
}

/// All pairs on a mesh.
fn on_mesh(scene: &Scene, mesh: Mesh, degree: usize) -> Result<Vec<Point>, SolveError> {
    let mut fine = mesh.clone();
    (0..HALVINGS).for_each(|_| fine = fine.bisected(&vec![true; fine.len()]).0);
    fine.degree.iter_mut().for_each(|p| *p += RAISED);
    let (body, fine) = (Supported::new(scene, mesh)?, Supported::new(scene, fine)?);
    let sides = contact_sides(scene);
    let mut points = Vec::with_capacity(PAIRS.len());
    let mut shared: Option<((MultiplierMesh, MultiplierDegree), Forms)> = None;
    for (pair, Pair { mesh: kind, degree: order, part, .. }) in PAIRS.into_iter().enumerate() {
        let forms = match shared.take() {
            Some((key, forms)) if key == (kind, order) => forms,
            _ => {
                let space = MultiplierSpace::new(&body.mesh, &sides, kind, order)?;
                Forms::new(scene, &body, &fine, space)
            }
        };
        let to = match part {
            Part::All => None,
            Part::Continuous => Some(continuous(&body, &forms.space)),
            Part::Biorthogonal => {
                let data = OnMesh { scene, mesh: &body.mesh, space: &body.space };
                data.contact(&data.held()?, &[])?.map(|boundary| biorthogonal(&body, &boundary, &forms.space))
            }
        };
        let beta = |form: &Result<Mat<f64>, ContactError>| match (form, &forms.reference) {
            (Ok(form), Ok(reference)) => Ok(inf_sup(&restricted(form, &to), &restricted(reference, &to))?.beta),
            (Err(error), _) | (_, Err(error)) => Err(error.clone()),
        };
        let both = [beta(&forms.plain), beta(&forms.stabilised)];
        let failure = both.iter().find_map(|b| b.as_ref().err()).map(ToString::to_string);
        let [plain, stabilised] = both.map(|b| b.unwrap_or(f64::NAN));
        let multipliers = to.as_ref().map_or(2 * forms.space.nodes.len(), Mat::ncols);
        let (elements, dofs) = (body.mesh.len(), body.space.dofs());
        points.push(Point { pair, elements, degree, dofs, multipliers, plain, stabilised, failure });
        shared = Some(((kind, order), forms));
    }
    Ok(points)
}

/// The forms on a space of multipliers.
struct Forms {
    space: MultiplierSpace,
    /// B S⁻¹ Bᵀ.
    plain: Result<Mat<f64>, ContactError>,
    /// E (S - B_γ)⁻¹ Eᵀ + D.
    stabilised: Result<Mat<f64>, ContactError>,
    /// B S⁻¹ Bᵀ of the fine displacements.
    reference: Result<Mat<f64>, ContactError>,
}

impl Forms {
    fn new(scene: &Scene, body: &Supported, fine: &Supported, space: MultiplierSpace) -> Self {
        let plain = |b: &Supported| dual_form(&pairing(&b.mesh, &b.space, &space), &b.stiffness, &b.held, &[]);
        let forms = StabilisedForms::new(&body.mesh, &body.space, &scene.body().material(), &body.traction, &space);
        let stabilised = forms.and_then(|forms| {
            let critical = forms.critical_gamma(&body.stiffness, &body.held, &[])?;
            forms.dual_form(&body.stiffness, &body.held, &[], SAFE * critical)
        });
        Self { plain: plain(body), stabilised, reference: plain(fine), space }
    }
}
