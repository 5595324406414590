//! What must not be: wrong signs and halves, a quotient by translations only. The full systems are built here from the matrices.

use crate::common::{PAIRS, around, dense, difference, double_layers, energy_error, lu, manufactured, problem};
use faer::{Mat, MatMut, Scale};
use steklov_algebra::{Lu, singular_values};
use steklov_coupling::{Form, Interior, Medium, Radiation};
use steklov_msfem::HeterogeneousBody;

const SAME: [f64; 2] = [2.0, 0.3];

/// A body of n × n cells, its system with all unknowns, and the jump.
struct Full {
    medium: HeterogeneousBody,
    exterior: Medium,
    stiffness: Mat<f64>,
    load: Vec<f64>,
    /// Unknowns of the trace, in the order of the boundary elements.
    boundary: Vec<usize>,
    jump: Vec<f64>,
    mass: Mat<f64>,
}

impl Full {
    fn new(n: usize, body: [f64; 2], outside: [f64; 2]) -> Self {
        let (medium, loads) = manufactured(n, body, outside);
        let interior = Interior::fine(&medium, &loads).unwrap();
        let exterior = around(&interior, 1, 1, outside);
        let jump = exterior.space.interpolate(|x| crate::common::jump(&exterior.material, x));
        let mass = dense(&exterior.operators.mass);
        let (load, boundary) = (interior.load, interior.trace.unknowns);
        Self { stiffness: dense(&interior.stiffness), medium, exterior, load, boundary, jump, mass }
    }

    fn dofs(&self) -> usize {
        self.load.len()
    }

    /// A zero system with `more` unknowns, and A in it.
    fn empty(&self, more: usize) -> Mat<f64> {
        let size = self.dofs() + more;
        let mut matrix = Mat::zeros(size, size);
        matrix.get_mut(..self.dofs(), ..self.dofs()).copy_from(&self.stiffness);
        matrix
    }

    /// Adds a block between the displacement of the trace and unknowns from `row` on, and its transpose.
    fn couple(&self, mut matrix: MatMut<'_, f64>, row: usize, block: &Mat<f64>) {
        for (j, &unknown) in self.boundary.iter().enumerate() {
            for i in 0..block.nrows() {
                matrix[(row + i, unknown)] += block[(i, j)];
                matrix[(unknown, row + i)] += block[(i, j)];
            }
        }
    }

    /// (A + S) u = F + S u0 with any S on the interface.
    fn with_operator(&self, s: &Mat<f64>) -> f64 {
        let (mut matrix, mut load) = (self.empty(0), self.load.clone());
        for (i, &row) in self.boundary.iter().enumerate() {
            for (j, &column) in self.boundary.iter().enumerate() {
                matrix[(row, column)] += s[(i, j)];
                load[row] += s[(i, j)] * self.jump[j];
            }
        }
        energy_error(&self.medium, SAME, &lu(matrix.as_ref(), &load))
    }

    /// W + Hᵀ V⁻¹ H.
    fn steklov(&self, h: &Mat<f64>) -> Mat<f64> {
        let operators = &self.exterior.operators;
        &operators.w + h.transpose() * Lu::new(operators.v.as_ref()).solve(h.as_ref())
    }

    /// The matrix of the three-field form with a factor before W and the first `motions` rigid motions removed.
    fn three_field(&self, factor: f64, motions: usize) -> Mat<f64> {
        let operators = &self.exterior.operators;
        let (n, size) = (self.dofs(), self.jump.len());
        let mut matrix = self.empty(2 * size);
        self.couple(matrix.as_mut(), n, &(Scale(-1.0) * &self.mass));
        let [_, plus] = double_layers(&self.exterior);
        matrix.get_mut(n..n + size, n..n + size).copy_from(Scale(-1.0) * &operators.v);
        matrix.get_mut(n..n + size, n + size..).copy_from(&plus);
        matrix.get_mut(n + size.., n..n + size).copy_from(plus.transpose());
        let points = &self.exterior.space.points;
        let z = Mat::from_fn(size, motions, |row, k| match (k, row % 2) {
            (2, 0) => -points[row / 2][1],
            (2, _) => points[row / 2][0],
            (k, i) => f64::from(u8::from(k == i)),
        });
        let z = z * Scale(1.0 / (points.len() as f64).sqrt());
        matrix.get_mut(n + size.., n + size..).copy_from(Scale(factor) * &operators.w + &z * z.transpose());
        matrix
    }

    fn three_field_error(&self, factor: f64) -> f64 {
        let (n, size) = (self.dofs(), self.jump.len());
        let mut right = self.load.clone();
        right.resize(n + 2 * size, 0.0);
        for i in 0..size {
            right[n + i] = -(0..size).map(|j| self.mass[(i, j)] * self.jump[j]).sum::<f64>();
        }
        let u = lu(self.three_field(factor, 3).as_ref(), &right);
        energy_error(&self.medium, SAME, &u[..n])
    }
}

/// Errors on two meshes, the finer one last.
fn errors(error: impl Fn(&Full) -> f64) -> [f64; 2] {
    [8, 16].map(|n| error(&Full::new(n, SAME, SAME)))
}

#[test]
fn only_the_right_sign_and_half_converge() {
    let right = |[coarse, fine]: [f64; 2]| fine < 0.55 * coarse && fine < 0.06;
    // as the crate has them
    let schur = errors(|full| full.with_operator(&full.steklov(&double_layers(&full.exterior)[0])));
    let three = errors(|full| full.three_field_error(1.0));
    assert!(right(schur) && right(three), "{schur:?} {three:?}");
    // traction + S u_c
    let sign = errors(|full| full.with_operator(&(Scale(-1.0) * full.steklov(&double_layers(&full.exterior)[0]))));
    // the half of a body: n out of the medium
    let half = errors(|full| full.with_operator(&full.steklov(&double_layers(&full.exterior)[1])));
    // W of kernels with a factor 2, without the half before it
    let twice = errors(|full| full.three_field_error(2.0));
    println!("right {schur:?} {three:?}, sign {sign:?}, half {half:?}, twice {twice:?}");
    for (what, [coarse, fine]) in [("sign", sign), ("half", half), ("twice W", twice)] {
        assert!(fine > 0.75 * coarse && fine > 0.15, "{what}: {coarse} then {fine}");
    }
}

#[test]
fn all_three_rigid_motions_must_leave_the_three_field_form() {
    let full = Full::new(8, SAME, SAME);
    let condition = |motions| {
        let values = singular_values(full.three_field(1.0, motions).as_ref()).unwrap();
        values[values.len() - 1] / values[0]
    };
    let [two, three] = [condition(2), condition(3)];
    println!("reciprocal condition with two {two:.1e}, with three {three:.1e}");
    assert!(two < 1e-14, "{two}");
    assert!(three > 1e-5, "{three}");
}

#[test]
fn the_bounded_solution_is_that_of_the_system_with_the_constant_as_unknown() {
    for (_, body, outside) in PAIRS {
        let full = Full::new(8, body, outside);
        let (n, size) = (full.dofs(), full.jump.len());
        let operators = &full.exterior.operators;
        let [minus, _] = double_layers(&full.exterior);
        // u, φ, a, and the force that fixes the mean of u
        let mut matrix = full.empty(size + 4);
        for (i, &row) in full.boundary.iter().enumerate() {
            full.boundary.iter().enumerate().for_each(|(j, &column)| matrix[(row, column)] += operators.w[(i, j)]);
        }
        full.couple(matrix.as_mut(), n, &minus);
        matrix.get_mut(n..n + size, n..n + size).copy_from(Scale(-1.0) * &operators.v);
        let whole = Mat::from_fn(2, size, |i, j| if j % 2 == i { full.exterior.mesh.length(j / 2) } else { 0.0 });
        matrix.get_mut(n + size..n + size + 2, n..n + size).copy_from(&whole);
        matrix.get_mut(n..n + size, n + size..n + size + 2).copy_from(whole.transpose());
        // equal elements of degree 1: the integral over the boundary has the same weights
        full.couple(matrix.as_mut(), n + size + 2, &whole);
        let mut right = full.load.clone();
        right.resize(n + size + 4, 0.0);
        for i in 0..size {
            right[full.boundary[i]] += (0..size).map(|j| operators.w[(i, j)] * full.jump[j]).sum::<f64>();
            right[n + i] = (0..size).map(|j| minus[(i, j)] * full.jump[j]).sum::<f64>();
        }
        let wanted = lu(matrix.as_ref(), &right);
        let (medium, loads) = manufactured(8, body, outside);
        let interior = Interior::fine(&medium, &loads).unwrap();
        let (problem, jump) = problem(interior, &full.exterior);
        for form in [Form::TwoField, Form::Schur] {
            let solved = problem.solve(&jump, form, Radiation::Bounded).unwrap();
            let errors = [
                difference(&solved.displacement, &wanted[..n]),
                difference(&solved.traction, &wanted[n..n + size]),
                difference(&solved.constant, &wanted[n + size..n + size + 2]),
            ];
            println!("{form:?} {errors:?}");
            assert!(errors.iter().all(|e| *e < 1e-11), "{errors:?}");
            let decaying = problem.solve(&jump, form, Radiation::Decaying).unwrap();
            assert_eq!(decaying.constant, [0.0; 2]);
            // both fields outside differ by the constant only
            let at = |solution| full.exterior.field(solution).at([2.0, 1.0]);
            let (a, b) = (at(&solved), at(&decaying));
            for i in 0..2 {
                assert!((a.displacement[i] - b.displacement[i] - solved.constant[i]).abs() < 1e-11);
            }
            assert!(difference(&a.stress, &b.stress) < 1e-10);
        }
    }
}
