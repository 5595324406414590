//! The manufactured problem: errors of the reference file, rates, and which of the forms agree.

use crate::common::{
    PAIRS, around, close, difference, energy_error, manufactured, number, outer, problem, reference, traction_error,
};
use steklov_coupling::{Form, Interior, Radiation};

#[test]
fn two_and_three_fields_have_the_errors_of_the_reference_file_and_converge_by_order_one() {
    let data = reference("transmission");
    let tolerance = number(&data["tol_rel"]);
    for (pair, body, medium) in PAIRS {
        let rows = &data[format!("manufactured_{pair}")];
        for (form, key) in [(Form::TwoField, "two"), (Form::ThreeField, "three")] {
            let mut before = None;
            for n in [4, 8, 16, 32, 64] {
                if n == 64 && form == Form::ThreeField && pair != "same" {
                    continue;
                }
                let (grid, loads) = manufactured(n, body, medium);
                let interior = Interior::fine(&grid, &loads).unwrap();
                let exterior = around(&interior, 1, 1, medium);
                let (problem, jump) = problem(interior, &exterior);
                let solved = problem.solve(&jump, form, Radiation::Decaying).unwrap();
                let error = energy_error(&grid, body, &solved.displacement);
                let what = format!("{pair} {key} N = {n}");
                let wanted = &rows[n.to_string()];
                println!("{what}: {error:.6}");
                close(&what, error, number(&wanted[key]["energy"]), tolerance);
                let error_traction = traction_error(&exterior, &solved.traction);
                close(&format!("{what} V"), error_traction, number(&wanted[key]["V"]), tolerance);
                if let Some(before) = before.replace(error).filter(|_| n > 8) {
                    let rate = f64::log2(before / error);
                    assert!((0.97..1.08).contains(&rate), "{what}: rate {rate}");
                }
            }
        }
    }
}

#[test]
fn the_schur_form_is_the_two_field_form_and_the_three_field_form_is_another_one() {
    for (_, body, medium) in PAIRS {
        let (grid, loads) = manufactured(8, body, medium);
        let interior = Interior::fine(&grid, &loads).unwrap();
        let exterior = around(&interior, 1, 1, medium);
        let (problem, jump) = problem(interior, &exterior);
        let [two, three, schur] = [Form::TwoField, Form::ThreeField, Form::Schur]
            .map(|form| problem.solve(&jump, form, Radiation::Decaying).unwrap());
        assert!(difference(&schur.displacement, &two.displacement) < 1e-12);
        assert!(difference(&schur.traction, &two.traction) < 1e-12);
        assert!(difference(&schur.exterior_displacement, &two.exterior_displacement) < 1e-12);
        let apart = difference(&three.displacement, &two.displacement);
        assert!((1e-6..0.1).contains(&apart), "{apart}");
    }
}

/// ξ of the three-field form is determined up to a rigid motion, which the jump of displacements then tells.
#[test]
fn the_displacement_of_the_medium_converges_in_all_forms() {
    let (body, medium) = ([20.0, 0.25], [2.0, 0.3]);
    for form in [Form::TwoField, Form::ThreeField, Form::Schur] {
        let [coarse, fine] = [8, 16].map(|n| {
            let (grid, loads) = manufactured(n, body, medium);
            let interior = Interior::fine(&grid, &loads).unwrap();
            let exterior = around(&interior, 1, 1, medium);
            let (problem, jump) = problem(interior, &exterior);
            let solved = problem.solve(&jump, form, Radiation::Decaying).unwrap();
            let exact = exterior.space.interpolate(|x| outer(&exterior.material, x).0);
            difference(&solved.exterior_displacement, &exact)
        });
        println!("{form:?} {coarse:.2e} {fine:.2e}");
        assert!(fine < 0.35 * coarse && fine < 0.01, "{form:?}: {coarse} then {fine}");
    }
}
