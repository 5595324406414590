//! Springs on sides: closed forms, identities, the estimate.

use std::sync::atomic::AtomicUsize;

use steklov_model::run::adaptive_loop::{Reason, Run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::summary::Summary;
use steklov_study::reference::Reference;
use steklov_tests::{Random, adapt, full, solved_in_steps};

use crate::on_springs::{block, close, force, scene, solved};

fn summary(text: &str) -> Summary {
    steklov_model::solve(&scene(text)).unwrap_or_else(|e| panic!("{e}\n{text}")).summary
}

/// Largest distance of nodal displacements from a field, and the largest displacement.
fn worst(run: &Run<BoundaryElements>, field: impl Fn([f64; 2]) -> [f64; 2]) -> (f64, f64) {
    let (mut worst, mut largest): (f64, f64) = (0.0, 0.0);
    for (x, u) in run.last.space.points.iter().zip(run.last.displacement.chunks_exact(2)) {
        let exact = field(*x);
        worst = worst.max((u[0] - exact[0]).hypot(u[1] - exact[1]));
        largest = largest.max(exact[0].hypot(exact[1]));
    }
    (worst, largest)
}

/// A bar on springs under tension: u_x = p/k + p x/E, u_y = -ν p y/E, with springs from 1e-8 to 2e12 times E over its length, which
/// alone hold it along x. What stiff ones store goes with 1/k.
#[test]
fn a_bar_on_springs_under_tension() {
    for k in [5e-7, 0.1, 7.0, 1e3, 1e9, 1e14] {
        let sprung = format!("sides.left.springs = [\"{k:e}\", 0]\n");
        let run = solved(&block(&format!(
            "{sprung}sides.floor.displacement = [\"free\", 0]\nsides.right.traction = [3, 0]\n"
        )));
        let (off, largest) = worst(&run, |[x, y]| [3.0 / k + 0.03 * x, -0.009 * y]);
        println!("k = {k:e}: displacements off by {:.1e}", off / largest);
        assert!(off < 1e-12 * largest && run.reason == Reason::Tolerance);
        let energies = run.last.energies;
        // strains of 0.03 are differences of displacements 3/k, which have 16 digits
        let digits = 1e-12f64.max(3e-14 / k);
        close(energies.strain, 0.09, digits, "strain energy");
        close(energies.springs, 4.5 / k, 1e-12, "spring energy");
        close(energies.load_work, 9.0 / k + 0.18, 1e-12, "load work");
        let [x, y] = force(&run, "left");
        assert!((x + 3.0).abs() < 1e-12 && y.abs() < 1e-12, "{x} {y}");
        assert!(run.last.balanced && run.last.equilibrium < digits, "{:e}", run.last.equilibrium);
    }
}

/// A block under pressure on a normal foundation, with springs along the floor that hold nothing but its sliding: p/k and pν/E; as
/// components and as normal and tangent, and turned by an angle.
#[test]
fn a_block_under_pressure_on_a_foundation() {
    for floor in ["springs = [\"2\", \"40\"]", "springs = { normal = \"40\", tangential = \"2\" }"] {
        let run = solved(&block(&format!(
            "sides.floor.{floor}\nsides.floor.traction = [\"0.024*(x-1)\", 0]\n\
             sides.top.pressure = 4\nmethod.tolerance = 1e-9\n"
        )));
        let (off, largest) = worst(&run, |[x, y]| [0.012 * (x - 1.0), -0.1 - 0.04 * y]);
        println!("{floor}: off by {:.1e}", off / largest);
        assert!(off < 1e-13 * largest);
        let [x, y] = force(&run, "floor");
        assert!(x.abs() < 1e-12 && (y - 8.0).abs() < 1e-12);
    }
    // turned by 0.4: tangent (c, s)
    let (s, c) = 0.4f64.sin_cos();
    let at = |x: f64, y: f64| format!("[{:?},{:?}]", c * x - s * y, s * x + c * y);
    let corners = [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(0.0, 1.0)].join(",");
    let text = format!(
        "body.corners = [{corners}]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
         material = {{ young = 100.0, poisson = 0.3, plane = \"stress\" }}\n\
         sides.floor.springs = {{ normal = \"40\", tangential = \"2\" }}\nsides.top.pressure = 4\n\
         sides.floor.traction = [\"0.024*(2*s-1)*{c:?}\", \"0.024*(2*s-1)*{s:?}\"]\nmethod.tolerance = 1e-9\n"
    );
    let run = solved(&text);
    let (off, largest) = worst(&run, |[x, y]| {
        let (x, y) = (c * x + s * y, c * y - s * x);
        let (u, v) = (0.012 * (x - 1.0), -0.1 - 0.04 * y);
        [c * u - s * v, s * u + c * v]
    });
    println!("turned: off by {:.1e}", off / largest);
    assert!(off < 1e-13 * largest);
}

/// A disc whose rim rests on radial springs, under a pressure beside them: u = c r, c = -p/(E/((1+ν)(1-2ν)) + k R). It may turn as it
/// likes, and a couple is refused.
#[test]
fn a_disc_on_radial_springs() {
    let disc = |more: &str| {
        format!(
            "body = {{ circle = {{ centre = [0.3, -0.1], radius = 2 }}, side = \"rim\" }}\n\
             material = {{ young = 100.0, poisson = 0.3 }}\n{more}"
        )
    };
    for k in [0.01, 20.0, 1e7] {
        let radial = format!("sides.rim.springs = {{ normal = \"{k:?}\" }}\n");
        let text = disc(&format!("{radial}sides.rim.pressure = 5\nmethod.tolerance = 1e-8\n"));
        let run = solved(&text);
        let c = -5.0 / (100.0 / (1.3 * 0.4) + 2.0 * k);
        let (off, largest) = worst(&run, |[x, y]| [c * (x - 0.3), c * (y + 0.1)]);
        println!("k = {k:e}: {} dofs, off by {:.1e}", run.step().dofs, off / largest);
        assert!(off < 1e-7 * largest && run.last.free_motions.len() == 1);
        close(run.last.energies.springs, 0.5 * k * (2.0 * c).powi(2) * 4.0 * std::f64::consts::PI, 2e-7, "springs");
        let couple = scene(&disc(&format!("{radial}sides.rim.traction = [\"-(y+0.1)\", \"x-0.3\"]\n")));
        let error = adapt(&couple).err().expect("a couple turns it");
        assert!(error.to_string().contains("rotation about (0.3, -0.1)"), "{error}");
    }
}

/// The same disc under its weight b on springs k_n, k_t: u_x = (a-c)xy, u_y = T + a y² + c x² with
///
/// ```text
/// μ(a+c) + λ(3a-c) + 4μa = b      (λ(3a-c)+4μa) R = -k_n (T + aR²)      μ(a+c) R = -k_t (T + cR²)
/// ```
#[test]
fn a_disc_under_its_weight() {
    let (young, nu, radius, weight) = (100.0, 0.3, 2.0, 3.0);
    let (lambda, mu): (f64, f64) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), young / 2.0 / (1.0 + nu));
    for (kn, kt) in [(1e-4, 1e-4), (30.0, 2.0), (1.0, 500.0), (4e5, 3e6)] {
        let rows = [
            [3.0 * lambda + 5.0 * mu, mu - lambda, 0.0, weight],
            [(3.0 * lambda + 4.0 * mu) * radius + kn * radius * radius, -lambda * radius, kn, 0.0],
            [mu * radius, mu * radius + kt * radius * radius, kt, 0.0],
        ];
        let [a, c, t] = solve3(rows);
        let run = solved(&format!(
            "body = {{ circle = {{ centre = [0, 0], radius = {radius} }}, side = \"rim\" }}\n\
             material = {{ young = {young}, poisson = {nu} }}\nbody_force.value = [0, {}]\n\
             sides.rim.springs = {{ normal = \"{kn:?}\", tangential = \"{kt:?}\" }}\nmethod.tolerance = 1e-7\n",
            -weight
        ));
        let (off, largest) = worst(&run, |[x, y]| [(a - c) * x * y, t + a * y * y + c * x * x]);
        let ([_, fy], energies) = (force(&run, "rim"), run.last.energies);
        println!("k = {kn:e}, {kt:e}: {} dofs, off by {:.1e}, {:?}", run.step().dofs, off / largest, run.reason);
        assert!(off < 1e-6 * largest);
        close(fy, weight * std::f64::consts::PI * radius * radius, 1e-6, "force");
        close(2.0 * (energies.strain + energies.springs), energies.load_work, 1e-9, "load work");
        let estimate = run.step().estimate();
        // ½ ∫ b·u, in polar coordinates
        let exact = 0.5 * weight * std::f64::consts::PI * radius.powi(2) * (t + (a + c) * radius.powi(2) / 4.0);
        let off = (estimate.energy - exact).abs();
        println!("J {:e} ± {:e}, off by {off:e}", estimate.energy, estimate.uncertainty);
        assert!(off <= estimate.uncertainty + 1e-13 * exact.abs());
    }
}

/// The unknowns of three equations by Cramer's rule.
fn solve3(rows: [[f64; 4]; 3]) -> [f64; 3] {
    let det = |columns: [usize; 3]| {
        let at = |i: usize, j: usize| rows[i][columns[j]];
        at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) - at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0))
            + at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0))
    };
    let all = det([0, 1, 2]);
    [det([3, 1, 2]) / all, det([0, 3, 2]) / all, det([0, 1, 3]) / all]
}

/// A block 1e8 times as stiff as its springs, k along the floor and 2k up it, moves as a rigid body: forces and moments balance.
#[test]
fn a_stiff_block_moves_as_a_rigid_body() {
    let run = solved(
        &block("sides.floor.springs = [\"3\", \"5\"]\nsides.top.traction = [2, \"-1-3*x\"]\nmethod.tolerance = 1e-6\n")
            .replace("100.0", "1e9"),
    );
    // about the middle (1, 0) of the floor: ∫k_y x² = 5·2/3, the moment of the load is -2·1·2 - ∫(1+3x)(x-1)
    let rotation = (-4.0 - 3.0 * 2.0 / 3.0) / (5.0 * 2.0 / 3.0);
    let (fx, fy) = (4.0 / 6.0, -8.0 / 10.0);
    let (off, largest) = worst(&run, |[x, y]| [fx - rotation * y, fy + rotation * (x - 1.0)]);
    println!("off by {:.1e}", off / largest);
    assert!(off < 1e-7 * largest);
    let [x, y] = force(&run, "floor");
    assert!((x + 4.0).abs() < 1e-11 && (y - 8.0).abs() < 1e-11, "{x} {y}");
}

/// u = m (2xy, x² - y²), without body force, with springs of stiffnesses that vary, have kinks and jump on all sides: t = σn + k u.
/// Degree 2 has it to rounding, however k varies.
#[test]
fn a_manufactured_solution_with_varying_stiffness() {
    let (mu, m) = (100.0 / 2.6, 0.01);
    let springs = [
        ("floor", ["20*(1+x)", "if(x<0.7,300,5)"], [0.0, -1.0]),
        ("right", ["1+5*abs(y-0.4)", "exp(3*y)"], [1.0, 0.0]),
        ("top", ["1e7*s", "0"], [0.0, 1.0]),
        ("left", ["0", "3/(0.1+y)"], [-1.0, 0.0]),
    ];
    for frame in ["axes", "normal"] {
        let sides = springs.map(|(side, [first, second], [nx, ny])| {
            let u = [format!("{m}*2*x*y"), format!("{m}*(x^2-y^2)")];
            // along axes k = (first, second); along the normal and the tangent the axes are the same lines
            let (given, [kx, ky]) = match frame {
                "axes" => (format!("[\"{first}\", \"{second}\"]"), [first, second]),
                _ if nx == 0.0 => (format!("{{ normal = \"{second}\", tangential = \"{first}\" }}"), [first, second]),
                _ => (format!("{{ normal = \"{first}\", tangential = \"{second}\" }}"), [first, second]),
            };
            let stress = |i: usize| match i {
                0 => format!("{}*(2*y*{nx:?} + 2*x*{ny:?})", 2.0 * mu * m),
                _ => format!("{}*(2*x*{nx:?} - 2*y*{ny:?})", 2.0 * mu * m),
            };
            let [tx, ty] = [0, 1].map(|i| format!("{} + ({})*{}", stress(i), [kx, ky][i], u[i]));
            format!("sides.{side}.springs = {given}\nsides.{side}.traction = [\"{tx}\", \"{ty}\"]\n")
        });
        let run = solved(&block(&format!("{}method = {{ tolerance = 1e-9, degree = 2 }}\n", sides.concat())));
        let (off, largest) = worst(&run, |[x, y]| [m * 2.0 * x * y, m * (x * x - y * y)]);
        println!("{frame}: {} dofs, off by {:.1e}, {:?}", run.step().dofs, off / largest, run.reason);
        assert!(off < 1e-11 * largest);
        let traction = run.last.traction(0, 0.3);
        println!("{traction:?}");
    }
}

/// The estimate against true errors, distances to a solution on a refinement that is much finer, step by step, from springs much
/// softer than the body to much stiffer ones, with jumps and body forces; uniform and adaptive. Where an estimate is low it says so.
#[test]
fn the_estimate_is_near_the_true_error() {
    let cases = [
        ("soft", "sides.floor.springs = \"0.01\"\n"),
        ("alike", "sides.floor.springs = \"50\"\n"),
        ("stiff", "sides.floor.springs = \"1e4\"\n"),
        ("stiffer", "sides.floor.springs = \"1e9\"\n"),
        ("jump", "sides.floor.springs = \"if(x<0.7,1000,3)\"\n"),
        ("axis", "sides.floor.springs = [\"1e3\", \"1\"]\n"),
        (
            "normal",
            "sides.floor.springs = { normal = \"1e4*(1+x)\", tangential = \"1\" }\nbody_force.value = [1, -3]\n",
        ),
    ];
    let never = AtomicUsize::new(0);
    for (name, floor) in cases {
        let refined = |refine: &str| {
            scene(&block(&format!(
                "{floor}sides.top.traction = [1, \"-1-x\"]\nmethod = {{ tolerance = 1e-3, max_dofs = 260, refine = \"{refine}\" }}\n"
            )))
        };
        // by the hp strategy, whatever that of the scene is
        let reference = Reference::new(&refined("hp"), &never, &mut |_, _| Ok(())).unwrap_or_else(|e| panic!("{e}"));
        // uniform meshes have the same ratios on soft springs as on those that are alike the body, and on stiff as on stiffer ones
        let strategies = if ["soft", "stiff", "axis"].contains(&name) && !full() { 1 } else { 3 };
        for refine in &["hp", "uniform-h", "uniform-p"][..strategies] {
            let scene = refined(refine);
            let (run, displacements) = solved_in_steps(&scene).unwrap_or_else(|e| panic!("{e}"));
            let mut told = Vec::new();
            for (step, displacement) in run.progress.steps.iter().zip(&displacements) {
                let error = reference.true_error(&scene, step, displacement, &never).unwrap_or_else(|e| panic!("{e}"));
                let Some(error) = error else { continue };
                let (estimate, doubted) = (step.estimate(), !step.estimate().doubts.is_empty());
                let off = (estimate.energy - reference.own_energy).abs();
                told.push(format!("{:.2}{}", estimate.error / error, if doubted { "?" } else { "" }));
                assert!((0.7..1.7).contains(&(estimate.error / error)) || doubted, "{name}, {refine}: {told:?}");
                assert!(
                    off <= estimate.uncertainty + reference.uncertainty || doubted,
                    "{name}, {refine}: J off by {off:e}"
                );
            }
            println!("{name}, {refine}: {}", told.join(" "));
            assert!(told.len() > 2);
        }
    }
}

/// An adaptive run and a forced fine mesh have the same energies, forces and displacements; a mirrored scene too.
#[test]
fn refinement_comes_to_the_fine_mesh() {
    let adaptive = |k: &str, load: &str, method: &str| {
        solved(&block(&format!(
            "sides.floor.springs = \"{k}\"\nsides.right.springs = {{ normal = \"7\" }}\nsides.left.springs = {{ normal = \"7\" }}\n\
             sides.top.pressure = \"{load}\"\n{method}"
        )))
    };
    let hp = adaptive("10+40*x", "1+x^2", "method.tolerance = 1e-6\n");
    let mirrored = adaptive("10+40*(2-x)", "1+(2-x)^2", "method.tolerance = 1e-6\n");
    let fine = adaptive("10+40*x", "1+x^2", "method = { refine = \"none\", elements = 96, degree = 5 }\n");
    for (name, other) in [("mirrored", &mirrored), ("fine", &fine)] {
        let (e, f) = (hp.last.energies, other.last.energies);
        let ([a, b], off) = ([&hp, other].map(|run| run.step().estimate()), (f.total - e.total).abs());
        println!("{name}: J {} ± {:e}, {} ± {:e}", a.energy, a.uncertainty, b.energy, b.uncertainty);
        assert!((a.energy - b.energy).abs() <= a.uncertainty + b.uncertainty && off < 2e-8 * e.total.abs());
        close(f.springs, e.springs, 1e-6, name);
        close(f.strain, e.strain, 1e-6, name);
        let ([ax, ay], [bx, by]) = (force(&hp, "floor"), force(other, "floor"));
        let sign = if name == "mirrored" { -1.0 } else { 1.0 };
        assert!((ay - by).abs() < 1e-6 && (ax - sign * bx).abs() < 1e-6, "{ax} {ay}, {bx} {by}");
    }
}

/// With contact: a block pressed on an obstacle that it lifts off in part, with friction, held by springs at its sides. Forces
/// balance, J is that of a fine mesh, and the block is held along what friction does not hold.
#[test]
fn springs_beside_contact() {
    for law in ["", ", friction = { coulomb = \"0.3\" }", ", friction = { tresca = \"0.2\" }"] {
        let text = |method: &str| {
            block(&format!(
                "sides.floor.contact = {{ gap = \"0.02*(x-0.5)^2\"{law} }}\nsides.left.springs = [\"20\", \"1\"]\n\
                 sides.top.traction = [\"0.4\", \"-2\"]\nsides.right.springs = [\"3\", \"0\"]\n{method}"
            ))
        };
        let hp = solved(&text("method.tolerance = 1e-4\n"));
        let fine = solved(&text("method = { refine = \"none\", elements = 240, degree = 2 }\n"));
        let sum = hp.last.reactions.iter().fold([0.0; 2], |s, (_, f)| [s[0] + f[0], s[1] + f[1]]);
        println!("{law}: forces {:?}, {:?}", hp.last.reactions, hp.reason);
        assert!((sum[0] + 0.8).abs() < 1e-9 && (sum[1] - 4.0).abs() < 1e-9, "{sum:?}");
        assert_eq!(hp.reason, Reason::Tolerance);
        let (e, f) = (hp.last.energies, fine.last.energies);
        close(f.total, e.total, 3e-5, "J");
        close(f.springs, e.springs, 1e-3, "springs");
    }
}

/// Coupled with stabilised multipliers and the residual indicator the answers are the same.
#[test]
fn other_multipliers_and_indicators() {
    let text = |method: &str| {
        block(&format!(
            "sides.floor.contact = {{ gap = \"0.02*(x-0.5)^2\" }}\nsides.left.springs = [\"20\", \"1+x\"]\n\
             sides.top.traction = [\"0.4\", \"-2\"]\n{method}"
        ))
    };
    let plain = solved(&text("method.tolerance = 1e-4\n"));
    for method in
        ["tolerance = 1e-3, multiplier = \"stabilised\"", "tolerance = 2e-3, refine = \"h\", indicator = \"residual\""]
    {
        let other = solved(&text(&format!("method = {{ {method} }}\n")));
        assert_eq!(other.reason, Reason::Tolerance);
        close(other.last.energies.total, plain.last.energies.total, 1e-4, method);
        close(force(&other, "left")[0], force(&plain, "left")[0], 1e-3, method);
    }
}

/// Two blocks tied on springs are one; two in contact balance, each held by what is its own.
#[test]
fn several_bodies_on_springs() {
    let two = |law: &str, more: &str| {
        format!(
            "[[body]]\nname = \"low\"\ncorners = [[0,0],[2,0],[2,0.5],[0,0.5]]\nsides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 100.0, poisson = 0.3, plane = \"stress\" }}\n\
             [[body]]\nname = \"high\"\ncorners = [[0,0.5],[2,0.5],[2,1],[0,1]]\nsides = [\"floor\",\"right\",\"top\",\"left\"]\n\
             material = {{ young = 100.0, poisson = 0.3, plane = \"stress\" }}\n\
             [[interface]]\nbetween = [\"low.top\", \"high.floor\"]\n{law}\n\
             [sides.low.floor]\nsprings = \"10*(1+x)\"\n[sides.high.top]\ntraction = [\"1\", \"-1-x\"]\n{more}\n\
             [method]\ntolerance = 1e-5\n"
        )
    };
    let one = solved(&block(
        "sides.floor.springs = \"10*(1+x)\"\nsides.top.traction = [\"1\", \"-1-x\"]\nmethod.tolerance = 1e-6\n",
    ));
    let tied = solved(&two("tied = true", ""));
    close(tied.last.energies.total, one.last.energies.total, 1e-8, "J of tied bodies");
    close(tied.last.energies.springs, one.last.energies.springs, 1e-6, "springs of tied bodies");
    let ([x, y], [a, b]) = (force(&tied, "low.floor"), force(&one, "floor"));
    assert!((x - a).abs() < 1e-8 && (y - b).abs() < 1e-8);
    // without friction the upper one slides: refused by its name, unless springs hold it
    let loose = adapt(&scene(&two("contact = {}", ""))).err().expect("the upper block slides");
    assert!(loose.to_string().contains("high"), "{loose}");
    let held = solved(&two("contact = {}", "[sides.high.left]\nsprings = [\"5\", \"0\"]"));
    let [x, y] = force(&held, "high.left");
    println!("{x} {y}, {:?}", held.reason);
    assert!((x + 2.0).abs() < 1e-9 && y.abs() < 1e-9 && held.reason == Reason::Tolerance);
    let [x, y] = force(&held, "low.floor");
    assert!(x.abs() < 1e-9 && (y - 4.0).abs() < 1e-9);
}

/// Random loads on deterministic springs: u is linear in the load, J quadratic.
#[test]
fn random_loads_on_springs() {
    let text = |load: &str, more: &str| {
        block(&format!(
            "sides.floor.springs = \"10*(1+x)\"\nsides.top.pressure = \"{load}*(1+x)\"\nbody_force.value = [0, \"-{load}\"]\n{more}"
        ))
    };
    let random = summary(&text(
        "p",
        "random.p = { distribution = \"uniform\", low = 1.0, high = 3.0 }\n\
         stochastic.quantities = [\"energy\", \"spring_energy\", \"strain_energy\", \"reactions.floor.y\"]\n",
    ));
    let one = summary(&text("1", ""));
    let json = random.stochastic.expect("statistics");
    let mean = |of: &str| {
        json.pointer(&format!("/{}/mean", of.replace('.', "/")))
            .and_then(serde_json::Value::as_f64)
            .unwrap_or_else(|| panic!("{json}"))
    };
    let square = 4.0 + 1.0 / 3.0;
    close(mean("energy"), one.energy * square, 1e-6, "J");
    close(mean("spring_energy"), one.spring_energy.expect("springs") * square, 1e-6, "springs");
    close(mean("strain_energy"), one.strain_energy * square, 1e-5, "strain");
    close(mean("reactions.floor.y"), one.reactions["floor"][1] * 2.0, 1e-9, "force");
}

/// Random blocks on random springs: forces and moments balance, twice the energies are the work of loads, and J is that of a run with
/// another tolerance.
#[test]
fn random_blocks_on_springs() {
    let seed = std::env::var("PROPTEST_RNG_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(7u64);
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let mut draw = |low: f64, high: f64| random.between(low, high);
    for k in 0..6 {
        let corners: Vec<[f64; 2]> = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]: [f64; 2]| [x + draw(-0.3, 0.3), y + draw(-0.3, 0.3)])
            .into();
        let [a, b, c, d] = [0; 4].map(|_| 10f64.powf(draw(-3.0, 5.0)));
        let (at, px, py) = (draw(0.2, 0.8), draw(-1.0, 1.0), draw(-1.0, 1.0));
        let text = |tolerance: f64| {
            format!(
                "body.corners = {corners:?}\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
                 material = {{ young = 100.0, poisson = 0.3 }}\nbody_force.value = [{py:?}, {px:?}]\n\
                 sides.floor.springs = {{ normal = \"if(s<{at},{a},{b})\", tangential = \"{c}*s\" }}\n\
                 sides.left.springs = [\"{d}\", 0]\nsides.left.pressure = \"s\"\n\
                 sides.top.traction = [\"{px}\", \"{py}*x\"]\nmethod.tolerance = {tolerance:e}\n"
            )
        };
        let (run, finer) = (solved(&text(1e-3)), solved(&text(1e-4)));
        let (e, estimate) = (run.last.energies, run.step().estimate());
        let off = (estimate.energy - finer.step().estimate().energy).abs();
        println!(
            "{k}: k = {a:.1e} {b:.1e} {c:.1e} {d:.1e}, {:?}, J off by {:.1} of its uncertainty",
            run.reason,
            off / estimate.uncertainty
        );
        // the work of body forces is that of tractions on their particular solution, which meshes know to their error
        close(2.0 * (e.strain + e.springs), e.load_work, 1e-5, "load work");
        let sum = ["floor", "left"].map(|side| force(&run, side));
        println!("   {sum:?}");
        assert!(off <= 1.05 * estimate.uncertainty && run.reason == Reason::Tolerance);
    }
}

/// What nothing resists is refused by its motion: springs along x leave a block free along y.
#[test]
fn springs_along_one_direction_leave_the_other() {
    let text = |load: &str| {
        block(&format!(
            "sides.floor.springs = [\"3\", \"0\"]\nsides.left.springs = [\"2\", 0]\nsides.top.traction = {load}\n"
        ))
    };
    let error = adapt(&scene(&text("[0, 1]"))).err().expect("nothing holds it along y");
    assert!(error.to_string().contains("translation along (0, 1)"), "{error}");
    let run = solved(&text("[1, 0]"));
    assert_eq!(run.last.free_motions.len(), 1);
    let sum = ["floor", "left"].map(|side| force(&run, side)[0]);
    assert!((sum[0] + sum[1] + 2.0).abs() < 1e-11, "{sum:?}");
}
