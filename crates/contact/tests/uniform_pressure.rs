//! Stabilised multipliers of nearly incompressible bodies: the constant pressure is damped, all else is as ever.

use crate::clamped::Clamped;
use steklov_bem_operators::{Datum, Loop, Mesh, Polygon, Site};
use steklov_contact::{
    Loading, MultiplierDegree, MultiplierMesh, SideData, dual_form, inf_sup, interior_point, kkt, pairing,
};
use steklov_elastic::{Material, Plane};

const NEARLY_HALF: f64 = 0.499_99;

fn square() -> Loop {
    let corners = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    Loop::straight(corners, ["floor", "right", "top", "left"].map(String::from).to_vec())
}

fn body(n: usize, p: usize, poisson: f64, plane: Plane) -> Clamped {
    let polygon = Polygon::new(square(), vec![]).unwrap();
    Clamped::on(Mesh::uniform(&polygon, 4 * n, p), Material::new(7.0, poisson, plane).unwrap())
}

/// Critical γ₀E.
fn critical(body: &Clamped) -> f64 {
    let multipliers = body.multipliers(MultiplierMesh::Same, MultiplierDegree::Relative(0));
    7.0 * body.forms(&multipliers).critical_gamma(&body.stiffness, &body.held, &[]).unwrap()
}

/// Computed beforehand by another code, with its own quadrature; without damping 0.0002, 0.0005, 0.001.
#[test]
fn the_critical_gamma_does_not_fall_with_compressibility() {
    for (n, p, nu, want) in [
        (4, 1, 0.3, 0.6934),
        (8, 1, 0.3, 0.6438),
        (4, 1, 0.49, 0.5377),
        (4, 1, NEARLY_HALF, 0.5110),
        (8, 1, NEARLY_HALF, 0.4866),
        (4, 2, NEARLY_HALF, 0.7453),
    ] {
        let found = critical(&body(n, p, nu, Plane::Strain));
        println!("n = {n}, p = {p}, ν = {nu}: {found:.4}");
        assert!((found / want - 1.0).abs() < 0.01, "n = {n}, p = {p}, ν = {nu}: {found} not {want}");
    }
    let [a, b] = [0.4999, 0.499_999_9].map(|nu| critical(&body(8, 2, nu, Plane::Strain)));
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
}

/// In plane stress ν = ½ is nothing special: it is plane strain of ν/(1+ν) = 1/3 and 8/9 of Young's modulus.
#[test]
fn plane_stress_is_left_alone() {
    for (n, p) in [(4, 1), (16, 1), (8, 2)] {
        let found = critical(&body(n, p, NEARLY_HALF, Plane::Stress));
        let strain = critical(&body(n, p, 1.0 / 3.0, Plane::Strain));
        assert!((found / strain * 8.0 / 9.0 - 1.0).abs() < 5e-3, "n = {n}, p = {p}: {found} {strain}");
    }
}

#[test]
fn a_hole_changes_little() {
    let hole = |size: f64| {
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|c| c.map(|x| 0.5 * size * x)).to_vec();
        Loop::straight(corners, vec!["hole".into(); 4])
    };
    // four elements across the thinnest wall
    for (size, elements, range) in [(0.2, 64, 0.45..0.65), (0.5, 96, 0.4..0.65)] {
        let polygon = Polygon::new(square(), vec![hole(size)]).unwrap();
        for nu in [0.3, NEARLY_HALF] {
            let material = Material::new(7.0, nu, Plane::Strain).unwrap();
            let found = critical(&Clamped::on(Mesh::uniform(&polygon, elements, 1), material));
            println!("hole {size}, ν = {nu}: {found:.4}");
            assert!(range.contains(&found), "hole {size}, ν = {nu}: {found}");
        }
    }
}

/// β with stabilisation, of the pairs that are unstable without.
#[test]
fn the_pairs_are_stable() {
    for (mesh, degree) in [
        (MultiplierMesh::Same, MultiplierDegree::Relative(0)),
        (MultiplierMesh::Finer(2), MultiplierDegree::Relative(0)),
        (MultiplierMesh::Shifted, MultiplierDegree::Relative(-1)),
    ] {
        for (n, p) in [(4, 1), (8, 1), (4, 2)] {
            let (coarse, fine) =
                (body(n, p, NEARLY_HALF, Plane::Strain), body(4 * n, p + 3, NEARLY_HALF, Plane::Strain));
            let multipliers = coarse.multipliers(mesh, degree);
            let reference =
                dual_form(&pairing(&fine.mesh, &fine.space, &multipliers), &fine.stiffness, &fine.held, &[]).unwrap();
            let forms = coarse.forms(&multipliers);
            let critical = forms.critical_gamma(&coarse.stiffness, &coarse.held, &[]).unwrap();
            let dual = forms.dual_form(&coarse.stiffness, &coarse.held, &[], 0.5 * critical).unwrap();
            let beta = inf_sup(&dual, &reference).unwrap().beta;
            println!("{mesh:?} {degree:?} n = {n}, p = {p}: {beta:.4}");
            assert!(beta > 0.5 && beta < 1.0 + 1e-6, "{mesh:?} {degree:?} n = {n}, p = {p}: {beta}");
        }
    }
}

/// A block that nothing holds, pressed onto the floor by the same pressure on its top: the solution is in every space, and the
/// damped form must have it still.
#[test]
fn a_floating_block_has_its_uniform_pressure() {
    for nu in [0.3, 0.49, NEARLY_HALF] {
        let mut block = body(4, 2, nu, Plane::Strain);
        block.held.clear();
        let pressure = 0.25;
        let mut load = vec![0.0; block.space.dofs()];
        for e in (0..block.mesh.len()).filter(|&e| block.mesh.side[e] == 2) {
            let basis = block.space.basis(e);
            for (w, node) in basis.weights.iter().zip(block.space.element_nodes(e)) {
                load[2 * node + 1] -= pressure * w * block.mesh.length(e) / 2.0;
            }
        }
        let points = &block.space.points;
        let shift: Vec<f64> = (0..load.len()).map(|i| f64::from(i % 2 == 0)).collect();
        let up: Vec<f64> = (0..load.len()).map(|i| f64::from(i % 2 == 1)).collect();
        let turn: Vec<f64> =
            (0..load.len()).map(|i| if i % 2 == 0 { -points[i / 2][1] } else { points[i / 2][0] }).collect();
        let rigid = [shift.clone(), up, turn];
        let (gap, kinks) = (|_: &Site| 0.0, |_: usize| vec![]);
        let gap = Datum { name: "gap", value: &gap, kinks: &kinks, rounding: None };
        let side = SideData { side: 0, gap, bound: None, coefficient: None, beyond: None };
        let multipliers = block.multipliers(MultiplierMesh::Finer(2), MultiplierDegree::Relative(0));
        let forms = block.forms(&multipliers);
        let critical = forms.critical_gamma(&block.stiffness, &[], &rigid).unwrap();
        assert!((0.7..1.1).contains(&(7.0 * critical)), "ν = {nu}: {critical}");
        let motions = [shift];
        let loading =
            Loading { stiffness: &block.stiffness, load: &load, held: &[], motions: &motions, particular: None };
        let stabilised =
            forms.condense(&block.mesh, &multipliers, &[side], &loading, 0.5 * critical, critical).unwrap();
        let solution = interior_point(&stabilised.problem).unwrap();
        let worst = solution.multipliers.iter().fold(0.0f64, |m, l| m.max((l[0] - pressure).abs()).max(l[1].abs()));
        assert!(solution.converged() && kkt(&stabilised.problem, &solution).worst() < 1e-12, "ν = {nu}: {solution:?}");
        assert!(worst < 1e-10, "ν = {nu}: {worst:e}");
    }
}
