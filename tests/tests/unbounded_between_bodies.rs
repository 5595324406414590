//! Whether the pressure between bodies is told as unbounded: by the exponents of both at the ends of what touches.

use steklov_tests::{parse, summary};

/// Two blocks, the lower one held below and the upper one pressed down or under its own displacement.
fn blocks(upper: [f64; 2], lower: [f64; 2], moduli: [f64; 2], law: &str) -> String {
    let ([a, b], [c, d], [of_upper, of_lower]) = (upper, lower, moduli);
    format!(
        "[[body]]\nname = \"upper\"\ncorners = [[{a}, 0], [{b}, 0], [{b}, 1], [{a}, 1]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = {{ young = {of_upper}, poisson = 0.3 }}\n\
         [[body]]\nname = \"lower\"\ncorners = [[{c}, -1], [{d}, -1], [{d}, 0], [{c}, 0]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = {{ young = {of_lower}, poisson = 0.3 }}\n\
         [sides.upper.top]\ndisplacement = [\"0\", \"-0.01\"]\n[sides.lower.bottom]\ndisplacement = [\"0\", \"0\"]\n\
         [[interface]]\nbetween = [\"upper.bottom\", \"lower.top\"]\ncontact = {law}\n"
    )
}

fn is_unbounded(scene: &str) -> bool {
    let scene = parse(scene, &["method.tolerance=1e-2"]).unwrap_or_else(|e| panic!("{}", e.render()));
    let told = summary(&scene);
    told.contact.unwrap().max_pressure_unbounded
}

/// Corners of a punch press without bound on a wider block, with and without friction, on whichever side the multipliers are.
#[test]
fn corners_of_a_punch_are_unbounded() {
    let coulomb = "{ friction = { coulomb = \"0.2\" } }";
    for law in ["true", coulomb] {
        for moduli in [[1000.0, 200.0], [200.0, 1000.0], [1000.0, 1000.0]] {
            assert!(is_unbounded(&blocks([-0.5, 0.5], [-1.0, 1.0], moduli, law)), "{moduli:?}, {law}");
            assert!(is_unbounded(&blocks([-1.0, 1.0], [-0.5, 0.5], moduli, law)), "{moduli:?}, {law}, below");
        }
    }
}

/// Blocks of one width have right angles on both sides of the corner, which no pressure makes singular; on one that is wider the
/// faces that touch may end between the corners, and a disc touches smoothly.
#[test]
fn blocks_of_one_width_and_discs_are_bounded() {
    for moduli in [[1000.0, 200.0], [200.0, 1000.0], [1000.0, 1000.0]] {
        assert!(!is_unbounded(&blocks([-0.5, 0.5], [-0.5, 0.5], moduli, "true")), "{moduli:?}");
    }
    let stuck = "{ friction = { coulomb = \"0.9\" } }";
    assert!(!is_unbounded(&blocks([-0.5, 0.5], [-0.5, 0.5], [1000.0, 1000.0], stuck)), "stuck");
    let parabola = "{ gap = \"x^2\" }";
    assert!(!is_unbounded(&blocks([-0.5, 0.5], [-1.0, 1.0], [1000.0, 300.0], parabola)), "parabola");
}
