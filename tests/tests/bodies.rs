//! Several bodies, tied and in contact, against other codes, closed forms and themselves.

use std::fmt::Write as _;

use steklov_model::summary::Summary;
use steklov_problem::Scene;
use steklov_quadrature::unit_uniform;
use steklov_tests::{adapt, summary};

fn parse(text: &str, overrides: &[&str]) -> Scene {
    steklov_tests::parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

fn solved(text: &str, overrides: &[&str]) -> Summary {
    summary(&parse(text, overrides))
}

/// A block [x0, x1] × [y0, y1] with the sides bottom, right, top, left.
fn block(name: &str, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2], young: f64, poisson: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\ncorners = [[{x0:?}, {y0:?}], [{x1:?}, {y0:?}], [{x1:?}, {y1:?}], [{x0:?}, {y1:?}]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = {{ young = {young:?}, poisson = {poisson:?} }}\n"
    )
}

const ON: &str = "[[interface]]\nbetween = [\"upper.bottom\", \"lower.top\"]\n";
const FLOOR: &str = "[sides.lower.bottom]\ndisplacement = [\"0\", \"0\"]\n";

fn pair(widths: [f64; 2], upper: [f64; 2], lower: [f64; 2], top: &str, law: &str) -> String {
    let [a, b] = widths;
    block("upper", [-a, a], [0.0, 1.0], upper[0], upper[1])
        + &block("lower", [-b, b], [-1.0, 0.0], lower[0], lower[1])
        + FLOOR
        + &format!("[sides.upper.top]\n{top}\n{ON}{law}\n")
}

/// J of hp finite elements with matching nodes, extrapolated, or of one body on a rigid floor with half of the gap; each with what
/// it may be off.
#[test]
fn energies_are_those_of_other_codes() {
    let down = "displacement = [\"0\", \"-0.02\"]";
    let equal = |top: &str, law: &str| pair([0.5, 0.5], [1000.0, 0.3], [1000.0, 0.3], top, law);
    let cases = [
        (
            "hertz",
            pair([0.5, 1.0], [1000.0, 0.3], [300.0, 0.2], down, "contact = { gap = \"x^2\" }"),
            0.020_933_670_5,
            2e-9,
        ),
        ("mirrored Hertz", equal(down, "contact = { gap = \"x^2\" }"), 0.045_298_880_485_08, 1e-12),
        (
            "mirrored wedge",
            equal("displacement = [\"0\", \"0\"]", "contact = { gap = \"abs(x)/5 - 0.1\" }"),
            1.292_713_158_159_4,
            1e-9,
        ),
        (
            "dissimilar",
            pair(
                [0.5, 1.0],
                [1000.0, 0.3],
                [200.0, 0.2],
                "traction = [\"0\", \"-7\"]",
                "contact = { friction = { coulomb = \"0.2\" } }",
            ),
            -0.104_548_857,
            1e-8,
        ),
        (
            "cattaneo",
            equal(
                "displacement = [\"0.004\", \"-0.02\"]",
                "contact = { gap = \"x^2\", friction = { coulomb = \"0.3\" } }",
            ),
            0.045_856_756,
            3e-9,
        ),
    ];
    for (name, text, energy, tolerance) in cases {
        let told = solved(&text, &["method.tolerance=1e-5"]);
        let found = told.energy_extrapolated.unwrap();
        println!("{name}: {found:.12} {energy} {} dofs", told.dofs);
        assert!(told.converged && (found - energy).abs() < tolerance, "{name}: {found} {energy}");
        let bar = told.energy_uncertainty.unwrap();
        assert!((found - energy).abs() < bar + tolerance && bar < 1e-6 * energy.abs(), "{name}: {bar}");
    }
}

/// Uniform pressure goes through an interface whatever the degree, the widths of the elements and the side that carries.
#[test]
fn uniform_pressure_passes_every_patch() {
    for degree in 1..=8 {
        for (carrier, friction) in
            [("upper.bottom", ""), ("lower.top", ""), ("lower.top", ", friction = { coulomb = \"0.4\" }")]
        {
            // equal ν(1+ν)/E: nothing slips
            let lower = if friction.is_empty() { 200.0 } else { 615.384_615_384_615_4 };
            let mut text = block("upper", [0.0, 1.0], [0.0, 1.0], 1000.0, 0.3)
                + &block("lower", [0.0, 1.0], [-1.7, 0.0], lower, 0.2)
                + "[sides.upper]\ntop = { traction = [\"0\", \"-7\"] }\nleft = { displacement = [\"0\", \"free\"] }\n\
                   [sides.lower]\nbottom = { displacement = [\"free\", \"0\"] }\nleft = { displacement = [\"0\", \"free\"] }\n";
            write!(text, "{ON}multiplier = \"{carrier}\"\ncontact = {{ gap = \"0\"{friction} }}\n").unwrap();
            let told =
                solved(&text, &["method.refine=\"none\"", &format!("method.degree={degree}"), "method.elements=14"]);
            let contact = told.contact.unwrap();
            let energy = -0.5 * 49.0 * ((1.0 - 0.09) / 1000.0 + 1.7 * (1.0 - 0.04) / lower);
            assert!((contact.max_pressure / 7.0 - 1.0).abs() < 1e-11, "degree {degree}: {}", contact.max_pressure);
            assert!((told.energy / energy - 1.0).abs() < 1e-11, "degree {degree}: {} {energy}", told.energy);
            assert!((contact.length - 1.0).abs() < 1e-12 && (contact.force[1] - 7.0).abs() < 1e-10);
        }
    }
}

/// A block that is moved over the end of another one: J is continuous down to slivers, and that of the mirror image at the other
/// end.
#[test]
fn what_is_covered_is_followed_to_slivers() {
    let energy = |x0: f64| {
        let text = block("upper", [x0, x0 + 0.5], [0.0, 0.6], 1000.0, 0.3)
            + &block("lower", [0.0, 1.1], [-0.8, 0.0], 700.0, 0.2)
            + FLOOR
            + "[sides.upper.top]\ndisplacement = [\"0\", \"-0.01\"]\n"
            + ON
            + "contact = true\n";
        let told = solved(&text, &["method.tolerance=1e-4"]);
        assert!(told.converged, "{x0}");
        let contact = told.contact.unwrap();
        assert!((contact.length - (x0 + 0.5).min(0.5).min(1.1 - x0)).abs() < 1e-6, "{x0}: {}", contact.length);
        [told.energy_extrapolated.unwrap(), told.energy_uncertainty.unwrap()]
    };
    let [flush, bar] = energy(0.0);
    // dJ/dx there is 0.0254
    for x0 in [-1e-9, -1e-12, 1e-12, 1e-9, 1e-8, -1e-8] {
        let [other, _] = energy(x0);
        assert!((other - flush).abs() < 2.0 * bar + 0.03 * f64::abs(x0), "{x0}: {other} {flush}");
    }
    for x0 in [-0.45, -0.1, -1e-3, 0.1] {
        let ([here, bar], [there, _]) = (energy(x0), energy(0.6 - x0));
        assert!((here - there).abs() < 2.0 * bar, "{x0}: {here} {there}");
    }
}

/// Sides that are covered in part, under every law.
#[test]
fn parts_of_sides_obey_every_law() {
    for law in ["friction = { tresca = \"0.4\" }", "friction = { coulomb = \"0.3\" }", "gap = \"0.1*x^2\""] {
        let text = block("upper", [-0.9, 0.4], [0.0, 0.7], 300.0, 0.3)
            + &block("lower", [-0.5, 0.7], [-0.8, 0.0], 700.0, 0.2)
            + FLOOR
            + "[sides.upper.top]\ndisplacement = [\"0.001\", \"-0.01\"]\n"
            + ON
            + &format!("contact = {{ {law} }}\n");
        let [coarse, fine] = ["1e-3", "1e-5"].map(|t| solved(&text, &[&format!("method.tolerance={t}")]));
        let [(a, da), (b, db)] =
            [&coarse, &fine].map(|s| (s.energy_extrapolated.unwrap(), s.energy_uncertainty.unwrap()));
        println!("{law}: {a:.10} {b:.10} ± {da:.1e}");
        assert!((a - b).abs() < da + db && da < 1e-4 * b.abs(), "{law}: {a} {b} {da}");
        let (force, held) = (fine.interfaces[0].force, fine.reactions["lower.bottom"]);
        assert!((0..2).all(|i| (force[i] - held[i]).abs() < 1e-8), "{force:?} {held:?}");
    }
}

/// A punch that is stiffer and stiffer tends to a rigid one, J linearly in the ratio of the moduli, whichever side carries: on the few
/// elements of a stiff body multipliers do not hold a soft one unless what is left apart is seen.
#[test]
fn stiff_punches_are_pressed_as_rigid_ones() {
    let energy = |ratio: f64, carrier: &str, law: &str| {
        let text = block("upper", [0.2, 0.8], [0.0, 1.0], 300.0 * ratio, 0.3)
            + &block("lower", [0.0, 1.0], [-1.0, 0.0], 300.0, 0.3)
            + FLOOR
            + "[sides.upper.top]\ntraction = [\"0.1*x\", \"-1\"]\n"
            + ON
            + &format!("multiplier = \"{carrier}\"\n{law}\n");
        let told = solved(&text, &["method.tolerance=1e-3"]);
        [told.energy_extrapolated.unwrap(), told.energy_uncertainty.unwrap()]
    };
    for law in ["tied = true", "contact = { friction = { coulomb = \"0.5\" } }"] {
        let mut rigid: Vec<[f64; 2]> = Vec::new();
        for carrier in ["lower.top", "upper.bottom"] {
            let [(a, da), (b, db), (c, dc)] =
                [1e3, 1e4, 1e6].map(|ratio| energy(ratio, carrier, law)).map(|[e, d]| (e, d));
            // b = r + s/1e4 and a = r + s/1e3 tell r and s
            let slope = (a - b) / (1e-3 - 1e-4);
            let (limit, bar) = (b - 1e-4 * slope, db + 0.2 * (da + db));
            println!("{law}, {carrier} carries: {limit:.10e} ± {bar:.1e}, {c:.10e} ± {dc:.1e}");
            // what is of second order in the ratio
            let second = 1e-6 * (a - b).abs();
            assert!((c - limit - 1e-6 * slope).abs() < bar + dc + second && dc < 1e-5 * c.abs(), "{law} {carrier}");
            rigid.push([c, dc]);
        }
        assert!((rigid[0][0] - rigid[1][0]).abs() < rigid[0][1] + rigid[1][1], "{law}: {rigid:?}");
    }
}

/// A body that is cut in two and tied is the body, under random loads, whichever side carries.
#[test]
fn a_cut_that_is_tied_is_none() {
    let seed = 20_261_123;
    println!("seed {seed}");
    let mut drawn = 0;
    let mut next = |low: f64, high: f64| {
        drawn += 1;
        low + (high - low) * unit_uniform(seed, drawn)
    };
    for _ in 0..6 {
        let (below, above) = (next(0.3, 0.7), next(0.3, 0.7));
        let (tx, ty) = (next(-1.0, 1.0), next(-3.0, 3.0));
        let load = format!("traction = [\"{tx:?}*(1 + x)\", \"{ty:?} - y\"]\n");
        let rest = "material = { young = 3.0, poisson = 0.3 }\n";
        let whole = format!(
            "[body]\ncorners = [[0, 0], [1.2, 0], [1.5, 1], [0.1, 1.1]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\n\
             [material]\nyoung = 3.0\npoisson = 0.3\n[sides.left]\ndisplacement = [\"0\", \"0\"]\n[sides.right]\n{load}"
        );
        // from the bottom to the top
        let foot = [1.2 * below, 0.0];
        let head = [0.1 + 1.4 * above, 1.1 - 0.1 * above];
        let part = |name: &str, corners: String, sides: &str| {
            format!("[[body]]\nname = \"{name}\"\ncorners = {corners}\nsides = {sides}\n{rest}")
        };
        let [fx, fy] = foot;
        let [hx, hy] = head;
        let cut = |carrier: &str| {
            part(
                "a",
                format!("[[0, 0], [{fx:?}, {fy:?}], [{hx:?}, {hy:?}], [0.1, 1.1]]"),
                "[\"bottom\", \"cut\", \"top\", \"left\"]",
            ) + &part(
                "b",
                format!("[[{fx:?}, {fy:?}], [1.2, 0], [1.5, 1], [{hx:?}, {hy:?}]]"),
                "[\"bottom\", \"right\", \"top\", \"cut\"]",
            ) + &format!(
                "[sides.a.left]\ndisplacement = [\"0\", \"0\"]\n[sides.b.right]\n{load}\
                 [[interface]]\nbetween = [\"a.cut\", \"b.cut\"]\ntied = true\nmultiplier = \"{carrier}.cut\"\n"
            )
        };
        let one = solved(&whole, &["method.tolerance=1e-5"]);
        let [exact, bar] = [one.energy_extrapolated, one.energy_uncertainty].map(Option::unwrap);
        for carrier in ["a", "b"] {
            let told = solved(&cut(carrier), &["method.tolerance=1e-4"]);
            let [found, own] = [told.energy_extrapolated, told.energy_uncertainty].map(Option::unwrap);
            println!("{below:.3} {above:.3} {carrier}: {found:.10} {exact:.10} ± {own:.1e}");
            assert!((found - exact).abs() < own + bar && own < 1e-6 * exact.abs(), "{found} {exact} {own}");
            let force = told.interfaces[0].force;
            let reaction = told.reactions["a.left"];
            // the force on a, whichever side carries
            (0..2).for_each(|i| assert!((reaction[i] + force[i]).abs() < 1e-9 * (tx.abs() + ty.abs()), "{force:?}"));
        }
    }
}

/// A ring that is too large for the one around it: in contact, and tied with the interference as a jump.
#[test]
fn rings_press_each_other_as_lame_says() {
    let ring = |name: &str, outer: f64, inner: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\ncircle = {{ centre = [0, 0], radius = {outer:?} }}\nside = \"outside\"\n\
             material = {{ young = 1.0, poisson = 0.3, plane = \"stress\" }}\n[[body.holes]]\n\
             circle = {{ centre = [0, 0], radius = {inner:?} }}\nside = \"inside\"\n"
        )
    };
    let rings = ring("inner", 2.0, 1.0)
        + &ring("outer", 3.0, 2.0)
        + "[[interface]]\nbetween = [\"inner.outside\", \"outer.inside\"]\n";
    let pressure = 1.171_875e-3;
    let energy = 0.5 * pressure * 0.01 * 2.0 * std::f64::consts::TAU;
    let pressed = solved(&(rings.clone() + "contact = { gap = \"-0.01\" }\n"), &["method.tolerance=1e-8"]);
    let contact = pressed.contact.as_ref().unwrap();
    println!("{} {} dofs", contact.max_pressure / pressure - 1.0, pressed.dofs);
    assert!((contact.max_pressure / pressure - 1.0).abs() < 5e-8 && (pressed.energy / energy - 1.0).abs() < 1e-11);
    let jump = "tied = { displacement_jump = [\"-0.01*x/2\", \"-0.01*y/2\"] }\n";
    let tied = solved(&(rings + jump), &["method.tolerance=1e-6"]);
    assert!((tied.energy / energy - 1.0).abs() < 1e-9, "{} {energy}", tied.energy);
}

/// An eccentric ring in one that is pressed unevenly, in contact without friction: nothing resists the rotation of either about the centre
/// of the circle on which they meet, whose nodal values are no rotation between the nodes. Forces between the rings turn neither, on any mesh.
#[test]
fn rings_that_nothing_holds_are_in_equilibrium_on_every_mesh() {
    let text = "[[body]]\nname = \"a\"\ncircle = { centre = [0, 0], radius = 1 }\nside = \"o\"\n\
                material = { young = 12.06, poisson = 0.3 }\n[[body.holes]]\ncircle = { centre = [0.1, 0], radius = 0.8 }\n\
                side = \"i\"\n[[body]]\nname = \"b\"\ncircle = { centre = [0, 0], radius = 2 }\nside = \"out\"\n\
                material = { young = 13.28, poisson = 0.2 }\n[[body.holes]]\ncircle = { centre = [0, 0], radius = 1 }\n\
                side = \"w\"\n[sides.b.out]\npressure = \"0.1 + 0.04*x*y\"\n[sides.a.i]\npressure = 0.07\n\
                [[interface]]\nbetween = [\"b.w\", \"a.o\"]\ncontact = { gap = -0.0017 }\n";
    let at = |tolerance: &str| solved(text, &[&format!("method.tolerance={tolerance}")]);
    let fine = at("1e-5");
    for tolerance in ["5e-1", "1e-1", "1e-2", "1e-3"] {
        let told = at(tolerance);
        let (j, extrapolated) = (fine.energy, told.energy_extrapolated.unwrap());
        let (off, bar) = ((extrapolated - j).abs(), told.energy_uncertainty.unwrap());
        println!("{tolerance}: {} dofs, {:?}, J off by {off:e} ± {bar:e}", told.dofs, told.audit);
        assert!(told.audit.unwrap().equilibrium < 1e-12 && told.converged && off < bar);
    }
}

/// A ring tied into a plate, pulled and turned at its bore: the moment that the support of the plate bears is that of the loads, and
/// J = -½ their work. The ring follows rotations, of which the polynomials of the plate have none at its round hole.
#[test]
fn moments_go_through_round_ties() {
    let [x, y, r] = [0.35, -0.25, 0.25];
    let [pull, lift, couple] = [0.9, 0.4, 0.8 * r * r].map(|t| t * std::f64::consts::TAU * r);
    let area = std::f64::consts::PI * (0.64 - r * r);
    let held = "displacement = [0, 0]";
    for (support, weight) in
        [("springs = 1.0", 0.0), ("springs = 0.01", 0.0), ("springs = 0.01", 0.6), (held, 0.0), (held, 0.6)]
    {
        let moment = -(x * (lift - weight * area) - y * (pull + 0.2 * weight * area) + couple);
        let text = format!(
            "[[body]]\nname = \"p\"\ncorners = [[-2, -2], [2, -2], [2, 2], [-2, 2]]\n\
             sides = [\"bottom\", \"right\", \"top\", \"left\"]\n[[body.holes]]\n\
             circle = {{ centre = [{x}, {y}], radius = 0.8 }}\nside = \"hole\"\n[[body]]\nname = \"d\"\n\
             circle = {{ centre = [{x}, {y}], radius = 0.8 }}\nside = \"rim\"\nbody_force = [{}, {}]\n[[body.holes]]\n\
             circle = {{ centre = [{x}, {y}], radius = {r} }}\nside = \"bore\"\n\
             [material]\nyoung = 1000\npoisson = 0.3\n\
             [sides.d.bore]\ntraction = [\"0.9 - 0.8*(y + 0.25)\", \"0.4 + 0.8*(x - 0.35)\"]\n[sides.p.bottom]\n{support}\n\
             [[interface]]\nbetween = [\"d.rim\", \"p.hole\"]\ntied = true\n\
             [quantities]\nm = {{ moment = \"p.bottom\", about = [0, 0] }}\n",
            0.2 * weight,
            -weight
        );
        for (tolerance, most) in [("1e-1", 5e-3), ("1e-2", 1e-5), ("1e-3", 1e-7)] {
            let told = solved(&text, &[&format!("method.tolerance={tolerance}")]);
            let own = &told.quantities["moment.m"];
            let off = (own.value - moment).abs();
            println!("{support}, {weight}, {tolerance}: moment off by {off:e} ± {:e}", own.uncertainty);
            assert!(off < most && off < 4.0 * own.uncertainty + 1e-9);
            let [j, work] = ["energy", "load_work"].map(|path| told.quantities[path].value);
            // the work of a body force is that of tractions of the mesh
            assert!((j + work / 2.0).abs() < if weight == 0.0 { 1e-9 } else { 1e-4 } * work, "{j} {work}");
        }
    }
}

/// A traction jump on a tie is a load of the body, on whichever side it is counted.
#[test]
fn jumps_of_tractions_load_both_bodies() {
    let text = |jump: &str| {
        pair(
            [0.5, 0.5],
            [1000.0, 0.3],
            [1000.0, 0.3],
            "traction = [\"0\", \"-7\"]",
            &format!("tied = {{ traction_jump = {jump} }}"),
        )
    };
    let told = solved(&text("[\"0\", \"-3\"]"), &["method.tolerance=1e-4"]);
    let reaction = told.reactions["lower.bottom"];
    assert!((reaction[1] - 10.0).abs() < 1e-9 && reaction[0].abs() < 1e-9, "{reaction:?}");
    // of the body that is named first: 7 holds the upper one up, the lower one bears 7 and the jump
    let (jump, orders) =
        ("[\"0.1\", \"-3 + 2*x\"]", ["\"upper.bottom\", \"lower.top\"", "\"lower.top\", \"upper.bottom\""]);
    let between = |order: &str| {
        let text = text(jump);
        let (before, after) = text.split_once("between = [").expect("an interface");
        format!("{before}between = [{order}]{}", after.split_once(']').expect("two sides").1)
    };
    for (order, exact) in orders.into_iter().zip([[0.0, 7.0], [0.1, -10.0]]) {
        let told = solved(&between(order), &["method.tolerance=1e-4"]);
        let force = told.interfaces[0].force;
        let lower = told.reactions["lower.bottom"];
        println!("{order}: {force:?}, the bottom {lower:?}");
        assert!((0..2).all(|i| (force[i] - exact[i]).abs() < 1e-8), "{order}: {force:?}, {exact:?}");
    }
}

/// A gap that takes the distance of the bodies away leaves the rounding of both, which is none: dJ/dg = -F, F the force between
/// them, as beside it.
#[test]
fn a_gap_may_cancel_the_distance() {
    let text = |gap: &str| {
        let upper = block("upper", [0.0, 1.0], [0.0, 1.0], 100.0, 0.3).replace("[1.0, 0.0]", "[1.0, 0.02]");
        let lower = block("lower", [0.0, 1.0], [-1.0, 0.0], 100.0, 0.3);
        format!(
            "{upper}{lower}{FLOOR}[sides.upper.top]\ndisplacement = [\"0\", \"-0.01\"]\n\
             [[interface]]\nbetween = [\"lower.top\", \"upper.bottom\"]\ncontact = {{ gap = \"{gap}\" }}\n"
        )
    };
    let told = ["-0.02*x", "1e-7 - 0.02*x"].map(|gap| solved(&text(gap), &["method.tolerance=1e-3"]));
    assert!(told.iter().all(|told| told.converged));
    let [closed, apart] = told.each_ref().map(|told| told.energy_extrapolated.unwrap());
    let force = told[0].contact.as_ref().unwrap().force[1].abs();
    assert!(force > 0.5 && (closed - apart - 1e-7 * force).abs() < 1e-11, "{closed} {apart} {force}");
}

/// Motions that only friction could stop, and loads that drive them, are refused by name; balanced ones are none of the answer.
#[test]
fn what_nothing_holds_is_told() {
    let slides = |top: &str| pair([0.5, 1.0], [1000.0, 0.3], [300.0, 0.2], top, "contact = true");
    let error = adapt(&parse(&slides("traction = [\"1\", \"-7\"]"), &[])).err().unwrap().to_string();
    assert!(error.starts_with("nothing holds upper against a motion"), "{error}");
    let told = solved(&slides("traction = [\"0\", \"-7\"]"), &["method.tolerance=1e-3"]);
    assert!(told.converged && (told.reactions["lower.bottom"][1] - 7.0).abs() < 1e-9);
}

/// Blocks that are moved through each other deform by rounding alone, of either sign: only that they lie in each other is in doubt.
#[test]
fn rigid_motions_leave_no_doubt_about_normals() {
    let block = |name: &str, low: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\ncorners = [[0,{low}],[1,{low}],[1,{high}],[0,{high}]]\n\
             sides = [\"bottom\",\"right\",\"top\",\"left\"]\n",
            high = low + 1.0
        )
    };
    for elements in [8, 12, 16] {
        let text = format!(
            "material = {{ young = 1.0, poisson = 0.3 }}\nmethod = {{ refine = \"none\", elements = {elements} }}\n{}{}\
             [sides.lower.bottom]\ndisplacement = [\"0\",\"0.1\"]\n[sides.upper.top]\ndisplacement = [\"0\",\"-0.1\"]\n",
            block("lower", 0.0),
            block("upper", 1.1)
        );
        let told = summary(&parse(&text, &[]));
        assert!(told.strain_energy.abs() < 1e-15, "{}", told.strain_energy);
        assert!(!told.estimate_doubts.iter().any(|doubt| doubt == "normals"), "{:?}", told.estimate_doubts);
        assert!(told.estimate_doubts.iter().any(|doubt| doubt == "reach"), "{:?}", told.estimate_doubts);
    }
}
