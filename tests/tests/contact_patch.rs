//! Contact of bodies under constant stress: exact for any mesh, degree, shape and Poisson's ratio.

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use steklov_bem_operators::proptest::{loops, star};
use steklov_bem_operators::{Loop, Mesh};
use steklov_contact::ContactError;
use steklov_elastic::{Material, Plane};
use steklov_model::error::SolveError;
use steklov_problem::Scene;
use steklov_tests::{Answer, Case, On, View, answer_on, attempt, parse};

fn scene(case: &Case) -> Scene {
    parse(&case.toml(&View::PLAIN), &[]).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// Young's modulus.
const YOUNG: f64 = 200.0;

/// The field u = A x + b in a body with constant stress.
struct Linear {
    gradient: [[f64; 2]; 2],
    shift: [f64; 2],
    stress: [f64; 3],
}

impl Linear {
    fn new(gradient: [[f64; 2]; 2], shift: [f64; 2], material: &Material) -> Self {
        Self { gradient, shift, stress: material.stress(gradient) }
    }

    fn at(&self, x: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.gradient[i][0] * x[0] + self.gradient[i][1] * x[1] + self.shift[i])
    }

    fn traction(&self, n: [f64; 2]) -> [f64; 2] {
        let [xx, yy, xy] = self.stress;
        [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]]
    }

    /// u·d as an expression.
    fn along(&self, d: [f64; 2]) -> String {
        let part = |j: usize| self.gradient[0][j] * d[0] + self.gradient[1][j] * d[1];
        format!("{:?}*x + {:?}*y + {:?}", part(0), part(1), self.shift[0] * d[0] + self.shift[1] * d[1])
    }

    /// max |A|.
    fn size(&self) -> f64 {
        self.gradient.iter().flatten().fold(0.0, |m: f64, g| m.max(g.abs()))
    }

    /// ½ ∫ σ:ε for a body of the given area.
    fn energy(&self, area: f64) -> f64 {
        let ([[a, b], [c, d]], [xx, yy, xy]) = (self.gradient, self.stress);
        0.5 * area * (xx * a + yy * d + xy * (b + c))
    }
}

/// Normal and tangent of an edge of a loop that has the body to its left.
fn frame(a: [f64; 2], b: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let d = [b[0] - a[0], b[1] - a[1]];
    let l = d[0].hypot(d[1]);
    ([d[1] / l, -d[0] / l], [d[0] / l, d[1] / l])
}

/// Smallest sine of the angle between neighbouring edges.
fn flattest(corners: &[[f64; 2]]) -> f64 {
    let tangents: Vec<[f64; 2]> = (0..corners.len()).map(|k| edge(corners, k)).map(|[a, b]| frame(a, b).1).collect();
    let next = tangents.iter().cycle().skip(1);
    tangents.iter().zip(next).fold(1.0, |m: f64, (s, t)| m.min((s[0] * t[1] - s[1] * t[0]).abs()))
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Lengths (relative) and degrees of the elements of each edge.
type Cuts = Vec<Vec<(f64, usize)>>;

fn cuts(edges: usize) -> impl Strategy<Value = Cuts> {
    use proptest::collection::vec;
    vec(vec((0.3..3.0f64, 1..=6usize), 1..=4), edges)
}

fn mesh(scene: &Scene, cuts: &Cuts) -> Mesh {
    let breaks = |edge: &Vec<(f64, usize)>| {
        let total: f64 = edge.iter().map(|e| e.0).sum();
        let mut s = 0.0;
        let ends = edge[..edge.len() - 1].iter().map(|e| {
            s += e.0 / total;
            s
        });
        ends.collect::<Vec<f64>>()
    };
    let edges = 0..scene.problem.outline.edges().len();
    let breaks: Vec<_> = edges.clone().map(|k| breaks(&cuts[k])).collect();
    let degrees: Vec<Vec<usize>> = edges.map(|k| cuts[k].iter().map(|e| e.1).collect()).collect();
    Mesh::from_breaks(&scene.problem.outline, &breaks, &degrees).expect("rising breaks")
}

/// Largest error of nodal forces, displacements and energies of a patch, relative to the terms that add up to them:
/// rounding of sums over a hundred nodes, in polygons with acute corners (1e-13 is usual).
const PATCH: f64 = 1e-11;

/// All pressures and shears but those at the points `but` are as given, and the judge agrees. A multiplier is a nodal
/// force over a nodal weight, so that at the small end weights of short elements of high degree less is asked of it.
fn uniform(
    a: &Answer,
    field: &Linear,
    pressure: f64,
    shear: f64,
    but: &[[f64; 2]],
    flat: f64,
) -> Result<(), TestCaseError> {
    // at a corner inside the contact boundary two pressures share one force: their normals' sine divides its rounding
    let scale = YOUNG / flat * field.size();
    let (mut stress, mut force) = (0.0f64, 0.0f64);
    for r in &a.rows {
        if but.iter().any(|x| (r.point[0] - x[0]).hypot(r.point[1] - x[1]) < 1e-9) {
            continue;
        }
        let off = (r.pressure - pressure).abs().max((r.shear - shear).abs()) / scale;
        (stress, force) = (stress.max(off), force.max(off * r.weight));
    }
    println!("patch: stress off by {stress:.1e}, nodal force by {force:.1e}, judge {:.1e}", a.judged().1);
    prop_assert!(force <= PATCH && stress <= 100.0 * PATCH, "stress off by {stress:e}, force by {force:e}");
    prop_assert!(a.converged() && a.judged().1 <= 1e-10, "{:?}", a.judged());
    Ok(())
}

fn polygon_and_cuts() -> impl Strategy<Value = (Vec<[f64; 2]>, Cuts)> {
    star([0.2, -0.1], 1.0, 7).prop_flat_map(|corners| {
        let n = corners.len();
        (Just(corners), cuts(n))
    })
}

fn names(n: usize) -> Vec<String> {
    (0..n).map(|k| format!("e{k}")).collect()
}

fn polygon_case(corners: &[[f64; 2]], poisson: f64) -> Case {
    let names = names(corners.len());
    Case::new(corners, &names.iter().map(String::as_str).collect::<Vec<_>>(), poisson)
}

fn edge(corners: &[[f64; 2]], k: usize) -> [[f64; 2]; 2] {
    [corners[k], corners[(k + 1) % corners.len()]]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A floating body under uniform stress, one oblique side on a smooth obstacle that follows its shape: uniform
    /// pressure q, shear 0, strain energy ½ σ:ε |Ω|, whatever mesh, degrees and ν. The free translation along the
    /// obstacle stays at rest.
    #[test]
    fn a_smooth_patch_is_exact(
        (corners, cuts) in polygon_and_cuts(), k in 0..7usize, q in 0.1..10.0f64, along in -10.0..10.0f64,
        turn in -0.1..0.1f64, poisson in -0.8..0.49f64, newton in any::<bool>(),
    ) {
        let k = k % corners.len();
        let [a, b] = edge(&corners, k);
        let (n, t) = frame(a, b);
        // σ = -q nn + s tt; plane strain: ε = (1+ν)/E ((1-ν) σ_nn - ν σ_tt), ...
        let strain = |one: f64, other: f64| (1.0 + poisson) / YOUNG * ((1.0 - poisson) * one - poisson * other);
        let (e_n, e_t) = (strain(-q, along), strain(along, -q));
        let gradient = [0, 1].map(|i| [0, 1].map(|j| e_n * n[i] * n[j] + e_t * t[i] * t[j] + turn * (n[i] * t[j] - t[i] * n[j])));
        let material = Material::new(YOUNG, poisson, Plane::Strain).expect("in range");
        let field = Linear::new(gradient, [0.03, 0.01], &material);
        let mut case = polygon_case(&corners, poisson);
        for (j, name) in names(corners.len()).iter().enumerate() {
            let [x, y] = field.traction({ let [a, b] = edge(&corners, j); frame(a, b).0 });
            case = case.on(name, if j == k { On::smooth(&field.along(n)) } else { On::traction(&format!("{x:?}"), &format!("{y:?}")) });
        }
        let case = case.method(if newton { "solver = \"newton\"" } else { "solver = \"active-set\"" });
        let scene = scene(&case);
        let mesh = mesh(&scene, &cuts);
        let a = answer_on(&scene, mesh);
        uniform(&a, &field, q, 0.0, &[], 1.0)?;
        prop_assert_eq!(a.solved.free_motions.len(), 1);
        let energy = field.energy(scene.problem.outline.area());
        prop_assert!((a.solved.energies.strain - energy).abs() <= PATCH * YOUNG * field.size().powi(2), "{} and {energy}", a.solved.energies.strain);
    }

    /// One side held at a linear displacement (in full, or one component), another one, which may be its neighbour, in
    /// contact with friction, stick or slip: displacement, pressure and shear exact.
    #[test]
    fn a_rough_patch_beside_a_held_side_is_exact(
        (corners, cuts) in polygon_and_cuts(), k in 0..7usize, j in 1..7usize, slips in any::<bool>(), held in 0..3usize,
        gradient in [[-1.0..1.0f64, -1.0..1.0f64], [-1.0..1.0f64, -1.0..1.0f64]], poisson in -0.8..0.49f64, newton in any::<bool>(),
    ) {
        let (k, count) = (k % corners.len(), corners.len());
        let j = (k + 1 + j % (count - 1)) % count;
        let [a, b] = edge(&corners, k);
        let (n, t) = frame(a, b);
        let material = Material::new(YOUNG, poisson, Plane::Strain).expect("in range");
        let gradient = if slips {
            gradient.map(|row| row.map(|g| 0.01 * g))
        } else {
            // one displacement all along the contact side: u = v (x - a)·n
            [0, 1].map(|i| [0, 1].map(|l| (-0.005 * (1.2 + gradient[0][0]) * n[i] + 0.01 * gradient[0][1] * t[i]) * n[l]))
        };
        let mut field = Linear::new(gradient, [0.0; 2], &material);
        let traction = field.traction(n);
        let (pressure, shear) = (-dot(traction, n), -dot(traction, t));
        prop_assume!(pressure > 0.05 && (!slips || shear.abs() > 0.05));
        let (ua, ub) = (field.at(a), field.at(b));
        // slip goes along the shear: u_t at least 0.01 times its sign all along the side
        let lift = if slips { shear.signum() * 0.01 - if shear > 0.0 { dot(ua, t).min(dot(ub, t)) } else { dot(ua, t).max(dot(ub, t)) } } else { -dot(ua, t) };
        let drop = if slips { 0.0 } else { 0.01 - dot(ua, n) };
        field.shift = [0, 1].map(|i| lift * t[i] + drop * n[i]);
        let bound = if slips { shear.abs() } else { 2.0 * shear.abs() + 0.1 };
        let gap = field.along(n);
        let held = if slips { 0 } else { held };
        let mut case = polygon_case(&corners, poisson);
        for (i, name) in names(count).iter().enumerate() {
            let [x, y] = field.traction({ let [a, b] = edge(&corners, i); frame(a, b).0 }).map(|t| format!("{t:?}"));
            let [u, v] = [field.along([1.0, 0.0]), field.along([0.0, 1.0])];
            let condition = match held {
                _ if i == k => On::rough(&gap, &format!("{bound:?}")),
                _ if i != j => On::traction(&x, &y),
                0 => On::held(&u, &v),
                1 => On::Partly([u, "free".into()], ["0".into(), y]),
                _ => On::Partly(["free".into(), v], [x, "0".into()]),
            };
            case = case.on(name, condition);
        }
        let case = case.method(if newton { "solver = \"newton\"" } else { "solver = \"active-set\"" });
        let scene = scene(&case);
        let mesh = mesh(&scene, &cuts);
        let a = match attempt(&scene, mesh) {
            // the one case that has no multiplier: degree 1 between two held ends
            Err(SolveError::Contact(ContactError::Inconsistent { what })) if what.contains("raise its degree") => {
                prop_assert!(cuts[k].len() == 1 && cuts[k][0].1 == 1, "{what}");
                return Ok(());
            }
            other => other.unwrap_or_else(|e| panic!("{e}")),
        };
        // where a held component leaves an oblique contact side's node one direction, its force has one component, which
        // pressure and shear share: only the sum is determined
        let but = if held == 0 { vec![] } else { edge(&corners, j).to_vec() };
        uniform(&a, &field, pressure, shear, &but, 1.0)?;
        let exact = a.solved.space.interpolate(|x| field.at(x));
        let size = exact.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        let off = exact.iter().zip(&a.solved.displacement).fold(0.0, |m: f64, (u, v)| m.max((u - v).abs()));
        prop_assert!(off <= PATCH * size, "off by {off:e} of {size}");
    }

    /// Uniform pressure q all around a body with holes, some of its sides loaded by it and the others, convex and
    /// re-entrant corners and whole loops among them, pressed by obstacles: λ_n = q everywhere.
    #[test]
    fn uniform_compression_by_any_sides_is_exact(
        (outer, holes) in loops(), chosen in proptest::collection::vec(any::<bool>(), 9 + 6 + 6), cuts in cuts(9 + 6 + 6), all in any::<bool>(),
        q in 0.1..10.0f64, poisson in -0.5..0.49f64, newton in any::<bool>(), rough in any::<bool>(),
    ) {
        let material = Material::new(YOUNG, poisson, Plane::Strain).expect("in range");
        let rate = -q / (2.0 * (material.lambda() + material.mu()));
        let field = Linear::new([[rate, 0.0], [0.0, rate]], [0.0; 2], &material);
        let flat = holes.iter().chain([&outer]).fold(1.0, |m: f64, l| m.min(flattest(&l.corners)));
        let mut case = polygon_case(&outer.corners, poisson);
        let mut number = 0;
        let mut contact = 0;
        let mut side = |case: Case, corners: &[[f64; 2]], clockwise: bool, names: &[String]| {
            (0..corners.len()).fold(case, |case, i| {
                let [a, b] = edge(corners, i);
                let (n, _) = if clockwise { frame(a, b) } else { frame(b, a) };
                number += 1;
                let touches = all || chosen[number - 1] || number == 1;
                contact += usize::from(touches);
                // a bound that cannot be reached: symmetric data have no shear, but friction would stop any
                let condition = if rough { On::rough(&field.along(n), "0") } else { On::smooth(&field.along(n)) };
                case.on(&names[i], if touches { condition } else { On::pressure(&format!("{q:?}")) })
            })
        };
        case = side(case, &outer.corners, true, &names(outer.corners.len()));
        for (h, Loop { corners, .. }) in holes.iter().enumerate() {
            let names: Vec<String> = (0..corners.len()).map(|i| format!("h{h}e{i}")).collect();
            let area: f64 = (0..corners.len()).map(|i| { let [a, b] = edge(corners, i); a[0] * b[1] - a[1] * b[0] }).sum();
            case.holes.push(corners.iter().copied().zip(names.iter().cloned()).collect());
            case = side(case, corners, area < 0.0, &names);
        }
        let case = case.method(if newton { "solver = \"newton\"" } else { "solver = \"active-set\"" });
        let scene = scene(&case);
        let mesh = mesh(&scene, &cuts);
        let a = answer_on(&scene, mesh);
        uniform(&a, &field, q, 0.0, &[], flat)?;
        let energy = field.energy(scene.problem.outline.area());
        prop_assert!((a.solved.energies.strain - energy).abs() <= PATCH * YOUNG * field.size().powi(2), "{} and {energy}, {contact} in contact", a.solved.energies.strain);
    }
}
