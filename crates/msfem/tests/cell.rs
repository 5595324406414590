//! One coarse cell: rigid motions, partition of unity, closed forms, and the homogenised tensor of a laminate.

use crate::common::{kind, number, reference, strain};
use proptest::prelude::*;
use steklov_elastic::Plane;
use steklov_msfem::{Basis, CellBasis, CoarseMesh, Elasticity, Grid, HeterogeneousBody, Multiscale};
use steklov_quadrature::unit_uniform;

/// The unit square of m × m cells as one coarse cell.
fn unit_cell(m: usize, young: Vec<f64>, basis: Basis) -> CellBasis {
    let body = HeterogeneousBody::new(Grid::rectangle([1.0; 2], [m; 2]).unwrap(), young, strain()).unwrap();
    let mesh = CoarseMesh::uniform(&body.grid, [m; 2]).unwrap();
    Multiscale::new(&body, mesh, basis).unwrap().cell_basis(0).unwrap()
}

/// Corner values of a field.
fn corners(field: impl Fn(f64, f64) -> [f64; 2]) -> [f64; 8] {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    std::array::from_fn(|c| field(points[c / 2][0], points[c / 2][1])[c % 2])
}

fn multiply(k: &[[f64; 8]; 8], u: &[f64; 8]) -> [f64; 8] {
    k.map(|row| row.iter().zip(u).map(|(k, u)| k * u).sum())
}

fn energy(k: &[[f64; 8]; 8], u: &[f64; 8]) -> f64 {
    multiply(k, u).iter().zip(u).map(|(f, u)| f * u).sum()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Largest entries of R less hat_p e_k, and of components across the direction.
fn deviations(basis: &CellBasis) -> [f64; 2] {
    let [m, n] = basis.size;
    let (mut from_bilinear, mut across) = (0.0f64, 0.0f64);
    for (dof, row) in basis.values.iter().enumerate() {
        let (node, k) = (dof / 2, dof % 2);
        let (x, y) = ((node % (m + 1)) as f64 / m as f64, (node / (m + 1)) as f64 / n as f64);
        let hats = [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
        for c in 0..8 {
            let hat = if c % 2 == k { hats[c / 2] } else { 0.0 };
            from_bilinear = from_bilinear.max((row[c] - hat).abs());
            // the reference looks at u_y of the functions along x
            if k == 1 && c % 2 == 0 {
                across = across.max(row[c].abs());
            }
        }
    }
    [from_bilinear, across]
}

#[test]
fn cells_have_the_published_energies_and_rigid_motions() {
    let data = reference("cell");
    let tolerance = number(&data["tol_abs"]);
    for (name, young) in
        [("hom", vec![2000.0; 36]), ("rand", (0..36).map(|i| 2000.0 + 1000.0 * unit_uniform(7, i)).collect())]
    {
        let q1 = unit_cell(6, young.clone(), Basis::Q1).stiffness;
        for word in ["a", "b", "c", "e"] {
            let wanted = &data["checks_6x6"][format!("{name}_{word}")];
            let basis = unit_cell(6, young.clone(), kind(word, 6));
            let k = &basis.stiffness;
            for rigid in [corners(|_, _| [1.0, 0.0]), corners(|_, _| [0.0, 1.0]), corners(|x, y| [-y, x])] {
                assert!(largest(multiply(k, &rigid)) < 1e-11 * 2000.0, "{name} {word}: a rigid motion resists");
            }
            // translations: the x functions add up to (1, 0)
            let unity = basis.values.iter().enumerate().map(|(dof, row)| {
                let sum: f64 = (0..4).map(|p| row[2 * p]).sum();
                sum - if dof % 2 == 0 { 1.0 } else { 0.0 }
            });
            assert!(largest(unity) < 1e-13);
            let [from_bilinear, across] = deviations(&basis);
            let near = |what: &str, got: f64, wanted: &serde_json::Value, scale: f64| {
                let wanted = number(wanted);
                assert!((got - wanted).abs() <= tolerance * scale, "{name} {word} {what}: {got} instead of {wanted}");
            };
            near("cross", across, &wanted["max_cross"], 1.0);
            near("bilinear", from_bilinear, &wanted["dev_bilinear"], 1.0);
            let hourglass = corners(|x, y| [x * y, 0.0]);
            let affine = corners(|x, _| [x, 0.0]);
            near("hourglass", energy(k, &hourglass), &wanted["hourglass_energy"], 1e3);
            near("hourglass of q1", energy(&q1, &hourglass), &wanted["hourglass_energy_q1"], 1e3);
            near("affine", energy(k, &affine), &wanted["affine_xx_energy"], 1e3);
            near("affine of q1", energy(&q1, &affine), &wanted["affine_xx_energy_q1"], 1e3);
        }
    }
}

#[test]
fn the_homogeneous_unit_cell_softens_as_published() {
    let data = reference("cell");
    let tolerance = number(&data["tol_abs"]);
    for (m, wanted) in data["unit_cell_E1"].as_object().unwrap() {
        let basis = match m.as_str() {
            "q1" => unit_cell(4, vec![1.0; 16], Basis::Q1),
            m => {
                let m: usize = m.parse().unwrap();
                unit_cell(m, vec![1.0; m * m], Basis::Coupled)
            }
        };
        let k = &basis.stiffness;
        for (name, entry) in [("KE00", k[0][0]), ("KE01", k[0][1]), ("KE02", k[0][2]), ("KE04", k[0][4])] {
            let wanted = number(&wanted[name]);
            assert!((entry - wanted).abs() < tolerance, "m = {m}, {name}: {entry} instead of {wanted}");
        }
    }
}

/// Voigt matrix of λ and μ.
fn voigt(lambda: f64, mu: f64) -> [[f64; 3]; 3] {
    [[lambda + 2.0 * mu, lambda, 0.0], [lambda, lambda + 2.0 * mu, 0.0], [0.0, 0.0, mu]]
}

#[test]
fn a_laminate_has_the_published_tensors_and_its_closed_form() {
    let data = reference("cell");
    let tolerance = number(&data["tol_abs"]);
    let young: Vec<f64> = (0..256).map(|c| if c / 16 % 4 < 2 { 1.0 } else { 10.0 }).collect();
    for (word, wanted) in data["laminate_tensor"].as_object().unwrap() {
        if word == "exact" {
            continue;
        }
        let tensor = unit_cell(16, young.clone(), kind(word, 16)).tensor([1.0 / 16.0; 2]);
        for a in 0..3 {
            for b in 0..3 {
                let wanted = number(&wanted[a][b]);
                assert!(
                    (tensor[a][b] - wanted).abs() < tolerance,
                    "{word} {a}{b}: {} instead of {wanted}",
                    tensor[a][b]
                );
            }
        }
    }
    // layers across x: means of 1/c11, c12/c11, c22 - c12²/c11, 1/c33
    let layers = [1.0, 10.0].map(|e: f64| voigt(e * 0.3 / (1.3 * 0.4), e / 2.6));
    let mean = |f: &dyn Fn(&[[f64; 3]; 3]) -> f64| (f(&layers[0]) + f(&layers[1])) / 2.0;
    let c11 = 1.0 / mean(&|c| 1.0 / c[0][0]);
    let ratio = mean(&|c| c[0][1] / c[0][0]);
    let exact = [
        [c11, ratio * c11, 0.0],
        [ratio * c11, mean(&|c| c[1][1] - c[0][1] * c[0][1] / c[0][0]) + ratio * ratio * c11, 0.0],
        [0.0, 0.0, 1.0 / mean(&|c| 1.0 / c[2][2])],
    ];
    let tensor = unit_cell(16, young, Basis::Periodic).tensor([1.0 / 16.0; 2]);
    for a in 0..3 {
        for b in 0..3 {
            assert!((tensor[a][b] - exact[a][b]).abs() < 1e-12, "{a}{b}: {} instead of {}", tensor[a][b], exact[a][b]);
        }
    }
}

const KINDS: [Basis; 5] = [Basis::Q1, Basis::Linear, Basis::Coupled, Basis::Oscillatory, Basis::Periodic];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_cell_is_free_to_move_rigidly_and_bounded_by_uniform_strain(
        young in proptest::collection::vec(1e-2..1e2f64, 5 * 4),
        lengths in (0.2..3.0f64, 0.2..3.0f64),
        poisson in -0.5..0.49f64,
        stress in any::<bool>(),
    ) {
        let plane = if stress { Plane::Stress } else { Plane::Strain };
        let grid = Grid::rectangle([lengths.0, lengths.1], [5, 4]).unwrap();
        let spacing = grid.spacing;
        let body = HeterogeneousBody::new(grid, young.clone(), Elasticity::new(poisson, plane).unwrap()).unwrap();
        let cell = |basis| {
            let mesh = CoarseMesh::uniform(&body.grid, [5, 4]).unwrap();
            Multiscale::new(&body, mesh, basis).unwrap().cell_basis(0).unwrap()
        };
        let points = [[0.0, 0.0], [lengths.0, 0.0], [lengths.0, lengths.1], [0.0, lengths.1]];
        let at = |f: &dyn Fn([f64; 2]) -> [f64; 2]| -> [f64; 8] { std::array::from_fn(|c| f(points[c / 2])[c % 2]) };
        let mut bounds = Vec::new();
        for kind in KINDS {
            let basis = cell(kind);
            let scale = largest(basis.stiffness.iter().flatten().copied());
            for motion in [at(&|_| [1.0, 0.0]), at(&|_| [0.0, 1.0]), at(&|[x, y]| [-y, x])] {
                prop_assert!(largest(multiply(&basis.stiffness, &motion)) < 1e-11 * scale, "{kind:?}");
            }
            for a in 0..8 {
                for b in 0..8 {
                    prop_assert!((basis.stiffness[a][b] - basis.stiffness[b][a]).abs() < 1e-11 * scale, "{kind:?}");
                }
            }
            // rotations on the fine nodes too, but for functions whose other component is dropped
            if kind != Basis::Linear {
                let rotation = at(&|[x, y]| [-y, x]);
                for (dof, row) in basis.values.iter().enumerate() {
                    let (i, j) = (dof / 2 % 6, dof / 2 / 6);
                    let exact = [-(j as f64) * spacing[1], i as f64 * spacing[0]][dof % 2];
                    let got: f64 = row.iter().zip(&rotation).map(|(r, u)| r * u).sum();
                    prop_assert!((got - exact).abs() < 1e-10 * (lengths.0 + lengths.1), "{kind:?}");
                }
            }
            bounds.push(basis.tensor(spacing));
        }
        // on affine data: bilinear above coupled above periodic
        for a in 0..3 {
            let [q1, coupled, periodic] = [bounds[0][a][a], bounds[2][a][a], bounds[4][a][a]];
            prop_assert!(q1 >= coupled * (1.0 - 1e-12) && coupled >= periodic * (1.0 - 1e-12), "{q1} {coupled} {periodic}");
        }
    }

    #[test]
    fn a_homogeneous_cell_is_exact_for_affine_fields(
        m in 1..6usize, n in 1..6usize, young in 1e-3..1e3f64, poisson in -0.5..0.49f64,
    ) {
        let grid = Grid::rectangle([1.3, 0.7], [m, n]).unwrap();
        let spacing = grid.spacing;
        let elasticity = Elasticity::new(poisson, Plane::Strain).unwrap();
        let body = HeterogeneousBody::new(grid, vec![young; m * n], elasticity).unwrap();
        for kind in KINDS {
            let mesh = CoarseMesh::uniform(&body.grid, [m, n]).unwrap();
            let tensor = Multiscale::new(&body, mesh, kind).unwrap().cell_basis(0).unwrap().tensor(spacing);
            for a in 0..3 {
                let mut strain = [0.0; 3];
                strain[a] = 1.0;
                let stress = elasticity.unit_stress(strain).map(|s| young * s);
                for b in 0..3 {
                    prop_assert!((tensor[a][b] - stress[b]).abs() < 1e-11 * stress[a], "{kind:?} {a}{b}");
                }
            }
        }
    }
}
