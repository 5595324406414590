//! Error bars of numbers on grids: judged by known solutions, by boundary elements and by the fine grid of coarse cells.

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_tests::{Random, on_grid, parse, summary};

/// The sides of a square.
const SQUARE: &str =
    "body = { corners = [[0, 0], [1, 0], [1, 1], [0, 1]], sides = [\"lower\", \"right\", \"upper\", \"left\"] }\n";

fn solved(text: &str) -> Summary {
    on_grid(&parse(text, &["method.refine=\"none\""]).unwrap_or_else(|e| panic!("{}\n{text}", e.render())))
}

/// Value and uncertainty of a number without doubts.
fn bar(summary: &Summary, path: &str) -> Option<[f64; 2]> {
    let Quantity { value, uncertainty, doubts, .. } = summary.quantities.get(path)?;
    doubts.is_empty().then_some([*value, *uncertainty])
}

/// u = (x y sin πy, 0) on the unit square with μ = 1 and λ = 100, which bilinear elements meet with ν = 0.495.
#[test]
fn a_known_field_is_inside_its_bars_on_every_grid() {
    use std::f64::consts::PI;
    let (mu, lambda) = (1.0, 100.0);
    let text = format!(
        "{SQUARE}material = {{ young = {}, poisson = {} }}\nmethod.model = \"fem\"\n\
         sides.left.displacement = [0, 0]\nsides.lower.displacement = [0, 0]\nsides.upper.displacement = [0, 0]\n\
         sides.right.displacement = [\"y*sin(pi*y)\", 0]\nprobe.points = [[0.5, 0.5], [0.31, 0.77], [0.25, 0.25]]\n\
         body_force.value = [\"-x*(2*pi*cos(pi*y) - pi^2*y*sin(pi*y))\", \"-101*(sin(pi*y) + pi*y*cos(pi*y))\"]\n",
        mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu),
        lambda / (2.0 * (lambda + mu)),
    );
    let mut widest = [f64::INFINITY; 15];
    for n in [8, 16, 32, 64] {
        let summary = solved(&format!("{text}grid = {{ coarse = [{n}, {n}], fine = [1, 1] }}\n"));
        let mut of_path = widest.iter_mut();
        for (k, [x, y]) in [[0.5, 0.5], [0.31, 0.77], [0.25, 0.25]].into_iter().enumerate() {
            let (s, c) = (PI * y).sin_cos();
            let of = [
                ("displacement.x", x * y * s),
                ("displacement.y", 0.0),
                ("stress.xx", (lambda + 2.0 * mu) * y * s),
                ("stress.yy", lambda * y * s),
                ("stress.xy", mu * x * (s + PI * y * c)),
            ];
            for (name, exact) in of {
                let path = format!("probe.{k}.{name}");
                let Quantity { value, uncertainty, doubts, .. } = &summary.quantities[&path];
                // strains of a half
                assert_eq!(doubts, &["large"]);
                let error = (value - exact).abs();
                println!("{n} {path}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
                assert!(error <= 1.1 * *uncertainty, "{path} at {n}: {error:e} and {uncertainty:e}");
                let widest = of_path.next().expect("a number for each");
                assert!(*uncertainty < *widest / 1.2, "{path} at {n}: {uncertainty:e} after {widest:e}");
                *widest = *uncertainty;
            }
        }
    }
    assert!(widest.iter().step_by(5).all(|bar| *bar < 2e-4), "{widest:?}");
}

/// The same field: the work of the traction on y(y - 1) along x = 1 is -(1/π - 8/π³), the mean displacement there 1/π.
#[test]
fn the_work_of_a_varying_support_is_inside_its_bar_on_every_grid() {
    use std::f64::consts::PI;
    let exact = [("weighted_force.shear", 8.0 / PI.powi(3) - 1.0 / PI), ("mean_displacement.pull.x", 1.0 / PI)];
    let text = format!(
        "{SQUARE}material = {{ young = {}, poisson = {} }}
         sides.left.displacement = [0, 0]\nsides.lower.displacement = [0, 0]\nsides.upper.displacement = [0, 0]\n         sides.right.displacement = [\"y*sin(pi*y)\", 0]\n         quantities.shear = {{ weighted_force = \"right\", weight = [0, \"y*(y - 1)\"] }}\n         quantities.pull = {{ mean_displacement = \"right\" }}\n         body_force.value = [\"-x*(2*pi*cos(pi*y) - pi^2*y*sin(pi*y))\", \"-101*(sin(pi*y) + pi*y*cos(pi*y))\"]\n",
        302.0 / 101.0,
        50.0 / 101.0,
    );
    let mut least = [f64::INFINITY; 2];
    let grids =
        [8, 16, 32, 64].map(|n| format!("grid = {{ coarse = [{n}, {n}], fine = [1, 1] }}\nmethod.model = \"fem\"\n"));
    let coarse = ["coupled", "oscillatory"].map(|basis| {
        format!("grid = {{ coarse = [8, 8], fine = [8, 8], basis = \"{basis}\" }}\nmethod.model = \"msfem\"\n")
    });
    for grid in grids.iter().chain(&coarse) {
        let summary = solved(&format!("{text}{grid}"));
        for ((path, exact), least) in exact.iter().zip(&mut least) {
            let Quantity { value, uncertainty, .. } = summary.quantities[*path];
            let error = (value - exact).abs();
            println!("{path}: {value} ± {uncertainty:.1e}, off by {error:.1e}, {grid}");
            assert!(error <= uncertainty, "{path}: {error:e} and {uncertainty:e}, {grid}");
            *least = least.min(uncertainty);
        }
    }
    assert!(least[0] < 3e-4 && least[1] < 1e-4, "{least:?}");
}

/// Weights that are rigid motions give forces and moments, on grids and with boundary elements.
#[test]
fn weights_that_are_rigid_motions_give_forces_and_moments() {
    let text = format!(
        "{SQUARE}material = {{ young = 10, poisson = 0.3 }}\nsides.left.displacement = [0, 0]\n         sides.right.traction = [0.2, \"1 + y\"]\nsides.upper.traction = [0, -0.5]\n         quantities.up = {{ weighted_force = \"left\", weight = [0, 1] }}\n         quantities.about = {{ weighted_force = \"left\", weight = [\"0.25 - y\", \"x - 3\"] }}\n         quantities.turns = {{ moment = \"left\", about = [3, 0.25] }}\n"
    );
    let grid = "grid = { coarse = [4, 4], fine = [4, 4] }\n";
    let of = |model: &str| {
        let scene = parse(&format!("{text}{model}"), &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        if model.contains("grid") { on_grid(&scene) } else { summary(&scene) }
    };
    for model in ["", &format!("{grid}method.model = \"fem\"\n"), &format!("{grid}method.model = \"msfem\"\n")] {
        let summary = of(model);
        let [up, about] = ["up", "about"].map(|name| summary.named.weighted_force[name]);
        assert!((up - summary.reactions["left"][1]).abs() < 1e-9 && (up + 1.0).abs() < 1e-9, "{model}: {up}");
        let turns = summary.named.moment["turns"];
        // the loads on the right side about (3, 0.25): -2 (1.5) + 0.2 (0.25 - 0.5); on the upper one -2.5 (-0.5)
        let exact = -(-2.0 * 1.5 - 0.2 * 0.25 + 2.5 * 0.5);
        assert!((about - turns).abs() < 1e-9 && (turns - exact).abs() < 1e-9, "{model}: {about}, {turns}, {exact}");
        assert!(bar(&summary, "weighted_force.about").is_some_and(|[_, bar]| bar < 1e-7), "{model}");
    }
}

/// A rectangle of 2 by 1, held on the left and loaded on the right and above; every second one of random cells.
fn random_body(random: &mut Random, cells: bool) -> String {
    let mut number = |low: f64, high: f64| random.between(low, high);
    let young = match cells {
        true => {
            format!("cells = {{ size = 0.25, young = {{ uniform = [1, 20], seed = {} }} }}", number(0.0, 1e3) as u64)
        }
        false => "young = 10".to_owned(),
    };
    let poisson = number(0.0, 0.45);
    let [a, b, c, d, e, x, y] = std::array::from_fn(|k| if k < 5 { number(-1.0, 1.0) } else { number(0.1, 0.9) });
    format!(
        "body = {{ corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = [\"lower\", \"right\", \"upper\", \"left\"] }}\n\
         material = {{ poisson = {poisson}, {young} }}\nsides.left.displacement = [0, 0]\n\
         sides.right.traction = [{a}, \"{b} + {c}*y\"]\nsides.upper.traction = [{d}, \"{e}*sin(2*x)\"]\n\
         probe.points = [[{}, {y}], [{}, {}], [0, {x}]]\n",
        2.0 * x,
        2.0 * y,
        1.0 - x,
    )
}

/// Bar over error of the numbers of one summary against those of another, where that tells the error.
pub fn effectivities(own: &Summary, reference: &Summary, bar_of: impl Fn(&Quantity) -> f64) -> Vec<f64> {
    let mut found = Vec::new();
    for (path, quantity) in own.quantities.iter().filter(|(path, of)| *path != "energy" && of.doubts.is_empty()) {
        let Some(Quantity { value, uncertainty, .. }) = reference.quantities.get(path) else { continue };
        let error = (quantity.value - value).abs();
        if error > 5.0 * uncertainty && error > 1e-8 * value.abs() {
            found.push(bar_of(quantity) / error);
        }
    }
    found
}

/// The shares of `found` at least `below`, and at most `above`.
pub fn shares(found: &[f64], below: f64, above: f64) -> [f64; 2] {
    let share = |holds: &dyn Fn(f64) -> bool| found.iter().filter(|e| holds(**e)).count() as f64 / found.len() as f64;
    [share(&|e| e >= below), share(&|e| e <= above)]
}

/// Asserts that more than `count` bars are at least half, 0.3 and a tenth of their errors in 97 %, in 99.5 % and in all, and at most 4 and 10
/// times as large in these parts of all.
pub fn assert_near_errors(found: &[f64], count: usize, [of_narrow, of_ten]: [f64; 2]) {
    let least = found.iter().fold(f64::INFINITY, |m: f64, e| m.min(*e));
    let ([half, narrow], [third, ten]) = (shares(found, 0.5, 4.0), shares(found, 0.3, 10.0));
    println!("{} numbers: half {half}, third {third}, least {least}, at most 4 {narrow}, 10 {ten}", found.len());
    assert!(found.len() > count && half >= 0.97 && third >= 0.995 && least >= 0.1, "{half} {third} {least}");
    assert!(narrow >= of_narrow && ten >= of_ten, "{narrow} {ten}");
}

#[test]
fn bars_of_fine_grids_hold_against_boundary_elements() {
    let (mut random, mut found) = (Random::new(11), Vec::new());
    for _ in 0..12 {
        let text = random_body(&mut random, false);
        let exact = summary(&parse(&text, &["method.tolerance=1e-5"]).expect("a scene"));
        for n in [6, 12, 24] {
            let grid = format!("grid = {{ coarse = [{}, {n}], fine = [1, 1] }}\nmethod.model = \"fem\"\n", 2 * n);
            found.extend(effectivities(&solved(&format!("{text}{grid}")), &exact, |quantity| quantity.uncertainty));
        }
    }
    assert_near_errors(&found, 500, [0.75, 0.9]);
}

/// A rectangle of 2 by 1, pushed onto a parabola from above, without friction or by either law.
fn random_contact(random: &mut Random, scene: usize) -> String {
    let number: [f64; 10] = std::array::from_fn(|_| random.between(0.0, 1.0));
    let [gap, at, push, shift, poisson, load, a, b, c, d] = number;
    let friction = ["", ", friction = { tresca = 0.2 }", ", friction = { coulomb = 0.25 }"][scene % 3];
    format!(
        "body = {{ corners = [[0, 0], [2, 0], [2, 1], [0, 1]], sides = [\"lower\", \"right\", \"upper\", \"left\"] }}\n\
         material = {{ poisson = {}, young = 10 }}\nsides.upper.displacement = [{}, {}]\n\
         sides.lower.contact = {{ gap = \"{}*(x - {})^2\"{friction} }}\nsides.right.traction = [{}, 0]\n\
         probe.points = [[{}, {}], [{}, 1], [2, {}], [{}, 0]]\n\
         [quantities]\nturn = {{ moment = \"lower\", about = [1, 0] }}\nmean = {{ mean_displacement = \"right\" }}\n",
        0.4 * poisson,
        0.02 * (shift - 0.5),
        -0.03 - 0.03 * push,
        0.1 + 0.2 * gap,
        0.7 + 0.6 * at,
        load - 0.5,
        2.0 * a,
        0.2 + 0.7 * b,
        2.0 * c,
        0.2 + 0.7 * d,
        0.9 + 0.2 * c,
    )
}

/// Ends of contact lie between nodes, and the pressure is lumped there.
#[test]
fn bars_with_contact_hold_against_boundary_elements() {
    let (mut random, mut found) = (Random::new(13), Vec::new());
    for scene in 0..9 {
        let text = random_contact(&mut random, scene);
        let exact = summary(&parse(&text, &["method.tolerance=1e-4"]).expect("a scene"));
        let grids = [(8, 1, "fem"), (16, 1, "fem"), (8, 4, "msfem")];
        for (n, fine, model) in grids {
            let cells = format!("coarse = [{}, {n}]\nfine = [{fine}, {fine}]\n", 2 * n);
            let own = solved(&format!("{text}[grid]\n{cells}[method]\nmodel = \"{model}\"\n"));
            for path in ["energy", "contact.force.y", "reactions.lower.x", "moment.turn", "probe.3.displacement.y"] {
                assert!(own.quantities.contains_key(path), "{path}\n{text}");
            }
            let works = ["strain_energy", "load_work", "friction_work"].map(|path| own.quantities.contains_key(path));
            // the work against Coulomb's friction is not linear
            let friction = ["none", "tresca", "coulomb"][scene % 3];
            let slips = own.friction_work > 0.0;
            assert_eq!(
                works,
                [true, friction == "none" || friction == "tresca" && slips, friction == "tresca" && slips],
                "{text}"
            );
            let own = effectivities(&own, &exact, |quantity| quantity.uncertainty);
            if own.iter().any(|e| *e < 0.5) {
                println!("{own:?} on {n} cells of {fine}\n{text}");
            }
            found.extend(own);
        }
    }
    assert_near_errors(&found, 500, [0.4, 0.7]);
}

#[test]
fn the_multiscale_part_is_that_of_the_fine_grid() {
    let (mut random, mut found) = (Random::new(12), Vec::new());
    let cells = |basis: &str| format!("grid = {{ coarse = [8, 4], fine = [8, 8], basis = \"{basis}\" }}\n");
    for scene in 0..12 {
        let text = random_body(&mut random, scene % 2 == 0);
        let whole = solved(&format!("{text}{}method.model = \"fem\"\n", cells("coupled")));
        let basis = ["coupled", "oscillatory", "linear", "q1", "oversampled"][scene % 5];
        let own = solved(&format!("{text}{}method.model = \"msfem\"\n", cells(basis)));
        let mut exact = whole.clone();
        // the fine grid is what the part is told against
        exact.quantities.values_mut().for_each(|quantity| quantity.uncertainty = 0.0);
        let own_found = effectivities(&own, &exact, |quantity| quantity.parts["multiscale"]);
        if own_found.iter().any(|e| *e < 0.5) {
            println!("{own_found:?} with {basis}\n{text}");
        }
        found.extend(own_found);
        for (path, quantity) in own.quantities.iter().filter(|(path, _)| *path != "energy") {
            let sum: f64 = quantity.parts.values().sum();
            assert!(quantity.uncertainty >= (1.0 - 1e-12) * sum, "{path}: {quantity:?}");
            assert!(whole.quantities[path].parts["multiscale"] == 0.0, "{path}: {:?}", whole.quantities[path]);
        }
    }
    let least = found.iter().fold(f64::INFINITY, |m: f64, e| m.min(*e));
    let ([half, narrow], [_, ten]) = (shares(&found, 0.5, 4.0), shares(&found, 0.3, 10.0));
    println!("{} numbers: half {half}, least {least}, at most 4 {narrow}, 10 {ten}", found.len());
    assert!(found.len() > 200 && half >= 0.97 && least >= 0.3, "{half} {least}");
    assert!(narrow >= 0.7 && ten >= 0.85, "{narrow} {ten}");
}

/// A cubic about the middle of a side of a cell: the bubble of the side has nothing of it.
#[test]
fn points_of_a_support_know_what_it_gives() {
    let text = format!(
        "{SQUARE}material = {{ young = 1000, poisson = 0.3 }}\nsides.lower.displacement = [\"free\", 0]\n\
         sides.right.displacement = [\"(y - 0.59375)^3\", \"free\"]\nprobe.points = [[1, 0.58], [1, 0.61]]\n"
    );
    for model in ["coarse = [16, 16], fine = [1, 1] }\nmethod.model = \"fem\"", "coarse = [4, 4], fine = [4, 4] }"] {
        let summary = solved(&format!("{text}grid = {{ {model}\n"));
        for (k, y) in [0.58_f64, 0.61].into_iter().enumerate() {
            let path = format!("probe.{k}.displacement.x");
            let [value, uncertainty] = bar(&summary, &path).unwrap_or_else(|| panic!("{path}"));
            let error = (value - (y - 0.59375).powi(3)).abs();
            assert!(error <= uncertainty && uncertainty < 3.0 * error, "{path}: {error:e} and {uncertainty:e}");
        }
    }
}

/// The force of the support is the integral of a body force that jumps, or has a kink between the points of all rules.
#[test]
fn body_forces_that_jump_are_known_as_well_as_their_bars_say() {
    let cases = [
        ("if(x < 0.51, 1, 0)", 0.51),
        ("if(x + y < 1.03, 1, 0)", 1.0 - 0.97 * 0.97 / 2.0),
        ("if((x - 0.4)^2 + (y - 0.5)^2 < 0.09, 1, 0)", 0.09 * std::f64::consts::PI),
        ("sign(x - 0.5001)", -2e-4),
        ("abs(x - 0.53)", (0.53 * 0.53 + 0.47 * 0.47) / 2.0),
        ("1000*max(0, x - 0.999)", 5e-4),
    ];
    for (force, exact) in cases {
        let text = format!(
            "{SQUARE}material = {{ young = 10, poisson = 0.3 }}\nsides.lower.displacement = [0, 0]\n\
             body_force.value = [0, \"{force}\"]\ngrid = {{ coarse = [8, 8], fine = [1, 1] }}\nmethod.model = \"fem\"\n"
        );
        let [value, uncertainty] = bar(&solved(&text), "reactions.lower.y").unwrap_or_else(|| panic!("{force}"));
        let error = (value + exact).abs();
        println!("{force}: off by {error:.1e}, {uncertainty:.1e}");
        assert!(error <= uncertainty && uncertainty < 2e-4, "{force}: {error:e} and {uncertainty:e}");
    }
}

/// Within a cell of a re-entrant corner, and within half a cell of a point where moduli cross, the cells have little of the field.
#[test]
fn points_beside_singular_points_are_in_doubt() {
    let corner = "body = { corners = [[0, 0], [1, 0], [1, 0.5], [0.5, 0.5], [0.5, 1], [0, 1]],\n\
                  sides = [\"lower\", \"right\", \"notch\", \"notch\", \"upper\", \"left\"] }\n\
                  material = { young = 10, poisson = 0.3 }\n";
    let crossed = format!(
        "{SQUARE}material.poisson = 0.3\nmaterial.cells = {{ size = 0.5, young = \"if((x - 0.5)*(y - 0.5) > 0, 10, 1)\" }}\n"
    );
    for (text, near) in [(corner, 0.06), (&crossed, 0.03)] {
        let text = format!(
            "{text}sides.lower.displacement = [0, 0]\nsides.upper.traction = [1, 0]\nmethod.model = \"fem\"\n\
             grid = {{ coarse = [16, 16], fine = [1, 1] }}\nprobe.points = [[{}, 0.49], [0.3, 0.3]]\n",
            0.5 - near / 2.0
        );
        let summary = solved(&text);
        let doubts = |path: &str| summary.quantities[path].doubts.join(" ");
        for name in ["displacement.x", "stress.xy", "von_mises"] {
            assert_eq!(doubts(&format!("probe.0.{name}")), "coarse", "{name}: {text}");
            assert_eq!(doubts(&format!("probe.1.{name}")), "", "{name}: {text}");
        }
    }
}

/// J of the known field, whose support varies: ½ a(u, u) - f·u with f·u = a(u, u) - ∫ σn·u over x = 1.
#[test]
fn energies_are_inside_their_bars_on_every_grid() {
    use std::f64::consts::PI;
    let text = format!(
        "{SQUARE}material = {{ young = 2.5, poisson = 0.25 }}\n\
         sides.left.displacement = [0, 0]\nsides.lower.displacement = [0, 0]\nsides.upper.displacement = [0, 0]\n\
         sides.right.displacement = [\"y*sin(pi*y)\", 0]\n\
         body_force.value = [\"-x*(2*pi*cos(pi*y) - pi^2*y*sin(pi*y))\", \"-2*(sin(pi*y) + pi*y*cos(pi*y))\"]\n"
    );
    // μ = λ = 1: a(u, u) = ∫ 3 (y s)² + x² (s + π y c)², ∫ σn·u = ∫ 3 (y s)² over x = 1
    let squares = 1.0 / 6.0 - 1.0 / (4.0 * PI * PI);
    let bends = 0.5 + (1.0 / 6.0 + 1.0 / (4.0 * PI * PI)) * PI * PI - 0.5;
    let exact = 0.5 * (3.0 * squares + bends / 3.0) - (3.0 * squares + bends / 3.0) + 3.0 * squares;
    let grids =
        [8, 16, 32].map(|n| format!("grid = {{ coarse = [{n}, {n}], fine = [1, 1] }}\nmethod.model = \"fem\"\n"));
    let coarse = ["coupled", "oscillatory", "linear", "q1"].map(|basis| {
        format!("grid = {{ coarse = [8, 8], fine = [8, 8], basis = \"{basis}\" }}\nmethod.model = \"msfem\"\n")
    });
    for grid in grids.iter().chain(&coarse) {
        let summary = solved(&format!("{text}{grid}"));
        let Quantity { value, uncertainty, parts, .. } = &summary.quantities["energy"];
        let error = (value - exact).abs();
        println!("{value} ± {uncertainty:.1e}, off by {error:.1e}, {parts:?}, {grid}");
        assert!(error <= *uncertainty && *uncertainty < 8.0 * error, "{error:e} and {uncertainty:e}, {grid}");
        assert!((parts.values().sum::<f64>() - uncertainty).abs() < 1e-12 * value.abs(), "{parts:?}");
    }
}

#[test]
fn stresses_where_cells_of_other_moduli_meet_are_in_doubt() {
    let text = format!(
        "{SQUARE}material.poisson = 0.3\nmaterial.cells = {{ size = 0.5, young = \"if(x > 0.5, 2, 1)\" }}\n\
         sides.left.displacement = [0, 0]\nsides.right.traction = [1, 0]\nmethod.model = \"fem\"\n\
         probe.points = [[0.5, 0.3], [0.3, 0.5]]\ngrid = {{ coarse = [4, 4], fine = [2, 2] }}\n"
    );
    let summary = solved(&text);
    let doubts = |path: &str| summary.quantities[path].doubts.join(" ");
    assert_eq!(doubts("probe.0.stress.yy"), "coarse");
    assert_eq!(doubts("probe.0.displacement.x"), "");
    assert_eq!(doubts("probe.1.stress.yy"), "");
}

#[test]
fn a_field_that_the_grid_has_is_told_to_rounding() {
    let text = format!(
        "{SQUARE}material = {{ young = 3, poisson = 0.3 }}\nmethod.model = \"msfem\"\n\
         sides.left.displacement = [0, \"free\"]\nsides.lower.displacement = [\"free\", 0]\nsides.right.traction = [1, 0]\n\
         probe.points = [[0.37, 0.81], [1, 1]]\ngrid = {{ coarse = [4, 4], fine = [4, 4] }}\n"
    );
    let summary = solved(&text);
    for (path, exact) in
        [("probe.0.stress.xx", 1.0), ("probe.1.displacement.x", 0.91 / 3.0), ("reactions.left.x", -1.0)]
    {
        let [value, uncertainty] = bar(&summary, path).unwrap_or_else(|| panic!("{path}"));
        assert!((value - exact).abs() <= uncertainty && uncertainty < 1e-8, "{path}: {value} ± {uncertainty:e}");
    }
}
