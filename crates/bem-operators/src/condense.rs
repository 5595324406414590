//! Elimination of the free unknowns, in the storage of S itself.

use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::prelude::*;
use faer::{Col, Mat, MatMut, Par};
use steklov_algebra::{Image, add_to_lower, check_cholesky, cholesky, scaled_probe, solve_lower};

use crate::steklov::{is_finite, of_factor};
use crate::{BemError, Dof};

/// The treatment of the unknowns: each displacement unknown is eliminated, kept, or held at a value.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Partition {
    /// Unknowns that stay, in the order of the condensed system (the contact unknowns).
    pub kept: Vec<Dof>,
    /// Unknowns whose value is prescribed, with the value.
    pub held: Vec<(Dof, f64)>,
    /// Nodes whose two unknowns are taken along other directions: unknown 2·node along the first, 2·node+1 along the
    /// second of two orthonormal directions.
    pub frames: Vec<(usize, [[f64; 2]; 2])>,
}

/// S with the free unknowns R eliminated and the kept unknowns K left: S_c = S_KK - S_KR S_RR⁻¹ S_RK.
///
/// Unknowns are reordered R, K, held, turned into their frames, and S_RR is factorised in the lower triangle of S's own
/// storage, while its upper triangle still holds S.
#[derive(Debug, Clone)]
pub struct Condensation {
    parts: CondensationParts,
    /// The image of L⁻¹ S_RK; none if the parts were read.
    of_coupling: Option<Image>,
}

/// The parts of a [`Condensation`].
#[derive(Debug, Clone)]
pub struct CondensationParts {
    /// Strict upper triangle: S in the order of the positions; lower triangle: L of S_RR, and S_KR L⁻ᵀ below it. The rest
    /// of the lower triangle is not used.
    pub matrix: Mat<f64>,
    /// Diagonal of S.
    pub diagonal: Vec<f64>,
    /// Unknown at each position: eliminated, kept, held.
    pub order: Vec<Dof>,
    /// How many are eliminated.
    pub eliminated: usize,
    /// How many are kept.
    pub kept: usize,
    /// Values of the held ones.
    pub held: Vec<f64>,
    /// As in [`Partition`].
    pub frames: Vec<(usize, [[f64; 2]; 2])>,
}

/// A load reduced to the kept unknowns.
#[derive(Debug, Clone)]
pub struct CondensedLoad {
    /// f_K - S_KR S_RR⁻¹ f_R - …, in the order of the kept unknowns.
    pub kept: Vec<f64>,
    /// L⁻¹ (f_R - S_RH u_H).
    eliminated: Vec<f64>,
    /// u_H.
    held: Vec<f64>,
}

impl Condensation {
    /// Eliminates all unknowns that `partition` neither keeps nor holds.
    ///
    /// `motions` are rigid motions (nodal vectors) that nothing resists: each is given a spring, so that the solution of
    /// a balanced load is orthogonal to it. The spring does no work in that solution.
    ///
    /// Cost: n³/3 for n eliminated unknowns and n² per kept one; no memory beyond S_c.
    /// # Errors
    /// [`BemError::StiffnessSingular`] when the eliminated unknowns can still move rigidly, [`BemError::Fault`].
    /// # Panics
    /// When an unknown is kept and held, or kept twice.
    pub fn new(mut matrix: Mat<f64>, partition: &Partition, motions: &[Vec<f64>]) -> Result<Self, BemError> {
        let n = matrix.nrows();
        add_springs(matrix.as_mut(), motions);
        for &(node, frame) in &partition.frames {
            rotate(matrix.as_mut(), node, frame);
        }
        let mut taken = vec![false; n];
        for dof in partition.kept.iter().copied().chain(partition.held.iter().map(|h| h.0)) {
            assert!(!std::mem::replace(&mut taken[dof], true), "unknown {dof} is kept or held twice");
        }
        let mut order: Vec<Dof> = (0..n).filter(|&dof| !taken[dof]).collect();
        let (eliminated, kept) = (order.len(), partition.kept.len());
        order.extend(&partition.kept);
        order.extend(partition.held.iter().map(|h| h.0));
        permute(matrix.as_mut(), &order);
        let diagonal: Vec<f64> = (0..n).map(|i| matrix[(i, i)]).collect();

        cholesky(matrix.as_mut().submatrix_mut(0, 0, eliminated, eliminated))
            .map_err(|none| none.or(|pivot| BemError::StiffnessSingular { pivot, size: eliminated }))?;
        let smallest =
            (0..eliminated).map(|i| (i, matrix[(i, i)].powi(2) / diagonal[i])).min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((pivot, ratio)) = smallest
            && ratio < 1e-13
        {
            return Err(BemError::StiffnessSingular { pivot, size: eliminated });
        }
        let (upper, lower) = matrix.as_mut().split_at_row_mut(eliminated);
        let factor = upper.rb().submatrix(0, 0, eliminated, eliminated);
        let coupling = lower.submatrix_mut(0, 0, kept, eliminated);
        let of_coupling = solve_lower(factor, coupling.transpose_mut(), None)?;

        let held = partition.held.iter().map(|h| h.1).collect();
        let frames = partition.frames.clone();
        let parts = CondensationParts { matrix, diagonal, order, eliminated, kept, held, frames };
        Ok(Self { parts, of_coupling: Some(of_coupling) })
    }

    /// Its parts.
    pub fn parts(&self) -> &CondensationParts {
        &self.parts
    }

    /// The condensation of these parts. A vector shows in n² operations that L Lᵀ = S_RR and C Lᵀ = S_KR.
    ///
    /// # Errors
    /// [`BemError::Part`] for a part that does not fit.
    pub fn from_parts(parts: CondensationParts) -> Result<Self, BemError> {
        parts.check()?;
        Ok(Self { parts, of_coupling: None })
    }

    /// S_c, kept × kept, full storage.
    ///
    /// # Errors
    /// [`BemError::Fault`].
    pub fn stiffness(&self) -> Result<Mat<f64>, BemError> {
        let (r, k) = (self.parts.eliminated, self.parts.kept);
        let coupling = self.coupling();
        let mut condensed = Mat::from_fn(k, k, |i, j| self.entry(r + i.min(j), r + i.max(j)));
        add_to_lower(condensed.as_mut(), coupling, coupling.transpose(), -1.0, self.of_coupling.as_ref())?;
        crate::steklov::mirror_lower(condensed.as_mut());
        Ok(condensed)
    }

    /// Reduces a nodal load (interleaved x, y, all unknowns) and the forces of the held values.
    pub fn load(&self, load: &[f64]) -> CondensedLoad {
        self.load_held(load, &self.parts.held)
    }

    /// As [`Self::load`], with other values of the held unknowns, in the order of [`Partition::held`].
    ///
    /// # Panics
    /// When there are fewer or more of them.
    pub fn load_held(&self, load: &[f64], held: &[f64]) -> CondensedLoad {
        assert_eq!(held.len(), self.parts.held.len(), "values of held unknowns");
        let (r, k) = (self.parts.eliminated, self.parts.kept);
        let mut f = self.to_positions(load);
        for (h, &value) in held.iter().enumerate() {
            if value != 0.0 {
                for i in 0..r + k {
                    f[i] -= self.entry(i, r + k + h) * value;
                }
            }
        }
        let mut y = Col::from_fn(r, |i| f[i]);
        solve_lower_triangular_in_place(self.factor(), y.as_mat_mut(), Par::Seq);
        let correction = self.coupling() * &y;
        CondensedLoad {
            kept: (0..k).map(|i| f[r + i] - correction[i]).collect(),
            eliminated: y.iter().copied().collect(),
            held: held.to_vec(),
        }
    }

    /// Reduces the nodal load of a correction: all held values are 0.
    pub fn load_of_correction(&self, load: &[f64]) -> CondensedLoad {
        self.load_held(load, &vec![0.0; self.parts.held.len()])
    }

    /// Nodal displacement (interleaved x, y) from the kept values, in equilibrium with the load at the eliminated unknowns.
    pub fn expand(&self, load: &CondensedLoad, kept: &[f64]) -> Vec<f64> {
        let v = Col::from_fn(self.parts.kept, |i| kept[i]);
        let mut u = Col::from_fn(self.parts.eliminated, |i| load.eliminated[i]);
        u -= self.coupling().transpose() * &v;
        solve_upper_triangular_in_place(self.factor().transpose(), u.as_mat_mut(), Par::Seq);
        let positions: Vec<f64> = u.iter().chain(kept).chain(&load.held).copied().collect();
        self.to_nodes(&positions)
    }

    /// Number of all unknowns.
    pub fn size(&self) -> usize {
        self.parts.order.len()
    }

    /// Largest diagonal entry of S: the scale of S u is this times that of u.
    pub fn largest_diagonal(&self) -> f64 {
        self.parts.diagonal.iter().fold(0.0, |m: f64, d| m.max(*d))
    }

    /// S u of a nodal displacement (both interleaved x, y).
    pub fn multiply(&self, displacement: &[f64]) -> Vec<f64> {
        let u = self.to_positions(displacement);
        let mut result: Vec<f64> = u.iter().zip(&self.parts.diagonal).map(|(u, d)| u * d).collect();
        for first in (0..u.len()).step_by(BESIDE) {
            let columns = first..(first + BESIDE).min(u.len());
            let done = if columns.len() == BESIDE { self.add_columns(first, &u, &mut result) } else { [0.0; BESIDE] };
            let from = if columns.len() == BESIDE { first } else { 0 };
            for (j, mut sum) in columns.zip(done) {
                for (i, &s) in (from..j).zip(&self.parts.matrix.col_as_slice(j)[from..j]) {
                    sum += s * u[i];
                    result[i] += s * u[j];
                }
                result[j] += sum;
            }
        }
        self.to_nodes(&result)
    }

    /// Adds the part of the columns from `first` on above that row to S u, and returns what their transposes add to it at the columns. Each
    /// entry is summed in the order of single columns.
    fn add_columns(&self, first: usize, u: &[f64], result: &mut [f64]) -> [f64; BESIDE] {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| &self.parts.matrix.col_as_slice(first + k)[..first]);
        let (above, own) = (&u[..first], &u[first..first + BESIDE]);
        let mut sums = [0.0; BESIDE];
        for (i, result) in result[..first].iter_mut().enumerate() {
            sums[0] += a[i] * above[i];
            sums[1] += b[i] * above[i];
            sums[2] += c[i] * above[i];
            sums[3] += d[i] * above[i];
            *result = *result + a[i] * own[0] + b[i] * own[1] + c[i] * own[2] + d[i] * own[3];
        }
        sums
    }

    fn factor(&self) -> faer::MatRef<'_, f64> {
        self.parts.matrix.as_ref().submatrix(0, 0, self.parts.eliminated, self.parts.eliminated)
    }

    fn coupling(&self) -> faer::MatRef<'_, f64> {
        self.parts.matrix.as_ref().submatrix(self.parts.eliminated, 0, self.parts.kept, self.parts.eliminated)
    }

    /// Entry of S at positions i ≤ j.
    fn entry(&self, i: usize, j: usize) -> f64 {
        if i == j { self.parts.diagonal[i] } else { self.parts.matrix[(i, j)] }
    }

    fn to_positions(&self, nodal: &[f64]) -> Vec<f64> {
        let mut turned = nodal.to_vec();
        for &(node, [a, b]) in &self.parts.frames {
            let (x, y) = (nodal[2 * node], nodal[2 * node + 1]);
            turned[2 * node] = a[0] * x + a[1] * y;
            turned[2 * node + 1] = b[0] * x + b[1] * y;
        }
        self.parts.order.iter().map(|&dof| turned[dof]).collect()
    }

    fn to_nodes(&self, positions: &[f64]) -> Vec<f64> {
        let mut nodal = vec![0.0; positions.len()];
        for (&dof, &value) in self.parts.order.iter().zip(positions) {
            nodal[dof] = value;
        }
        for &(node, [a, b]) in &self.parts.frames {
            let (p, q) = (nodal[2 * node], nodal[2 * node + 1]);
            nodal[2 * node] = a[0] * p + b[0] * q;
            nodal[2 * node + 1] = a[1] * p + b[1] * q;
        }
        nodal
    }
}

/// Columns of S that are multiplied side by side: their sums do not wait for each other.
const BESIDE: usize = 4;

/// Rounding of C Lᵀ over the number of its terms and the root of the diagonal.
const SAME: f64 = 1e-11;

impl CondensationParts {
    fn check(&self) -> Result<(), BemError> {
        let wrong = |part: &'static str, what: String| Err(BemError::Part { part, what });
        let (n, r, k) = (self.order.len(), self.eliminated, self.kept);
        if (self.matrix.nrows(), self.matrix.ncols(), self.diagonal.len()) != (n, n, n) || n % 2 != 0 {
            let what = format!("it is {}×{} for {n} unknowns", self.matrix.nrows(), self.matrix.ncols());
            return wrong("S", what);
        }
        if r.checked_add(k).and_then(|all| all.checked_add(self.held.len())) != Some(n) {
            return wrong("held_values", format!("{r} eliminated, {k} kept, {} held of {n}", self.held.len()));
        }
        let mut taken = vec![false; n];
        for (position, &dof) in self.order.iter().enumerate() {
            if dof >= n || std::mem::replace(&mut taken[dof], true) {
                let part = ["eliminated", "kept", "held"][usize::from(position >= r) + usize::from(position >= r + k)];
                return wrong(part, format!("unknown {dof} of {n} stands there twice or is none"));
            }
        }
        if !is_finite(&self.matrix) || !self.diagonal.iter().all(|d| d.is_finite()) {
            return wrong("S", "an entry of it, of L or of the coupling is not finite".into());
        }
        if let Some(value) = self.held.iter().find(|v| !v.is_finite()) {
            return wrong("held_values", format!("{value} is no displacement"));
        }
        let mut turned = vec![false; n / 2];
        for &(node, [a, b]) in &self.frames {
            let products =
                [a[0] * a[0] + a[1] * a[1] - 1.0, b[0] * b[0] + b[1] * b[1] - 1.0, a[0] * b[0] + a[1] * b[1]];
            if node >= n / 2 || std::mem::replace(&mut turned[node], true) {
                return wrong("frame_nodes", format!("node {node} of {} is turned twice or is none", n / 2));
            }
            if !products.iter().all(|p| p.abs() <= 1e-9) {
                return wrong("frames", format!("{a:?} and {b:?} are not orthonormal"));
            }
        }
        self.check_factor()
    }

    fn check_factor(&self) -> Result<(), BemError> {
        let wrong = |part: &'static str, what: String| Err(BemError::Part { part, what });
        let (r, k) = (self.eliminated, self.kept);
        let factor = self.matrix.as_ref().submatrix(0, 0, r, r);
        if let Some(i) = (0..r).find(|&i| factor[(i, i)] <= 0.0) {
            return wrong("L", format!("pivot {i} is {}", factor[(i, i)]));
        }
        let mut stiffness = of_factor(factor);
        (0..r).for_each(|i| stiffness[(i, i)] = self.diagonal[i]);
        if let Err(fault) = check_cholesky(stiffness.as_ref(), factor) {
            return wrong("L", format!("L L^T is not S of the eliminated unknowns: {fault}"));
        }
        let probe = scaled_probe(self.diagonal[..r].iter().copied());
        let transposed = |j: usize| (j..r).map(|i| factor[(i, j)] * probe[i]).sum::<f64>();
        let inner: Vec<f64> = (0..r).map(transposed).collect();
        for row in r..r + k {
            let of_coupling: f64 = (0..r).map(|j| self.matrix[(row, j)] * inner[j]).sum();
            let of_stiffness: f64 = (0..r).map(|i| self.matrix[(i, row)] * probe[i]).sum();
            let rounding = SAME * r as f64 * self.diagonal[row].max(0.0).sqrt();
            if (of_coupling - of_stiffness).abs() > rounding {
                let what = format!("row {} makes {of_coupling} of a vector, S {of_stiffness}", row - r);
                return wrong("coupling", what);
            }
        }
        Ok(())
    }
}

/// Springs that hold motions: forces -σ Σ r (r·u) on a displacement u.
#[derive(Debug, Clone)]
pub(crate) struct Springs {
    /// σ.
    stiffness: f64,
    /// r, orthonormal.
    motions: Vec<Vec<f64>>,
}

impl Springs {
    /// Their forces on the body.
    pub(crate) fn forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; displacement.len()];
        for r in &self.motions {
            let along: f64 = r.iter().zip(displacement).map(|(r, u)| r * u).sum();
            forces.iter_mut().zip(r).for_each(|(f, r)| *f -= self.stiffness * along * r);
        }
        forces
    }
}

/// S + σ Σ r rᵀ with orthonormal r and σ the mean diagonal of S.
pub(crate) fn add_springs(mut s: MatMut<'_, f64>, motions: &[Vec<f64>]) -> Springs {
    let n = s.nrows();
    let scale = (0..n).map(|i| s[(i, i)]).sum::<f64>() / n as f64;
    let mut orthonormal: Vec<Vec<f64>> = Vec::new();
    for motion in motions {
        let mut r = motion.clone();
        for other in &orthonormal {
            let dot: f64 = other.iter().zip(&r).map(|(a, b)| a * b).sum();
            r.iter_mut().zip(other).for_each(|(a, b)| *a -= dot * b);
        }
        let norm = r.iter().map(|v| v * v).sum::<f64>().sqrt();
        r.iter_mut().for_each(|v| *v /= norm);
        orthonormal.push(r);
    }
    for r in &orthonormal {
        for j in 0..n {
            let factor = scale * r[j];
            for (s, r) in s.rb_mut().col_mut(j).iter_mut().zip(r) {
                *s += factor * r;
            }
        }
    }
    Springs { stiffness: scale, motions: orthonormal }
}

/// Turns the two unknowns of a node: S := Rᵀ S R with the directions as columns of R.
fn rotate(mut s: MatMut<'_, f64>, node: usize, [a, b]: [[f64; 2]; 2]) {
    let (i, j) = (2 * node, 2 * node + 1);
    for k in 0..s.nrows() {
        let (x, y) = (s[(k, i)], s[(k, j)]);
        s[(k, i)] = a[0] * x + a[1] * y;
        s[(k, j)] = b[0] * x + b[1] * y;
    }
    for k in 0..s.ncols() {
        let (x, y) = (s[(i, k)], s[(j, k)]);
        s[(i, k)] = a[0] * x + a[1] * y;
        s[(j, k)] = b[0] * x + b[1] * y;
    }
}

/// S := S[order, order], in place: rows column by column, then columns along the cycles of the permutation.
fn permute(mut s: MatMut<'_, f64>, order: &[usize]) {
    let n = s.nrows();
    let mut column = vec![0.0; n];
    for j in 0..n {
        column.iter_mut().zip(s.rb().col(j).iter()).for_each(|(c, v)| *c = *v);
        s.rb_mut().col_mut(j).iter_mut().zip(order).for_each(|(v, &i)| *v = column[i]);
    }
    let mut done = vec![false; n];
    for start in 0..n {
        if done[start] {
            continue;
        }
        column.iter_mut().zip(s.rb().col(start).iter()).for_each(|(c, v)| *c = *v);
        let mut j = start;
        loop {
            done[j] = true;
            let from = order[j];
            if from == start {
                s.rb_mut().col_mut(j).iter_mut().zip(&column).for_each(|(v, c)| *v = *c);
                break;
            }
            for i in 0..n {
                s[(i, j)] = s[(i, from)];
            }
            j = from;
        }
    }
}
