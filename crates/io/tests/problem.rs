//! Problems and methods come back with the same bits and the same meaning, and are refused when damaged.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::{check_damage_is_refused, check_round_trip, spoiled, stored_twice, written};
use steklov_bem_operators::{Loop, Path, Polygon};
use steklov_contact::{MultiplierDegree, MultiplierMesh};
use steklov_coupling::Radiation;
use steklov_elastic::{Material, Plane};
use steklov_io::*;
use steklov_problem::steklov_expression::{Expression, Profile, Value};
use steklov_problem::*;

fn expression(text: &str) -> Expression {
    let constants = BTreeMap::from([("load".to_owned(), 0.1 + 0.2), ("unused".to_owned(), 1.0)]);
    let knots = |values: [f64; 3]| Arc::new(Profile::new(vec![-2.0, 0.1 + 0.2, 2.0], values.to_vec()).unwrap());
    let smooth = Arc::new(Profile::smooth(vec![-2.0, 0.0, 0.7, 2.0], vec![0.0, 1.0, -1.0, 1.0 / 3.0]).unwrap());
    let profiles = [("rough", knots([0.1, -0.5, 0.25])), ("even", smooth)];
    let profiles = profiles.map(|(name, profile)| (name.to_owned(), profile)).into();
    Expression::with_profiles(text, &constants, &BTreeMap::new(), &profiles).unwrap()
}

fn steel() -> Material {
    Material::new(200.0, 0.3, Plane::Strain).unwrap()
}

fn rectangle([x, y]: [f64; 2], name: &str, third: Path) -> Loop {
    let corners = vec![[x, y], [x + 1.0, y], [x + 1.0, y + 1.0], [x, y + 1.0]];
    let sides = ["bottom", "right", "top", "left"].map(|side| format!("{name}{side}")).to_vec();
    Loop { paths: vec![Path::Line, Path::Line, third, Path::Line], ..Loop::straight(corners, sides) }
}

/// One body with all conditions, springs and Coulomb's law.
fn loaded() -> Problem {
    let outline = Polygon::new(rectangle([0.0, 0.0], "", Path::Arc { opening: 0.3 }), vec![]).unwrap();
    let mut problem = Problem::new(outline, Substance::Homogeneous(steel()));
    let friction = Friction::Coulomb(expression("0.2 + 0*load"));
    problem.touch(0, Contact { gap: expression("0.1*abs(x - 0.5) - load + rough(x)"), friction });
    problem.sides[1].condition = Condition::Traction([expression("load*y + rough(s)*even(y)"), expression("-1e-300")]);
    problem.sides[1].springs = Some(Springs::Normal { normal: expression("3"), tangential: expression("s") });
    let values = [None, Some(expression("x^2"))];
    let traction = Some([expression("sin(pi*x)"), Expression::number(0.0)]);
    problem.sides[2].condition = Condition::Displacement { values, traction };
    problem.sides[3].condition = Condition::Pressure(expression("if(y < 0.5, load, 2)"));
    problem.sides[3].springs = Some(Springs::both(expression("4")));
    problem.bodies[0].force = Some([expression("0"), expression("-load")]);
    problem
}

/// Two bodies in contact, one of them tied to a third one with jumps; the second side carries the multipliers.
fn joined() -> Problem {
    let outlines = [([0.0, 0.0], "a."), ([0.0, 1.0], "b."), ([0.0, 2.0], "c.")];
    let outline = outlines.map(|(at, name)| Polygon::new(rectangle(at, name, Path::Line), vec![]).unwrap());
    let bodies = ["a", "b", "c"].map(|name| Body::new(name, Substance::Homogeneous(steel())));
    let mut problem = Problem::of_bodies(Polygon::assembly(outline.to_vec()), bodies.to_vec());
    let side = |name: &str| [problem.side(name).unwrap()];
    let [top, bottom, upper, lowest, highest] = ["a.top", "b.bottom", "b.top", "a.bottom", "c.bottom"].map(side);
    problem.sides[lowest[0]].condition = Condition::held();
    // a side that no interface may have
    problem.sides[1].condition = Condition::Pressure(expression("load"));
    let contact = Contact { gap: Expression::number(0.0), friction: Friction::Tresca(expression("0.3")) };
    problem.join(&top, &bottom, Law::Contact(contact), Some(Place::Second)).unwrap();
    let jump = Some([expression("0.01*x"), Expression::number(0.0)]);
    let tie = Tie { displacement_jump: jump, ..Tie::default() };
    problem.join(&upper, &highest, Law::Tied(tie), None).unwrap().name = "a name of its own".into();
    problem
}

/// A body on a grid in a medium.
fn surrounded(young: CellModuli) -> Problem {
    let outline = Polygon::new(rectangle([-1.0, 2.0], "", Path::Line), vec![]).unwrap();
    let of_unit_modulus = Material::new(1.0, 0.25, Plane::Stress).unwrap();
    let mut problem = Problem::new(
        outline,
        Substance::Cells(Cells { size: 0.25, poisson: Some(young.clone()), young, of_unit_modulus }),
    );
    let basis = BasisInput::Oversampled;
    problem.bodies[0].grid = Some(GridInput { coarse: [2, 4], fine: [6, 3], basis, oversample: Some(1) });
    let remote_stress = [0.0, -1.0, 0.3];
    let far = FarField { remote_stress, at_infinity: Some(Radiation::Bounded), named: true };
    let jumps = [expression("load"), expression("x*y"), expression("0")];
    problem.surround(steel(), far, Tie { stress_jump: Some(jumps), ..Tie::default() }).unwrap();
    problem
}

fn moduli() -> [CellModuli; 3] {
    let values: Arc<[f64]> = (0..16).map(|k| 1.0 + f64::from(k) / 3.0).collect();
    [
        CellModuli::Uniform { low: 1.0, high: 5.0, seed: u64::MAX },
        CellModuli::Table { values, order: TableOrder::Rows, source: "young of moduli.h5".into() },
        CellModuli::Expression(expression("2 + sin(load*x)")),
    ]
}

fn cavity() -> Problem {
    let hole = Loop::straight(vec![[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]], ["a", "b", "c"].map(str::to_owned).to_vec());
    Problem::new(Polygon::outside(vec![hole]).unwrap(), Substance::Homogeneous(steel()))
}

/// A problem as text; its expressions as text, names, values and values at points.
fn said(problem: &Problem) -> String {
    let mut text = format!("{:?}\n", problem.outline);
    let mut bare = problem.clone();
    let mut expressions = Vec::new();
    let mut take = |e: &mut Expression| expressions.push(std::mem::replace(e, Expression::number(0.0)));
    for side in &mut bare.sides {
        match &mut side.condition {
            Condition::Free => {}
            Condition::Traction(pair) => pair.iter_mut().for_each(&mut take),
            Condition::Pressure(q) => take(q),
            Condition::Displacement { values, traction } => {
                values.iter_mut().flatten().chain(traction.iter_mut().flatten()).for_each(&mut take);
            }
        }
        match &mut side.springs {
            None => {}
            Some(Springs::Axes(pair)) => pair.iter_mut().for_each(&mut take),
            Some(Springs::Normal { normal, tangential }) => [normal, tangential].into_iter().for_each(&mut take),
        }
    }
    for law in bare.laws_mut() {
        match law {
            Law::Contact(contact) => {
                take(&mut contact.gap);
                match &mut contact.friction {
                    Friction::None => {}
                    Friction::Tresca(datum) | Friction::Coulomb(datum) => take(datum),
                }
            }
            Law::Tied(tie) => {
                let jumps = tie.displacement_jump.iter_mut().chain(tie.traction_jump.iter_mut()).flatten();
                jumps.chain(tie.stress_jump.iter_mut().flatten()).for_each(&mut take);
            }
        }
    }
    for body in &mut bare.bodies {
        body.force.iter_mut().flatten().for_each(&mut take);
        if let Substance::Cells(Cells { young: CellModuli::Expression(young), .. }) = &mut body.substance {
            take(young);
        }
    }
    text += &format!("{:?}\n{:?}\n{:?}\n", bare.sides, bare.bodies, bare.interfaces());
    for e in expressions {
        let values = [(0.2, 0.7, 0.4), (-1.5, 3.0, 1.0)].map(|(x, y, s)| e.eval(x, y, s));
        let named = |value: &Value| if let Value::Constant(value) = value { *value } else { f64::NAN };
        let of_names: Vec<f64> = e.values().iter().map(named).collect();
        text += &format!("{} {:?} {of_names:?} {values:?}\n", e.text(), e.names());
    }
    text
}

#[test]
fn problems_come_back() {
    let [uniform, table, varying] = moduli();
    let all = [loaded(), joined(), cavity(), surrounded(uniform), surrounded(table), surrounded(varying)];
    for problem in &all {
        let back = stored_twice(problem);
        assert_eq!(said(&back), said(problem));
        assert_eq!(
            Scene::of(back).check().map_err(|e| e.message),
            Scene::of(problem.clone()).check().map_err(|e| e.message)
        );
    }
    assert!(said(&all[0]).contains("0.30000000000000004"));
}

#[test]
fn damaged_problems_are_refused() {
    let numbers = [
        "expressions/values",
        "outline/corners",
        "condition",
        "springs",
        "displacement",
        "traction",
        "stiffness",
        "expressions/profiles/positions",
        "expressions/profiles/values",
        "expressions/profiles/slopes",
    ];
    let material = |k: usize| ["young", "poisson"].map(|name| format!("bodies/{k}/material/{name}"));
    let of_bodies = (0..3).flat_map(material);
    let others =
        ["cells/size", "cells/uniform", "cells/table", "cells/young", "grid/cells", "grid/oversample", "force"];
    let mut free: Vec<String> = numbers.map(str::to_owned).into_iter().chain(of_bodies).collect();
    free.extend(others.map(|name| format!("bodies/0/{name}")));
    free.extend(["far/remote_stress", "force"].map(|name| format!("bodies/1/{name}")));
    free.extend((0..2).flat_map(|k| ["data", "name"].map(|name| format!("interfaces/{k}/{name}"))));
    free.extend((0..3).map(|k| format!("bodies/{k}/name")));
    free.extend(["cells/source", "cells/seed"].map(|name| format!("bodies/0/{name}")));
    let of_ratios = ["uniform", "table", "young", "source", "seed"];
    free.extend(of_ratios.map(|name| format!("bodies/0/cells/poisson/{name}")));
    free.push("outline/path_numbers".into());
    let free: Vec<&str> = free.iter().map(String::as_str).collect();
    let [uniform, table, varying] = moduli();
    for problem in [loaded(), joined(), surrounded(uniform), surrounded(table), surrounded(varying)] {
        let count = check_damage_is_refused(&problem, &free);
        println!("{count} damaged files");
    }
}

#[test]
fn methods_come_back_and_damaged_ones_are_refused() {
    let default = Method::default();
    let all = [
        default,
        Method {
            model: Model::MsfemBem,
            tolerance: Some(1e-5),
            refine: Refine::HpDecay,
            elements: Some(7),
            degree: 3,
            max_dofs: Some(600),
            memory: Some(1 << 40),
            max_steps: 2,
            cuts: Cutting::Auto,
            indicator: Indicator::Residual,
            estimators: true,
            marking: Some(0.5),
            smoothness: 0.1,
            multiplier: Multiplier::Stabilised,
            gamma: Some(1e-3),
            multiplier_mesh: MultiplierMesh::Coarser(3),
            multiplier_degree: MultiplierDegree::Relative(-1),
            solver: Solver::Uzawa,
        },
        Method { multiplier_mesh: MultiplierMesh::Finer(2), multiplier_degree: MultiplierDegree::Fixed(4), ..default },
        Method {
            multiplier_mesh: MultiplierMesh::Shifted,
            multiplier_degree: MultiplierDegree::ContinuousLinear,
            ..default
        },
    ];
    for method in &all {
        assert_eq!(&check_round_trip(method), method);
    }
    let optional = ["tolerance", "marking", "gamma", "elements", "max_dofs", "memory"];
    for name in optional {
        let (_folder, file) = written(|f| {
            save(f, "value", &all[1])?;
            f.group("value").unwrap().unlink(name).unwrap();
            Ok(())
        });
        let back: Method = load(&file, "value").unwrap();
        assert_ne!(back, all[1], "{name}");
    }
    let number =
        |name: &'static str, value: f64| spoiled(&all[1], name, move |at| save_number(at, name, value, "1", "wrong"));
    for (name, value) in [("tolerance", 1.0), ("marking", 0.0), ("smoothness", f64::NAN), ("gamma", f64::INFINITY)] {
        assert!(number(name, value).contains(name), "{name}");
    }
    assert!(number("multiplier_degree", 0.5).contains("no degree"));
    for (name, value) in [("degree", 65), ("elements", 0), ("max_dofs", 0), ("max_steps", 0), ("multiplier_parts", 0)] {
        let wrong = Label { unit: "1", meaning: "wrong", axes: &["value"] };
        assert!(spoiled(&all[1], name, |at| save_integers(at, name, &[value], &wrong)).contains(name), "{name}");
    }
    for name in [
        "model",
        "refine",
        "cuts",
        "indicator",
        "multiplier",
        "solver",
        "estimators",
        "multiplier_mesh",
        "multiplier_kind",
    ] {
        assert!(spoiled(&all[1], name, |at| save_text(at, name, "nothing", "wrong")).contains("nothing"), "{name}");
    }
}

#[test]
fn what_cannot_be_stored_is_refused_by_name() {
    let refused = |problem: &Problem| {
        let (folder, path) = crate::common::place();
        let error = create_atomically(&path, false, |file| save(file, "value", problem)).unwrap_err();
        assert!(!path.exists(), "{}", folder.path().display());
        error.to_string()
    };
    let outline = Polygon::new(rectangle([0.0, 0.0], "", Path::Line), vec![]).unwrap();
    let crack = Crack { side: "crack".into(), points: vec![[0.0, 0.5], [0.5, 0.5]] };
    let cut = cut_by_cracks(&outline, std::slice::from_ref(&crack)).unwrap();
    let mut problem = Problem::new(cut, Substance::Homogeneous(steel()));
    problem.join_cracks(vec![(crack, None)]);
    assert!(refused(&problem).contains("store the body and its cracks"));

    let mut problem = loaded();
    let free = expression("load").with_values(&BTreeMap::from([("load".to_owned(), Value::Free(0))]));
    problem.sides[1].condition = Condition::Pressure(free);
    assert!(refused(&problem).contains("load"));
}
