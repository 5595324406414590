//! Spaces of multipliers and the forms of their stabilisation come back with the same bits, satisfy the formulas in the
//! file, and are refused when damaged.

use crate::common::{
    check_damage_is_refused, check_round_trip, dense_bits, place, python, spoiled, stored_twice, written,
};
use faer::Mat;
use proptest::prelude::*;
use steklov_algebra::{Cholesky, eigenvalues};
use steklov_bem_operators::{Domain, Loop, Mesh, Operators, Path, Polygon, Space, Steklov};
use steklov_contact::{InfSup, MultiplierDegree, MultiplierMesh, MultiplierSpace, StabilisedForms, dual_form, inf_sup};
use steklov_elastic::{Material, Plane};
use steklov_io::*;

/// A block on a floor, straight or round, clamped on top.
struct Block {
    mesh: Mesh,
    space: Space,
    material: Material,
    steklov: Steklov,
    held: Vec<(usize, f64)>,
}

impl Block {
    fn new(round: bool, parts: usize, degree: usize, poisson: f64) -> Self {
        let corners = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        let straight = Loop::straight(corners, ["floor", "right", "top", "left"].map(String::from).to_vec());
        let first = if round { Path::Arc { opening: 0.7 } } else { Path::Line };
        let outer = Loop { paths: vec![first, Path::Line, Path::Line, Path::Line], ..straight };
        let mesh = Mesh::uniform(&Polygon::new(outer, vec![]).unwrap(), parts, degree);
        let space = Space::new(&mesh);
        let material = Material::new(3.0, poisson, Plane::Strain).unwrap();
        let operators = Operators::assemble(&mesh, &space, &material, None).unwrap();
        let steklov = Steklov::new(operators, Domain::Interior).unwrap();
        let top = mesh.side_names.iter().position(|name| name == "top").unwrap();
        let nodes = (0..mesh.len()).filter(|&e| mesh.side[e] == top).flat_map(|e| space.element_nodes(e));
        let mut held: Vec<(usize, f64)> = nodes.flat_map(|k| [(2 * k, 0.0), (2 * k + 1, 0.0)]).collect();
        held.sort_by_key(|h| h.0);
        held.dedup();
        Self { mesh, space, material, steklov, held }
    }

    fn multipliers(&self, kind: MultiplierMesh, degree: MultiplierDegree) -> MultiplierSpace {
        let floor = self.mesh.side_names.iter().position(|name| name == "floor").unwrap();
        MultiplierSpace::new(&self.mesh, &[floor], kind, degree).unwrap()
    }

    fn forms(&self, multipliers: &MultiplierSpace) -> StabilisedForms {
        StabilisedForms::new(&self.mesh, &self.space, &self.material, &self.steklov.traction, multipliers).unwrap()
    }
}

const MESHES: [MultiplierMesh; 4] =
    [MultiplierMesh::Same, MultiplierMesh::Coarser(2), MultiplierMesh::Finer(3), MultiplierMesh::Shifted];
const DEGREES: [MultiplierDegree; 4] = [
    MultiplierDegree::Relative(-1),
    MultiplierDegree::Fixed(0),
    MultiplierDegree::Fixed(4),
    MultiplierDegree::ContinuousLinear,
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn spaces_forms_and_constants(
        round: bool, parts in 8_usize..14, degree in 1_usize..4, kind in 0_usize..4, multiplier in 0_usize..4, poisson in 0.0_f64..0.49999,
        beta in 0.0_f64..1.0,
    ) {
        let block = Block::new(round, parts, degree, poisson);
        let multipliers = block.multipliers(MESHES[kind], DEGREES[multiplier]);
        let back = check_round_trip(&multipliers);
        prop_assert_eq!(&back, &multipliers);
        prop_assert_eq!(back.nodes[0].resultant.is_some(), round);
        prop_assert_eq!(check_round_trip(&InfSup { beta }), InfSup { beta });

        let forms = block.forms(&multipliers);
        let back = stored_twice(&forms);
        let s = &block.steklov.matrix;
        let critical = forms.critical_gamma(s, &block.held, &[]).unwrap();
        prop_assert_eq!(back.critical_gamma(s, &block.held, &[]).unwrap().to_bits(), critical.to_bits());
        let dual = |forms: &StabilisedForms| dense_bits(&forms.dual_form(s, &block.held, &[], 0.5 * critical).unwrap());
        prop_assert_eq!(dual(&forms), dual(&back));
        for k in 0..2 {
            prop_assert_eq!(dense_bits(&forms.parts().pairing[k]), dense_bits(&back.parts().pairing[k]));
        }
    }
}

fn apart(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    (a - b).norm_max() / b.norm_max()
}

/// Checks B, C and D against the stored traces and values, Q against stored numbers, and the Schur complement E (S -
/// B_γ)⁻¹ Eᵀ + D_γ of stored forms.
#[test]
fn the_forms_are_those_of_the_stored_parts() {
    let block = Block::new(false, 10, 3, 0.45);
    let multipliers = block.multipliers(MultiplierMesh::Shifted, MultiplierDegree::Fixed(2));
    let (_folder, file) = written(|f| save(f, "value", &block.forms(&multipliers)));
    let group = open_group(&file, "value").unwrap();
    let dense = |name: &str| load_dense(&group, name).unwrap();
    let (trace, values) =
        (["n", "t"].map(|k| dense(&format!("trace_{k}"))), ["n", "t"].map(|k| dense(&format!("values_{k}"))));
    let b = trace[0].transpose() * &trace[0] + trace[1].transpose() * &trace[1];
    let mut worst = [apart(&dense("B_gamma"), &b), 0.0, 0.0, 0.0];
    for (k, name) in ["n", "t"].into_iter().enumerate() {
        worst[1] = apart(&dense(&format!("C_gamma_{name}")), &(values[k].transpose() * &trace[k])).max(worst[1]);
        worst[2] = apart(&dense(&format!("D_gamma_{name}")), &(values[k].transpose() * &values[k])).max(worst[2]);
    }

    // a constant multiplier has the form of the weights, and γ₀ = ½ of the critical one gives the dual form of the library
    let weights = load_vector(&group, "weights").unwrap();
    let sum: f64 = (0..multipliers.nodes.len())
        .flat_map(|i| (0..multipliers.nodes.len()).map(move |j| (i, j)))
        .map(|(i, j)| dense("D_gamma_t")[(i, j)])
        .sum();
    let squares: f64 = weights.iter().map(|w| w * w).sum();
    let forms: StabilisedForms = load(&file, "value").unwrap();
    let s = &block.steklov.matrix;
    let gamma = 0.5 * forms.critical_gamma(s, &block.held, &[]).unwrap();
    let free: Vec<usize> = (0..s.nrows()).filter(|i| block.held.iter().all(|h| h.0 != *i)).collect();
    let rest = Mat::from_fn(free.len(), free.len(), |i, j| s[(free[i], free[j])] - gamma * b[(free[i], free[j])]);
    let nodes = multipliers.nodes.len();
    let pairing = ["n", "t"].map(|k| load_sparse(&group, &format!("pairing_{k}")).unwrap().to_dense());
    let mixed = ["n", "t"].map(|k| dense(&format!("C_gamma_{k}")));
    let own = ["n", "t"].map(|k| dense(&format!("D_gamma_{k}")));
    let e = Mat::from_fn(2 * nodes, free.len(), |i, j| {
        pairing[i % 2][(i / 2, free[j])] - gamma * mixed[i % 2][(i / 2, free[j])]
    });
    let mut by_hand = &e * Cholesky::new(rest.as_ref()).unwrap().solve(e.transpose());
    for (i, j) in (0..2 * nodes).flat_map(|i| (0..2 * nodes).map(move |j| (i, j))).filter(|(i, j)| i % 2 == j % 2) {
        by_hand[(i, j)] += gamma * own[i % 2][(i / 2, j / 2)];
    }
    worst[3] = apart(&forms.dual_form(s, &block.held, &[], gamma).unwrap(), &by_hand);
    eprintln!(
        "B {:.1e}, C {:.1e}, D {:.1e}, dual form {:.1e}, constant {:.1e}",
        worst[0],
        worst[1],
        worst[2],
        worst[3],
        sum / squares - 1.0
    );
    assert!(worst.iter().all(|w| *w < 1e-10) && (sum / squares - 1.0).abs() < 1e-12, "{worst:?}");
}

/// Checks β against the stored pairing and matrix, by eigenvalues of B S⁻¹ Bᵀ of a coarse against a finer space.
#[test]
fn the_constant_is_that_of_the_stored_matrices() {
    let (coarse, fine) = (Block::new(false, 8, 2, 0.3), Block::new(false, 16, 3, 0.3));
    let multipliers = coarse.multipliers(MultiplierMesh::Same, MultiplierDegree::Relative(-1));
    let of = |block: &Block| {
        let pairing = steklov_contact::pairing(&block.mesh, &block.space, &multipliers);
        dual_form(&pairing, &block.steklov.matrix, &block.held, &[]).unwrap()
    };
    let (_folder, file) = written(|f| {
        save(f, "constant", &inf_sup(&of(&coarse), &of(&fine)).unwrap())?;
        save(f, "coarse", &coarse.steklov)?;
        save(f, "forms", &coarse.forms(&multipliers))
    });
    let (constant, steklov, forms): (InfSup, Steklov, StabilisedForms) =
        (load(&file, "constant").unwrap(), load(&file, "coarse").unwrap(), load(&file, "forms").unwrap());
    let (s, pairing) = (&steklov.matrix, &forms.parts().pairing);
    let free: Vec<usize> = (0..s.nrows()).filter(|i| coarse.held.iter().all(|h| h.0 != *i)).collect();
    let b = Mat::from_fn(2 * multipliers.nodes.len(), free.len(), |i, j| pairing[i % 2][(i / 2, free[j])]);
    let s = Mat::from_fn(free.len(), free.len(), |i, j| s[(free[i], free[j])]);
    let discrete = &b * Cholesky::new(s.as_ref()).unwrap().solve(b.transpose());
    let reference = of(&fine);
    let pencil = Cholesky::new(reference.as_ref()).unwrap().solve(discrete.as_ref());
    let least = eigenvalues(pencil.as_ref()).unwrap().iter().fold(f64::INFINITY, |m, v| m.min(v.re));
    let difference = (least.sqrt() / constant.beta - 1.0).abs();
    eprintln!("beta {}, apart {difference:.1e}", constant.beta);
    assert!(constant.beta > 0.0 && constant.beta < 1.0 && difference < 1e-9, "{least} {constant:?}");
}

#[test]
fn damaged_files_are_refused() {
    let block = Block::new(true, 10, 2, 0.4);
    for degree in DEGREES {
        let multipliers = block.multipliers(MultiplierMesh::Shifted, degree);
        check_damage_is_refused(&multipliers, &["points", "weight", "curved", "resultant"]);
    }
    let multipliers = block.multipliers(MultiplierMesh::Same, MultiplierDegree::Relative(0));
    let sparse = |k: &str| ["data", "indices", "indptr"].map(|part| format!("pairing_{k}/{part}"));
    let [n, t] = [sparse("n"), sparse("t")];
    let free: Vec<&str> =
        ["elements", "coordinates"].into_iter().chain(n.iter().chain(&t).map(String::as_str)).collect();
    check_damage_is_refused(&block.forms(&multipliers), &free);
    check_damage_is_refused(&InfSup { beta: 0.5 }, &["beta"]);
    let list = Label { unit: "1", meaning: "wrong", axes: &["value"] };
    let negative = |g: &Group| save_vector(g, "beta", &[-0.5], &list);
    assert!(spoiled(&InfSup { beta: 0.5 }, "beta", negative).contains("-0.5 is no root"));
}

/// `read_forms.py` checks the formulas with numpy.
#[test]
fn numpy_finds_the_formulas() {
    let block = Block::new(false, 10, 2, 0.4);
    let multipliers = block.multipliers(MultiplierMesh::Finer(2), MultiplierDegree::Fixed(1));
    let (_folder, path) = place();
    create_atomically(&path, false, |f| {
        save(f, "space", &multipliers)?;
        save(f, "forms", &block.forms(&multipliers))
    })
    .unwrap();
    python("read_forms.py", &path);
}
