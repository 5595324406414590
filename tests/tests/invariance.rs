//! One scene looked at in turned coordinates and in other units has one dimensionless answer; threads change no bit of
//! V, K and W.

use std::f64::consts::FRAC_PI_2;

use faer::Mat;
use rayon::ThreadPoolBuilder;
use steklov_bem_operators::{Domain, Operators, PairCache, Space, Steklov};
use steklov_model::mesh::first_mesh::first_mesh;
use steklov_model::stage::Stage;
use steklov_tests::{Answer, Case, On, View, answer, parse, point_of, rotated, scene};

const TURN: f64 = 17.0 * std::f64::consts::PI / 180.0;
const VIEWS: [(&str, View); 6] = [
    ("turned by 17 degrees", View { angle: TURN, length: 1.0, stress: 1.0 }),
    ("turned by 90 degrees", View { angle: FRAC_PI_2, length: 1.0, stress: 1.0 }),
    ("in millimetres", View { angle: 0.0, length: 1e3, stress: 1.0 }),
    ("of small length", View { angle: 0.0, length: 1e-6, stress: 1.0 }),
    ("a million times as stiff", View { angle: 0.0, length: 1.0, stress: 1e6 }),
    ("all together", View { angle: TURN, length: 1e3, stress: 1e6 }),
];

/// Largest relative difference of two answers, each quantity by its own scale, after undoing the view.
fn difference(plain: &Answer, seen: &Answer, view: &View, probes: &[[f64; 2]]) -> f64 {
    let mut worst = Worst(0.0);
    let (l, s) = (view.length, view.stress);
    let energies = |a: &Answer, unit: f64| {
        let e = &a.solved.energies;
        [e.total, e.strain, e.load_work, e.friction_work].map(|x| x / unit)
    };
    worst.of(&energies(plain, 1.0), &energies(seen, s * l * l));
    let back = |u: [f64; 2], unit: f64| rotated(u, -view.angle).map(|c| c / unit);
    let nodal = |a: &Answer| a.solved.displacement.as_chunks().0.to_vec();
    let moved: Vec<[f64; 2]> = nodal(seen).into_iter().map(|u| back(u, l)).collect();
    worst.of(nodal(plain).as_flattened(), moved.as_flattened());
    let forces = |a: &Answer, unit: f64, angle: f64| -> Vec<f64> {
        a.solved.reactions.iter().flat_map(|r| rotated(r.1, angle).map(|c| c / unit)).collect()
    };
    worst.of(&forces(plain, 1.0, 0.0), &forces(seen, s * l, -view.angle));
    assert_eq!(plain.rows.len(), seen.rows.len());
    if plain.summary.is_some() {
        let stresses = |a: &Answer, unit: f64| -> Vec<f64> {
            let contact = a.contact();
            let rows = a.rows.iter().flat_map(|r| [r.pressure / unit, r.shear / unit]);
            rows.chain([contact.max_pressure / unit]).collect()
        };
        worst.of(&stresses(plain, 1.0), &stresses(seen, s));
        let lengths =
            |a: &Answer, unit: f64| [a.contact().length, a.contact().stick, a.contact().slip].map(|x| x / unit);
        worst.of(&lengths(plain, 1.0), &lengths(seen, l));
        let status = |a: &Answer| a.rows.iter().map(|r| r.status).collect::<Vec<_>>();
        assert_eq!(status(plain), status(seen), "states of the nodes");
        let iterations = [plain, seen].map(|a| a.judged().0);
        assert!(iterations[0] == iterations[1], "iterations {iterations:?}");
    }
    let (mut u, mut sigma) = (Worst(0.0), Worst(0.0));
    for &x in probes {
        let ((u0, s0), (u1, s1)) = (plain.solved.inside(0, x), seen.solved.inside(0, point_of(view, x)));
        u.of(&u0, &back(u1, l));
        // σ turned back column by column, then row by row
        let columns = [back([s1[0], s1[2]], s), back([s1[2], s1[1]], s)];
        let rows = [
            rotated([columns[0][0], columns[1][0]], -view.angle),
            rotated([columns[0][1], columns[1][1]], -view.angle),
        ];
        sigma.of(&s0, &[rows[0][0], rows[1][1], rows[0][1]]);
    }
    worst.0.max(u.0).max(sigma.0)
}

struct Worst(f64);

impl Worst {
    /// max |a - b| over max |a|.
    fn of(&mut self, a: &[f64], b: &[f64]) {
        let scale = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let off = a.iter().zip(b).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
        self.0 = self.0.max(if scale > 0.0 { off / scale } else { off });
    }
}

/// The case must give one answer in all views, to 1e-10.
fn one_answer(name: &str, case: &Case, probes: &[[f64; 2]]) {
    let solved = |view: &View| {
        let scene = parse(&case.toml(view), &[]).unwrap_or_else(|e| panic!("{}", e.render()));
        answer(&scene)
    };
    let plain = solved(&View::PLAIN);
    for (words, view) in &VIEWS {
        let off = difference(&plain, &solved(view), view, probes);
        println!("{name}, {words}: {off:.1e}");
        assert!(off <= 1e-10, "{name}, {words}: {off:e}");
    }
    // the measure sees a change of one part in a million
    let mut other = case.clone();
    other.young *= 1.0 + 1e-6;
    let scene = parse(&other.toml(&View::PLAIN), &[]).unwrap_or_else(|e| panic!("{}", e.render()));
    let off = difference(&plain, &answer(&scene), &View::PLAIN, probes);
    assert!(off > 1e-8, "{name}: a stiffness of 1 + 1e-6 is seen as {off:e}");
}

fn block() -> Case {
    let side = On::traction("-400*sign(x)*(y+0.5)*(0.5-y)*exp(-10*(y+0.3)^2)", "10*(y+0.5)*(0.5-y)");
    Case::square(0.3)
        .on("floor", On::rough("0", "0.3"))
        .on("left", side.clone())
        .on("right", side)
        .on("top", On::traction("0", "-500*(0.5-x)^2*(0.5+x)^2"))
        .method("elements = 40\ndegree = 2")
}

#[test]
fn a_floating_block_with_friction() {
    one_answer("block", &block(), &[[0.0, 0.0], [0.3, -0.4]]);
}

#[test]
fn a_held_block_on_a_wedge() {
    let case = Case::square(0.3)
        .on("floor", On::rough("abs(x + 0.03)/10 - 0.05", "0.3 + 0.1*x"))
        .on("top", On::held("0.001*y", "0.002*x - 0.001"))
        .on("right", On::pressure("10*(1 + y)"))
        .method("elements = 36\ndegree = 3");
    one_answer("wedge", &case, &[[0.1, 0.0], [0.0, -0.45]]);
}

#[test]
fn a_smooth_heap_under_its_own_weight_in_plane_stress() {
    let corners = [[-0.6, 0.0], [0.7, 0.0], [0.4, 0.8], [-0.2, 0.9]];
    let mut case = Case::new(&corners, &["floor", "right", "top", "wall"], 0.2)
        .on("floor", On::smooth("0.01*x^2"))
        .on("wall", On::held("0", "0"))
        .on("top", On::traction("3*x", "-5"))
        .method("elements = 30\ndegree = 3");
    case.plane_stress = true;
    case.body_force = Some([4.0, -30.0]);
    one_answer("heap", &case, &[[0.0, 0.4], [0.3, 0.2]]);
}

#[test]
fn a_plate_with_a_pin_in_its_hole() {
    let mut case = Case::square(0.25)
        .on("left", On::held("0", "0"))
        .on("right", On::traction("2", "1"))
        .on("hole", On::rough("-0.002 + 0.004*x", "1.5"))
        .method("elements = 44\ndegree = 2\nsolver = \"active-set\"\ncuts = \"none\"");
    let hole = [[-0.15, -0.1], [0.2, -0.12], [0.1, 0.15], [-0.1, 0.2]];
    case.holes.push(hole.iter().map(|x| (*x, "hole".to_owned())).collect());
    one_answer("pin", &case, &[[0.3, 0.3], [-0.3, 0.1]]);
}

#[test]
fn a_bar_without_contact() {
    let mut case = Case::square(0.3)
        .on("left", On::held("0", "0"))
        .on("right", On::traction("if(y > 0.1, 3, 1)", "y"))
        .method("elements = 24\ndegree = 4");
    case.body_force = Some([1.0, 2.0]);
    one_answer("bar", &case, &[[0.0, 0.1]]);
}

fn bits(a: &Mat<f64>) -> Vec<u64> {
    (0..a.ncols()).flat_map(|j| a.col_as_slice(j).iter().map(|x| x.to_bits())).collect()
}

/// V, K and W have the same bits for one, two and three threads; S and J, which go through dense factorisations, agree
/// to 1e-13.
#[test]
fn threads_change_no_bit_of_the_operators() {
    let scene = scene("block-on-floor", &["method.elements=60", "method.degree=4"]);
    let on = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
        pool.install(|| {
            let mesh = first_mesh(&scene);
            let space = Space::new(&mesh);
            let operators = Operators::assemble(&mesh, &space, &scene.body().material(), None).expect("a valid mesh");
            let first = [&operators.v, &operators.k, &operators.w].map(bits);
            let s = Steklov::new(operators, Domain::Interior).expect("V is positive definite").matrix;
            let mut stages = 0;
            let solved = steklov_model::solve::one_mesh::solve(
                &scene,
                (mesh, None),
                true,
                &mut PairCache::default(),
                &mut |stage| {
                    if let Stage::Steklov(_, again) = stage {
                        stages += usize::from(bits(again) == bits(&s));
                    }
                    Ok(())
                },
            );
            let (solved, ..) = solved.unwrap_or_else(|e| panic!("{e}"));
            println!("{threads} threads: S computed twice has the same bits: {}", stages == 1);
            (first, s, solved.energies.total)
        })
    };
    let (operators, s, energy) = on(1);
    for threads in [2, 3] {
        let (o, t, j) = on(threads);
        for (name, (a, b)) in ["V", "K", "W"].iter().zip(operators.iter().zip(&o)) {
            assert!(a == b, "{name} on {threads} threads has other bits");
        }
        let off = (&s - &t).norm_max() / s.norm_max();
        let same = bits(&s) == bits(&t);
        println!("{threads} threads: S off by {off:.1e} (same bits: {same}), J by {:.1e}", (j - energy).abs());
        assert!(off <= 1e-13 && (j - energy).abs() <= 1e-13 * energy.abs(), "{threads}: {off:e}, {j} and {energy}");
    }
}
