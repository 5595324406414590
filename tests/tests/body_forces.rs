//! The work of body forces.

use steklov_tests::{adapt, answer, parse};

/// A column of height H and width w between smooth walls under its weight g and a pressure q, its foot moved by d along y:
/// ε_yy = -(q + g (H - y))/M, M = λ + 2μ. J, strain energy and the work of weight and pressure, wherever the column stands.
#[test]
fn a_column_under_its_weight_has_the_energies_of_its_strain() {
    let (young, nu, w, h) = (10.0, 0.3, 0.7, 1.9_f64);
    let m = young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    for (g, q, d, [x, y]) in
        [(0.4, 0.0, 0.0, [0.0, 0.0]), (0.4, 0.3, 0.02, [0.0, 0.0]), (-0.2, 0.3, -0.05, [3.0, -7.0])]
    {
        let text = format!(
            "[body]\ncorners = [[{x}, {y}], [{0}, {y}], [{0}, {1}], [{x}, {1}]]\nsides = [\"foot\", \"wall\", \"top\", \"wall\"]\n\
             [material]\nyoung = {young:?}\npoisson = {nu}\n[body_force]\nvalue = [\"0\", \"{2}\"]\n\
             [sides.foot]\ndisplacement = [\"free\", \"{d}\"]\n[sides.wall]\ndisplacement = [\"0\", \"free\"]\n\
             [sides.top]\npressure = \"{q}\"\n[method]\nrefine = \"none\"\nelements = 12\ndegree = 2\n",
            x + w,
            y + h,
            -g
        );
        let found = answer(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))).solved.energies;
        let strain = w / (2.0 * m) * ((q + g * h).powi(3) - q.powi(3)) / (3.0 * g);
        let of_weight = -g * w * (d * h - q * h * h / (2.0 * m) - g * h.powi(3) / (3.0 * m));
        let work = of_weight - q * w * (d - q * h / m - g * h * h / (2.0 * m));
        let size = strain + work.abs();
        for (what, found, exact) in [
            ("strain energy", found.strain, strain),
            ("work", found.load_work, work),
            ("J", found.total, strain - work),
        ] {
            assert!(
                (found - exact).abs() < 1e-10 * size,
                "g = {g}, q = {q}, d = {d}, {what}: {found} instead of {exact}"
            );
        }
    }
}

/// Clapeyron: where supports do not move the strain energy is half of the loads' work, and J its negative. The weight bends the
/// body, so that neither is in the particular solution alone.
#[test]
fn of_dead_loads_half_of_the_work_is_strain_energy() {
    for (corners, weight) in [
        ("[[0, 0], [2, 0], [2, 1], [0, 1]]", "[\"0.3\", \"-1\"]"),
        ("[[1, -3], [3, -2.5], [2.5, -1], [1, -2]]", "[\"-1\", \"0.4\"]"),
    ] {
        let text = format!(
            "[body]\ncorners = {corners}\nsides = [\"low\", \"far\", \"high\", \"wall\"]\n[material]\nyoung = 10.0\npoisson = 0.3\n\
             [body_force]\nvalue = {weight}\n[sides.wall]\ndisplacement = [\"0\", \"0\"]\n\
             [sides.far]\ntraction = [\"0.1\", \"-0.2*s\"]\n[method]\ntolerance = 1e-4\n"
        );
        let run =
            adapt(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))).unwrap_or_else(|e| panic!("{e}"));
        let found = run.last.energies;
        println!("{found:?}");
        assert!(run.converged() && found.load_work > 0.01);
        assert!((found.strain / (0.5 * found.load_work) - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.total / (-0.5 * found.load_work) - 1.0).abs() < 1e-6, "{found:?}");
    }
}
