//! Error bars of strain energy, work of loads and work against friction, judged by closed forms and by solutions of smaller tolerances.

use std::f64::consts::PI;

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_tests::{parse, scene, summary as solved};

const ENERGIES: [&str; 3] = ["strain_energy", "load_work", "friction_work"];

fn quantity<'s>(summary: &'s Summary, path: &str) -> &'s Quantity {
    summary.quantities.get(path).unwrap_or_else(|| panic!("{path} of {:?}", summary.quantities.keys()))
}

/// A ring whose inner edge is pushed out by w and whose outer edge bears the pressure q.
///
/// u = A r + B/r, σ_r = E/(1+ν) (A/(1-2ν) - B/r²) in plane strain (Lamé 1852).
#[test]
fn energies_of_a_ring_that_is_pushed_out_are_lames() {
    let (young, poisson, a, b, w, q) = (200.0, 0.3, 1.0, 2.0, 0.01, 3.0);
    let scale = young / (1.0 + poisson);
    // A a + B/a = w, σ_r(b) = -q
    let (s, t) = (scale / (1.0 - 2.0 * poisson), -scale / (b * b));
    let spread = (-q - t * a * w) / (s - t * a * a);
    let (swirl, at) = (a * w - a * a * spread, |r: f64, swirl: f64| spread * r + swirl / r);
    let inner = scale * (spread / (1.0 - 2.0 * poisson) - swirl / (a * a));
    let work = -q * at(b, swirl) * 2.0 * PI * b;
    let strain = 0.5 * (work - inner * w * 2.0 * PI * a);
    let circle = |r: f64, name: &str| format!("circle = {{ centre = [0, 0], radius = {r} }}\nside = \"{name}\"\n");
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let text = format!(
            "method.tolerance = {tolerance}\nsides.inner.displacement = [\"{w}*x\", \"{w}*y\"]\n\
             sides.outer.pressure = {q}\nmaterial = {{ young = {young}, poisson = {poisson} }}\n\
             [body]\n{}[[body.holes]]\n{}",
            circle(b, "outer"),
            circle(a, "inner")
        );
        let summary = solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{e:?}")));
        for (path, exact) in [("strain_energy", strain), ("load_work", work)] {
            let Quantity { value, uncertainty, .. } = quantity(&summary, path);
            let error = (value - exact).abs();
            println!("{tolerance:e} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
            assert!(error <= 2.0 * uncertainty, "{path} at {tolerance:e}: {error:e} and {uncertainty:e}");
            assert!(*uncertainty <= tolerance * exact.abs(), "{path} at {tolerance:e}: {uncertainty:e}");
        }
    }
}

/// Gaps, prescribed displacements, friction of both laws, bodies that touch.
#[test]
fn energies_with_contact_and_supports_that_move_are_inside_their_bars() {
    let (mut count, mut inside, mut wide) = (0, 0, 0);
    for name in ["hertz", "wedge-gap", "coulomb-wedge", "two-cylinders"] {
        let at = |tolerance: &str| solved(&scene(name, &[&format!("method.tolerance={tolerance}"), "expect={}"]));
        let known = at("1e-6");
        for tolerance in ["3e-2", "3e-3", "3e-4"] {
            let summary = at(tolerance);
            for path in ENERGIES.into_iter().filter(|path| known.quantities.contains_key(*path)) {
                let Quantity { value, uncertainty, doubts, .. } = quantity(&summary, path);
                let exact = quantity(&known, path);
                let error = (value - exact.value).abs();
                println!("{name} {tolerance} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e} {doubts:?}");
                if *value == 0.0 && exact.value == 0.0 {
                    assert_eq!(*uncertainty, 0.0, "{name}: {path} without loads");
                    continue;
                }
                assert!(error <= 2.0 * uncertainty, "{name} {path} at {tolerance}: {error:e} and {uncertainty:e}");
                (count, inside) = (count + 1, inside + usize::from(error <= *uncertainty));
                wide += usize::from(*uncertainty > 100.0 * error);
            }
        }
    }
    println!("{inside} of {count} errors inside, {wide} bars more than a hundred errors wide");
    assert!(count == 24 && 100 * inside >= 90 * count && 4 * wide <= count, "{inside} of {count}, {wide} wide");
}
