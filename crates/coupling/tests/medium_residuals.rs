//! Dual weighted residuals of the medium against the change of numbers in the spaces of one more degree.

use steklov_bem_operators::Space;
use steklov_coupling::{
    Coupled, Factored, Form, Interior, Medium, MediumField, MediumResiduals, Outline, Radiation, Transmission,
};
use steklov_msfem::{Elasticity, Grid, HeterogeneousBody, Loads};

use crate::common::material;

/// A square of stiffness `young` in a medium of E = 2, torn by a jump of tractions, with a jump of displacements of this size.
struct Torn {
    body: HeterogeneousBody,
    interior: Interior,
    jump: f64,
}

const POINT: [f64; 2] = [0.9, 0.4];

impl Torn {
    fn new(young: f64, jump: f64) -> Self {
        let n = 6;
        let grid = Grid::new([-0.5; 2], [1.0 / n as f64; 2], [n; 2], |_, _| true).unwrap();
        let elasticity = Elasticity::new(0.3, steklov_elastic::Plane::Strain).unwrap();
        let mut loads = Loads::default();
        let outline = Outline::new(&grid).unwrap();
        outline.add_traction_jump(&grid, &mut loads, |_, [nx, ny]| [nx + 0.2 * ny, 0.2 * nx - 0.5 * ny]);
        let body = HeterogeneousBody::new(grid, vec![young; n * n], elasticity).unwrap();
        let interior = Interior::fine(&body, &loads).unwrap();
        Self { body, interior, jump }
    }

    fn jump(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.jump * x * x, self.jump * (x * y - y * y)]
    }

    /// Medium, solution, factors and energy for elements of one degree, as long as the cells.
    fn solve(&self, degree: usize) -> (Medium, Coupled, Factored, f64) {
        let around = material([2.0, 0.2]);
        let medium = Medium::new(self.interior.trace.mesh(1, degree).unwrap(), around, None).unwrap();
        let problem = Transmission::new(self.interior.clone(), &medium).unwrap();
        let factor = problem.factor().unwrap();
        let jump = medium.space.interpolate(|x| self.jump(x));
        let solved = problem.solve_with(&factor, &jump, Radiation::Decaying).unwrap();
        assert_eq!(solved.traction, problem.solve(&jump, Form::Schur, Radiation::Decaying).unwrap().traction);
        let factored = problem.into_factored(factor);
        let u = &solved.displacement;
        let work: f64 = self.interior.load.iter().zip(u).map(|(f, u)| f * u).sum();
        let energy = self.body.energy(u, u) / 2.0 + medium.energy(&solved) - work;
        (medium, solved, factored, energy)
    }

    /// A displacement of the body, and one of the medium.
    fn numbers(&self, medium: &Medium, solved: &Coupled) -> [f64; 2] {
        [solved.displacement[2 * self.node()], medium.field(solved).at(POINT).displacement[0]]
    }

    fn node(&self) -> usize {
        self.body.grid.node(5, 4).unwrap()
    }
}

/// How far Σ η is off the true change of the body's number, the medium's, and of J, over Σ |η|.
fn off(young: f64, jump: f64) -> [f64; 3] {
    let torn = Torn::new(young, jump);
    let (medium, solved, factored, energy) = torn.solve(1);
    let (finer, in_finer, _, more) = torn.solve(2);
    let residuals = MediumResiduals::new(&medium, factored.traction_map(), &solved, &|x| torn.jump(x), true).unwrap();
    let off = |etas: Vec<f64>, change: f64| {
        let size: f64 = etas.iter().map(|eta| eta.abs()).sum();
        (etas.iter().sum::<f64>() - change).abs() / size
    };
    let ([a, b], [c, d]) = (torn.numbers(&medium, &solved), torn.numbers(&finer, &in_finer));

    let mut load = vec![0.0; torn.interior.load.len()];
    load[2 * torn.node()] = -1.0;
    let nothing = vec![0.0; medium.space.dofs()];
    let z = factored.solve(&load, &nothing).unwrap();
    let of_body = off(residuals.weighted(&z.trace, None), c - a);

    let raised = medium.mesh.raised(&vec![true; medium.mesh.len()]);
    let space = Space::new(&raised);
    let zero = vec![0.0; space.dofs()];
    let field = MediumField::new(&raised, &space, &medium.material, medium.operators.length, (&zero, &zero, [0.0; 2]));
    let own = residuals.load(factored.traction_map(), &field.functionals_at(POINT)[0].enriched(&medium.space));
    let z = factored.solve(&vec![0.0; load.len()], &own.opposite()).unwrap();
    let of_medium = off(residuals.weighted(&z.trace, Some(&own)), d - b);
    [of_body, of_medium, off(residuals.of_energy(&solved), more - energy)]
}

/// The trace is linear between the points, so that elements of degree 2 add tractions and the bubbles of the jump alone: the sums are the
/// changes but for the coupling between the elements.
#[test]
fn residuals_of_the_medium_are_the_change_by_one_degree_more() {
    for young in [0.2, 2.0, 40.0] {
        for jump in [0.0, 0.3] {
            let off = off(young, jump);
            println!("E {young} jump {jump}: {off:.3?}");
            assert!(off.iter().all(|off| *off < 0.3), "E {young} jump {jump}: {off:.3?}");
        }
    }
}
