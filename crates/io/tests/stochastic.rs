//! Types of random input come back with the same bits, and parts that do not fit are refused.

mod common;

use common::{check_round_trip, written};
use steklov_io::*;
use steklov_stochastic::{
    Covariance, Distribution, KarhunenLoeve, Kernel, Moments, StochasticMesh, Truncation, Variable, smolyak,
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
    for kernel in [Kernel::Exponential, Kernel::Gaussian, Kernel::Matern32] {
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
