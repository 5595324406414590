//! Types of random input come back with the same bits, and parts that do not fit are refused.

use crate::common::{bits, check_damage_is_refused, check_round_trip, dense_bits, spoiled, written};
use faer::Mat;
use proptest::prelude::*;
use steklov_contact::proptest::{Friction, mixed};
use steklov_contact::{ContactNode, Problem, multiplier_rows};
use steklov_io::*;
use steklov_stochastic::{
    CellBasis, Covariance, Distribution, KarhunenLoeve, Kernel, Moments, Nodes, StochasticCell, StochasticMesh,
    Truncation, Variable, smolyak, tensor_active_set,
};

fn variables() -> Vec<Variable> {
    vec![
        Variable::uniform(-1.0, 2.0).unwrap(),
        Variable::new(Distribution::Normal { mean: 1.0, deviation: 0.3 }, 0.1, f64::INFINITY).unwrap(),
        Variable::lognormal(2000.0, 300.0).unwrap(),
        Variable::beta(2.0, 3.5, 0.0, 1.0).unwrap(),
    ]
}

#[test]
fn expansions_meshes_points_and_moments() {
    for kernel in [Kernel::Exponential, Kernel::Gaussian, Kernel::MATERN_32] {
        let covariance = Covariance { kernel, correlation: [0.4; 2] };
        let kl = KarhunenLoeve::new(&covariance, 2.0, Truncation::Modes(5)).unwrap();
        let back = check_round_trip(&kl);
        let (mut a, mut b) = ([0.0; 5], [0.0; 5]);
        kl.modes(0.7, &mut a);
        back.modes(0.7, &mut b);
        assert_eq!(a.map(f64::to_bits), b.map(f64::to_bits));
    }
    let mut mesh = StochasticMesh::uniform(variables(), &[2, 1, 1, 1], &[3, 0, 1, 2]).unwrap();
    mesh.split(1, 1, 0.9).unwrap();
    mesh.raise(2, 3).unwrap();
    check_round_trip(&mesh);
    check_round_trip(&smolyak(&variables(), 2).unwrap());
    check_round_trip(&Moments { mean: vec![1.0, -0.0], variance: vec![0.0, 2.5e-300] });
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let label = Label { unit: "1", meaning: "test", axes: &["what"] };
    let rewritten = |name: &'static str, data: Vec<f64>| {
        let covariance = Covariance { kernel: Kernel::Exponential, correlation: [0.4; 2] };
        let kl = KarhunenLoeve::new(&covariance, 2.0, Truncation::Modes(3)).unwrap();
        let (_folder, file) = written(|file| {
            save(file, "kl", &kl)?;
            let group = open_group(file, "kl")?;
            group.unlink(name).unwrap();
            save_vector(&group, name, &data, &label)
        });
        load::<KarhunenLoeve>(&file, "kl").unwrap_err().to_string()
    };
    assert!(rewritten("shares", vec![0.5, 0.2]).contains("2 eigenvalues and 3 modes"));
    assert!(rewritten("roots", vec![0.5, f64::NAN, 1.0]).contains("do not fit"));
    let mesh = StochasticMesh::uniform(variables(), &[1; 4], &[1; 4]).unwrap();
    let (_folder, file) = written(|file| {
        save(file, "mesh", &mesh)?;
        let group = open_group(file, "mesh")?;
        group.unlink("degree").unwrap();
        save_integers(&group, "degree", &[1, 1, 1], &label)
    });
    assert!(load::<StochasticMesh>(&file, "mesh").unwrap_err().to_string().contains("differ in number"));
}

/// A basis of two or three directions on a cell that is a part of the germs.
fn basis(degree: [usize; 3], directions: usize, kind: Nodes) -> CellBasis {
    let variables = [
        Variable::uniform(-1.0, 2.0).unwrap(),
        Variable::beta(2.0, 3.5, 0.0, 1.0).unwrap(),
        Variable::new(Distribution::Lognormal { mean: 20.0, deviation: 5.0 }, 1.0, 60.0).unwrap(),
    ];
    let cell = StochasticCell {
        bounds: vec![[-0.5, 1.5], [0.0, 1.0], variables[2].germ_support()][..directions].to_vec(),
        degree: degree[..directions].to_vec(),
    };
    CellBasis::new(&variables[..directions], &cell, kind).unwrap()
}

/// A contact problem in several stochastic nodes, whose gaps, slips and bounds differ.
fn tensor(problem: &Problem, basis: &CellBasis) -> StoredTensorProblem {
    let count = basis.weights.len();
    let varied = |j: usize| -> Vec<ContactNode> {
        let mut nodes = problem.nodes.clone();
        for c in nodes.iter_mut().flat_map(|n| &mut n.conditions) {
            c.gap *= 1.0 + 0.1 * j as f64;
            c.bound *= 1.0 + 0.2 * j as f64;
        }
        nodes
    };
    StoredTensorProblem {
        stiffness: problem.stiffness.full().into_owned(),
        mass: basis.mass(&|germ| 2.0 + 0.3 * germ[0]).unwrap(),
        weights: basis.weights.clone(),
        load: Mat::from_fn(problem.load.len(), count, |i, j| {
            basis.weights[j] * problem.load[i] * (1.0 + 0.1 * j as f64)
        }),
        nodes: (0..count).map(varied).collect(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn variables_and_ends_of_expansions(
        law in 0_usize..4, low in -1e3_f64..1e3, width in 1e-3_f64..1e3, a in 0.1_f64..50.0, b in 0.1_f64..50.0, modes in 1_usize..1000,
        share in 1e-9_f64..0.999, p in 0.0_f64..1.0,
    ) {
        let variable = match law {
            0 => Variable::uniform(low, low + width),
            1 => Variable::new(Distribution::Normal { mean: low, deviation: a }, low - b, f64::INFINITY),
            2 => Variable::lognormal(a, b),
            _ => Variable::beta(a, b, low, low + width),
        }
        .unwrap();
        let back = check_round_trip(&variable);
        prop_assert_eq!(&back, &variable);
        prop_assert_eq!(back.quantile(p).to_bits(), variable.quantile(p).to_bits());
        prop_assert_eq!(check_round_trip(&Truncation::Modes(modes)), Truncation::Modes(modes));
        prop_assert_eq!(check_round_trip(&Truncation::Captured(share)), Truncation::Captured(share));
    }

    /// Products of basis functions have the same bits as before writing; with Gauss nodes M_E of E = 1 is diagonal,
    /// with the entries D_j.
    #[test]
    fn bases_of_cells(degree in prop::array::uniform3(0_usize..6), directions in 1_usize..4, lobatto: bool) {
        let kind = if lobatto { Nodes::Lobatto } else { Nodes::Gauss };
        let basis = basis(degree, directions, kind);
        let back = check_round_trip(&basis);
        let coefficient = |germ: &[f64]| (0.1 * germ[0]).exp();
        prop_assert_eq!(dense_bits(&back.mass(&coefficient).unwrap()), dense_bits(&basis.mass(&coefficient).unwrap()));
        let values: Vec<f64> = (0..basis.points.len()).map(|i| (i as f64).sin()).collect();
        prop_assert_eq!(bits(&back.coefficients(&values)), bits(&basis.coefficients(&values)));
        if !lobatto {
            let mass = back.mass(&|_| 1.0).unwrap();
            let wanted = Mat::from_fn(mass.nrows(), mass.nrows(), |i, j| if i == j { back.weights[i] } else { 0.0 });
            prop_assert!((&mass - &wanted).norm_max() < 1e-12 * wanted.norm_max());
        }
    }

    /// The read problem has the same solution, bit by bit, as the written one, and satisfies the equation in the file.
    #[test]
    fn coupled_problems(
        problem in prop_oneof![mixed(4, Friction::Tresca), mixed(4, Friction::Coulomb(0.2))], degree in 0_usize..4,
    ) {
        let basis = basis([degree, 1, 0], 2, Nodes::Gauss);
        let stored = tensor(&problem, &basis);
        let back = check_round_trip(&stored);
        let borrowed = stored.problem();
        check_round_trip(&StoredTensorProblem::from(&borrowed));
        let (one, other) = (tensor_active_set(&borrowed), tensor_active_set(&back.problem()));
        let (one, other) = (one.unwrap(), other.unwrap());
        prop_assert_eq!(dense_bits(&one.displacement), dense_bits(&other.displacement));
        prop_assert_eq!(&one.multipliers, &other.multipliers);
        let rest = imbalance(&back, &other.displacement, &other.multipliers);
        prop_assert!(rest < 1e-12, "{rest:e}");
    }
}

/// The largest entry of Σ_k (M_E)_jk S v_k + D_j Bᵀ W λ_j - F_j over the largest term.
fn imbalance(problem: &StoredTensorProblem, displacement: &Mat<f64>, multipliers: &[Vec<[f64; 2]>]) -> f64 {
    let inner = &problem.stiffness * displacement * &problem.mass;
    let mut rest = &inner - &problem.load;
    let mut scale = inner.norm_max() + problem.load.norm_max();
    for (j, lambda) in multipliers.iter().enumerate() {
        for (row, lambda) in multiplier_rows(&problem.nodes[j]).iter().zip(lambda.iter().flatten()) {
            for i in 0..rest.nrows() {
                let force = problem.weights[j] * row.weight * row.entry(i) * lambda;
                rest[(i, j)] += force;
                scale = scale.max(force.abs());
            }
        }
    }
    rest.norm_max() / scale
}

/// Rules of the highest degree are still recognised.
#[test]
fn bases_of_high_degree() {
    for variable in variables() {
        let cell = StochasticCell { bounds: vec![variable.germ_support()], degree: vec![200] };
        check_round_trip(&CellBasis::new(&[variable], &cell, Nodes::Gauss).unwrap());
    }
}

#[test]
fn damaged_files_are_refused() {
    for variable in variables() {
        check_damage_is_refused(&variable, &["parameters", "interval"]);
    }
    assert!(spoiled_by_loss(&Truncation::Modes(3), "modes").to_string().contains("no /value/modes, nor captured"));
    assert!(spoiled(&Truncation::Modes(3), "modes", |g| save_integers(g, "modes", &[1, 2], &LIST)).contains("[1, 2]"));
    check_damage_is_refused(&Truncation::Captured(0.5), &["captured"]);
    assert!(spoiled(&Truncation::Modes(3), "modes", |g| save_integers(g, "modes", &[0], &LIST)).contains("1 or more"));
    for share in [0.0, 1.0, -0.5] {
        let wrong = |g: &Group| save_vector(g, "captured", &[share], &LIST);
        assert!(spoiled(&Truncation::Captured(0.5), "captured", wrong).contains("no share"));
    }
    let uniform = Variable::uniform(0.0, 1.0).unwrap();
    let wrong = |g: &Group| save_vector(g, "parameters", &[0.0, 1.0], &LIST);
    assert!(spoiled(&uniform, "parameters", wrong).contains("uniform law"));

    check_damage_is_refused(&basis([8, 7, 0], 1, Nodes::Gauss), &["axis_0/recurrence/interval"]);
    check_damage_is_refused(&basis([8, 9, 0], 2, Nodes::Lobatto), &[]);
    let problem = square_problem();
    let free = ["load", "weights", "nodes/gap", "nodes/slip_offset", "nodes/bound", "nodes/normal", "nodes/tangent"];
    let weights = ["nodes/normal_weight", "nodes/tangent_weight", "nodes/coefficient"];
    check_damage_is_refused(&tensor(&problem, &basis([1, 1, 0], 2, Nodes::Gauss)), &[&free[..], &weights].concat());
}

/// The error of reading a value without a part.
fn spoiled_by_loss<T: Persist>(value: &T, part: &str) -> IoError {
    let (_folder, file) = written(|f| {
        save(f, "value", value)?;
        f.group("value").unwrap().unlink(part).unwrap();
        Ok(())
    });
    load::<T>(&file, "value").map(drop).unwrap_err()
}

const LIST: Label<'static> = Label { unit: "1", meaning: "wrong", axes: &["entry"] };

/// Two ordinary nodes.
fn square_problem() -> Problem {
    let condition = |gap| steklov_contact::Condition {
        normal: [1.0, 0.0],
        tangent: [0.0, 1.0],
        normal_weight: 0.5,
        tangent_weight: 0.25,
        gap,
        slip_offset: 0.0,
        bound: 0.3,
        coefficient: 0.0,
    };
    Problem {
        stiffness: Mat::from_fn(4, 4, |i, j| if i == j { 4.0 } else { 1.0 / (1.0 + (i + j) as f64) }).into(),
        load: vec![1.0, -2.0, 0.5, 0.0],
        nodes: [0.1, 0.2]
            .iter()
            .enumerate()
            .map(|(k, g)| ContactNode { first: 2 * k, unknowns: 2, conditions: vec![condition(*g)] })
            .collect(),
    }
}
