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

/// The points of infinite stress.
fn infinite(scene: &str) -> Vec<[f64; 2]> {
    let scene = parse(scene, &["method.tolerance=1e-2"]).unwrap_or_else(|e| panic!("{}", e.render()));
    summary(&scene).infinite_stress
}

fn has(found: &[[f64; 2]], x: [f64; 2]) -> bool {
    found.iter().any(|p| (p[0] - x[0]).abs() + (p[1] - x[1]).abs() < 1e-12)
}

/// Two blocks of one width are tied: where the joint meets the free sides stresses are infinite if α(α - 2β) > 0, by Dundurs'
/// parameters of plane strain (Bogy, J. Appl. Mech. 38, 1971), and finite if it is negative; of one material there is no joint.
#[test]
fn ends_of_a_joint_of_two_materials_follow_bogy() {
    let dundurs = |[e1, n1]: [f64; 2], [e2, n2]: [f64; 2]| {
        let (m1, m2, k1, k2) = (e1 / (2.0 + 2.0 * n1), e2 / (2.0 + 2.0 * n2), 3.0 - 4.0 * n1, 3.0 - 4.0 * n2);
        let below = m1 * (k2 + 1.0) + m2 * (k1 + 1.0);
        let alpha = (m1 * (k2 + 1.0) - m2 * (k1 + 1.0)) / below;
        alpha * (alpha - 2.0 * (m1 * (k2 - 1.0) - m2 * (k1 - 1.0)) / below)
    };
    let of = |material: [f64; 2]| format!("{{ young = {}, poisson = {} }}", material[0], material[1]);
    let mut both = [0, 0];
    for pair in [
        [[1000.0, 0.1], [10.0, 0.45]],
        [[1000.0, 0.3], [500.0, 0.3]],
        [[1000.0, 0.45], [900.0, 0.1]],
        [[1000.0, 0.1], [1100.0, 0.42]],
        [[100.0, 0.0], [130.0, 0.45]],
        [[2.0, 0.45], [3.0, 0.2]],
    ] {
        let sign = dundurs(pair[0], pair[1]);
        both[usize::from(sign > 0.0)] += 1;
        for [upper, lower] in [pair, [pair[1], pair[0]]] {
            let scene = blocks([-0.5, 0.5], [-0.5, 0.5], [1.0, 1.0], "true")
                .replacen("{ young = 1, poisson = 0.3 }", &of(upper), 1)
                .replacen("{ young = 1, poisson = 0.3 }", &of(lower), 1)
                .replace("contact = true", "tied = true");
            let found = infinite(&scene);
            let told = [-0.5, 0.5].map(|x| has(&found, [x, 0.0]));
            assert_eq!(told, [sign > 0.0; 2], "{upper:?} on {lower:?}: α(α - 2β) = {sign}, {found:?}");
        }
    }
    assert!(both[0] > 0 && both[1] > 0, "both signs are there: {both:?}");
    let alike = blocks([-0.5, 0.5], [-0.5, 0.5], [700.0, 700.0], "true").replace("contact = true", "tied = true");
    assert!(!has(&infinite(&alike), [0.5, 0.0]));
}

/// A narrow block that is tied to a wide one of its material makes corners of 270 degrees, a square inclusion four of 90.
#[test]
fn bodies_that_are_tied_are_one_at_their_corners() {
    for swapped in [false, true] {
        let [a, b] = if swapped { [[-1.0, 1.0], [-0.5, 0.5]] } else { [[-0.5, 0.5], [-1.0, 1.0]] };
        let found = infinite(&blocks(a, b, [300.0, 300.0], "true").replace("contact = true", "tied = true"));
        assert!([-0.5, 0.5].iter().all(|&x| has(&found, [x, 0.0])), "{found:?}");
        assert!([-1.0, 1.0].iter().all(|&x| !has(&found, [x, 0.0])), "{found:?}");
    }
    let square = "[[-1, -1], [1, -1], [1, 1], [-1, 1]]";
    let [edge, rim] = ["edge", "rim"].map(|name| format!("{:?}", [name; 4]));
    let inclusion = |outside: &str, young: f64, load: &str| {
        format!(
            "[[body]]\nname = \"inner\"\ncorners = {square}\nsides = {edge}\nmaterial = {{ young = {young}, poisson = 0.3 }}\n\
             [[body]]\nname = \"outer\"\n{outside}\nmaterial = {{ young = 10, poisson = 0.3 }}\n\
             [[body.holes]]\ncorners = {square}\nsides = {rim}\n{load}\n\
             [[interface]]\nbetween = [\"inner.edge\", \"outer.rim\"]\ntied = true\n"
        )
    };
    let plate = "corners = [[-4, -4], [4, -4], [4, 4], [-4, 4]]\nsides = [\"b\", \"r\", \"t\", \"l\"]";
    let pulled = "[sides.outer.l]\ntraction = [\"-1\", \"0\"]\n[sides.outer.r]\ntraction = [\"1\", \"0\"]";
    for (outside, load) in [("medium = { remote_stress = [1, 0, 0] }", ""), (plate, pulled)] {
        let corners = |found: &[[f64; 2]]| [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|x| has(found, x));
        let stiff = infinite(&inclusion(outside, 1000.0, load));
        assert_eq!((corners(&stiff), stiff.len()), ([true; 4], 4), "{stiff:?}");
        let alike = infinite(&inclusion(outside, 10.0, load));
        assert_eq!(alike.len(), 0, "{alike:?}");
    }
}

/// On a straight side a jump of the shear, a kink of the displacement and the end of a spring along it are logarithms; a jump of
/// the pressure, or of the slope of a traction, is none.
#[test]
fn data_that_jump_along_a_straight_side_are_infinite_by_their_kind() {
    let body = "[body]\ncorners = [[0, 0], [4, 0], [4, 2], [2, 2], [0, 2]]\nsides = [\"b\", \"r\", \"t1\", \"t2\", \"l\"]\n\
                [material]\nyoung = 100\npoisson = 0.3\n[sides.b]\ndisplacement = [\"0\", \"0\"]\n";
    for (sides, at, is_infinite) in [
        ("[sides.t1]\ntraction = [\"1\", \"0\"]", 2.0, true),
        ("[sides.t1]\ntraction = [\"0\", \"1\"]", 2.0, false),
        ("[sides.t1]\npressure = \"1\"", 2.0, false),
        ("[sides.t1]\ntraction = [\"1\", \"0\"]\n[sides.t2]\ntraction = [\"1\", \"3\"]", 2.0, false),
        ("[sides.t1]\ntraction = [\"x-2\", \"0\"]", 2.0, false),
        ("[sides.t1]\ntraction = [\"if(x < 3, 1, 0)\", \"0\"]\n[sides.t2]\ntraction = [\"1\", \"0\"]", 3.0, true),
        ("[sides.t1]\ntraction = [\"0\", \"if(x < 3, 1, 0)\"]", 3.0, false),
        ("[sides.t1]\nsprings = { normal = \"10\", tangential = \"5\" }\n[sides.t2]\npressure = \"1\"", 2.0, true),
        ("[sides.t1]\nsprings = { normal = \"10\", tangential = \"0\" }\npressure = \"1\"", 2.0, false),
        ("[sides.t1]\ndisplacement = [\"0\", \"0.01*(x-2)\"]\n[sides.t2]\ndisplacement = [\"0\", \"0\"]", 2.0, true),
        ("[sides.t1]\ndisplacement = [\"0\", \"0.01*(x-2)^2\"]\n[sides.t2]\ndisplacement = [\"0\", \"0\"]", 2.0, false),
        ("[sides.t1]\ndisplacement = [\"0\", \"0.01*abs(x-3)\"]\n[sides.t2]\ntraction = [\"0\", \"0\"]", 3.0, true),
    ] {
        let found = infinite(&format!("{body}{sides}\n"));
        assert_eq!(has(&found, [at, 2.0]), is_infinite, "{sides}: {found:?}");
    }
}

/// A quarter of a plate whose hole is a polygon: its ends at planes of symmetry, a little beyond a right angle, are those of a circle;
/// where both sides are held they are singular.
#[test]
fn ends_of_a_polygon_that_stands_for_a_curve_are_judged_by_the_curve() {
    let hole = (0..=16).rev().map(|k| std::f64::consts::FRAC_PI_2 * f64::from(k) / 16.0);
    let corners: Vec<[f64; 2]> = hole.map(|t| [t.cos(), t.sin()]).collect();
    // as they stand in tables: exactly on the axes
    let corners = [vec![[0.0, 1.0]], corners[1..16].to_vec(), vec![[1.0, 0.0]]].concat();
    let sides = [vec!["hole"; 16], vec!["bottom", "right", "top", "left"]].concat();
    let corners = [corners, vec![[3.0, 0.0], [3.0, 3.0], [0.0, 3.0]]].concat();
    let of = |bottom: &str, left: &str| {
        let scene = format!(
            "[body]\ncorners = {corners:?}\nsides = {sides:?}\n[material]\nyoung = 1000\npoisson = 0.3\n\
             [sides]\nbottom = {{ displacement = {bottom} }}\nleft = {{ displacement = {left} }}\nright = {{ traction = [\"10\", \"0\"] }}\n"
        );
        infinite(&scene)
    };
    assert_eq!(of("[\"free\", \"0\"]", "[\"0\", \"free\"]"), Vec::<[f64; 2]>::new());
    let held = of("[\"0\", \"0\"]", "[\"0\", \"0\"]");
    assert!(
        [[1.0, 0.0], [0.0, 1.0], [3.0, 0.0], [0.0, 3.0]].iter().all(|&x| has(&held, x)) && held.len() == 4,
        "{held:?}"
    );
}

/// At corners and in joints constant data need a logarithm that no body by itself shows: a square too large for its hole in its own
/// material (σ_xy grows by 2μδ/(1-ν) log(1/r)/2π), shear beside a roller or a floor, and jumps that bricks or a cut part.
#[test]
fn data_that_no_constant_stress_bears_are_infinite() {
    let square = "[body]\ncorners = [[-1, 0], [0, 0], [0, 1], [-1, 1]]\nsides = [\"b\", \"r\", \"t\", \"l\"]\n\
                  [material]\nyoung = 1000\npoisson = 0.3\n[sides.l]\ndisplacement = [\"0\", \"0\"]\n[sides.t]\ntraction = [\"0\", \"-3\"]\n";
    for (beside, shear, is_infinite) in [
        ("displacement = [\"free\", \"0\"]", "1", true),
        ("displacement = [\"free\", \"0\"]", "y", false),
        ("contact = { gap = \"0\" }", "-1", true),
        ("contact = { gap = \"0\" }", "-y", false),
        ("contact = { gap = \"0\", friction = { tresca = \"1\" } }", "-2", true),
    ] {
        let found = infinite(&format!("{square}[sides.b]\n{beside}\n[sides.r]\ntraction = [\"0\", \"{shear}\"]\n"));
        assert_eq!(has(&found, [0.0, 0.0]), is_infinite, "{beside}, {shear}: {found:?}");
    }
    let misfit = |x: &str, y: &str| {
        infinite(&format!(
            "[body]\ncorners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]\nsides = [\"s\", \"s\", \"s\", \"s\"]\n\
             [material]\nyoung = 1000\npoisson = 0.3\n[exterior]\nyoung = 1000\npoisson = 0.3\ndisplacement_jump = [\"{x}\", \"{y}\"]\n"
        ))
    };
    assert_eq!(misfit("-0.001*x", "-0.001*y").len(), 4);
    assert_eq!(misfit("0.001*y", "-0.001*x").len(), 0, "turned in its hole");
    let bricks = |side: &str, law: &str| {
        infinite(&format!(
            "[material]\nyoung = 1000\npoisson = 0.3\n\
             [[body]]\nname = \"a\"\ncorners = [[-1, 0], [0, 0], [0, 1], [-1, 1]]\nsides = [\"b\", \"r\", \"t\", \"l\"]\n\
             [[body]]\nname = \"q\"\ncorners = [[0, 0], [1, 0], [1, 1], [0, 1]]\nsides = [\"b\", \"r\", \"t\", \"l\"]\n\
             [sides.a.b]\ndisplacement = [\"0\", \"0\"]\n{side}\n\
             [[interface]]\nbetween = [\"a.r\", \"q.l\"]\ntied = {law}\n"
        ))
    };
    assert!(has(&bricks("[sides.a.t]\ntraction = [\"1\", \"0\"]", "true"), [0.0, 1.0]), "a jump of the shear");
    assert!(!has(&bricks("[sides.a.t]\ntraction = [\"0\", \"1\"]", "true"), [0.0, 1.0]), "a jump of the pressure");
    let steps = |jump: &str| bricks("", &format!("{{ traction_jump = {jump} }}"));
    assert!(has(&steps("[\"0\", \"if(y < 0.3, 1, 0)\"]"), [0.0, 0.3]), "a step of the traction in a joint");
    assert!(!has(&steps("[\"0\", \"y\"]"), [0.0, 0.3]));
    let kinks = |jump: &str| bricks("", &format!("{{ displacement_jump = [\"0\", \"{jump}\"] }}"));
    assert!(has(&kinks("0.01*y*abs(y-0.3)"), [0.0, 0.3]) && !has(&kinks("0.01*y*(y-0.3)^2"), [0.0, 0.3]));
}
