//! Boundary elements that follow indicators, and a trace that changes below them.

use crate::common::{dense, manufactured, material, traction};
use proptest::prelude::*;
use steklov_bem_operators::{Mesh, doerfler};
use steklov_coupling::{
    CouplingError, Form, InterfaceIndicators, Interior, Jumps, Medium, Outline, Radiation, Trace, Transfer,
    Transmission,
};
use steklov_msfem::{Basis, CoarseMesh, Elasticity, Grid, HeterogeneousBody, Loads, Multiscale, mark, refine};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Both refined at will: nested, as fine as both, degrees kept.
    #[test]
    fn a_mesh_follows_a_trace_that_is_refined(
        seed in any::<u64>(),
        rounds in 1..4usize,
        degree in 1..4usize,
    ) {
        let grid = Grid::new([-0.3, 0.7], [0.1, 0.07], [24, 16], |i, j| i < 8 || j < 8).unwrap();
        let count = 24 * 16;
        let medium = HeterogeneousBody::new(grid, vec![1.0; count], Elasticity::new(0.3, steklov_elastic::Plane::Strain).unwrap()).unwrap();
        let outline = Outline::new(&medium.grid).unwrap();
        let mut cells = CoarseMesh::uniform(&medium.grid, [8, 8]).unwrap();
        let trace_of = |cells: &CoarseMesh| {
            let problem = Multiscale::new(&medium, cells.clone(), Basis::Coupled).unwrap();
            Trace::coarse(&problem, &outline).unwrap()
        };
        let mut mesh = trace_of(&cells).mesh(1, degree).unwrap();
        let mut random = seed;
        let mut draw = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as f64 / f64::from(1u32 << 31)
        };
        for _ in 0..rounds {
            let marked: Vec<bool> = (0..mesh.len()).map(|_| draw() < 0.3).collect();
            let mut finer = mesh.bisected(&marked).0;
            finer.degree.iter_mut().for_each(|p| *p += usize::from(draw() < 0.2));
            let indicators: Vec<f64> = (0..cells.cells.len()).map(|_| draw()).collect();
            cells = refine(&medium.grid, &cells, &mark(&indicators, 0.4)).unwrap();
            let trace = trace_of(&cells);
            mesh = trace.mesh_with(&finer).unwrap();
            let near = |x: [f64; 2], y: [f64; 2]| (x[0] - y[0]).hypot(x[1] - y[1]) < 1e-12;
            for x in finer.vertices.iter().chain(&trace.points) {
                prop_assert_eq!(mesh.vertices.iter().filter(|y| near(*x, **y)).count(), 1);
            }
            for y in &mesh.vertices {
                prop_assert!(finer.vertices.iter().chain(&trace.points).any(|x| near(*x, *y)));
            }
            // where the degree is read
            for e in 0..mesh.len() {
                let x = mesh.point(e, 0.1);
                let owner = (0..finer.len()).find(|&f| {
                    let ([a, b], t) = (finer.ends(f), finer.tangent(f, 0.0));
                    let (r, s) = ([x[0] - a[0], x[1] - a[1]], [b[0] - x[0], b[1] - x[1]]);
                    let along = |r: [f64; 2]| r[0] * t[0] + r[1] * t[1];
                    (r[0] * t[1] - r[1] * t[0]).abs() < 1e-12 && along(r) > 0.0 && along(s) > 0.0
                });
                prop_assert_eq!(Some(mesh.degree[e]), owner.map(|f| finer.degree[f]));
            }
            let exterior = Medium::new(mesh.clone(), material([1.0, 0.3]), None).unwrap();
            let transfer = Transfer::new(&trace, &exterior.mesh, &exterior.space).unwrap();
            let through = dense(&exterior.operators.mass) * dense(&transfer.projection);
            let b = dense(&transfer.mass);
            prop_assert!((&b - &through).norm_max() < 1e-13 * b.norm_max());
        }
    }
}

#[test]
fn a_mesh_of_another_body_is_refused() {
    let (medium, loads) = manufactured(4, [1.0, 0.3], [1.0, 0.3]);
    let trace = Interior::fine(&medium, &loads).unwrap().trace;
    let wider = Grid::new([-0.5; 2], [0.25; 2], [5, 4], |_, _| true).unwrap();
    let other = Mesh::uniform(&Outline::new(&wider).unwrap().polygon, 16, 1);
    let refused = trace.mesh_with(&other).unwrap_err();
    assert!(matches!(&refused, CouplingError::Boundary { what } if what.contains("cover")), "{refused}");
}

/// A square inclusion in a medium that is strained: corners are singular.
#[test]
fn refinement_by_the_error_of_the_traction_needs_fewer_elements_than_uniform_one() {
    for young in [1e-3, 1e3] {
        let n = 4;
        let grid = Grid::new([-0.5; 2], [0.25; 2], [n; 2], |_, _| true).unwrap();
        let outline = Outline::new(&grid).unwrap();
        let around = material([1.0, 0.3]);
        let gradient = [[-1.0, 0.2], [0.2, 0.3]];
        let strained = |x: [f64; 2]| [0, 1].map(|i| gradient[i][0] * x[0] + gradient[i][1] * x[1]);
        let pulled = |_: [f64; 2], normal: [f64; 2]| traction(around.stress(gradient), normal);
        let mut loads = Loads::default();
        outline.add_traction_jump(&grid, &mut loads, pulled);
        let elasticity = Elasticity::new(0.3, steklov_elastic::Plane::Strain).unwrap();
        let medium = HeterogeneousBody::new(grid, vec![young; n * n], elasticity).unwrap();
        let interior = Interior::fine(&medium, &loads).unwrap();
        let jumps = Jumps { displacement: &strained, traction: &pulled, halvings: 0 };
        let gains = |mesh: &Mesh| {
            let exterior = Medium::new(mesh.clone(), around, None).unwrap();
            let transmission = Transmission::new(interior.clone(), &exterior).unwrap();
            let u0 = exterior.space.interpolate(strained);
            let solved = transmission.solve(&u0, Form::Schur, Radiation::Decaying).unwrap();
            let found =
                InterfaceIndicators::new(&exterior, &medium, &solved.displacement, &solved, Form::Schur, &jumps)
                    .unwrap();
            found.traction_error
        };
        let sum = |terms: &[f64]| terms.iter().sum::<f64>().sqrt();
        let rate = |points: &[(f64, f64)]| {
            let (first, last) = (points[0], points[points.len() - 1]);
            (first.1 / last.1).ln() / (last.0 / first.0).ln()
        };
        let uniform: Vec<(f64, f64)> = [1, 2, 4, 8]
            .map(|parts| interior.trace.mesh(parts, 1).unwrap())
            .iter()
            .map(|mesh| (mesh.len() as f64, sum(&gains(mesh))))
            .collect();
        let mut mesh = interior.trace.mesh(1, 1).unwrap();
        let mut adaptive = Vec::new();
        for _ in 0..12 {
            let found = gains(&mesh);
            adaptive.push((mesh.len() as f64, sum(&found)));
            let marks: Vec<bool> = doerfler(&found, 0.5).iter().map(Option::is_some).collect();
            mesh = interior.trace.mesh_with(&mesh.bisected(&marks).0).unwrap();
        }
        let rates = [rate(&uniform), rate(&adaptive)];
        println!("E = {young}: {uniform:.4?}\n{adaptive:.4?}\nrates {rates:.2?}");
        assert!(rates[0] < 0.9 && rates[1] > 1.25, "{rates:?}");
        // the error of 128 equal elements by less than 85
        let enough = adaptive.iter().find(|(_, error)| *error <= uniform[3].1).unwrap();
        assert!(enough.0 < 85.0, "{enough:?}");
    }
}
