//! Every type of the numerics comes back with the same bits, and a file with parts that do not fit is refused.

use crate::common::{check_round_trip, place, spoiled, written};
use faer::Mat;
use proptest::prelude::*;
use steklov_bem_operators::{Cut, Loop, Mesh, Operators, Polygon, Space};
use steklov_contact::proptest::{Friction, mixed};
use steklov_contact::{Condition, ContactNode, Outcome, Problem, Solution, Status, active_set, kkt};
use steklov_elastic::{Material, Plane};
use steklov_io::*;
use steklov_quadrature::{BiorthogonalBasis, LobattoBasis, Rule, Series, gauss_legendre};

fn ring(side: f64, corners: &[[f64; 2]], names: &[&str]) -> Loop {
    Loop::straight(
        corners.iter().map(|c| [side * c[0], side * c[1]]).collect(),
        names.iter().map(|&n| n.to_owned()).collect(),
    )
}

/// A square with a hole, the hole listed in either order.
fn polygon(side: f64, clockwise: bool) -> Polygon {
    let outer = ring(side, &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], &["floor", "right", "top", "links ü"]);
    let mut hole = vec![[0.3, 0.3], [0.6, 0.3], [0.4, 0.7]];
    if clockwise {
        hole.reverse();
    }
    Polygon::new(outer, vec![ring(side, &hole, &["hole", "top", "hole"])]).unwrap()
}

fn mesh() -> Mesh {
    let mesh = Mesh::uniform(&polygon(1.0, false), 9, 2);
    let marked: Vec<bool> = (0..mesh.len()).map(|e| e % 3 == 0).collect();
    mesh.raised(&marked)
}

/// Holes in the plane, several bodies and a medium among them come back unchanged; pieces between cracks are refused.
#[test]
fn polygons_of_media_and_of_several_bodies() {
    let square = |x: f64, y: f64, size: f64, name: &str| {
        let corners = vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]];
        Loop::straight(corners, ["a", "b", "a", name].map(str::to_owned).to_vec())
    };
    let one = || Polygon::new(square(0.0, 0.0, 1.0, "c"), vec![square(0.25, 0.25, 0.5, "b")]).unwrap();
    let plane =
        || Polygon::outside(vec![Loop::circle([5.0, 0.5], 0.7, 4, "rim"), square(-3.0, 0.0, 1.0, "d")]).unwrap();
    let disc = Polygon::new(Loop::circle([5.0, 0.5], 0.7, 3, "rim"), vec![]).unwrap();
    for (polygon, version) in [
        (one(), 1),
        (disc.clone(), 2),
        (plane(), 3),
        (Polygon::assembly(vec![one(), disc.with_body_name("disc")]), 3),
        (Polygon::assembly(vec![one().with_body_name("left"), plane()]), 3),
    ] {
        assert_eq!(Persist::version(&polygon), version);
        let back = check_round_trip(&polygon);
        assert_eq!(back, polygon);
        assert_eq!(back.is_bounded(), polygon.is_bounded());
    }
    let of_nothing = |at: &steklov_io::Group| {
        steklov_io::save_pairs(at, "bodies", &[[0, 3]], &steklov_io::label("1", "loops", &["body", "first, end"]))
    };
    assert!(spoiled(&plane(), "bodies", of_nothing).contains("no loops 0 to 3 of 2"));
    let body = Polygon::new(square(0.0, 0.0, 1.0, "c"), vec![]).unwrap();
    let cut =
        body.cut(&[Cut { ends: [[0.0, 0.5], [1.0, 0.5]], sides: ["lower", "upper"].map(str::to_owned) }]).unwrap();
    let (_folder, path) = place();
    let refused = steklov_io::create_atomically(&path, false, |file| save(file, "pieces", &cut)).unwrap_err();
    assert!(refused.to_string().contains("store the body and its cracks"), "{refused}");
}

/// Two nodes: an ordinary one, and a corner with two conditions.
fn problem() -> Problem {
    let condition = |normal, tangent, bound| Condition {
        normal,
        tangent,
        normal_weight: 0.5,
        tangent_weight: 0.25,
        gap: 0.125,
        slip_offset: -0.0,
        bound,
        coefficient: 0.5,
    };
    let (x, y) = ([1.0, 0.0], [0.0, 1.0]);
    Problem {
        stiffness: Mat::from_fn(4, 4, |i, j| if i == j { 4.0 } else { 1.0 / (1.0 + (i + j) as f64) }).into(),
        load: vec![1.0, -2.0, 0.5, 0.0],
        nodes: vec![
            ContactNode { first: 2, unknowns: 2, conditions: vec![condition(x, y, f64::INFINITY)] },
            ContactNode { first: 0, unknowns: 2, conditions: vec![condition(x, y, 0.3), condition(y, x, 0.0)] },
        ],
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn rules_and_bases(n in 1_usize..20, coefficients in prop::collection::vec(any::<f64>(), 0..30)) {
        let rule = gauss_legendre(n);
        prop_assert_eq!(&check_round_trip(&rule), &rule);
        let series = Series { coefficients };
        check_round_trip(&series);
        let basis = LobattoBasis::new(n);
        check_round_trip(&basis);
        check_round_trip(&BiorthogonalBasis::new(&basis));
    }

    #[test]
    fn bodies_and_materials(side in 1e-6_f64..1e6, clockwise: bool, poisson in -0.99_f64..0.499, strain: bool) {
        let body = polygon(side, clockwise);
        prop_assert_eq!(&check_round_trip(&body), &body);
        let mesh = Mesh::uniform(&body, 20, 3);
        prop_assert_eq!(&check_round_trip(&mesh), &mesh);
        let plane = if strain { Plane::Strain } else { Plane::Stress };
        let material = Material::new(side, poisson, plane).unwrap();
        prop_assert_eq!(check_round_trip(&material), material);
    }

    #[test]
    fn contact(problem in prop_oneof![mixed(8, Friction::Tresca), mixed(8, Friction::Coulomb(2.0))], codes in prop::collection::vec(0_usize..4, 0..20)) {
        check_round_trip(&problem);
        let solution = active_set(&problem, None).unwrap();
        check_round_trip(&solution);
        let audit = kkt(&problem, &solution);
        prop_assert_eq!(check_round_trip(&audit), audit);
        let states = [Status::Apart, Status::Stick, Status::SlipPlus, Status::SlipMinus];
        let outcomes = [Outcome::Converged, Outcome::IterationLimit, Outcome::Diverged];
        check_round_trip(&Solution {
            multipliers: codes.iter().map(|&c| [-0.0, c as f64]).collect(),
            status: codes.iter().map(|&c| states[c]).collect(),
            outcome: outcomes[codes.len() % 3],
            history: vec![f64::NAN, 1e-300],
            ..solution
        });
    }
}

#[test]
fn operators() {
    let mesh = mesh();
    let material = Material::new(200.0, 0.3, Plane::Strain).unwrap();
    let operators = Operators::assemble(&mesh, &Space::new(&mesh), &material, None).unwrap();
    let back = check_round_trip(&operators);
    assert!(back.v == operators.v && back.k == operators.k && back.w == operators.w && back.mass == operators.mass);
}

#[test]
fn another_kind_or_version_is_refused() {
    let rule = gauss_legendre(3);
    let (_folder, file) = written(|f| {
        save(f, "rule", &rule)?;
        let later = create_group(f, "later")?;
        write_text_attribute(&later, "kind", Rule::KIND)?;
        write_integer_attribute(&later, "version", &[i64::from(Rule::VERSION) + 1])?;
        rule.write(&later)
    });
    let error = load::<Series>(&file, "rule").unwrap_err();
    assert!(matches!(&error, IoError::Mismatch { found, .. } if found.contains(Rule::KIND)), "{error}");
    let error = load::<Rule>(&file, "later").unwrap_err();
    assert!(matches!(&error, IoError::Version { object, found: 2, known: 1, .. } if object == "/later"), "{error}");
    assert!(matches!(load::<Rule>(&file, "none"), Err(IoError::Missing { .. })));
    assert!(matches!(load::<Rule>(&file, "rule/points"), Err(IoError::Mismatch { .. })));
    assert_eq!(load::<Rule>(&file, "rule").unwrap(), rule);
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let one = Label { unit: "1", meaning: "wrong", axes: &["entry"] };
    let two = Label { unit: "1", meaning: "wrong", axes: &["entry", "xy"] };
    let integers = |name, v: Vec<usize>| move |g: &Group| save_integers(g, name, &v, &one);
    let vector = |name, v: Vec<f64>| move |g: &Group| save_vector(g, name, &v, &one);
    let square = |name, n| move |g: &Group| save_dense(g, name, Mat::zeros(n, n).as_ref(), &two);

    let rule = gauss_legendre(3);
    assert!(spoiled(&rule, "weights", vector("weights", vec![1.0])).contains("1 entries where 3"));
    assert!(spoiled(&rule, "degree", integers("degree", vec![])).contains("one degree"));
    let basis = LobattoBasis::new(2);
    assert!(spoiled(&basis, "degree", integers("degree", vec![3])).contains("degree 3"));
    assert!(spoiled(&basis, "to_legendre", square("to_legendre", 2)).contains("3×3"));
    let dual = BiorthogonalBasis::new(&basis);
    assert!(spoiled(&dual, "coefficients", square("coefficients", 1)).contains("1×1"));

    let body = polygon(1.0, true);
    let pairs = |name, v: Vec<[usize; 2]>| move |g: &Group| save_pairs(g, name, &v, &two);
    assert!(spoiled(&body, "loops", pairs("loops", vec![[0, 99]])).contains("/value/loops"));
    assert!(spoiled(&body, "loops", pairs("loops", vec![])).contains("there is none"));
    assert!(spoiled(&body, "side", integers("side", vec![9; 7])).contains("/value/side"));
    assert!(spoiled(&body, "corners", |g| save_points(g, "corners", &[[0.0; 2]; 7], &two)).contains("/value/corners"));

    let mesh = mesh();
    let n = mesh.len();
    let mut open_chain: Vec<[usize; 2]> = (0..n).map(|e| [e, mesh.next[e]]).collect();
    open_chain[1] = open_chain[0];
    assert!(spoiled(&mesh, "elements", pairs("elements", open_chain)).contains("element 1 starts"));
    let short = (0..n).map(|e| [e, 0]).collect();
    assert!(spoiled(&mesh, "elements", pairs("elements", short)).contains("loop"));
    assert!(spoiled(&mesh, "degree", integers("degree", vec![0; n])).contains("degree 0"));
    assert!(spoiled(&mesh, "side", integers("side", vec![77; n])).contains("side 77"));
    assert!(spoiled(&mesh, "span", |g| save_points(g, "span", &[], &two)).contains("spans"));

    let material = Material::new(200.0, 0.3, Plane::Stress).unwrap();
    assert!(spoiled(&material, "poisson", vector("poisson", vec![0.5])).contains("Poisson"));
    assert!(spoiled(&material, "plane", |g| save_text(g, "plane", "strains", "wrong")).contains("strains"));

    let operators = Operators::assemble(&mesh, &Space::new(&mesh), &material, None).unwrap();
    assert!(spoiled(&operators, "K", square("K", 3)).contains("/value/K"));
    assert!(spoiled(&operators, "V", |g| save_dense(g, "V", Mat::zeros(2, 3).as_ref(), &two)).contains("square"));
    assert!(spoiled(&operators, "M", |g| save_sparse(g, "M", &crate::common::sparse(3, 3), &two)).contains("/value/M"));

    let problem = problem();
    check_round_trip(&problem);
    assert!(spoiled(&problem, "stiffness", square("stiffness", 3)).contains("4×4"));
    assert!(spoiled(&problem, "first", integers("first", vec![3, 0])).contains("unknown 4"));
    assert!(spoiled(&problem, "first", integers("first", vec![i64::MAX as usize, 0])).contains("beyond 4"));
    assert!(spoiled(&problem, "unknowns", integers("unknowns", vec![3, 2])).contains("3 unknowns"));
    assert!(spoiled(&problem, "unknowns", integers("unknowns", vec![2])).contains("/value/unknowns"));
    assert!(spoiled(&problem, "conditions", integers("conditions", vec![1, 1])).contains("/value/normal"));
    assert!(spoiled(&problem, "conditions", integers("conditions", vec![2, 2])).contains("/value/conditions"));
    assert!(spoiled(&problem, "gap", vector("gap", vec![0.0; 2])).contains("/value/gap"));
    assert!(spoiled(&problem, "bound", vector("bound", vec![-1.0; 3])).contains("bound"));
    let solution = active_set(&problem, None).unwrap();
    assert!(spoiled(&solution, "status", integers("status", vec![0, 0, 4])).contains("4 is no status"));
    assert!(spoiled(&solution, "status", integers("status", vec![0, 0])).contains("2 entries"));
    assert!(spoiled(&solution, "iterations", integers("iterations", vec![])).contains("one number"));
    assert!(spoiled(&solution, "outcome", |g| save_text(g, "outcome", "lost", "wrong")).contains("lost"));
}
