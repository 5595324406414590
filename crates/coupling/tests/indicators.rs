//! Residual indicators: the reference file, an independent way with matrices of finer elements, exact solutions.

mod common;

use common::{
    PAIRS, around, body_force, close, double_layers, energy_error, inner_gradient, jump, manufactured, material,
    number, outer, problem, reference, traction, traction_error,
};
use faer::Mat;
use steklov_coupling::{CellIndicators, Coupled, Exterior, Form, InterfaceIndicators, Interior, Jumps, Radiation};

/// The jumps of the manufactured problem.
fn with_jumps<T>(body: [f64; 2], around: [f64; 2], halvings: usize, then: impl FnOnce(&Jumps<'_>) -> T) -> T {
    let (body, around) = (material(body), material(around));
    let displacement = |x: [f64; 2]| jump(&around, x);
    let t0 = |x: [f64; 2], n: [f64; 2]| {
        let (t, c) = (traction(body.stress(inner_gradient(x)), n), traction(outer(&around, x).1, n));
        [t[0] - c[0], t[1] - c[1]]
    };
    then(&Jumps { displacement: &displacement, traction: &t0, halvings })
}

/// d/ds of w by matrices of elements a quarter as long: h E₂ times h times the mean square of differences of mean values.
fn slope_by_matrices(interior: &Interior, exterior: &Exterior, solved: &Coupled, wrong_sign: bool) -> f64 {
    let fine = around(interior, 4, 1, [exterior.material.young, exterior.material.poisson]);
    let n = exterior.mesh.len();
    let xi = Mat::from_fn(8 * n, 1, |row, _| {
        let (point, i) = (row / 2, row % 2);
        let (e, s) = (point / 4, (point % 4) as f64 / 4.0);
        let u = (1.0 - s) * solved.trace[2 * e + i] + s * solved.trace[2 * ((e + 1) % n) + i];
        u - jump(&exterior.material, fine.space.points[point])[i]
    });
    let phi = Mat::from_fn(8 * n, 1, |row, _| solved.traction[2 * (row / 8) + row % 2]);
    let [minus, plus] = double_layers(&fine);
    // -ξ + V φ - (K + ½) ξ in place of -ξ - V φ + (K + ½) ξ
    let w = if wrong_sign { &plus * &xi + (&plus - &minus) * &xi } else { &minus * &xi } - &fine.operators.v * &phi;
    let quarter = fine.mesh.length(0);
    let mut sum = 0.0;
    for part in (0..4 * n - 1).filter(|part| part % 4 != 3) {
        for i in 0..2 {
            sum += ((w[(2 * part + 2 + i, 0)] - w[(2 * part + i, 0)]) / (quarter * quarter)).powi(2);
        }
    }
    (4.0 * quarter).powi(2) * exterior.material.young * sum / 3.0
}

#[test]
fn all_terms_are_those_of_the_reference_file_and_the_wrong_sign_does_not_converge() {
    let data = reference("transmission");
    let tolerance = number(&data["tol_rel"]);
    for (pair, body, medium) in PAIRS {
        let mut before: Option<[f64; 2]> = None;
        for n in [4, 8, 16] {
            let (grid, loads) = manufactured(n, body, medium);
            let interior = Interior::fine(&grid, &loads).unwrap();
            let exterior = around(&interior, 1, 1, medium);
            let (transmission, u0) = problem(interior.clone(), &exterior);
            let solved = transmission.solve(&u0, Form::TwoField, Radiation::Decaying).unwrap();
            let u = &solved.displacement;
            let inside = CellIndicators::new(&grid, u, &|x| body_force(&material(body), x));
            let on = with_jumps(body, medium, 2, |jumps| {
                InterfaceIndicators::new(&exterior, &grid, u, &solved, Form::TwoField, jumps).unwrap()
            });
            let wanted = &data["estimator"][format!("{pair}_N{n}")];
            let sum = |terms: &[f64]| terms.iter().sum::<f64>();
            let [volume, jumps] = [sum(&inside.volume), sum(&inside.jump)];
            let [tractions, slopes] = [sum(&on.traction), sum(&on.displacement)];
            let what = |term: &str| format!("{pair} N = {n} {term}");
            close(&what("volume"), volume, number(&wanted["vol"]), tolerance);
            close(&what("jump"), jumps, number(&wanted["jump"]), tolerance);
            close(&what("traction"), tractions, number(&wanted["traction"]), tolerance);
            close(&what("displacement"), slopes, number(&wanted["ds"]), tolerance);
            let [energy, v] = [energy_error(&grid, body, u), traction_error(&exterior, &solved.traction)];
            let error = energy.hypot(v);
            close(&what("error"), error, number(&wanted["err"]), tolerance);
            let effectivity = (sum(&inside.squared()) + sum(&on.squared())).sqrt() / error;
            close(&what("effectivity"), effectivity, number(&wanted["effectivity"]), tolerance);
            let by_matrices = slope_by_matrices(&interior, &exterior, &solved, false);
            let wrong = slope_by_matrices(&interior, &exterior, &solved, true);
            println!("{pair} {n}: {effectivity:.3}, {slopes:.4e} by matrices {:.1e}", by_matrices / slopes - 1.0);
            close(&what("displacement by matrices"), slopes, by_matrices, 1e-6);
            close(&what("wrong sign"), wrong, number(&wanted["ds_thesis_signs"]), tolerance);
            if let Some([right, other]) = before.replace([slopes, wrong]) {
                // the right one falls like h³, the wrong one like h
                assert!(slopes < right / 7.0 && (pair == "soft_in" || wrong > other / 2.1), "{pair} {n}");
            }
        }
    }
}
