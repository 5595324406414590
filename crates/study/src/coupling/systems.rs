//! The systems on the interface as dense matrices, whose signs and factors may be changed.

use faer::{Mat, Scale};
use sprs::CsMat;
use steklov_algebra::Lu;
use steklov_coupling::{CouplingError, Interior, Medium};
use steklov_msfem::{Elimination, HeterogeneousBody, ReducedLoad};

use super::grids::Level;
use super::manufactured::Manufactured;

/// A manufactured problem, reduced to the interface. The boundary elements have degree 1 and the points of the trace as nodes,
/// so that Π = I and B = M.
pub(super) struct Reduced {
    /// The body.
    pub body: HeterogeneousBody,
    exterior: Medium,
    elimination: Elimination,
    load: ReducedLoad,
    /// A_c.
    stiffness: Mat<f64>,
    /// u0.
    jump: Vec<f64>,
    /// M.
    mass: Mat<f64>,
}

fn dense(sparse: &CsMat<f64>) -> Mat<f64> {
    let mut full = Mat::zeros(sparse.rows(), sparse.cols());
    for (&value, (i, j)) in sparse {
        full[(i, j)] = value;
    }
    full
}

fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |i, _| values[i])
}

/// Solves by LU, because a wrong matrix need not be definite.
fn solve(matrix: &Mat<f64>, right: &Mat<f64>) -> Vec<f64> {
    Lu::new(matrix.as_ref()).solve(right.as_ref()).col_as_slice(0).to_vec()
}

impl Reduced {
    /// The matrices of body and medium on one level, the interior displacements eliminated.
    ///
    /// # Errors
    /// [`CouplingError`] if the grid has no outer boundary that is one curve, if the medium has no operators on it, or if the
    /// stiffness of the body cannot be factorised.
    pub fn new(exact: &Manufactured<'_>, level: &Level) -> Result<Self, CouplingError> {
        let problem = exact.problem(&level.grid)?;
        let interior = Interior::fine(&problem.body, &problem.loads)?;
        let exterior = exact.exterior(&interior)?;
        let Interior { stiffness, load, order, trace } = interior;
        let elimination = Elimination::new(stiffness, &order, &trace.unknowns, &[])?;
        let load = elimination.reduce(&load, &[]);
        let jump = exterior.space.interpolate(|x| exact.jump(x));
        let mass = dense(&exterior.operators.mass);
        Ok(Self { body: problem.body, stiffness: elimination.stiffness()?, exterior, elimination, load, jump, mass })
    }

    /// W + Hᵀ V⁻¹ H with H = K + `half` M: the medium has half = -½, the body itself ½.
    pub fn steklov(&self, half: f64) -> Mat<f64> {
        let operators = &self.exterior.operators;
        let h = &operators.k + Scale(half) * &self.mass;
        &operators.w + h.transpose() * Lu::new(operators.v.as_ref()).solve(h.as_ref())
    }

    /// Solves (A_c + S) v = f_c + S u0 with any S; returns the field at all nodes.
    pub fn with_operator(&self, s: &Mat<f64>) -> Vec<f64> {
        let right = column(&self.load.kept) + s * column(&self.jump);
        self.elimination.expand(&self.load, &solve(&(&self.stiffness + s), &right))
    }

    /// The matrix of the three-field form with a factor before W and the first `motions` of two translations and the
    /// rotation removed. Tractions are in units of E/L, L the size of the body, and forces in units of E of the medium,
    /// so that the matrix has no unit.
    pub fn three_field(&self, factor: f64, motions: usize) -> Mat<f64> {
        let operators = &self.exterior.operators;
        let (young, length, n) = (self.exterior.material.young, operators.length, self.jump.len());
        let points = &self.exterior.space.points;
        let centre = [0, 1].map(|i| points.iter().map(|x| x[i]).sum::<f64>() / points.len() as f64);
        let mut z = Mat::from_fn(n, motions, |row, k| match (k, row % 2) {
            (2, 0) => centre[1] - points[row / 2][1],
            (2, _) => points[row / 2][0] - centre[0],
            (k, i) => f64::from(u8::from(k == i)),
        });
        for k in 0..motions {
            let norm = z.col(k).norm_l2();
            (0..n).for_each(|i| z[(i, k)] /= norm);
        }
        let scale = (0..n).fold(0.0f64, |m, i| m.max(operators.w[(i, i)])) / young;
        let plus = &operators.k + Scale(0.5) * &self.mass;
        let mut matrix = Mat::zeros(3 * n, 3 * n);
        let mut put = |i: usize, j: usize, block: Mat<f64>| {
            matrix.get_mut(i * n..(i + 1) * n, j * n..(j + 1) * n).copy_from(&block);
            matrix.get_mut(j * n..(j + 1) * n, i * n..(i + 1) * n).copy_from(block.transpose());
        };
        put(0, 0, &self.stiffness * Scale(1.0 / young));
        put(1, 0, &self.mass * Scale(-1.0 / length));
        put(1, 1, &operators.v * Scale(-young / (length * length)));
        put(1, 2, plus * Scale(1.0 / length));
        put(2, 2, &operators.w * Scale(factor / young) + Scale(scale) * &z * z.transpose());
        matrix
    }

    /// Solves the three-field form with a factor before W; returns the field at all nodes.
    pub fn by_three_fields(&self, factor: f64) -> Vec<f64> {
        let (young, length, n) = (self.exterior.material.young, self.exterior.operators.length, self.jump.len());
        let mut right: Vec<f64> = self.load.kept.iter().map(|f| f / young).collect();
        right.extend((&self.mass * column(&self.jump)).col_as_slice(0).iter().map(|m| -m / length));
        right.resize(3 * n, 0.0);
        let solved = solve(&self.three_field(factor, 3), &column(&right));
        self.elimination.expand(&self.load, &solved[..n])
    }
}
