//! Multiscale bases of one coarse cell.
//!
//! Φ_(p,k), p = 0..4 the corner, k = 0, 1 the direction, is a field with two components on the m × n fine cells of a coarse
//! cell T: row 2·node + component, column 2p + k of R_T. hat_p is the bilinear function of corner p.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use faer::Mat;
use steklov_algebra::Lu;

use crate::body::CellMatrices;
use crate::local::{Columns, Freedom, LocalProblem, cell_dofs, nodes};
use crate::{HeterogeneousBody, MsfemError};

/// The boundary values of the basis functions of a coarse cell; inside they satisfy div σ = 0 on the fine cells.
///
/// Source: Zhang, Wu, Lü and Fu (2010) for linear functions; Zhang, Wu and Fu, Comput. Mech. 45 (2010), for coupled ones;
/// Issaoui (2014), section 5.3.1, for both; Hou and Wu (1997) for oscillatory traces and oversampling; Sanchez-Palencia
/// (1980) for periodic cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Basis {
    /// hat_p e_k everywhere: coarse bilinear elements, the moduli integrated on the fine cells.
    Q1,
    /// Component k = hat_p, the other one free of traction and then dropped.
    Linear,
    /// Component k = hat_p, the other one 0; both components inside are kept.
    Coupled,
    /// As coupled, but along each edge the tangential component solves (E φ')' = 0.
    Oscillatory,
    /// Coupled on T enlarged by this many fine cells on each side, restricted to T and made nodal. Not conforming: a cell
    /// whose patch the boundary cuts off has other traces than its neighbour, so that even affine fields of a homogeneous body
    /// have an error there.
    Oversampled(usize),
    /// hat_p e_k and a periodic field that vanishes at the corners. Not conforming.
    Periodic,
}

impl Basis {
    /// Whether the functions of neighbouring cells agree on their common edge.
    pub fn is_conforming(self) -> bool {
        !matches!(self, Self::Oversampled(_) | Self::Periodic)
    }

    /// The word of the scene file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Q1 => "q1",
            Self::Linear => "linear",
            Self::Coupled => "coupled",
            Self::Oscillatory => "oscillatory",
            Self::Oversampled(_) => "oversampled",
            Self::Periodic => "periodic",
        }
    }
}

/// R_T and R_Tᵀ K_T R_T of a coarse cell.
///
/// Source: Issaoui (2014), equations (5.24) and (5.28).
#[derive(Debug, Clone)]
pub struct CellBasis {
    /// Fine cells m, n.
    pub size: [usize; 2],
    /// R_T: row 2·node + component of the (m+1)(n+1) nodes, j·(m+1) + i; column 2·corner + direction.
    pub values: Vec<[f64; 8]>,
    /// K_T^H = R_Tᵀ K_T R_T (stress).
    pub stiffness: [[f64; 8]; 8],
}

impl CellBasis {
    /// C_ab = Ū_aᵀ K_T^H Ū_b / |T|, Ū_a the corner displacements of the unit Voigt strain a (stress), on fine cells with
    /// these sides: the homogenised tensor of a periodic body for [`Basis::Periodic`], an upper bound of it (uniform strain
    /// on the boundary) for [`Basis::Coupled`].
    ///
    /// Source: Zhang, Fu and Wu, *Extended multiscale finite element method for mechanical analysis of periodic lattice
    /// truss materials*, Int. J. Multiscale Comput. Eng. 8 (2010); periodic cells: Sanchez-Palencia, *Non-homogeneous media
    /// and vibration theory*, 1980.
    pub fn tensor(&self, spacing: [f64; 2]) -> [[f64; 3]; 3] {
        let [lx, ly] = [0, 1].map(|k| self.size[k] as f64 * spacing[k]);
        let corners = [[0.0, 0.0], [lx, 0.0], [lx, ly], [0.0, ly]];
        // 2 ε_xy = 1 by a half in each component
        let strain = |a: usize, [x, y]: [f64; 2]| [[x, 0.0], [0.0, y], [y / 2.0, x / 2.0]][a];
        let field = |a: usize| -> [f64; 8] { std::array::from_fn(|c| strain(a, corners[c / 2])[c % 2]) };
        let fields = [0, 1, 2].map(field);
        let form = |u: &[f64; 8], v: &[f64; 8]| -> f64 {
            (0..8).map(|a| u[a] * (0..8).map(|b| self.stiffness[a][b] * v[b]).sum::<f64>()).sum()
        };
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| form(&fields[a], &fields[b]) / (lx * ly)))
    }
}

/// The data on which a basis depends: a patch of cells around a coarse cell.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// Cells of the patch.
    pub size: [usize; 2],
    /// Their numbers in the body, (i, j) at i·n + j.
    pub cells: Vec<usize>,
    /// First cell of T in the patch.
    pub first: [usize; 2],
    /// Cells of T.
    pub inner: [usize; 2],
    /// Moduli along the lower, right, upper and left edge; for oscillatory bases.
    pub edges: Option<[Vec<f64>; 4]>,
}

impl Patch {
    /// The cells of T.
    pub fn inner_cells(&self) -> Vec<usize> {
        let [m, n] = self.inner;
        let at = |c: usize| self.cells[(self.first[0] + c / n) * self.size[1] + self.first[1] + c % n];
        (0..m * n).map(at).collect()
    }
}

/// φ with φ(0) = 1, φ(L) = 0, (E φ')' = 0 at the nodes of an edge: 1 - ∫₀ˢ E⁻¹ / ∫₀ᴸ E⁻¹.
pub(crate) fn bar(edge: &[f64]) -> Vec<f64> {
    let total: f64 = edge.iter().map(|e| 1.0 / e).sum();
    let mut sum = 0.0;
    let mut phi = vec![1.0];
    for (k, e) in edge.iter().enumerate() {
        sum += 1.0 / e;
        phi.push(if k + 1 == edge.len() { 0.0 } else { 1.0 - sum / total });
    }
    phi
}

/// hat_p e_k at all nodes.
pub(crate) fn bilinear([m, n]: [usize; 2]) -> Columns {
    let mut columns = vec![[0.0; 8]; 2 * nodes([m, n])];
    for j in 0..=n {
        for i in 0..=m {
            let hats = crate::elasticity::shape([i as f64 / m as f64, j as f64 / n as f64]);
            for k in 0..2 {
                (0..4).for_each(|p| columns[2 * (j * (m + 1) + i) + k][2 * p + k] = hats[p]);
            }
        }
    }
    columns
}

/// The boundary data of coupled and oscillatory bases; 0 inside.
fn boundary_data(size: [usize; 2], edges: Option<&[Vec<f64>; 4]>) -> Columns {
    let [m, n] = size;
    let mut columns = bilinear(size);
    for j in 1..n {
        for i in 1..m {
            let node = j * (m + 1) + i;
            (columns[2 * node], columns[2 * node + 1]) = ([0.0; 8], [0.0; 8]);
        }
    }
    if let Some([lower, right, upper, left]) = edges {
        // moduli, corners at its ends, direction, first node
        let along =
            [(lower, [0, 1], 0, 0), (right, [1, 2], 1, m), (upper, [3, 2], 0, n * (m + 1)), (left, [0, 3], 1, 0)];
        for (young, [a, b], k, first) in along {
            for (s, phi) in bar(young).into_iter().enumerate() {
                let node = first + if k == 0 { s } else { s * (m + 1) };
                let row = &mut columns[2 * node + k];
                (0..4).for_each(|p| row[2 * p + k] = 0.0);
                (row[2 * a + k], row[2 * b + k]) = (phi, 1.0 - phi);
            }
        }
    }
    columns
}

/// The columns that follow from five solutions: translations and the rotation are combinations of the basis functions.
fn complete(values: &mut Columns, [m, n]: [usize; 2], [hx, hy]: [f64; 2]) {
    let (lx, ly) = (m as f64 * hx, n as f64 * hy);
    for (dof, row) in values.iter_mut().enumerate() {
        let (node, k) = (dof / 2, dof % 2);
        let (x, y) = ((node % (m + 1)) as f64 * hx, (node / (m + 1)) as f64 * hy);
        let rotation = [-y, x][k];
        let unit = |direction: usize| if direction == k { 1.0 } else { 0.0 };
        row[6] = unit(0) - row[0] - row[2] - row[4];
        row[5] = (rotation + ly * (row[4] + row[6])) / lx - row[3];
        row[7] = unit(1) - row[1] - row[3] - row[5];
    }
}

/// Σ_e R_eᵀ K_e R_e over the cells of T.
pub(crate) fn coarse_stiffness(size: [usize; 2], cells: &CellMatrices, values: &Columns) -> [[f64; 8]; 8] {
    let mut stiffness = [[0.0; 8]; 8];
    for cell in 0..size[0] * size[1] {
        let (young, unit) = cells.of(cell);
        let rows = cell_dofs(size, cell / size[1], cell % size[1]).map(|d| values[d]);
        for (a, unit) in unit.iter().enumerate() {
            let mut force = [0.0; 8];
            for (k, row) in unit.iter().zip(&rows) {
                (0..8).for_each(|c| force[c] += young * k * row[c]);
            }
            for (r, line) in stiffness.iter_mut().enumerate() {
                (0..8).for_each(|c| line[c] += rows[a][r] * force[c]);
            }
        }
    }
    stiffness
}

/// Cells of a rectangle, and which of its displacements are free.
type Shape = ([usize; 2], Freedom);

/// Structures of local problems by size and freedom, each analysed once.
#[derive(Debug, Default)]
pub(crate) struct Structures {
    known: Mutex<HashMap<Shape, Arc<LocalProblem>>>,
}

impl Structures {
    /// The local problem of this size and freedom, analysed at its first use.
    ///
    /// # Errors
    /// As [`LocalProblem::new`].
    pub fn get(&self, size: [usize; 2], freedom: Freedom) -> Result<Arc<LocalProblem>, MsfemError> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(problem) = known.get(&(size, freedom)) {
            return Ok(Arc::clone(problem));
        }
        let problem = Arc::new(LocalProblem::new(size, freedom)?);
        known.insert((size, freedom), Arc::clone(&problem));
        Ok(problem)
    }
}

/// The basis of T in its patch of a body.
pub(crate) fn cell_basis(
    kind: Basis,
    patch: &Patch,
    body: &HeterogeneousBody,
    structures: &Structures,
) -> Result<CellBasis, MsfemError> {
    let (size, spacing) = (patch.size, body.grid.spacing);
    let cells = body.matrices(&patch.cells);
    let mut values = match kind {
        Basis::Q1 => bilinear(size),
        Basis::Linear => {
            let mut values = bilinear(size);
            for k in 0..2 {
                let problem = structures.get(size, Freedom::Component(k))?;
                let factor = problem.factorise(&cells)?;
                let mut solved = bilinear(size);
                problem.solve(factor.as_ref(), &cells, &mut solved, &[k, 2 + k, 4 + k], None);
                for node in 0..nodes(size) {
                    let row = &solved[2 * node + k];
                    let known = [row[k], row[2 + k], row[4 + k]];
                    (0..3).for_each(|p| values[2 * node + k][2 * p + k] = known[p]);
                    values[2 * node + k][6 + k] = 1.0 - known.iter().sum::<f64>();
                }
            }
            values
        }
        Basis::Coupled | Basis::Oscillatory | Basis::Oversampled(_) => {
            let problem = structures.get(size, Freedom::Interior)?;
            let factor = problem.factorise(&cells)?;
            let mut values = boundary_data(size, patch.edges.as_ref());
            problem.solve(factor.as_ref(), &cells, &mut values, &[0, 1, 2, 3, 4], None);
            complete(&mut values, size, spacing);
            values
        }
        Basis::Periodic => {
            let problem = structures.get(size, Freedom::Periodic)?;
            let factor = problem.factorise(&cells)?;
            let mut values = bilinear(size);
            problem.solve(factor.as_ref(), &cells, &mut values, &[0, 1, 2, 3, 4], None);
            complete(&mut values, size, spacing);
            values
        }
    };
    if patch.inner != size {
        values = restrict(&values, patch);
    }
    let stiffness = coarse_stiffness(patch.inner, &body.matrices(&patch.inner_cells()), &values);
    Ok(CellBasis { size: patch.inner, values, stiffness })
}

/// The rows of T, R ← R (R_corner)⁻¹.
fn restrict(values: &Columns, patch: &Patch) -> Columns {
    let [m, n] = patch.inner;
    let mut rows = Vec::with_capacity(2 * nodes(patch.inner));
    for j in 0..=n {
        for i in 0..=m {
            let node = (patch.first[1] + j) * (patch.size[0] + 1) + patch.first[0] + i;
            rows.extend([values[2 * node], values[2 * node + 1]]);
        }
    }
    let corner = [0, m, (n + 1) * (m + 1) - 1, n * (m + 1)];
    let at_corners = Mat::from_fn(8, 8, |a, c| rows[2 * corner[a / 2] + a % 2][c]);
    let inverse = Lu::new(at_corners.as_ref()).inverse();
    for row in &mut rows {
        let old = *row;
        *row = std::array::from_fn(|c| (0..8).map(|k| old[k] * inverse[(k, c)]).sum());
    }
    rows
}
