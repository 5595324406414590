//! Stabilised mixed hp boundary elements: multipliers on a mesh of their own.
//!
//! ```text
//! <S u, v> + b(λ, v) - ∫ γ (λ + σ^h(u) + τ)·σ^h(v) = L(v)              γ = γ₀ h/p² on every element of T_h
//! b(μ-λ, u) - ∫ γ (μ-λ)·(λ + σ^h(u) + τ) ≤ <g, μ_n-λ_n>                 for λ, μ that obey the signs at the nodes
//! ```
//! σ^h(u) = S_hp u pointwise, τ the traction of a body force's particular solution u_p less σ^h(u_p) (0 without),
//! b(μ, v) = ∫ μ_n v_n + μ_t v_t. The constant normal stress is damped in the integrals of γ, for ν → ½ (`uniform_pressure`).
//! With E = B - C, B_γ = ∫ γ σ^h·σ^h, C = ∫ γ μ·σ^h, D = ∫ γ μ·μ the form is
//!
//! ```text
//! [ S - B_γ   Eᵀ ] [u]   [ f + ∫γτσ^h ]             r = E u - D λ - ∫ γ μ·τ - g
//! [ E        -D  ] [λ]                              λ_n ≥ 0,  r_n ≤ 0,  λ_n r_n = 0, friction likewise
//! ```
//! Let y = E u - D λ. Then λ = D⁻¹(E u - y), and u is eliminated: with Z = S - B_γ + EᵀD⁻¹E
//!
//! ```text
//! (D⁻¹ - D⁻¹E Z⁻¹ EᵀD⁻¹) y + λ = D⁻¹E Z⁻¹ f
//! ```
//! which with y = weight · displacement is a [`Problem`] with one node for each node of the multipliers: all its solvers
//! apply, floating bodies included (Z is regular even if S is not).

use faer::{Mat, Scale};
use steklov_algebra::{Cholesky, add_product, check_inverse, llt, solve_lower, solve_lower_transposed};
use steklov_bem_operators::{Dof, Mesh, ParticularSolution, Space, TractionMap, graded_panels, steklov_trace_rows};
use steklov_elastic::Material;
use steklov_elastic::plane::dot;
use steklov_quadrature::gauss_legendre;

use crate::on_mesh::inf_sup::dual_form;
use crate::on_mesh::multiplier_space::{CURVE_POINTS, frame};
use crate::on_mesh::node_data::{NodeData, node_data};
use crate::on_mesh::stabilised_parts::StabilisedParts;
use crate::on_mesh::uniform_pressure::UniformPressure;
use crate::solvers::lanczos::largest_eigenvalue;
use crate::{Condition, ContactError, ContactNode, MultiplierSpace, Problem, SideData};

/// The forms of the stabilisation with γ₀ = 1. All integrals of γ share one rule, graded to the ends of the elements of T_h, so that
/// ∫ γ |λ + σ^h|² is a sum of squares whatever its points.
///
/// Source: Banz, Gimperlein, Issaoui and Stephan (2017); Issaoui (2014), equation (3.8); after Barbosa and Hughes (1991)
/// and Hild and Renard (2010).
pub struct StabilisedForms {
    parts: StabilisedParts,
    /// Q of normal stresses.
    uniform: UniformPressure,
}

/// A stabilised problem, condensed to the multipliers.
pub struct Stabilised {
    /// Unknowns y/weight along n and t at each node of the multipliers; its multipliers are their values there.
    pub problem: Problem,
    /// γ₀ (1/stress).
    pub gamma: f64,
    /// g = ∫ g μ / ∫ μ of each node (length); the gap of the problem has the contributions of held displacements and a body
    /// force subtracted.
    pub gaps: Vec<f64>,
    /// Displacement unknowns that are not held.
    free: Vec<Dof>,
    /// Z.
    factor: Cholesky,
    /// EᵀD⁻¹ weight: free displacements × unknowns of the problem.
    coupling: Mat<f64>,
    load: Vec<f64>,
    /// Displacement of the held unknowns, 0 elsewhere.
    held: Vec<f64>,
}

/// Stiffness, loads and supports of a displacement besides contact.
pub struct Loading<'a> {
    /// S, full storage.
    pub stiffness: &'a Mat<f64>,
    /// f, nodal, without contact; for a body force with S u_p - t_p, so that S u = f.
    pub load: &'a [f64],
    /// Unknowns with a prescribed value.
    pub held: &'a [(Dof, f64)],
    /// Rigid motions that nothing resists and no load drives (nodal vectors): the solution is orthogonal to them.
    pub motions: &'a [Vec<f64>],
    /// The particular solution of a body force, and its nodal values.
    pub particular: Option<(&'a ParticularSolution, &'a [f64])>,
}

/// Smallest γ₀ over its critical value: the condensed problem is as ill-conditioned as that is small.
pub const LEAST_GAMMA: f64 = 1e-6;
/// Layers towards the ends of an element, and Gauss points on each: 5e-4 of ∫ |σ^h|².
const LAYERS: usize = 3;
const POINTS: usize = 5;

impl StabilisedForms {
    /// The forms on the contact sides of a mesh.
    ///
    /// *Cost*: m ≈ 40 + p points an element of these and n unknowns: 6 m n² operations, 16 m n bytes.
    ///
    /// # Errors
    /// [`ContactError::Data`] for linear algebra that went wrong.
    pub fn new(
        mesh: &Mesh,
        space: &Space,
        material: &Material,
        traction: &TractionMap,
        multipliers: &MultiplierSpace,
    ) -> Result<Self, ContactError> {
        let (n, nodes) = (space.dofs(), multipliers.nodes.len());
        let cells = multipliers.cells(mesh);
        let (mut points, mut weights, mut owners) = (Vec::new(), Vec::new(), Vec::new());
        for cell in &cells {
            let (e, p) = (cell.element, mesh.degree[cell.element]);
            let [a, b] = cell.span;
            // multipliers of high degree need as many points, or ∫ γ μ·μ is singular
            let degree = p.max(multipliers.elements[cell.multiplier].degree);
            for panel in graded_panels(LAYERS, POINTS, degree, &[a, b]) {
                let middle = panel.points.iter().sum::<f64>() / panel.len() as f64;
                if middle < a || middle > b {
                    continue;
                }
                for (&t, &w) in panel.points.iter().zip(&panel.weights) {
                    points.push((e, t));
                    let gamma = mesh.length(e) / (p * p) as f64;
                    weights.push((w * mesh.speed(e, t) * gamma).sqrt());
                    owners.push(cell.multiplier);
                }
            }
        }
        let rows = steklov_trace_rows(mesh, space, material, traction, &points)?;
        let mut trace = [0, 1].map(|k| {
            let directions: Vec<[f64; 2]> = points.iter().map(|&(e, t)| frame(mesh, e, t)[k]).collect();
            Mat::from_fn(points.len(), n, |i, j| {
                let d = directions[i];
                weights[i] * (d[0] * rows[(2 * i, j)] + d[1] * rows[(2 * i + 1, j)])
            })
        });
        let mut values = Mat::zeros(points.len(), nodes);
        for (i, &(e, t)) in points.iter().enumerate() {
            let mu = multipliers.basis(owners[i], mesh.edge_parameter(e, t));
            multipliers.elements[owners[i]].nodes.iter().zip(mu).for_each(|(&k, mu)| values[(i, k)] = weights[i] * mu);
        }
        let uniform = UniformPressure::new(mesh, material, &weights);
        let mut values = [values.clone(), values];
        uniform.damp_columns(&mut trace[0]);
        uniform.damp_columns(&mut values[0]);
        let (damping, pairing) = (uniform.part, pairing(mesh, space, multipliers));
        Ok(Self { parts: StabilisedParts { points, weights, damping, trace, values, pairing }, uniform })
    }

    /// Their parts.
    pub fn parts(&self) -> &StabilisedParts {
        &self.parts
    }

    /// The forms of these parts.
    ///
    /// # Errors
    /// [`ContactError::Inconsistent`] for parts of other sizes or numbers that are not finite; weights that are not positive; points
    /// outside of their elements; multipliers whose basis functions do not sum to 1, or which Q does not lead to one another.
    pub fn from_parts(parts: StabilisedParts) -> Result<Self, ContactError> {
        let uniform = UniformPressure::of(&parts.weights, parts.damping);
        parts.check(&uniform).map_err(|what| ContactError::Inconsistent { what })?;
        Ok(Self { parts, uniform })
    }

    /// ∫ (h/p²) μ σ^h of normal and of tangential stresses, C_γ of γ₀ = 1: nodes of the multipliers × displacements.
    ///
    /// # Errors
    /// [`ContactError::Fault`].
    pub fn mixed_forms(&self) -> Result<[Mat<f64>; 2], ContactError> {
        let [normal, tangential] = &self.parts.trace;
        Ok([gram(&self.parts.values[0], normal)?, gram(&self.parts.values[1], tangential)?])
    }

    /// ∫ (h/p²) μ_i μ_j of normal and of tangential multipliers, D_γ of γ₀ = 1.
    ///
    /// # Errors
    /// [`ContactError::Fault`].
    pub fn multiplier_forms(&self) -> Result<[Mat<f64>; 2], ContactError> {
        let [normal, tangential] = &self.parts.values;
        Ok([gram(normal, normal)?, gram(tangential, tangential)?])
    }

    /// ∫ (h/p²) σ^h·σ^h over the displacements: B_γ of γ₀ = 1.
    ///
    /// # Errors
    /// [`ContactError::Fault`].
    pub fn trace_form(&self) -> Result<Mat<f64>, ContactError> {
        let mut b = Mat::zeros(self.parts.trace[0].ncols(), self.parts.trace[0].ncols());
        for t in &self.parts.trace {
            add_product(b.as_mut(), t.transpose(), t.as_ref(), 1.0, None)?;
        }
        Ok(b)
    }

    /// The largest γ₀ (1/stress) for which <S v, v> - ∫ γ |σ^h(v)|² is not negative: 1/λ_max of ∫ (h/p²) σ^h·σ^h against S on the
    /// unknowns that are not held. Infinite without multipliers.
    ///
    /// `rigid`: the rigid motions that the supports leave (nodal vectors); neither form sees them.
    ///
    /// # Errors
    /// [`ContactError::Decomposition`] when S is not positive on the rest.
    pub fn critical_gamma(
        &self,
        stiffness: &Mat<f64>,
        held: &[(Dof, f64)],
        rigid: &[Vec<f64>],
    ) -> Result<f64, ContactError> {
        let free = free_unknowns(stiffness.nrows(), held);
        let n = free.len();
        let mut s = Mat::from_fn(n, n, |i, j| stiffness[(free[i], free[j])]);
        add_springs(&mut s, &free, rigid);
        let failed = ContactError::Decomposition { size: n };
        let factor = llt(&s).map_err(|none| none.or(|_| failed.clone()))?;
        // X = L⁻¹ Tᵀ: T S⁻¹ Tᵀ and X Xᵀ share their spectrum
        let form = self.trace_form()?;
        let mut x = Mat::from_fn(n, n, |i, j| form[(free[i], free[j])]);
        solve_lower(factor.lower(), x.as_mut(), None)?;
        let mut x = x.transpose().to_owned();
        solve_lower(factor.lower(), x.as_mut(), None)?;
        Ok(1.0 / largest_eigenvalue(&x).ok_or(failed)?)
    }

    /// E (S - B_γ)⁻¹ Eᵀ + D, the Schur complement of the multipliers: 2·node along n, 2·node+1 along t. `held` and `rigid` as in
    /// [`Self::critical_gamma`]; a rigid motion counts with a spring of the size of S.
    ///
    /// # Errors
    /// [`ContactError::Decomposition`] when S - B_γ is not positive.
    pub fn dual_form(
        &self,
        stiffness: &Mat<f64>,
        held: &[(Dof, f64)],
        rigid: &[Vec<f64>],
        gamma: f64,
    ) -> Result<Mat<f64>, ContactError> {
        let form = self.trace_form()?;
        let rest = Mat::from_fn(form.nrows(), form.ncols(), |i, j| stiffness[(i, j)] - gamma * form[(i, j)]);
        let coupled = [0, 1]
            .map(|k| &self.parts.pairing[k] - (self.parts.values[k].transpose() * &self.parts.trace[k]) * Scale(gamma));
        let mut dual = dual_form(&coupled, &rest, held, rigid)?;
        for (k, values) in self.parts.values.iter().enumerate() {
            let d = values.transpose() * values;
            for j in 0..d.ncols() {
                (0..d.nrows()).for_each(|i| dual[(2 * i + k, 2 * j + k)] += gamma * d[(i, j)]);
            }
        }
        Ok(dual)
    }

    /// The problem of γ = γ₀ h/p², condensed. `sides`: gap and bound of every contact side.
    ///
    /// # Errors
    /// [`ContactError::StabilisationNotCoercive`] when γ₀ is not below `critical`, or below a millionth of it; [`ContactError::Data`] for data that are
    /// not finite.
    pub fn condense(
        &self,
        mesh: &Mesh,
        multipliers: &MultiplierSpace,
        sides: &[SideData<'_>],
        loading: &Loading<'_>,
        gamma: f64,
        critical: f64,
    ) -> Result<Stabilised, ContactError> {
        let refused = ContactError::StabilisationNotCoercive { gamma, critical };
        if gamma.is_nan() || gamma >= critical || gamma < LEAST_GAMMA * critical {
            return Err(refused);
        }
        let free = free_unknowns(loading.load.len(), loading.held);
        let (n, nodes) = (free.len(), multipliers.nodes.len());
        let mut held = vec![0.0; loading.load.len()];
        loading.held.iter().for_each(|&(dof, value)| held[dof] = value);
        let tau = self.particular(mesh, loading.particular);

        // D and E
        let factor_of = |values: &Mat<f64>| -> Result<Cholesky, ContactError> {
            let mut d = Mat::zeros(nodes, nodes);
            add_product(d.as_mut(), values.transpose(), values.as_ref(), gamma, None)?;
            llt(&d).map_err(|none| none.or(|_| ContactError::Decomposition { size: nodes }))
        };
        let d_factors = [factor_of(&self.parts.values[0])?, factor_of(&self.parts.values[1])?];
        let mut coupled = self.parts.pairing.clone();
        for (k, e) in coupled.iter_mut().enumerate() {
            add_product(e.as_mut(), self.parts.values[k].transpose(), self.parts.trace[k].as_ref(), -gamma, None)?;
        }
        // Z = S - B_γ + Σ (L⁻¹E)ᵀ(L⁻¹E), and f
        let form = self.trace_form()?;
        let mut z = Mat::from_fn(n, n, |i, j| loading.stiffness[(free[i], free[j])] - gamma * form[(free[i], free[j])]);
        add_springs(&mut z, &free, loading.motions);
        let mut load: Vec<f64> = free.iter().map(|&i| loading.load[i]).collect();
        for (i, &row) in free.iter().enumerate() {
            let fixed = loading.held.iter().map(|&(j, u)| (loading.stiffness[(row, j)] - gamma * form[(row, j)]) * u);
            load[i] -= fixed.sum::<f64>();
            load[i] += gamma
                * (0..2).map(|k| steklov_algebra::dot(self.parts.trace[k].col_as_slice(row), &tau[k])).sum::<f64>();
        }
        // offset c = E u_held - ∫ γ μ τ of y, component by component
        let offset = [0, 1].map(|k| -> Vec<f64> {
            let of = |row: usize| {
                let fixed: f64 = loading.held.iter().map(|&(j, u)| coupled[k][(row, j)] * u).sum();
                fixed - gamma * steklov_algebra::dot(self.parts.values[k].col_as_slice(row), &tau[k])
            };
            (0..nodes).map(of).collect()
        });
        let weight = |k: usize| multipliers.nodes[k].weight;
        let mut coupling = Mat::zeros(n, 2 * nodes);
        for (k, e) in coupled.iter().enumerate() {
            let mut x = Mat::from_fn(nodes, n, |i, j| e[(i, free[j])]);
            let of_x = solve_lower(d_factors[k].lower(), x.as_mut(), None)?;
            add_product(z.as_mut(), x.transpose(), x.as_ref(), 1.0, Some(&of_x))?;
            solve_lower_transposed(d_factors[k].lower(), x.as_mut(), Some(&of_x))?;
            for node in 0..nodes {
                (0..n).for_each(|j| coupling[(j, 2 * node + k)] = weight(node) * x[(node, j)]);
            }
        }
        let factor = llt(&z).map_err(|none| none.or(|_| refused))?;
        let mut y = coupling.clone();
        let of_y = solve_lower(factor.lower(), y.as_mut(), None)?;
        let inverse = [0, 1].map(|k| d_factors[k].inverse());
        for (factor, inverse) in d_factors.iter().zip(&inverse) {
            check_inverse(factor.lower(), inverse.as_ref())?;
        }
        let mut stiffness = Mat::from_fn(2 * nodes, 2 * nodes, |i, j| {
            if i % 2 == j % 2 { weight(i / 2) * weight(j / 2) * inverse[i % 2][(i / 2, j / 2)] } else { 0.0 }
        });
        add_product(stiffness.as_mut(), y.transpose(), y.as_ref(), -1.0, Some(&of_y))?;
        let stiffness = Mat::from_fn(2 * nodes, 2 * nodes, |i, j| 0.5 * (stiffness[(i, j)] + stiffness[(j, i)]));
        let solved = factor.solve(column(&load).as_ref());
        let condensed = coupling.transpose() * &solved;

        let data = node_data(mesh, multipliers, sides)?;
        let gaps = data.iter().map(|d| d.gap).collect();
        let nodes = contact_nodes(data, &offset, &weight);
        let problem = Problem { stiffness: stiffness.into(), load: column_of(&condensed), nodes };
        Ok(Stabilised { problem, gamma, gaps, free, factor, coupling, load, held })
    }

    /// Bᵀλ - ∫ γ (λ + σ^h(u) + τ)·σ^h(φ) of every displacement unknown: the contribution of contact and its stabilisation to S
    /// u (force per thickness). `values`: λ at the nodes; `particular` as in [`Loading`].
    pub fn nodal_forces(
        &self,
        mesh: &Mesh,
        gamma: f64,
        values: &[[f64; 2]],
        displacement: &[f64],
        particular: Option<(&ParticularSolution, &[f64])>,
    ) -> Vec<f64> {
        let mut forces = Mat::<f64>::zeros(displacement.len(), 1);
        let (u, tau) = (column(displacement), self.particular(mesh, particular));
        for (k, tau) in tau.iter().enumerate() {
            let lambda = Mat::from_fn(values.len(), 1, |i, _| values[i][k]);
            let mut sum = &self.parts.values[k] * &lambda + &self.parts.trace[k] * &u;
            tau.iter().enumerate().for_each(|(i, tau)| sum[(i, 0)] += tau);
            forces +=
                self.parts.pairing[k].transpose() * &lambda - self.parts.trace[k].transpose() * (Scale(gamma) * sum);
        }
        column_of(&forces)
    }

    /// (w h/p²)^½ of n·τ, times Q, and t·τ at the points, less σ^h of the particular solution's nodal values; `particular` as
    /// in [`Loading`].
    pub fn particular(&self, mesh: &Mesh, particular: Option<(&ParticularSolution, &[f64])>) -> [Vec<f64>; 2] {
        let at = |(&(e, t), w): (&(usize, f64), &f64)| -> [f64; 2] {
            let (Some((b, _)), [normal, tangent]) = (particular, frame(mesh, e, t)) else { return [0.0; 2] };
            let tau = b.traction(mesh.point(e, t), normal);
            [w * dot(tau, normal), w * dot(tau, tangent)]
        };
        let both: Vec<[f64; 2]> = self.parts.points.iter().zip(&self.parts.weights).map(at).collect();
        let nodal = particular.map(|(_, u)| column(u));
        [0, 1].map(|k| {
            let mut tau: Vec<f64> = both.iter().map(|v| v[k]).collect();
            if k == 0 {
                self.uniform.damp(&mut tau);
            }
            if let Some(u) = &nodal {
                let discrete = &self.parts.trace[k] * u;
                tau.iter_mut().enumerate().for_each(|(i, tau)| *tau -= discrete[(i, 0)]);
            }
            tau
        })
    }
}

/// Aᵀ B.
fn gram(a: &Mat<f64>, b: &Mat<f64>) -> Result<Mat<f64>, ContactError> {
    let mut form = Mat::zeros(a.ncols(), b.ncols());
    add_product(form.as_mut(), a.transpose(), b.as_ref(), 1.0, None)?;
    Ok(form)
}

impl Stabilised {
    /// Nodal displacement of the body that belongs to the problem's displacement.
    pub fn displacement(&self, y: &[f64]) -> Vec<f64> {
        let mut right = &self.coupling * column(y);
        self.load.iter().enumerate().for_each(|(i, f)| right[(i, 0)] += f);
        let u = self.factor.solve(right.as_ref());
        let mut displacement = self.held.clone();
        self.free.iter().enumerate().for_each(|(i, &dof)| displacement[dof] = u[(i, 0)]);
        displacement
    }
}

/// ∫ μ n·φ and ∫ μ t·φ: nodes of the multipliers × displacement unknowns, of any mesh of the same polygon.
pub fn pairing(mesh: &Mesh, space: &Space, multipliers: &MultiplierSpace) -> [Mat<f64>; 2] {
    let (n, nodes) = (space.dofs(), multipliers.nodes.len());
    let mut pairing = [Mat::zeros(nodes, n), Mat::zeros(nodes, n)];
    for cell in multipliers.cells(mesh) {
        let (e, element) = (cell.element, &multipliers.elements[cell.multiplier]);
        let basis = space.basis(e);
        let more = if mesh.is_line(e) { 1 } else { CURVE_POINTS };
        let rule = gauss_legendre((basis.degree + element.degree) / 2 + more).mapped(cell.span[0], cell.span[1]);
        let mut phi = vec![0.0; basis.degree + 1];
        for (&t, &w) in rule.points.iter().zip(&rule.weights) {
            basis.evaluate(t, &mut phi);
            let mu = multipliers.basis(cell.multiplier, mesh.edge_parameter(e, t));
            let (frame, speed) = (frame(mesh, e, t), mesh.speed(e, t));
            for (&k, mu) in element.nodes.iter().zip(mu) {
                for (node, phi) in space.element_nodes(e).zip(&phi) {
                    let value = w * speed * mu * phi;
                    for (matrix, d) in pairing.iter_mut().zip(frame) {
                        matrix[(k, 2 * node)] += value * d[0];
                        matrix[(k, 2 * node + 1)] += value * d[1];
                    }
                }
            }
        }
    }
    pairing
}

pub(crate) fn free_unknowns(count: usize, held: &[(Dof, f64)]) -> Vec<Dof> {
    let mut free = vec![true; count];
    held.iter().for_each(|&(dof, _)| free[dof] = false);
    (0..count).filter(|&i| free[i]).collect()
}

/// Adds a spring of the matrix's own size against each motion.
pub(crate) fn add_springs(matrix: &mut Mat<f64>, free: &[Dof], motions: &[Vec<f64>]) {
    let n = free.len();
    let size = (0..n).fold(0.0f64, |m, i| m.max(matrix[(i, i)]));
    for motion in motions {
        let r: Vec<f64> = free.iter().map(|&i| motion[i]).collect();
        let norm: f64 = r.iter().map(|r| r * r).sum();
        for j in 0..n {
            for i in 0..n {
                matrix[(i, j)] += size / norm * r[i] * r[j];
            }
        }
    }
}

/// The nodes of the condensed problem: two unknowns each, and the `offset` of the prescribed ones.
fn contact_nodes(data: Vec<NodeData>, offset: &[Vec<f64>; 2], weight: &dyn Fn(usize) -> f64) -> Vec<ContactNode> {
    let node = |(k, NodeData { gap, bound, coefficient }): (usize, NodeData)| ContactNode {
        first: 2 * k,
        unknowns: 2,
        conditions: vec![Condition {
            normal: [1.0, 0.0],
            tangent: [0.0, 1.0],
            normal_weight: weight(k),
            tangent_weight: weight(k),
            gap: gap - offset[0][k] / weight(k),
            slip_offset: offset[1][k] / weight(k),
            bound,
            coefficient,
        }],
    };
    data.into_iter().enumerate().map(node).collect()
}

fn column_of(values: &Mat<f64>) -> Vec<f64> {
    (0..values.nrows()).map(|i| values[(i, 0)]).collect()
}

fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |i, _| values[i])
}
