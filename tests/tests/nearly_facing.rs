//! Bodies that nearly face each other: what sees what at which distance, what is tied, along which direction contact acts.

use steklov_model::summary::Summary;
use steklov_tests::summary;

fn solved(text: &str, overrides: &[&str]) -> Summary {
    summary(&steklov_tests::parse(text, overrides).unwrap_or_else(|e| panic!("{}", e.render())))
}

fn refused(text: &str) -> String {
    steklov_tests::parse(text, &[]).map(|_| ()).expect_err("the scene cannot be solved").render()
}

/// A quadrilateral with the sides bottom, right, top, left, from its lower left corner on.
fn block(name: &str, corners: [[f64; 2]; 4], young: f64) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\ncorners = {corners:?}\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\n\
         material = {{ young = {young:?}, poisson = 0.3 }}\n"
    )
}

const LOWER: [[f64; 2]; 4] = [[0.0, -1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 0.0]];
const HELD: &str = "[sides.lo.bottom]\ndisplacement = [\"0\", \"0\"]\n";

/// A block on another one, its bottom from one height to another, its top loaded or held.
fn on_block([left, right]: [f64; 2], top: &str, law: &str) -> String {
    block("up", [[0.0, left], [1.0, right], [1.0, 1.0], [0.0, 1.0]], 100.0)
        + &block("lo", LOWER, 100.0)
        + HELD
        + &format!("[sides.up.top]\n{top}\n[[interface]]\nbetween = [\"up.bottom\", \"lo.top\"]\n{law}\n")
}

fn energy(told: &Summary) -> [f64; 2] {
    [told.energy_extrapolated.unwrap(), told.energy_uncertainty.unwrap()]
}

/// A second block at a distance of 0.06 that is pushed through it: distance and push less the same are the same problem.
#[test]
fn a_block_at_any_distance_is_seen() {
    let at = |distance: f64| {
        let text = block("up", [[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]], 100.0)
            + &block("up2", [[0.6, distance], [1.0, distance], [1.0, 1.0 + distance], [0.6, 1.0 + distance]], 100.0)
            + &block("lo", LOWER, 100.0)
            + HELD
            + "[sides.up.top]\ndisplacement = [\"0\", \"-0.01\"]\n"
            + &format!("[sides.up2.top]\ndisplacement = [\"0\", \"{:?}\"]\n", -0.01 - distance)
            + "[[interface]]\nbetween = [\"lo.top\", [\"up.bottom\", \"up2.bottom\"]]\ncontact = true\n";
        solved(&text, &["method.tolerance=1e-4"])
    };
    let near = at(0.0);
    for distance in [0.03, 0.06, 0.5, 4.0] {
        let far = at(distance);
        let ([a, bar], [b, _]) = (energy(&near), energy(&far));
        assert!((a - b).abs() < 2.0 * bar && (b - 0.002_628_89).abs() < 1e-8, "{distance}: {a} {b} {bar}");
        let contact = far.contact.unwrap();
        assert!(
            (contact.length - 0.9).abs() < 1e-6 && (contact.force[1].abs() - 0.525_78).abs() < 2e-5,
            "{distance}: {contact:?}"
        );
    }
}

/// Blocks tied along sides that meet but for digits of a file: as if they met.
#[test]
fn ties_close_over_digits() {
    let loaded = "traction = [\"0\", \"-1\"]";
    for apart in [0.0, 1e-9, 1e-8, 1e-7, 1e-6] {
        for ends in [[0.0, apart], [apart, 0.0], [apart, apart], [-apart, 0.0]] {
            let told = solved(&on_block(ends, loaded, "tied = true"), &["method.tolerance=1e-4"]);
            let [j, bar] = energy(&told);
            assert!((j + 0.008_990_524).abs() < bar + 2e-8 && bar < 1e-9, "{ends:?}: {j} {bar}");
            assert!((told.interfaces[0].length - 1.0).abs() < 1e-6, "{ends:?}");
        }
    }
    let error = refused(&on_block([0.0, 1e-5], loaded, "tied = true"));
    assert!(error.contains("apart at (1, 0)") && error.contains("a tie covers all"), "{error}");
}

/// Blocks turned by 17 degrees, their corners with eight digits, against upright ones.
#[test]
fn turned_blocks_with_eight_digits_are_tied_wholly() {
    let text = block(
        "up",
        [
            [0.124_319_62, 0.038_008_32],
            [0.736_354_66, 0.225_126_21],
            [0.502_457_3, 0.990_170_02],
            [-0.109_577_75, 0.803_052_13],
        ],
        100.0,
    ) + &block(
        "lo",
        [[0.292_371_7, -0.956_304_76], [1.248_676_46, -0.663_933_05], [0.956_304_76, 0.292_371_7], [0.0, 0.0]],
        100.0,
    ) + HELD
        + "[sides.up.top]\ndisplacement = [\"0\", \"-0.01\"]\n[[interface]]\nbetween = [\"up.bottom\", \"lo.top\"]\ntied = true\n";
    let told = solved(&text, &["method.tolerance=1e-4"]);
    let [j, bar] = energy(&told);
    assert!((j - 0.002_153_19).abs() < bar + 2e-8, "{j} {bar}");
    assert!((told.interfaces[0].length - 0.64).abs() < 1e-7, "{}", told.interfaces[0].length);
}

/// A disc in a hole of nearly its radius, which it touches below, is tied all round; a polygon in a circle is not.
#[test]
fn a_disc_is_tied_into_its_hole() {
    let plate = "[[body]]\nname = \"out\"\ncorners = [[-3, -3], [3, -3], [3, 3], [-3, 3]]\n\
                 sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = { young = 10.0, poisson = 0.3 }\n";
    let rest = "[sides.out.top]\ntraction = [\"0\", \"1\"]\n[sides.out.bottom]\ndisplacement = [\"0\", \"0\"]\n\
                [[interface]]\nbetween = [\"in.rim\", \"out.hole\"]\ntied = true\n";
    let disc = "[[body]]\nname = \"in\"\ncircle = { centre = [0, 0], radius = 1.0 }\nside = \"rim\"\n\
                material = { young = 100.0, poisson = 0.3 }\n";
    for more in [0.0, 1e-9, 1e-8, 1e-7] {
        let hole = format!(
            "[[body.holes]]\ncircle = {{ centre = [0, {more:e}], radius = {:?} }}\nside = \"hole\"\n",
            1.0 + more
        );
        let told = solved(&[disc, plate, &hole, rest].concat(), &["method.tolerance=1e-3"]);
        let [j, bar] = energy(&told);
        assert!((j + 1.421_842).abs() < bar + 1e-6, "{more}: {j} {bar}");
        assert!((told.interfaces[0].length - std::f64::consts::TAU).abs() < 1e-6, "{more}");
    }
    let corners: Vec<[f64; 2]> =
        (0..12).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_6).map(|a| [a.cos(), a.sin()]).collect();
    let polygon = format!(
        "[[body]]\nname = \"in\"\ncorners = {corners:?}\nsides = {:?}\nmaterial = {{ young = 100.0, poisson = 0.3 }}\n",
        ["rim"; 12]
    );
    let hole = "[[body.holes]]\ncircle = { centre = [0, 0], radius = 1 }\nside = \"hole\"\n";
    let error = refused(&[&polygon, plate, hole, rest].concat());
    assert!(error.contains("3.407417371093") && error.contains("in.rim"), "{error}");
}

/// One of two sides that are to be tied does not meet.
#[test]
fn every_side_of_a_tie_meets() {
    for distance in [0.01, 1e-4] {
        let text = block("up", [[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [0.0, 1.0]], 100.0)
            + &block("up2", [[0.6, distance], [1.0, distance], [1.0, 1.0], [0.6, 1.0]], 100.0)
            + &block("lo", LOWER, 100.0)
            + HELD
            + "[[interface]]\nbetween = [\"lo.top\", [\"up.bottom\", \"up2.bottom\"]]\ntied = true\n";
        let error = refused(&text);
        assert!(error.contains("\"up2.bottom\"") && error.contains(&format!("{distance:e} apart")), "{error}");
    }
}

/// Right halves of two equal cylinders, mirror images: their contact lies in y = 0, and no force is along x, whichever carries. Twice
/// the half beside a frictionless plane is J = 0.01036995 (by a rigid block with half of the push).
#[test]
fn mirror_images_press_along_the_line_of_centres() {
    let cylinder = |name: &str, centre: f64| {
        let (corners, sides) = match centre > 0.0 {
            true => ("[[0, 0], [1.0, 1.0], [0, 1.0]]", "[\"rim\", \"flat\", \"axis\"]"),
            false => ("[[0, -1.0], [1.0, -1.0], [0, 0]]", "[\"flat\", \"rim\", \"axis\"]"),
        };
        format!(
            "[[body]]\nname = \"{name}\"\ncorners = {corners}\nsides = {sides}\n\
             arcs = {{ rim = {{ centre = [0, {centre:?}] }} }}\nmaterial = {{ young = 100.0, poisson = 0.3 }}\n\
             [sides.{name}.axis]\ndisplacement = [\"0\", \"free\"]\n"
        )
    };
    let text = cylinder("up", 1.0)
        + &cylinder("lo", -1.0)
        + "[sides.up.flat]\ndisplacement = [\"free\", \"-0.04\"]\n[sides.lo.flat]\ndisplacement = [\"free\", \"0\"]\n\
           [[interface]]\nbetween = [\"up.rim\", \"lo.rim\"]\ncontact = true\n";
    for carrier in ["up.rim", "lo.rim"] {
        let told = solved(&format!("{text}multiplier = \"{carrier}\"\n"), &["method.tolerance=1e-4"]);
        let [j, bar] = energy(&told);
        assert!((j - 0.010_369_95).abs() < bar + 2e-9, "{carrier}: {j} {bar}");
        let contact = told.contact.unwrap();
        assert!(contact.force[0].abs() < 1e-9 * contact.force[1].abs(), "{carrier}: {:?}", contact.force);
        assert!((contact.length - 0.1142).abs() < 1e-3, "{carrier}: {}", contact.length);
    }
}

/// A body that no interface names goes into another one: that is told where and how deep, and not where it stays outside.
#[test]
fn bodies_that_nothing_holds_apart_are_told() {
    let with = |tip: f64| {
        let wedge = format!(
            "[[body]]\nname = \"wedge\"\ncorners = [[1.5, {tip:?}], [2, 0.5], [1.2, 0.5]]\nsides = [\"a\", \"b\", \"c\"]\n\
             material = {{ young = 100.0, poisson = 0.3 }}\n"
        );
        let text = block("up", [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 100.0)
            + &block("lo", [[-1.0, -1.0], [3.0, -1.0], [3.0, 0.0], [-1.0, 0.0]], 100.0)
            + &wedge
            + HELD
            + "[sides.wedge.b]\ndisplacement = [\"0\", \"-0.01\"]\n[sides.up.top]\ndisplacement = [\"0\", \"-0.01\"]\n\
               [[interface]]\nbetween = [\"up.bottom\", \"lo.top\"]\ncontact = true\n";
        solved(&text, &[])
    };
    // the surface gives way by 7e-4 there, and turns by less than a tenth
    let told = with(0.008);
    let [place] = told.reach.as_slice() else { panic!("{:?}", told.reach) };
    assert!(told.estimate_doubts.contains(&"reach".to_owned()) && place.bodies == ["lo", "wedge"].map(str::to_owned));
    assert!((place.depth - 0.0018).abs() < 1e-4 && (place.point[0] - 1.5).abs() < 2e-3, "{place:?}");
    for tip in [0.009_3, 0.02] {
        let told = with(tip);
        assert_eq!(told.reach.len(), usize::from(tip < 0.009_35), "{tip}: {:?}", told.reach);
    }
}

/// A cylinder that is pressed far into a soft block: what it presses is not cut off by a distance, and the answer says how much the choice
/// of the normal decides. With the normals of the flat side, as one body on a rigid parabola-like gap, the length is 0.5027.
#[test]
fn steep_contact_is_told() {
    let text =
        "[[body]]\nname = \"up\"\ncorners = [[0, 0], [1.0, 1.0], [0, 1.0]]\nsides = [\"rim\", \"flat\", \"axis\"]\n\
                arcs = { rim = { centre = [0, 1.0] } }\nmaterial = { young = 10000.0, poisson = 0.3 }\n"
            .to_owned()
            + &block("lo", [[0.0, -2.0], [3.0, -2.0], [3.0, 0.0], [0.0, 0.0]], 10.0)
            + "[sides.up.axis]\ndisplacement = [\"0\", \"free\"]\n[sides.lo.left]\ndisplacement = [\"0\", \"free\"]\n\
           [sides.up.flat]\ndisplacement = [\"free\", \"-0.3\"]\n[sides.lo.bottom]\ndisplacement = [\"0\", \"0\"]\n\
           [[interface]]\nbetween = [\"up.rim\", \"lo.top\"]\ncontact = true\n";
    let mut told = Vec::new();
    for carrier in ["up.rim", "lo.top"] {
        let of = solved(&format!("{text}multiplier = \"{carrier}\"\n"), &["method.tolerance=1e-4"]);
        let contact = of.contact.clone().unwrap();
        assert!(contact.max_pressure < 4.0 && (contact.length - 0.5027).abs() < 0.03, "{carrier}: {contact:?}");
        assert!(of.estimate_doubts.contains(&"normals".to_owned()) && of.reach.is_empty(), "{carrier}: {:?}", of.reach);
        told.push(energy(&of));
    }
    assert!((told[0][0] - told[1][0]).abs() < told[0][1] + told[1][1], "{told:?}");
}

/// A wedge that its gap closes: with the gap of either side J is the same, and the answer says that it hangs on the normals.
#[test]
fn a_wedge_closed_by_its_gap_does_not_know_its_carrier() {
    for (height, truth) in [(0.12, 0.002_395_41), (0.02, 0.002_819_92)] {
        let law = format!("contact = {{ gap = \"{:?}*x\" }}", -height);
        let text = on_block([0.0, height], "displacement = [\"0\", \"-0.01\"]", &law);
        let exchanged = text.replace("[\"up.bottom\", \"lo.top\"]", "[\"lo.top\", \"up.bottom\"]");
        assert_ne!(text, exchanged);
        let told = [text, exchanged].map(|text| solved(&text, &["method.tolerance=1e-4"]));
        for of in &told {
            let normals = of.interfaces[0].normals.unwrap();
            assert!((normals.angle - height.atan()).abs() < 1e-6, "{normals:?}");
            // of contact along the normals of the upper block
            assert!(
                (energy(of)[0] - truth).abs() < 1.5 * normals.energy_change,
                "{:?} {truth} {normals:?}",
                energy(of)
            );
            assert!(of.estimate_doubts.contains(&"normals".to_owned()), "{height}");
        }
    }
}

/// A pin in a hole that is a little larger, under an oblique force.
fn pin(clearance: f64, force: [&str; 2], of_pin: &str, law: &str) -> String {
    format!(
        "[[body]]\nname = \"pin\"\ncircle = {{ centre = [0, 0], radius = 1.0 }}\nside = \"rim\"\n\
         material = {{ young = 1000.0, poisson = 0.3 }}\nbody_force = [\"{}\", \"{}\"]\n{of_pin}\
         [[body]]\nname = \"ring\"\ncorners = [[-3, -3], [3, -3], [3, 3], [-3, 3]]\n\
         sides = [\"bottom\", \"right\", \"top\", \"left\"]\nmaterial = {{ young = 500.0, poisson = 0.3 }}\n\
         [[body.holes]]\ncircle = {{ centre = [0, {clearance:?}], radius = {:?} }}\nside = \"hole\"\n\
         [sides.ring.bottom]\ndisplacement = [\"0\", \"0\"]\n\
         [[interface]]\nbetween = [\"pin.rim\", \"ring.hole\"]\n{law}\n",
        force[0],
        force[1],
        1.0 + clearance,
    )
}

/// Without friction a circle may turn: contact along the normals of pin and hole does not hold it, nor does it turn it. Whichever
/// side carries the multipliers, and with so little friction that it changes nothing, J is the same.
#[test]
fn a_pin_turns_in_its_hole() {
    let weight = std::f64::consts::PI;
    let of = |clearance: f64, force: [&str; 2], law: &str| solved(&pin(clearance, force, "", law), &[]);
    for clearance in [1e-5, 1e-3] {
        let carried = ["pin.rim", "ring.hole"].map(|carrier| {
            let law = format!("contact = true\nmultiplier = \"{carrier}\"");
            let told = of(clearance, ["0.1", "-1"], &law);
            let force = told.contact.as_ref().unwrap().force;
            assert!((force[0] + 0.1 * weight).abs() < 1e-6 && (force[1] - weight).abs() < 1e-6, "{force:?}");
            assert_eq!(told.reason, "tolerance");
            told
        });
        let [a, b] = carried.each_ref().map(energy);
        assert!((a[0] - b[0]).abs() < a[1] + b[1] && a[1] < 1e-5 * a[0].abs(), "{clearance}: {a:?} {b:?}");
        let mirrored = energy(&of(clearance, ["-0.1", "-1"], "contact = true"));
        assert!((a[0] - mirrored[0]).abs() < a[1] + mirrored[1], "{clearance}: {a:?} {mirrored:?}");
    }
    let rubbing = "contact = { friction = { coulomb = \"1e-4\" } }\nmultiplier = \"ring.hole\"";
    let [with, without] = [rubbing, "contact = true"].map(|law| energy(&of(1e-3, ["0.1", "-1"], law))[0]);
    assert!((with - without).abs() < 1e-4 * without.abs(), "{with} {without}");
}

/// A couple on the pin meets nothing.
#[test]
fn a_pin_that_a_couple_turns_is_refused() {
    let bore = "[[body.holes]]\ncircle = { centre = [0, 0], radius = 0.2 }\nside = \"bore\"\n";
    for (couple, law) in [("1", "contact = true"), ("1e-5", "contact = true\nmultiplier = \"ring.hole\"")] {
        let text = pin(1e-3, ["0.1", "-1"], bore, law)
            + &format!("[sides.pin.bore]\ntraction = [\"-{couple}*y\", \"{couple}*x\"]\n");
        let scene = steklov_tests::parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        let error = steklov_tests::adapt(&scene).err().unwrap().to_string();
        assert!(error.starts_with("nothing holds pin against a motion"), "{error}");
    }
    assert_eq!(solved(&pin(1e-3, ["0.1", "-1"], bore, "contact = true"), &[]).reason, "tolerance");
}

/// Friction bounds are those of the first place, per its length: what those of the other one change is told. Rings that slip
/// all around, with 2 % more length outside, and a coefficient that varies over the distance of two blocks.
#[test]
fn friction_of_the_other_side_is_told() {
    let ring = |name: &str, [inner, outer]: [f64; 2]| {
        format!(
            "[[body]]\nname = \"{name}\"\ncircle = {{ centre = [0, 0], radius = {outer:?} }}\nside = \"out\"\n\
             material = {{ young = 100.0, poisson = 0.3 }}\n[[body.holes]]\n\
             circle = {{ centre = [0, 0], radius = {inner:?} }}\nside = \"in\"\n"
        )
    };
    let rings = ring("a", [0.5, 1.0])
        + &ring("b", [1.02, 2.0])
        + "[sides.a.in]\ndisplacement = [\"-0.005*y\", \"0.005*x\"]\n[sides.b.out]\ndisplacement = [\"0\", \"0\"]\n\
           [[interface]]\nbetween = [\"a.out\", \"b.in\"]\n\
           contact = { gap = \"-0.0201\", friction = { tresca = \"0.05\" } }\n";
    let blocks = block("a", [[0.0, 0.05], [1.0, 0.05], [1.0, 1.0], [0.0, 1.0]], 100.0)
        + &block("b", LOWER, 100.0)
        + "[sides.b.bottom]\ndisplacement = [\"0\", \"0\"]\n[sides.a.top]\ndisplacement = [\"0.03\", \"-0.01\"]\n\
           [[interface]]\nbetween = [\"a.bottom\", \"b.top\"]\n\
           contact = { gap = \"-0.05\", friction = { coulomb = \"0.1+2*y\" } }\n";
    // to first order, which the coefficient that is doubled is not
    for (text, sides, within) in [(rings, ["a.out", "b.in"], [0.95, 1.05]), (blocks, ["a.bottom", "b.top"], [0.5, 1.5])]
    {
        let [first, second] = sides;
        let of = |places: [&str; 2]| {
            let text = text.replace(&format!("{sides:?}"), &format!("{places:?}"));
            let refused = refused(&format!("{text}multiplier = \"{}\"\n", places[1]));
            assert!(refused.contains("are those of the first one"), "{refused}");
            solved(&text, &["method.tolerance=1e-4"])
        };
        let told = [[first, second], [second, first]].map(of);
        let [a, b] = told.each_ref().map(energy);
        for of in &told {
            let normals = of.interfaces[0].normals.unwrap();
            let ratio = (a[0] - b[0]).abs() / normals.energy_change;
            assert!(within[0] < ratio && ratio < within[1], "{ratio} {normals:?} {a:?} {b:?}");
            assert!(normals.energy_change > 20.0 * (a[1] + b[1]) && normals.angle < 1e-9, "{normals:?} {a:?} {b:?}");
            assert!(of.estimate_doubts.contains(&"normals".to_owned()), "{:?}", of.estimate_doubts);
        }
    }
}

/// s runs along one side: that of the first place carries, and no other may.
#[test]
fn data_in_s_are_those_of_the_first_place() {
    let of = |law: &str| {
        block("a", [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1000.0)
            + &block("b", LOWER, 100.0)
            + "[sides.b.bottom]\ndisplacement = [\"0\", \"0\"]\n[sides.a.top]\ndisplacement = [\"0\", \"-0.01\"]\n\
               [[interface]]\nbetween = [\"a.bottom\", \"b.top\"]\n"
            + law
    };
    let [by_s, by_x] =
        ["0.001*s", "0.001*x"].map(|gap| energy(&solved(&of(&format!("contact = {{ gap = \"{gap}\" }}")), &[])));
    assert!((by_s[0] - by_x[0]).abs() < by_s[1] + by_x[1], "{by_s:?} {by_x:?}");
    let error =
        steklov_tests::parse(&of("contact = { gap = \"0.001*s\" }\nmultiplier = \"b.top\""), &[]).err().unwrap();
    assert!(error.render().contains("data in s are those of the first one"), "{}", error.render());
}

/// A ring pressed so far that the end of contact passes the end of an arc: its vertex on the ring does not go to that end, where an
/// element would have no length.
#[test]
fn vertices_do_not_go_to_ends_of_arcs() {
    let corners = [[-1.1345, -0.7096], [1.1345, -0.7096], [1.1345, 0.0], [-1.1345, 0.0]];
    let text = block("lo", corners, 4.974).replace("0.3 }", "0.45, plane = \"stress\" }")
        + HELD
        + "[[body]]\nname = \"up\"\ncircle = { centre = [0, 0.44729], radius = 0.4331 }\nside = \"rim\"\n\
           material = { young = 10.88, poisson = 0.2, plane = \"stress\" }\n[[body.holes]]\n\
           circle = { centre = [0, 0.44729], radius = 0.2424 }\nside = \"bore\"\n\
           [sides.up.bore]\ndisplacement = [\"0\", \"-0.16159\"]\n[[interface]]\n\
           between = [\"up.rim\", \"lo.top\"]\ncontact = { friction = { coulomb = \"0.138\" } }\n";
    let [coarse, fine] = ["1e-3", "1e-4"].map(|tolerance| solved(&text, &[&format!("method.tolerance={tolerance}")]));
    assert_eq!([&coarse.reason, &fine.reason], ["tolerance"; 2]);
    let [a, b] = [&coarse, &fine].map(energy);
    assert!((a[0] - b[0]).abs() < a[1] + b[1], "{a:?} {b:?}");
}

/// The overlap of two blocks ends 1e-5 before a corner: the mirror image has the same J.
#[test]
fn overlaps_end_close_to_corners() {
    let at = |mirror: f64| {
        let span = |a: f64, b: f64| if mirror < 0.0 { [-b, -a] } else { [a, b] };
        let (low, up) = (span(0.0, 0.646), span(-1.411_490_526_465_746_3e-5, 0.645_997_567_180_633_3));
        let of = |[x0, x1]: [f64; 2], y0: f64, y1: f64| [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        let text = block("lo", of(low, -0.786, 0.0), 1000.0)
            + &block("up", of(up, 0.0, 0.412), 1463.0)
            + HELD
            + &format!(
                "[sides.up.top]\ndisplacement = [\"{:?}\", \"-0.007238+{:?}*(x-{:?})\"]\n[[interface]]\n\
                 between = [\"up.bottom\", \"lo.top\"]\ncontact = {{ friction = {{ tresca = \"1.533\" }} }}\n",
                0.000_896 * mirror,
                -0.000_857 * mirror,
                0.322_991_725_876_137_86 * mirror
            );
        solved(&text, &["method.tolerance=1e-4"])
    };
    let told = [1.0, -1.0].map(at);
    let [a, b] = told.each_ref().map(energy);
    assert!((a[0] - b[0]).abs() < a[1] + b[1] && a[1] < 1e-6 * a[0], "{a:?} {b:?}");
    for of in &told {
        let length = of.contact.as_ref().unwrap().length;
        assert!(of.converged && (length - 0.645_997_567).abs() < 1e-6, "{length}");
    }
}

/// Two thin plates side by side: the sides that look away from each other do not meet through the plates.
#[test]
fn sides_do_not_see_what_is_behind_them() {
    let plate = |name: &str, x: f64| block(name, [[x, 0.0], [x + 0.02, 0.0], [x + 0.02, 1.0], [x, 1.0]], 100.0);
    let between = |sides: &str| {
        plate("a", 0.0)
            + &plate("b", -0.03)
            + "[sides.b.bottom]\ndisplacement = [\"0\", \"0\"]\n[sides.a.bottom]\ndisplacement = [\"0\", \"0\"]\n"
            + &format!("[[interface]]\nbetween = {sides}\ncontact = true\n")
    };
    let error = refused(&between("[\"a.right\", \"b.left\"]"));
    assert!(error.contains("do not face each other"), "{error}");
    assert!(steklov_tests::parse(&between("[\"a.left\", \"b.right\"]"), &[]).is_ok());
}

/// Two blocks side by side on a slab, as close as their ends are in what is seen of an edge: what lies between them touches nothing.
#[test]
fn blocks_stand_side_by_side_however_close() {
    let of = |gap: f64| {
        let left = [[0.0, 0.0], [1.106, 0.0], [1.106, 0.7444], [0.0, 0.7444]];
        let right = [[1.106 + gap, 0.0], [2.608, 0.0], [2.608, 0.9], [1.106 + gap, 0.9]];
        let text = block("right", right, 7.266)
            + &block("left", left, 21.25)
            + &block("slab", [[0.0, -0.6], [2.608, -0.6], [2.608, 0.0], [0.0, 0.0]], 7.266)
            + "[sides.right.top]\ndisplacement = [\"0\", \"-0.011\"]\n[sides.left.top]\ndisplacement = [\"0\", \"-0.006\"]\n\
               [sides.slab.bottom]\ndisplacement = [\"0\", \"0\"]\n[[interface]]\n\
               between = [\"slab.top\", [\"left.bottom\", \"right.bottom\"]]\ncontact = { gap = \"0\" }\n";
        energy(&solved(&text, &["method.tolerance=1e-2"]))
    };
    let all = [1e-4, 1e-5, 2.87e-6, 1e-6, 3e-7, 1e-7, 1e-8].map(|gap| (gap, of(gap)));
    let (_, least) = all[6];
    for (gap, told) in all {
        // a part of the width loses its energy
        let beyond = (told[0] - least[0]).abs();
        assert!(beyond < told[1] + least[1] + 2.0 * gap * least[0].abs(), "{gap:e}: {told:?} {least:?}");
    }
}
