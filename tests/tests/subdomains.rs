//! Bodies cut into subdomains, with cuts that are given.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use steklov_bem_operators::{Cuts, Loop, Mark, Piece, Polygon, Space, Subdivision, Subdomain};
use steklov_elastic::plane::{distance, dot, norm};
use steklov_elastic::{Material, Plane};
use steklov_expression::Expression;
use steklov_model::error::SolveError;
use steklov_model::estimate::error_estimate::Estimate;
use steklov_model::mesh::layout::{Layout, MeshedCuts};
use steklov_model::run::adaptive_loop::{Progress, Reason, Run, run};
use steklov_model::run::boundary_elements::{BoundaryElements, RefinedMesh};
use steklov_model::solve::solution::Solved;
use steklov_problem::{Condition, Contact, Friction, Refine, Scene, Springs};
use steklov_quadrature::gauss_legendre;

/// Arcs of a circular hole that begin at 45 degrees.
fn hole([x, y]: [f64; 2], radius: f64) -> Loop {
    let off = radius * std::f64::consts::FRAC_1_SQRT_2;
    let corners = [[off, off], [-off, off], [-off, -off], [off, -off]].map(|[dx, dy]| [x + dx, y + dy]);
    Loop { corners: corners.to_vec(), ..Loop::circle([x, y], radius, 4, "hole") }
}

/// A plate of cells with circular holes under tension along x, nothing held.
fn plate([nx, ny]: [usize; 2], holes: Vec<Loop>) -> Scene {
    let [x, y] = [nx as f64, ny as f64];
    let corners = vec![[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]];
    let outer = Loop::straight(corners, ["bottom", "right", "top", "left"].map(str::to_owned).to_vec());
    let polygon = Polygon::new(outer, holes).expect("a plate");
    let mut scene = Scene::new(polygon, Material::new(1.0, 0.3, Plane::Strain).expect("a material"));
    for (side, pull) in [("right", 1.0), ("left", -1.0)] {
        let traction = [pull, 0.0].map(Expression::number);
        scene.problem.side_mut(side).expect("a side").condition = Condition::Traction(traction);
    }
    scene
}

fn in_cells([nx, ny]: [usize; 2]) -> Scene {
    plate([nx, ny], (0..nx * ny).map(|k| hole([(k % nx) as f64 + 0.5, (k / nx) as f64 + 0.5], 0.3)).collect())
}

/// Lines through the plate along all cells.
fn cells([nx, ny]: [usize; 2]) -> Vec<[[f64; 2]; 2]> {
    let x = (1..nx).map(|k| [[k as f64, -1.0], [k as f64, ny as f64 + 1.0]]);
    let y = (1..ny).map(|k| [[-1.0, k as f64], [nx as f64 + 1.0, k as f64]]);
    x.chain(y).collect()
}

fn equal(length: f64, longest: f64, degree: usize) -> Vec<Piece> {
    let n = (length / longest - 1e-9).ceil().max(1.0) as usize;
    let at = |k: usize| k as f64 / n as f64;
    (0..n).map(|k| Piece { start: at(k), end: at(k + 1), degree, mark: Mark::Keep }).collect()
}

/// Solves a scene along lines with elements of degrees `[boundary, cuts]`, no longer than half.
fn solved(scene: &Scene, lines: &[[[f64; 2]; 2]], degrees: [usize; 2]) -> (Solved, Estimate) {
    solved_with(scene, lines, degrees, 0.5)
}

fn solved_with(
    scene: &Scene,
    lines: &[[[f64; 2]; 2]],
    [degree, of_cuts]: [usize; 2],
    longest: f64,
) -> (Solved, Estimate) {
    let outline = &scene.problem.outline;
    let cuts = Cuts::new(outline, lines).expect("subdomains");
    let mut edges: Vec<Vec<Piece>> = Vec::new();
    for (k, edge) in outline.edges().iter().enumerate() {
        let own = cuts.ends().into_iter().filter(|end| end.0 == k).map(|end| end.1);
        let vertices: Vec<f64> = [0.0].into_iter().chain(own).chain([1.0]).collect();
        let of_part = |part: &[f64]| {
            let along = |s: f64| part[0] + (part[1] - part[0]) * s;
            let pieces = equal(edge.length() * (part[1] - part[0]), longest, degree).into_iter();
            pieces.map(|p| Piece { start: along(p.start), end: along(p.end), ..p }).collect::<Vec<Piece>>()
        };
        edges.push(vertices.windows(2).flat_map(of_part).collect());
    }
    let elements = cuts.parts().iter().map(|[a, b]| equal(distance(*a, *b), longest, of_cuts)).collect();
    let cuts = MeshedCuts { cuts: Arc::new(cuts), elements };
    let mut once = scene.clone();
    once.method.refine = Refine::None;
    let next = Layout { subdivision: Subdivision { edges }, tips: Vec::new(), cuts: Some(cuts) };
    let run = attempt(&once, next).expect("a solution");
    let estimate = run.step().estimate().clone();
    (run.last, estimate)
}

fn attempt(scene: &Scene, next: Layout) -> Result<Run<BoundaryElements>, SolveError> {
    run(scene, Progress { steps: Vec::new(), next }, &AtomicUsize::new(0), &mut |_, _| Ok(()))
}

fn close(a: f64, b: f64, to: f64) {
    assert!((a / b - 1.0).abs() < to, "{a} {b}");
}

/// Six circles in cells: J, the energy of the correction and that of the indicators of another code of superelements, which
/// solves the enriched problem without iterations; J of the enriched spaces. The indicators of that code have the part of rotations
/// that elements of degree 6 miss on arcs, 4e-5 of them.
#[test]
fn estimate_of_six_circles_in_cells() {
    let (solved, estimate) = solved(&in_cells([3, 2]), &cells([3, 2]), [6, 6]);
    close(solved.energies.total, -6.237606344925924, 1e-12);
    close(estimate.correction, 0.003630290236295276f64.powi(2), 2e-4);
    let all = estimate.indicators.iter().chain(&estimate.of_cuts);
    close(all.map(|bubble| bubble.total()).sum::<f64>(), 0.004214218126608538f64.powi(2), 8e-5);
    close(estimate.energy, -6.237611418118328, 1e-8);
    assert_eq!(estimate.of_cuts.len(), 14);
}

/// Nine circles by degrees of the cuts along 2 and 4 lines, J of another code; uncut J is -9.100240524708465.
#[test]
fn degrees_of_cuts() {
    let scene = in_cells([3, 3]);
    let x = |x: f64| [[x, -1.0], [x, 4.0]];
    let y = |y: f64| [[-1.0, y], [4.0, y]];
    for (lines, degree, exact) in
        [(vec![x(1.0), y(1.0)], 4, -9.100251410987507), (vec![x(1.0), y(1.0), x(2.0), y(2.0)], 8, -9.100240524971433)]
    {
        let (solved, _) = solved(&scene, &lines, [12, degree]);
        close(solved.energies.total, exact, 1e-10);
    }
}

/// Stresses inside of subdomains, on cuts and at cross points are those of the body without cuts; the largest difference is that of
/// tractions at the ends of elements.
#[test]
fn fields_across_cuts() {
    let scene = in_cells([3, 2]);
    let (cut, _) = solved(&scene, &cells([3, 2]), [12, 12]);
    let (whole, _) = solved(&scene, &[], [12, 12]);
    let strain = |s: &Solved, x: [f64; 2]| s.probe(&scene, x).stress;
    for x in [[1.0, 1.0], [2.0, 0.3], [1.0, 1.7], [0.5, 1.0], [1.02, 0.97], [2.5, 0.1], [0.95, 0.5]] {
        let (a, b) = (strain(&cut, x), strain(&whole, x));
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 4e-5), "{x:?}: {a:?} {b:?}");
    }
    close(cut.energies.total, whole.energies.total, 1e-10);
}

/// Pure bending of a long body, whose displacement is quadratic: the largest error of u_x over the largest displacement, J over
/// its exact value less 1, and the residual. The traction -12 y/H³ makes
/// u_x = -k x y, k = 12 (1-ν²)/H³, and J = -k L/2.
fn bent([length, height]: [f64; 2], subdomains: usize, longest: f64) -> [f64; 3] {
    let h = height / 2.0;
    let corners = vec![[0.0, -h], [length, -h], [length, h], [0.0, h]];
    let sides = ["bottom", "right", "top", "left"].map(str::to_owned).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, sides), Vec::new()).expect("a beam");
    let mut scene = Scene::new(polygon, Material::new(1.0, 0.3, Plane::Strain).expect("a material"));
    let traction = [format!("{:e} * y", -12.0 / height.powi(3)), "0".to_owned()];
    let traction = traction.map(|text| Expression::parse(&text, &Default::default()).expect("an expression"));
    scene.problem.side_mut("right").expect("a side").condition = Condition::Traction(traction);
    let held = Condition::Displacement { values: [Some(Expression::number(0.0)), None], traction: None };
    scene.problem.side_mut("left").expect("a side").condition = held;
    let lines: Vec<[[f64; 2]; 2]> =
        (1..subdomains).map(|k| length * k as f64 / subdomains as f64).map(|x| [[x, -height], [x, height]]).collect();
    let (solved, _) = solved_with(&scene, &lines, [2, 2], longest);
    let k = 12.0 / height.powi(3) * (1.0 - 0.09);
    let points = solved.space.points.iter().enumerate();
    let error = points.fold(0.0f64, |m, (node, [x, y])| m.max((solved.displacement[2 * node] + k * x * y).abs()));
    let exact = -0.5 * 12.0 / height.powi(3) * (1.0 - 0.09) * length;
    [error / (k * length * length / 2.0), solved.energies.total / exact - 1.0, solved.equilibrium]
}

/// Beams of 100 and of 1000 times their thickness: refinement gains the digits that the condition takes, 1e-8 and 6e-5 without.
#[test]
fn digits_of_long_bodies() {
    for (size, subdomains, longest) in [([100.0, 1.0], 20, 1.0), ([1.0, 1e-3], 50, 4e-3)] {
        let [error, energy, equilibrium] = bent(size, subdomains, longest);
        assert!(error < 1e-11, "{size:?}: {error}");
        assert!(energy.abs() < 1e-11, "{size:?}: {energy}");
        assert!(equilibrium < 1e-9, "{size:?}: {equilibrium}");
    }
}

/// A block on a curved obstacle, with and without friction, cut through its zone of contact and beside it: J of the same elements
/// without a cut, the total force, and the largest pressure.
#[test]
fn contact_across_cuts() {
    let number = Expression::number;
    for friction in [Friction::None, Friction::Coulomb(number(0.3))] {
        let mut scene = plate([2, 1], Vec::new());
        for (side, pull) in [("left", 0.0), ("right", 0.0)] {
            scene.problem.side_mut(side).expect("a side").condition =
                Condition::Traction([pull, 0.0].map(Expression::number));
        }
        let held = Condition::Displacement { values: [number(0.0), number(-0.02)].map(Some), traction: None };
        scene.problem.side_mut("top").expect("a side").condition = held;
        let gap = Expression::parse("0.05 * (x - 0.9)^2", &Default::default()).expect("a gap");
        let bottom = scene.problem.side("bottom").expect("a side");
        scene.problem.touch(bottom, Contact { gap, friction });
        let (whole, _) = solved_with(&scene, &[], [10, 10], 0.25);
        let force = |s: &Solved| s.contact.as_ref().expect("contact").force(bottom);
        for (x, to) in [(1.0, 1e-5), (1.75, 1e-6)] {
            let (cut, estimate) = solved_with(&scene, &[[[x, -1.0], [x, 2.0]]], [10, 10], 0.25);
            close(cut.energies.total, whole.energies.total, to);
            close(force(&cut)[1], force(&whole)[1], to);
            assert!(cut.contact.as_ref().expect("contact").converged() && estimate.relative < 0.1);
        }
    }
}

/// What cannot be cut is refused by name.
#[test]
fn cuts_that_are_refused() {
    let scene = in_cells([2, 1]);
    let cuts = Cuts::new(&scene.problem.outline, &cells([2, 1])).expect("subdomains");
    let elements = cuts.parts().iter().map(|[a, b]| equal(distance(*a, *b), 0.5, 3)).collect();
    let mut next = Layout::first(&scene);
    for (edge, s) in cuts.ends() {
        next.subdivision.insert(edge, s, &[], 0.0);
    }
    next.cuts = Some(MeshedCuts { cuts: Arc::new(cuts), elements });
    let refused = |scene: &Scene| attempt(scene, next.clone()).err().expect("no solution").to_string();
    let mut halved = scene.clone();
    halved.method.refine = Refine::H;
    assert!(refused(&halved).contains("2 subdomains cannot have refinement"), "{}", refused(&halved));
    let mut once = scene.clone();
    once.method.refine = Refine::None;
    let mut springs = once.clone();
    springs.problem.side_mut("top").expect("a side").springs = Some(Springs::both(Expression::number(1.0)));
    assert!(refused(&springs).contains("cannot have springs"), "{}", refused(&springs));
    assert!(attempt(&once, next).is_ok());
}

/// Number of subdomains of a mesh none of which is a translate of another one.
fn different_subdomains(RefinedMesh { mesh, cuts, .. }: &RefinedMesh) -> usize {
    let cuts = cuts.as_ref().expect("cuts");
    let (parts, _) = cuts.cuts.subdomains(mesh, &Space::new(mesh), &cuts.elements);
    let first = Subdomain::first_translates(&parts.iter().collect::<Vec<_>>());
    first.iter().enumerate().filter(|(k, first)| k == *first).count()
}

/// The adaptive loop on twenty circles in cells, of which those that are translates of each other stay so: J within what is told of finite elements' on the last step, and the estimate on all
/// steps. The error of displacements raises J and that of tractions lowers it, 2 (J_h - J) = E_u² - E_ψ²; the estimate is that of
/// E_u² + E_ψ², so that E_ψ², known by its indicators, is added twice.
#[test]
fn refinement_of_cuts() {
    let mut scene = in_cells([5, 4]);
    scene.method.tolerance = Some(1e-5);
    let outline = &scene.problem.outline;
    let cuts = Cuts::new(outline, &cells([5, 4])).expect("subdomains");
    let elements = cuts.parts().iter().map(|[a, b]| equal(distance(*a, *b), 0.5, 4)).collect();
    let mut next = Layout::first(&scene);
    for (edge, s) in cuts.ends() {
        next.subdivision.insert(edge, s, &[], 0.0);
    }
    next.subdivision.edges.iter_mut().flatten().for_each(|piece| piece.degree = 4);
    next.cuts = Some(MeshedCuts { cuts: Arc::new(cuts), elements });
    let run = attempt(&scene, next).expect("a solution");
    let (exact, step) = (-19.184560653994, run.step());
    let estimate = step.estimate();
    assert_eq!(run.reason, Reason::Tolerance);
    assert!((estimate.energy - exact).abs() <= estimate.uncertainty, "{estimate:?}");
    for step in &run.progress.steps {
        // cells at the four corners, at the four sides, and inside
        assert!(different_subdomains(&step.layout) <= 9);
        let estimate = step.estimate();
        let all = estimate.indicators.iter().chain(&estimate.of_cuts);
        let of_traction = all.map(|bubble| bubble.traction).sum::<f64>() / estimate.scale.powi(2);
        let squared = 1.0 - step.energy / exact + 2.0 * of_traction;
        let effectivity = estimate.relative / squared.sqrt();
        assert!((0.8..1.3).contains(&effectivity), "{} dofs: {effectivity}", step.dofs);
    }
}

/// ∮ f over the sides between corners; exact for cubic f.
fn around(corners: &[[f64; 2]], f: impl Fn([f64; 2]) -> f64) -> f64 {
    let rule = gauss_legendre(2);
    let side = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        let at = |t: f64| [0, 1].map(|i| 0.5 * ((1.0 - t) * a[i] + (1.0 + t) * b[i]));
        let sum: f64 = rule.points.iter().zip(&rule.weights).map(|(&t, w)| w * f(at(t))).sum();
        sum * distance(a, b) / 2.0
    };
    (0..corners.len()).map(side).sum()
}

/// Of the displacements of a body that nothing holds the one with the smallest ∮|u|² is told, on any mesh and with any cuts: a
/// quadrilateral without symmetries under σ_xx = 1, whose displacement is linear.
#[test]
fn the_rigid_part_of_a_free_body_is_that_of_its_boundary() {
    let corners = vec![[3.0, 1.0], [5.0, 1.5], [4.5, 3.0], [2.5, 1.75]];
    let names = ["a", "b", "c", "d"].map(str::to_owned).to_vec();
    let polygon = Polygon::new(Loop::straight(corners.clone(), names.clone()), Vec::new()).expect("a quadrilateral");
    let mut scene = Scene::new(polygon, Material::new(2.0, 0.3, Plane::Strain).expect("a material"));
    for (k, name) in names.iter().enumerate() {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        let traction = [(b[1] - a[1]) / distance(a, b), 0.0].map(Expression::number);
        scene.problem.side_mut(name).expect("a side").condition = Condition::Traction(traction);
    }
    let mean = |i: usize| around(&corners, |x| x[i]) / around(&corners, |_| 1.0);
    let centre = [mean(0), mean(1)];
    let strained = |x: [f64; 2]| [(1.0 - 0.09) / 2.0 * (x[0] - centre[0]), -0.3 * 1.3 / 2.0 * (x[1] - centre[1])];
    let turn = |x: [f64; 2]| [centre[1] - x[1], x[0] - centre[0]];
    let rotation = around(&corners, |x| dot(strained(x), turn(x))) / around(&corners, |x| dot(turn(x), turn(x)));
    assert!(rotation.abs() > 1e-3, "{rotation}");
    let cut = [[[3.5, 0.0], [3.5, 4.0]]];
    for (lines, degree, longest) in [(&[][..], 2, 0.3), (&[], 5, 10.0), (&cut[..], 4, 0.5)] {
        let (solved, _) = solved_with(&scene, lines, [degree; 2], longest);
        for (x, u) in solved.space.points.iter().zip(solved.displacement.chunks_exact(2)) {
            let (strained, turn) = (strained(*x), turn(*x));
            let off = [0, 1].map(|i| u[i] - strained[i] + rotation * turn[i]);
            assert!(norm(off) < 1e-11, "degree {degree}, {} cuts, at {x:?}: {off:?}", lines.len());
        }
    }
}

/// With holes the displacement with cuts is that without them, as exactly as the meshes are.
#[test]
fn a_free_plate_with_holes_moves_alike_with_and_without_cuts() {
    let scene = plate([3, 1], vec![hole([0.6, 0.5], 0.3), hole([1.5, 0.45], 0.25), hole([2.4, 0.6], 0.2)]);
    let at = |x: [f64; 2], solved: &Solved| {
        let k = solved.space.points.iter().position(|node| distance(*node, x) < 1e-12).expect("a node");
        [solved.displacement[2 * k], solved.displacement[2 * k + 1]]
    };
    let (whole, _) = solved(&scene, &[], [12, 12]);
    let (cut, _) = solved(&scene, &cells([3, 1]), [12, 12]);
    for x in [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]] {
        let (a, b) = (at(x, &whole), at(x, &cut));
        assert!(distance(a, b) < 1e-7 * norm(a), "at {x:?}: {a:?} {b:?}");
    }
}

/// A uniform pressure on all sides and holes, and no load at all: exact on any mesh, and undoubted with cuts too.
#[test]
fn exact_answers_of_subdomains_have_no_doubt() {
    let hexagon = |[x, y]: [f64; 2]| {
        let corner = |k: usize| {
            let (sin, cos) = (-(k as f64) * std::f64::consts::FRAC_PI_3).sin_cos();
            [x + 0.3 * cos, y + 0.3 * sin]
        };
        Loop::straight((0..6).map(corner).collect(), vec!["hole".to_owned(); 6])
    };
    let holes = (0..6).map(|k| hexagon([(k % 3) as f64 + 0.5, (k / 3) as f64 + 0.5])).collect();
    let mut scene = plate([3, 2], holes);
    for pressure in [0.0, 0.4] {
        for side in &mut scene.problem.sides {
            side.condition = Condition::Pressure(Expression::number(pressure));
        }
        let (solved, estimate) = solved(&scene, &cells([3, 2]), [3, 3]);
        // plane strain, E = 1, ν = 0.3: the strain is -p (1 + ν)(1 - 2ν)/E in all directions
        let area = 6.0 * (1.0 - 1.5 * 3f64.sqrt() * 0.09);
        let energy = pressure * pressure * 1.3 * 0.4 * area;
        assert!((solved.energies.strain - energy).abs() <= 1e-12 * energy, "{} {energy}", solved.energies.strain);
        assert!(estimate.relative < 1e-9 && estimate.doubts.is_empty(), "{}: {:?}", estimate.relative, estimate.doubts);
    }
}
