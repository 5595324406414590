//! Prescribed displacements: which are continuous, and which are small.

use std::f64::consts::PI;
use std::sync::atomic::AtomicUsize;

use steklov_model::quantities::Quantity;
use steklov_model::summary::Summary;
use steklov_study::reference::Reference;
use steklov_tests::{adapt, parse, summary};

/// u = (2xy, x² - y² + b y²/2(λ+2μ)) on the unit square about 0 is in equilibrium under the body force (0, -b); μ = 1, λ = 3/2.
/// Held so all around on coarse meshes of linear elements, whose nodes know u up to h²: J = ½∫σ:ε - ∫b·u is right within its
/// uncertainty all the same, and converges faster than J of the nodes' data.
#[test]
fn j_is_that_of_the_displacements_between_the_nodes() {
    for force in [0.0, 1.0] {
        let slope = force / 3.5;
        let (exx, eyy, exy): (f64, f64, f64) = (2.0, slope - 2.0, 2.0);
        let strain = (0.75 * (exx + eyy).powi(2) + exx * exx + eyy * eyy + 2.0 * exy * exy) / 12.0;
        let exact = strain + force * slope / 24.0;
        let held = format!("[\"2*x*y\", \"x^2-y^2+{}*y^2\"]", slope / 2.0);
        let sides: String = ["a", "b", "c", "d"].map(|side| format!("sides.{side}.displacement = {held}\n")).concat();
        let mut before = f64::INFINITY;
        for elements in [16, 32, 64] {
            let text = format!(
                "body.corners = [[-0.5,-0.5],[0.5,-0.5],[0.5,0.5],[-0.5,0.5]]\nbody.sides = [\"a\",\"b\",\"c\",\"d\"]\n\
                 material = {{ young = 2.6, poisson = 0.3 }}\n{sides}body_force.value = [\"0\", \"{}\"]\n\
                 method.elements = {elements}\nmethod.refine = \"none\"\n",
                -force
            );
            let run = adapt(&parse(&text, &[]).unwrap_or_else(|e| panic!("{e}"))).unwrap_or_else(|e| panic!("{e}"));
            let estimate = run.step().estimate();
            let (nodal, off) = (run.last.energies.total - exact, estimate.energy - exact);
            println!("b = {force}, {elements}: J {nodal:e}, {off:e} ± {:e}", estimate.uncertainty);
            assert!(off.abs() <= estimate.uncertainty, "{off} of {}", estimate.uncertainty);
            assert!(nodal.abs() > 5.0 * estimate.uncertainty && off.abs() < 0.35 * before);
            before = off.abs();
        }
    }
}

/// An elliptic hole of a medium, and the inside of an ellipse, held at u = (a x - c y, a y + c x)/r² about a point outside of the material:
/// on a curved side no polynomial of the arc. The stresses are σ_rr = -σ_θθ = -2μa/r² and σ_rθ = -2μc/r², the moment about any
/// point of a hole 4πμc.
#[test]
fn numbers_of_curved_sides_that_are_held_are_inside_their_bars() {
    let (mu, a, c) = (10.0 / 2.6, 0.02, 0.01);
    let held = "[\"(0.02*x - 0.01*y)/(x^2 + y^2)\", \"(0.02*y + 0.01*x)/(x^2 + y^2)\"]";
    let outside = "body = { ellipse = { centre = [0.2, -0.1], radii = [0.6, 0.5], angle = 20 }, side = \"w\" }\n\
                   exterior = { young = 10, poisson = 0.3, at_infinity = \"bounded\" }\n";
    let inside = "body = { ellipse = { centre = [2, 1], radii = [1, 0.7], angle = 20 }, side = \"w\" }\n\
                  material = { young = 10, poisson = 0.3 }\n";
    let points =
        [[[1.0, 0.3], [-0.9, 0.2], [3.0, 4.0], [-40.0, 30.0]], [[2.1, 0.8], [1.5, 1.2], [2.8, 1.1], [2.0, 0.5]]];
    let mut worst: f64 = 0.0;
    for (body, points, moment) in [(outside, points[0], 4.0 * PI * mu * c), (inside, points[1], 0.0)] {
        for tolerance in ["1e-1", "1e-2", "1e-3", "1e-4"] {
            let text = format!(
                "{body}sides.w.displacement = {held}\nprobe.points = {points:?}\nmethod.tolerance = {tolerance}\n\
                 quantities.m = {{ moment = \"w\", about = [0.3, 0.1] }}\n"
            );
            let quantities = summary(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render()))).quantities;
            let mut check = |path: &str, exact: f64| {
                let own = &quantities[path];
                let error = (own.value - exact).abs();
                println!("{tolerance} {path}: {} ± {:.1e}, off by {error:.1e}", own.value, own.uncertainty);
                worst = worst.max(error / own.uncertainty);
            };
            check("moment.m", moment);
            for (k, [x, y]) in points.into_iter().enumerate() {
                let r2 = x * x + y * y;
                let (cos2, sin2) = ((x * x - y * y) / r2, 2.0 * x * y / r2);
                let (rr, shear) = (-2.0 * mu * a / r2, -2.0 * mu * c / r2);
                let (xx, xy) = (rr * cos2 - shear * sin2, rr * sin2 + shear * cos2);
                check(&format!("probe.{k}.displacement.x"), (a * x - c * y) / r2);
                check(&format!("probe.{k}.displacement.y"), (a * y + c * x) / r2);
                for (of, exact) in [("xx", xx), ("yy", -xx), ("xy", xy)] {
                    check(&format!("probe.{k}.stress.{of}"), exact);
                }
            }
        }
    }
    assert!(worst < 1.3, "an error is {worst} of its bar");
}

#[test]
fn steep_displacements_are_no_jumps() {
    let text = |u: &str| {
        format!(
            "body.corners = [[0,0],[1,0],[1,1],[0,1]]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 1.0, poisson = 0.3 }}\nsides.floor.displacement = [\"0\", \"{u}\"]\n"
        )
    };
    for u in
        ["-0.01*s^0.1", "0.01*abs(s-0.3)^0.1", "0.01*sqrt(abs(s-0.3))", "0.01*(1-s)^0.02", "0.01*max(0,s-0.5)^0.05"]
    {
        assert!(parse(&text(u), &[]).is_ok(), "{u}");
    }
    for u in ["if(s<0.3,0,0.01)", "0.01*sign(s-0.7)", "0.01*sign(s-0.7)-0.5*s", "if(s<0.5,s,0.4)", "if(s<0.5,s^0.1,1)"]
    {
        let error = parse(&text(u), &[]).err().unwrap_or_else(|| panic!("{u}"));
        assert!(error.render().contains("jumps from"), "{u}: {}", error.render());
    }
}

/// A part of 120 pushed 50 deep is not described by small strains; one pushed 0.5 deep is, and so is one that turns as a whole
/// by little.
#[test]
fn deformations_beyond_small_strains_are_doubted() {
    let pressed = |gap: f64| {
        let text = format!(
            "body.corners = [[0,0],[120,0],[120,40],[0,40]]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 210000.0, poisson = 0.3 }}\nsides.top.displacement = [\"0\",\"0\"]\n\
             sides.floor.contact = {{ gap = \"{gap:?}\" }}\nmethod.tolerance = 1e-2\n"
        );
        let scene = parse(&text, &[]).unwrap_or_else(|e| panic!("{e}"));
        let run = adapt(&scene).unwrap_or_else(|e| panic!("{e}"));
        Summary::of_run(&scene, &run, None).estimate_doubts.contains(&"large".to_owned())
    };
    assert!(pressed(-50.0) && !pressed(-0.5));
}

/// Between a held and a loaded face of a notch stresses grow as r^(-3/4), and one degree more shows a third of the error: what is
/// told of it is right all the same.
#[test]
fn the_error_between_a_held_and_a_loaded_face_is_told() {
    let scene = |tolerance: &str, sharp: f64| {
        let text = format!(
            "body.corners = [[0,0],[1,0],[1,1],[{},1],[0.49,0.52],[{},1],[0,1]]\n\
             body.sides = [\"e0\",\"e1\",\"e2\",\"loaded\",\"held\",\"e5\",\"e6\"]\n\
             material = {{ young = 100.0, poisson = 0.3 }}\nsides.held.displacement = [\"0\",\"0\"]\n\
             sides.loaded.pressure = 0.1\nmethod.tolerance = {tolerance}\n",
            0.49 + sharp,
            0.49 - sharp
        );
        parse(&text, &[]).unwrap_or_else(|e| panic!("{e}"))
    };
    for sharp in [0.01, 0.03, 0.1] {
        let go = AtomicUsize::new(0);
        let reference = Reference::new(&scene("1e-2", sharp), &go, &mut |_, _| Ok(())).unwrap();
        for tolerance in ["5e-2", "2e-2"] {
            let scene = scene(tolerance, sharp);
            let run = adapt(&scene).unwrap_or_else(|e| panic!("{e}"));
            let estimate = run.step().estimate();
            let off = (estimate.energy - reference.energy).abs() - reference.uncertainty;
            let error = reference.true_error(&scene, run.step(), &run.last.displacement, &go).unwrap();
            let told = estimate.error / error.expect("the reference is finer");
            println!("{sharp} {tolerance}: told {told:.2}, J off by {:.2}", off / estimate.uncertainty);
            assert!(off <= estimate.uncertainty && (0.6..2.0).contains(&told), "{sharp} {tolerance}: {told} {off}");
        }
    }
}

/// Ends that are held along an oblique obstacle are held inside of it by rounding only, which is no penetration.
#[test]
fn ends_held_along_an_obstacle_are_not_inside_of_it() {
    for k in 1..=12 {
        let held = format!("[\"0.{:02}\", \"0.{k:02}\"]", 3 * k);
        let text = format!(
            "body.corners = [[0,0],[3,1],[2.5,2.5],[-0.5,1.5]]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 100, poisson = 0.3 }}\nsides.top.displacement = {held}\n\
             sides.left.displacement = {held}\nsides.floor.contact.gap = \"0\"\n"
        );
        let told = summary(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())));
        assert!(told.converged && told.energy.abs() < 1e-12, "{held}: {}", told.energy);
    }
}

/// A block with a curved floor that sticks to an obstacle whose gap is no polynomial.
fn block_that_sticks(tolerance: &str, friction: &str, loads: &str) -> Summary {
    let text = format!(
        "[material]\nyoung = 100\npoisson = 0.215\n\
         [body]\ncorners = [[-0.643, 0], [0.643, 0], [0.643, 1.841], [-0.643, 1.841]]\n\
         sides = [\"floor\", \"right\", \"top\", \"left\"]\narcs = {{ floor = {{ through = [0, -0.235981] }} }}\n\
         [sides.floor.contact]\ngap = \"0.003*abs(x + 0.259)^3\"\nfriction = {{ {friction} }}\n{loads}\
         [quantities]\nmd = {{ mean_displacement = \"floor\" }}\n[method]\ntolerance = {tolerance}\n"
    );
    let told = summary(&parse(&text, &[]).unwrap_or_else(|e| panic!("{}", e.render())));
    let contact = told.contact.as_ref().expect("contact");
    assert!((contact.stick / contact.length - 1.0).abs() < 1e-12, "all of it sticks: {contact:?}");
    told
}

/// The mean displacement of the floor is that of the gap along its normal.
#[test]
fn sides_that_stick_to_obstacles_are_off_by_what_polynomials_leave_of_gaps() {
    let loads = "[sides.top]\ndisplacement = [\"-0.003\", \"-0.029*(1 + 0.157*x)\"]\n\
                 [sides.right]\ntraction = [0.213, 0.293]\n";
    for tolerance in ["1e-1", "1e-2", "3e-3", "1e-3"] {
        let told = block_that_sticks(tolerance, "coulomb = \"0.669\"", loads);
        let exact = mean_of_gap(0.643, 0.235981, |x| 0.003 * (x + 0.259).abs().powi(3));
        for (i, component) in ["x", "y"].iter().enumerate() {
            let Quantity { value, uncertainty, .. } = &told.quantities[&format!("mean_displacement.md.{component}")];
            let error = (value - exact[i]).abs();
            println!("{tolerance} {component}: {value} ± {uncertainty:.1e}, off by {error:.1e}");
            assert!(error <= 1.5 * uncertainty, "{component} at {tolerance}: {error:e} of {uncertainty:e}");
        }
    }
}

/// J is off by the work of the traction on what polynomials leave of the gap; J₊ has that, and comes within a fifth of the error of J.
#[test]
fn energies_know_the_work_on_what_polynomials_leave_of_gaps() {
    let loads = "[sides.top]\ntraction = [\"0.1\", \"-2*(1 + 0.157*x)\"]\n";
    let of = |tolerance| block_that_sticks(tolerance, "tresca = \"50\"", loads);
    let exact = of("1e-5").energy_extrapolated.expect("an estimate");
    for tolerance in ["1e-2", "1e-3", "3e-4"] {
        let told = of(tolerance);
        let uncertainty = told.quantities["energy"].uncertainty;
        let extrapolated = told.energy_extrapolated.expect("an estimate");
        let [error, left] = [told.energy, extrapolated].map(|energy| (energy - exact).abs());
        println!("{tolerance}: {} ± {uncertainty:.1e}, off by {error:.1e}, extrapolated by {left:.1e}", told.energy);
        assert!(error <= 1.5 * uncertainty, "{tolerance}: {error:e} of {uncertainty:e}");
        assert!(left <= 0.2 * error, "{tolerance}: {left:e} extrapolated, {error:e} before");
    }
}

/// The mean of g n over the arc below the x axis from -a to a of height h, n out of the body: midpoint rule.
fn mean_of_gap(a: f64, h: f64, gap: impl Fn(f64) -> f64) -> [f64; 2] {
    let radius = (a * a + h * h) / (2.0 * h);
    let half = (a / radius).asin();
    let count = 20_000;
    let mut mean = [0.0; 2];
    for k in 0..count {
        let (sin, cos) = (half * ((2 * k + 1) as f64 / f64::from(count) - 1.0)).sin_cos();
        let g = gap(radius * sin) / f64::from(count);
        mean = [mean[0] + g * sin, mean[1] - g * cos];
    }
    mean
}
