//! Lengths of contact and stick against the ends of contact and the nodes between them.

use steklov_model::answer::report::{contact_summary, located};
use steklov_model::run::adaptive_loop::Run;
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::contact_rows::{ContactRow, contact_rows};
use steklov_model::summary::ContactSummary;
use steklov_problem::Scene;
use steklov_tests::{Random, View, adapt, full, parse, random_case};

/// Oblique edges, of which one is in contact all along and one on a part in the middle.
const TWO_FLOORS: &str = r#"
body.corners = [[0.013,0.007],[0.547,-0.031],[1.037,0.091],[1.1,1.1],[0.1,0.9]]
body.sides = ["f1","f2","right","top","left"]
material = { young = 25.0, poisson = 0.49 }
sides.f1.contact = { gap = "0" }
sides.f2.contact = { gap = "0.01*(s-0.4)^2-0.001" }
sides.top.displacement = ["0","-0.002"]
"#;

/// Contact at both ends of an oblique edge, apart between them, with stick and slip.
const TWO_ENDS: &str = r#"
body.corners = [[0.82,0.378],[-0.717,0.538],[-0.336,-0.685],[-0.046,-0.6],[0.547,-0.085]]
body.sides = ["e0","e1","e2","e3","e4"]
body_force.value = ["0.000134405","0.000179473"]
material = { young = 0.0393839, poisson = 0.49 }
sides.e0.traction = ["if(s<0.4,6.15599e-05,0)","-0.000181623"]
sides.e1.displacement = ["0.000658198*sin(pi*s)","0.000658198*s"]
sides.e4.contact = { gap = "0.004*(1-cos(3*s))-0.002", friction = { tresca = "0.000118152*(1+s)" } }
"#;

/// Rows with their edge parameters on an edge, by the distance from it.
fn on_edge(scene: &Scene, k: usize, rows: &[ContactRow]) -> Vec<(f64, ContactRow)> {
    let edge = &scene.problem.outline.edges()[k];
    let (length, [a, _]) = (edge.length(), edge.listed());
    let [x, y] = [0, 1].map(|i| (edge.end[i] - edge.start[i]) / length);
    let sign = if edge.reversed { -1.0 } else { 1.0 };
    let place = |r: &ContactRow| {
        let d = [r.point[0] - a[0], r.point[1] - a[1]];
        let (along, off) = (sign * (d[0] * x + d[1] * y) / length, d[0] * y - d[1] * x);
        let same = r.normal[0] * y - r.normal[1] * x > 0.999;
        (same && off.abs() < 1e-9 * length && (-1e-9..=1.0 + 1e-9).contains(&along)).then_some((along, *r))
    };
    rows.iter().filter_map(place).collect()
}

/// What [`on_edge`] finds between the ends of contact: the length of the parts in which most nodes are pressed, and the
/// weight of the pressed nodes. None where a part has no nodes inside.
fn lengths(scene: &Scene, rows: &[ContactRow], ends: &[[f64; 2]]) -> Option<[f64; 2]> {
    let largest = rows.iter().fold(0.0, |m: f64, r| m.max(r.pressure));
    let pressed = |r: &ContactRow| r.pressure > 1e-12 * largest;
    let (mut length, edges) = (0.0, scene.problem.outline.edges());
    for (k, edge) in edges.iter().enumerate() {
        if scene.contact(edge.side).is_none() {
            continue;
        }
        let end = |x: &[f64; 2]| ContactRow { point: *x, ..on_edge(scene, k, rows)[0].1 };
        let ends: Vec<ContactRow> = ends.iter().map(end).collect();
        let mut knots: Vec<f64> = on_edge(scene, k, &ends).into_iter().map(|(s, _)| s).chain([0.0, 1.0]).collect();
        knots.sort_by(f64::total_cmp);
        for part in knots.windows(2) {
            let mut inside = on_edge(scene, k, rows);
            inside.retain(|(s, _)| part[0] + 1e-11 < *s && *s < part[1] - 1e-11);
            let weight = |of: &dyn Fn(&ContactRow) -> bool| -> f64 {
                inside.iter().filter(|(_, r)| of(r)).map(|(_, r)| r.weight).sum()
            };
            let (with, all) = (weight(&pressed), weight(&|_| true));
            if all == 0.0 {
                return None;
            }
            length += if with > 0.5 * all { (part[1] - part[0]) * edge.length() } else { 0.0 };
        }
    }
    Some([length, rows.iter().filter(|r| pressed(r)).map(|r| r.weight).sum()])
}

fn told(scene: &Scene, run: &Run<BoundaryElements>) -> Option<(Vec<ContactRow>, ContactSummary)> {
    let contact = run.last.contact.as_ref()?;
    let rows = contact_rows(run.last.trace(), contact);
    let summary = contact_summary(scene, run.last.trace(), contact, &rows, located(scene, &run.step().layout.located));
    Some((rows, summary))
}

/// Whether the length was located.
fn judge(scene: &Scene, run: &Run<BoundaryElements>) -> bool {
    let Some((rows, contact)) = told(scene, run) else { return false };
    assert!((contact.length - contact.stick - contact.slip).abs() < 1e-12 && contact.slip >= 0.0, "{contact:?}");
    let weight: f64 = rows.iter().filter(|r| r.pressure > 1e-12 * contact.max_pressure).map(|r| r.weight).sum();
    let Some(ends) = &contact.ends else {
        assert!((contact.length - weight).abs() < 1e-12 * (1.0 + weight), "{contact:?} {weight}");
        return false;
    };
    let Some([exact, weight]) = lengths(scene, &rows, ends) else { return false };
    println!("{:.9} by the ends, {exact:.9}, of the nodes {weight:.9}", contact.length);
    assert!((contact.length - exact).abs() < 1e-9, "{contact:?} {exact}");
    let longest = (0..run.last.mesh.len()).map(|e| run.last.mesh.length(e)).fold(0.0, f64::max);
    assert!((contact.length - weight).abs() < 0.5 * longest * ends.len() as f64 + 1e-9, "{contact:?} {weight}");
    true
}

fn solved(text: &str, tolerance: f64) -> (Scene, Run<BoundaryElements>) {
    let mut scene = parse(text, &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    scene.method.tolerance = Some(tolerance);
    let run = adapt(&scene).unwrap_or_else(|e| panic!("{e}"));
    (scene, run)
}

/// Near corners elements get as short as 1e-9 of their edges, and lose their directions.
#[test]
fn zones_on_oblique_edges_are_counted_at_tight_tolerances() {
    for (text, sizes) in [(TWO_FLOORS, [0.826, 0.0]), (TWO_ENDS, [0.365, 0.352])] {
        for tolerance in [1e-3, 1e-6] {
            let (scene, run) = solved(text, tolerance);
            assert!(judge(&scene, &run), "the ends are located");
            let (_, contact) = told(&scene, &run).expect("contact");
            for (value, size) in [contact.length, contact.stick].iter().zip(sizes) {
                assert!((value - size).abs() < 1e-3, "{contact:?}");
            }
        }
    }
}

/// A floor that is pressed and sheared sticks in the middle, between the ends of stick: symmetric about x = 0.
#[test]
fn stick_is_the_distance_of_its_ends() {
    let text = r#"
body.corners = [[-0.5,0],[0.5,0],[0.5,0.8],[-0.5,0.8]]
body.sides = ["floor","right","top","left"]
material = { young = 10.0, poisson = 0.3 }
sides.floor.contact = { gap = "0", friction = { tresca = "0.02*(1+4*x^2)" } }
sides.top.displacement = ["0","-0.005"]
"#;
    let (scene, run) = solved(text, 1e-6);
    let (rows, contact) = told(&scene, &run).expect("contact");
    let tips: Vec<f64> = run.step().layout.located.iter().map(|l| l.s).collect();
    println!("{tips:?} {contact:?}");
    assert_eq!(tips.len(), 2, "stick has two ends");
    assert!((contact.length - 1.0).abs() < 1e-12 && (contact.stick - (tips[1] - tips[0]).abs()).abs() < 1e-9);
    assert!((tips[0] + tips[1] - 1.0).abs() < 1e-5, "they are mirror images");
    let sticking: f64 = rows.iter().filter(|r| r.shear.abs() < r.bound * (1.0 - 1e-12)).map(|r| r.weight).sum();
    assert!((contact.stick - sticking).abs() < 0.02, "{sticking} {contact:?}");
}

#[test]
fn lengths_of_random_scenes_are_those_between_their_ends() {
    const SEED: u64 = 20_260_719;
    println!("seed {SEED}");
    let scenes = if full() { 24 } else { 16 };
    let mut located = 0;
    for number in 0..scenes {
        let case = random_case(&mut Random::new(SEED.wrapping_mul(1000).wrapping_add(number)));
        let mut scene = parse(&case.toml(&View::PLAIN), &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        if scene.contacts().next().is_none() {
            continue;
        }
        (scene.method.tolerance, scene.method.max_dofs) = (Some(1e-5), Some(900));
        // bodies that nothing holds are refused
        let Ok(run) = adapt(&scene) else { continue };
        println!("scene {number}");
        located += usize::from(judge(&scene, &run));
    }
    println!("{located} located");
    assert!(located >= 8, "{located} of {scenes} have located ends");
}

/// The first meshes have the end of contact beyond the zero of the friction bound, at s = 0.698, the solution before it: the end
/// of a coarse tolerance is that of a fine one.
#[test]
fn ends_of_contact_pass_singular_points_of_the_data() {
    let scene = |tolerance: &str| {
        let text = "body.corners = [[0,0],[0.737840606481611,0],[0.737840606481611,0.6415438613725092],[0,0.6415438613725092]]\n\
             body.sides = [\"floor\",\"right\",\"top\",\"left\"]\nmaterial = { young = 100.0, poisson = 0.26 }\n\
             sides.floor.contact = { gap = \"0.009808*(s-0.411974)^2-0.000736\", \
             friction = { tresca = \"max(0,0.393671*(s-0.69793)^2)\" } }\n\
             sides.left.displacement = [\"0\",\"0\"]\n\
             sides.right.traction = [\"0.13792*exp(-((s-0.127635)/0.0199)^2)+0.104509*exp(-((s-0.329908)/0.0199)^2)\
             +0.133292*exp(-((s-0.609409)/0.0199)^2)+0.090623*exp(-((s-0.800723)/0.0199)^2)\",\"-0.546597*(s-0.389044)^2\"]\n";
        parse(text, &[&format!("method.tolerance={tolerance}")]).expect("a scene")
    };
    let ends = |tolerance: &str| {
        let scene = scene(tolerance);
        let run = adapt(&scene).expect("an answer");
        let (_, summary) = told(&scene, &run).expect("contact");
        let doubts = run.step().estimate().doubts.clone();
        (summary.length, summary.ends.expect("located ends"), doubts)
    };
    let (fine, exact, _) = ends("1e-5");
    let (coarse, found, doubts) = ends("1e-3");
    assert_eq!(doubts, []);
    assert_eq!(found.len(), exact.len(), "{found:?} {exact:?}");
    let off = found.iter().zip(&exact).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
    assert!(off < 1e-3 * fine && (coarse - fine).abs() < 2e-3 * fine, "{found:?} {exact:?}, {coarse} {fine}");
    assert!(exact[1][0] < 0.69793 * 0.737840606481611, "{exact:?}");
}

/// The tip of a triangle presses on its obstacle with the node of the corner alone: such a zone is short, and has a length.
#[test]
fn a_corner_that_presses_has_a_length() {
    let bow = "0.0518028*x*(1-x)*atan2(x-0.197518,0.161057)/1.6";
    let along = "((x-0.554375)*-0.3310503660926445+(y-1.1693)*-0.6982587473679895)";
    let text = format!(
        "body.corners = [[0,0],[1,0],[0.554375,1.1693]]\nbody.sides = [\"floor\",\"right\",\"left\"]\n\
         material = {{ young = 7.92206, poisson = 0.49 }}\nsides.floor.displacement = [\"{bow}\",\"{bow}\"]\n\
         sides.right.contact = {{ gap = 0.00848685 }}\n\
         sides.left.traction = [\"0\",\"0.0862982*(min(abs({along}-0.789142),abs({along}-0.84355))-0.0730495)\"]\n\
         body_force.value = [\"0\",\"-0.0355671\"]\n"
    );
    for tolerance in ["3e-3", "1e-3", "3e-4"] {
        let scene = parse(&text, &[&format!("method.tolerance={tolerance}")]).unwrap_or_else(|e| panic!("{e}"));
        let run = adapt(&scene).unwrap_or_else(|e| panic!("{e}"));
        let contact = run.last.contact.as_ref().expect("a side is in contact");
        let rows = contact_rows(run.last.trace(), contact);
        let found =
            contact_summary(&scene, run.last.trace(), contact, &rows, located(&scene, &run.step().layout.located));
        println!("{tolerance}: length {:e}, force {:?}", found.length, found.force);
        assert!(found.force[0] < -1e-6 && (1e-6..1e-2).contains(&found.length), "{tolerance}: {found:?}");
    }
}
