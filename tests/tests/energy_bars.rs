//! Error bars of strain energy, work of loads and work against friction, judged by closed forms and by solutions of smaller tolerances.

use std::f64::consts::PI;

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_tests::{parse, scene, summary as solved};

use crate::error_bars::quantity;

const ENERGIES: [&str; 3] = ["strain_energy", "load_work", "friction_work"];

/// Asserts that numbers are known values to within two bars, and bars below the tolerance.
fn assert_known(summary: &Summary, tolerance: f64, known: &[(&str, f64)]) {
    for &(path, exact) in known {
        let Quantity { value, uncertainty, .. } = quantity(summary, path);
        let error = (value - exact).abs();
        println!("{tolerance:e} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
        assert!(error <= 2.0 * uncertainty, "{path} at {tolerance:e}: {error:e} and {uncertainty:e}");
        assert!(*uncertainty <= tolerance * exact.abs(), "{path} at {tolerance:e}: {uncertainty:e}");
    }
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
        assert_known(&summary, tolerance, &[("strain_energy", strain), ("load_work", work)]);
    }
}

/// Two rings pressed into each other by an interference δ at the radius b, as a contact with a gap and as a tie with a jump.
///
/// u = A r + B/r and σ_r as above; the same displacement less δ and the same pressure p at b (Lamé 1852).
#[test]
fn energies_of_pressed_rings_are_lames() {
    let (young, poisson, [a, b, c], delta) = (1.0, 0.3, [1.0, 2.0, 3.0], 0.01);
    // radial displacement at b over the pressure there, of the outer ring out and of the inner one in, in plane strain
    let [plane, ratio] = [young / (1.0 - poisson * poisson), poisson / (1.0 - poisson)];
    let outer = b / plane * ((c * c + b * b) / (c * c - b * b) + ratio);
    let inner = b / plane * ((b * b + a * a) / (b * b - a * a) - ratio);
    let pressure = delta / (outer + inner);
    let strain = [inner, outer].map(|compliance| PI * b * pressure * pressure * compliance);
    let ring = |name: &str, out: f64, inside: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\ncircle = {{ centre = [0, 0], radius = {out} }}\nside = \"outside\"\n\
             [[body.holes]]\ncircle = {{ centre = [0, 0], radius = {inside} }}\nside = \"inside\"\n"
        )
    };
    for law in ["contact = { gap = \"-0.01\" }", "tied = { displacement_jump = [\"-0.005*x\", \"-0.005*y\"] }"] {
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let text = format!(
                "method.tolerance = {tolerance}\nmaterial = {{ young = {young}, poisson = {poisson} }}\n{}{}\
                 [[interface]]\nbetween = [\"inner.outside\", \"outer.inside\"]\n{law}\n",
                ring("inner", b, a),
                ring("outer", c, b)
            );
            let summary = solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())));
            let [inner, outer] = strain;
            let known = [
                ("strain_energy", inner + outer),
                ("bodies.0.strain_energy", inner),
                ("bodies.1.strain_energy", outer),
            ];
            assert_known(&summary, tolerance, &known);
        }
    }
}

/// Media around bodies, with a remote stress and with jumps, on one mesh and as a second body; tied blocks.
#[test]
fn energies_of_media_and_bodies_are_inside_their_bars() {
    let (mut count, mut half) = (0, 0);
    for name in ["shrink-fit-square", "goodier-on-a-circle", "round-lining", "tied-blocks"] {
        let at = |tolerance: &str| solved(&scene(name, &[&format!("method.tolerance={tolerance}"), "expect={}"]));
        let known = at("1e-6");
        for tolerance in ["1e-1", "1e-2", "1e-3"] {
            let own = at(tolerance);
            let is_told = |path: &&String| path.ends_with("strain_energy") || *path == "load_work";
            for path in own.quantities.keys().filter(is_told) {
                let (Quantity { value, uncertainty, .. }, exact) = (quantity(&own, path), quantity(&known, path));
                let error = (value - exact.value).abs();
                println!("{name} {tolerance} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
                if error < 20.0 * exact.uncertainty {
                    continue;
                }
                assert!(error <= 4.0 * uncertainty, "{name} {path} at {tolerance}: {error:e} and {uncertainty:e}");
                (count, half) = (count + 1, half + usize::from(error <= 2.0 * uncertainty));
            }
        }
    }
    println!("{half} of {count}");
    assert!(count >= 15 && 100 * half >= 97 * count, "{half} of {count}");
}

/// Springs: forces, moments and energies, of a block on a bed, of a disc, and beside supports and contact.
#[test]
fn numbers_of_springs_are_inside_their_bars() {
    let block =
        "body = { corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = [\"floor\", \"right\", \"top\", \"left\"] }\n";
    let scenes = [
        format!(
            "{block}sides.floor.springs = {{ normal = \"50*(1 + x)\", tangential = 5 }}\nsides.right.springs = [2, 1]\n\
             sides.top.traction = [1, \"-3 - x\"]\nquantities.m = {{ moment = \"floor\", about = [0, 0] }}\n"
        ),
        "body = { circle = { centre = [0, 0], radius = 1 }, side = \"rim\" }\n\
         sides.rim = { springs = { normal = 20, tangential = 3 }, traction = [\"x*y\", \"1 + x\"] }\n"
            .to_owned(),
        format!(
            "{block}sides.floor.contact.gap = \"0.01*(x - 1)^2\"\nsides.right.springs = [20, 0]\n\
             sides.left.displacement = [0.01, 0]\nsides.top.pressure = 2\n"
        ),
    ];
    let (mut count, mut inside) = (0, 0);
    for scene in scenes {
        let at = |tolerance: &str| {
            let text = format!("{scene}material = {{ young = 100, poisson = 0.3 }}\nmethod.tolerance = {tolerance}\n");
            solved(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}\n{text}", e.render())))
        };
        let known = at("1e-6");
        for tolerance in ["1e-1", "1e-2", "1e-3", "1e-4"] {
            let own = at(tolerance);
            assert!(
                ["spring_energy", "strain_energy", "load_work"].iter().all(|path| own.quantities.contains_key(*path))
            );
            for (path, Quantity { value, uncertainty, .. }) in &own.quantities {
                let exact = quantity(&known, path);
                let error = (value - exact.value).abs();
                if error < 20.0 * exact.uncertainty {
                    continue;
                }
                println!("{tolerance} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
                assert!(error <= 3.0 * uncertainty, "{path} at {tolerance}: {error:e} and {uncertainty:e}");
                (count, inside) = (count + 1, inside + usize::from(error <= *uncertainty));
            }
        }
    }
    println!("{inside} of {count}");
    assert!(count > 25 && 10 * inside >= 9 * count, "{inside} of {count}");
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
