//! A body cut into subdomains that have the nodes on the cuts in common.

use faer::Mat;
use proptest::prelude::*;
use steklov_bem_operators::{
    Assembly, Continuation, CutPlan, CutRules, Cuts, Domain, Loop, Mark, Mesh, Operators, Partition, Piece, Polygon,
    Space, Steklov, Subdivision, Subdomain, continued_radius,
};
use steklov_elastic::plane::distance;
use steklov_elastic::{Material, Plane, RigidMotion};

type Line = [[f64; 2]; 2];

/// Lines along which a plate of `size` is cut into cells.
fn grid([nx, ny]: [usize; 2], size: [f64; 2]) -> Vec<Line> {
    let x = (1..nx).map(|k| size[0] * k as f64 / nx as f64).map(|x| [[x, -1.0], [x, size[1] + 1.0]]);
    let y = (1..ny).map(|k| size[1] * k as f64 / ny as f64).map(|y| [[-1.0, y], [size[0] + 1.0, y]]);
    x.chain(y).collect()
}

fn plate(size: [f64; 2], holes: Vec<Loop>) -> Polygon {
    let [x, y] = size;
    let corners = vec![[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]];
    let outer = Loop::straight(corners, ["bottom", "right", "top", "left"].map(str::to_owned).to_vec());
    Polygon::new(outer, holes).expect("a plate")
}

/// An orthonormal basis of the rigid motions of nodes.
fn rigid_motions(points: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for r in [RigidMotion::along([1.0, 0.0]), RigidMotion::along([0.0, 1.0]), RigidMotion::about([0.0; 2], 1.0)] {
        let mut r = without(r.nodal(points), &basis);
        let norm = dot(&r, &r).sqrt();
        r.iter_mut().for_each(|v| *v /= norm);
        basis.push(r);
    }
    basis
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A vector without its parts along an orthonormal basis.
fn without(mut v: Vec<f64>, basis: &[Vec<f64>]) -> Vec<f64> {
    for q in basis {
        let part = dot(q, &v);
        v.iter_mut().zip(q).for_each(|(v, q)| *v -= part * q);
    }
    v
}

/// S of a subdomain, with no resistance to rigid motions: nodal values miss a part of rotations on arcs.
fn stiffness(Subdomain { mesh, space, .. }: &Subdomain, material: &Material) -> Mat<f64> {
    let operators = Operators::assemble(mesh, space, material, None).expect("operators");
    let s = Steklov::new(operators, Domain::Interior).expect("S").matrix;
    let basis = rigid_motions(&space.points);
    let projected = |s: &Mat<f64>| -> Mat<f64> {
        let columns: Vec<Vec<f64>> =
            s.col_iter().map(|column| without(column.iter().copied().collect(), &basis)).collect();
        Mat::from_fn(s.nrows(), s.nrows(), |i, j| columns[j][i])
    };
    projected(&projected(&s).transpose().to_owned())
}

/// Equal elements, none longer than `longest`.
fn equal(length: f64, longest: f64, degree: usize) -> Vec<Piece> {
    let n = (length / longest - 1e-9).ceil().max(1.0) as usize;
    let at = |k: usize| k as f64 / n as f64;
    (0..n).map(|k| Piece { start: at(k), end: at(k + 1), degree, mark: Mark::Keep }).collect()
}

/// A body cut along lines, on elements of one degree that are no longer than `longest`.
struct CutBody {
    mesh: Mesh,
    /// Of its boundary.
    space: Space,
    subdomains: Vec<Subdomain>,
    /// All nodes.
    points: Vec<[f64; 2]>,
}

impl CutBody {
    fn new(polygon: &Polygon, lines: &[Line], longest: f64, degree: usize) -> Self {
        Self::with(polygon, lines, longest, degree, |ends| equal(distance(ends[0], ends[1]), longest, degree))
    }

    fn with(
        polygon: &Polygon,
        lines: &[Line],
        longest: f64,
        degree: usize,
        on_cut: impl Fn([[f64; 2]; 2]) -> Vec<Piece>,
    ) -> Self {
        let cuts = Cuts::new(polygon, lines).expect("subdomains");
        let mut subdivision = Subdivision { edges: vec![Vec::new(); polygon.edges().len()] };
        let ends = cuts.ends();
        for (k, (edge, pieces)) in polygon.edges().iter().zip(&mut subdivision.edges).enumerate() {
            let own = ends.iter().filter(|end| end.0 == k).map(|end| end.1);
            let vertices: Vec<f64> = [0.0].into_iter().chain(own).chain([1.0]).collect();
            for part in vertices.windows(2) {
                let along = |s: f64| part[0] + (part[1] - part[0]) * s;
                let length = edge.length() * (part[1] - part[0]);
                let of = |piece: Piece| Piece { start: along(piece.start), end: along(piece.end), ..piece };
                pieces.extend(equal(length, longest, degree).into_iter().map(of));
            }
        }
        let mesh = subdivision.mesh(polygon).expect("a mesh");
        let elements: Vec<Vec<Piece>> = cuts.parts().into_iter().map(on_cut).collect();
        let space = Space::new(&mesh);
        let (subdomains, of_cuts) = cuts.subdomains(&mesh, &space, &elements);
        let points = space.points.iter().chain(&of_cuts.points).copied().collect();
        Self { mesh, space, subdomains, points }
    }

    /// The nodes of all subdomains are at the points of theirs, and the elements of cuts have two of them.
    fn check(&self) {
        for Subdomain { space, nodes, mesh, .. } in &self.subdomains {
            mesh.check().expect("a mesh");
            assert_eq!(space.nodes(), nodes.len());
            for (x, &node) in space.points.iter().zip(nodes) {
                assert!(distance(*x, self.points[node]) < 1e-13, "{x:?} {:?}", self.points[node]);
            }
        }
        let mut of_elements = vec![0; self.subdomains.iter().flat_map(|s| &s.elements).max().unwrap() + 1];
        self.subdomains.iter().flat_map(|s| &s.elements).for_each(|&e| of_elements[e] += 1);
        assert!(of_elements.iter().enumerate().all(|(e, &n)| n == if e < self.mesh.len() { 1 } else { 2 }));
    }

    /// Nodal load of tractions on the boundary that are constant on each element.
    fn load(&self, traction: impl Fn(usize) -> [f64; 2]) -> Vec<f64> {
        let mut load = vec![0.0; 2 * self.points.len()];
        for e in 0..self.mesh.len() {
            let (t, to_legendre) = (traction(e), &self.space.basis(e).to_legendre);
            // the mean of a nodal function is its first Legendre coefficient
            for (j, node) in self.space.element_nodes(e).enumerate() {
                (0..2).for_each(|i| load[2 * node + i] += self.mesh.length(e) * to_legendre[(0, j)] * t[i]);
            }
        }
        load
    }

    fn assembly(&self, material: &Material, partition: &Partition, motions: &[Vec<f64>]) -> Assembly {
        let matrices = self.subdomains.iter().map(|s| stiffness(s, material)).collect();
        let of_bodies: Vec<(usize, Vec<usize>)> = (0..).zip(self.subdomains.iter().map(|s| s.nodes.clone())).collect();
        Assembly::new(matrices, &of_bodies, partition, &[], motions, &[]).expect("a stiffness")
    }

    /// The nodal displacement under a load, nothing held.
    fn solved(&self, material: &Material, load: &[f64]) -> Vec<f64> {
        let assembly = self.assembly(material, &Partition::default(), &rigid_motions(&self.points));
        assembly.expand(&assembly.load_held(load, &[]), &[])
    }
}

/// J = -½ f·u of a plate of cells under tension along x, every edge of the cells in halves.
fn tension([nx, ny]: [usize; 2], polygon: &Polygon, degree: usize) -> f64 {
    let body = CutBody::new(polygon, &grid([nx, ny], [nx as f64, ny as f64]), 0.5, degree);
    body.check();
    let pull = |e: usize| match body.mesh.side_names[body.mesh.side[e]].as_str() {
        "right" => [1.0, 0.0],
        "left" => [-1.0, 0.0],
        _ => [0.0; 2],
    };
    let load = body.load(pull);
    let u = body.solved(&Material::new(1.0, 0.3, Plane::Strain).expect("a material"), &load);
    -0.5 * dot(&load, &u)
}

/// Twenty circular holes of radius .3 in cells of 1: J of finite elements of degree 12 on curved triangles, -19.184560653994 to
/// 4e-12, and that of the same elements by another code of superelements. Degree 10 and 12 are off by 8e-11 and 2e-12.
#[test]
fn twenty_circular_holes_in_cells() {
    let hole = |k: usize| hole([(k % 5) as f64 + 0.5, (k / 5) as f64 + 0.5], 0.3);
    let polygon = plate([5.0, 4.0], (0..20).map(hole).collect());
    for (degree, by_others, to) in
        [(4, -19.182993609117496, 1e-12), (8, -19.184560529312055, 1e-12), (12, -19.184560653953653, 1e-12)]
    {
        let j = tension([5, 4], &polygon, degree);
        assert!((j / by_others - 1.0).abs() < to, "degree {degree}: {j}, {by_others} by others");
    }
    let j = tension([5, 4], &polygon, 13);
    assert!((j / -19.184560653994 - 1.0).abs() < 4e-12, "{j}");
}

/// A hole whose arcs begin at 45 degrees.
fn hole([x, y]: [f64; 2], radius: f64) -> Loop {
    let off = radius * std::f64::consts::FRAC_1_SQRT_2;
    let corners = [[off, off], [-off, off], [-off, -off], [off, -off]].map(|[dx, dy]| [x + dx, y + dy]);
    Loop { corners: corners.to_vec(), ..Loop::circle([x, y], radius, 4, "hole") }
}

/// Cells of one shape are translates of each other wherever their loops begin: they have one S, and an assembly that shares it has
/// the displacement of one that does not. A hole that is smaller by 1e-9 makes another cell.
#[test]
fn translates_have_one_stiffness() {
    let material = Material::new(1.0, 0.3, Plane::Strain).expect("a material");
    let body = |of_last: f64| {
        let radius = |k: usize| if k == 11 { of_last } else { 0.3 };
        let holes = (0..12).map(|k| hole([(k % 4) as f64 + 0.5, (k / 4) as f64 + 0.5], radius(k))).collect();
        CutBody::new(&plate([4.0, 3.0], holes), &grid([4, 3], [4.0, 3.0]), 0.5, 6)
    };
    let first = |body: &CutBody| Subdomain::first_translates(&body.subdomains.iter().collect::<Vec<_>>());
    let other = first(&body(0.3 - 1e-9));
    assert!(other.iter().enumerate().filter(|(k, f)| k == *f).count() == 2, "{other:?}");

    let body = body(0.3);
    assert_eq!(first(&body), [0; 12]);
    let matrices: Vec<Mat<f64>> = body.subdomains.iter().map(|one| stiffness(one, &material)).collect();
    let size = matrices[0].norm_max();
    for s in &matrices {
        assert!((s - &matrices[0]).norm_max() < 1e-12 * size, "{:e}", (s - &matrices[0]).norm_max() / size);
    }
    let pull = |e: usize| match body.mesh.side_names[body.mesh.side[e]].as_str() {
        "right" => [1.0, 0.0],
        "left" => [-1.0, 0.0],
        _ => [0.0; 2],
    };
    let load = body.load(pull);
    let own = body.solved(&material, &load);
    let of_bodies: Vec<(usize, Vec<usize>)> = body.subdomains.iter().map(|one| (0, one.nodes.clone())).collect();
    let motions = rigid_motions(&body.points);
    let shared = Assembly::new(matrices[..1].to_vec(), &of_bodies, &Partition::default(), &[], &motions, &[])
        .expect("a stiffness");
    let shared = shared.expand(&shared.load_held(&load, &[]), &[]);
    let largest = own.iter().fold(0.0f64, |m, u| m.max(u.abs()));
    let off = own.iter().zip(&shared).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(off < 1e-11 * largest, "{off:e} of {largest}");
}

/// The affine displacement of a constant stress, in a plate with square holes cut along random lines: cross points, ends on free
/// and loaded sides and on holes, a cut that ends on another one.
fn patch(lines: &[Line], degree: usize) -> f64 {
    let square = |x: f64, y: f64| {
        let corners = [[-0.2, -0.3], [0.2, -0.3], [0.2, 0.3], [-0.2, 0.3]].map(|[dx, dy]| [x + dx, y + dy]);
        Loop::straight(corners.to_vec(), vec!["hole".into(); 4])
    };
    let polygon = plate([3.0, 2.0], vec![square(0.7, 0.9), square(2.1, 1.1)]);
    let body = CutBody::new(&polygon, lines, 0.4, degree);
    body.check();
    let (sigma, material) = ([[1.0, 0.3], [0.3, -0.4]], Material::new(2.0, 0.3, Plane::Strain).expect("a material"));
    let load = body.load(|e| {
        let n = body.mesh.normal(e, 0.0);
        sigma.map(|row| row[0] * n[0] + row[1] * n[1])
    });
    let u = body.solved(&material, &load);
    let (e, nu) = (2.0, 0.3);
    let strain = [0, 1].map(|i| {
        [0, 1].map(|j| (1.0 + nu) / e * (sigma[i][j] - if i == j { nu * (sigma[0][0] + sigma[1][1]) } else { 0.0 }))
    });
    let exact: Vec<f64> = body.points.iter().flat_map(|x| strain.map(|row| row[0] * x[0] + row[1] * x[1])).collect();
    // up to a rigid motion
    let rest = without(u.iter().zip(&exact).map(|(a, b)| a - b).collect(), &rigid_motions(&body.points));
    let largest = |v: &[f64]| v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    largest(&rest) / largest(&exact)
}

/// 1, 2, 4 and 16 cuts.
#[test]
fn constant_stress_in_subdomains() {
    let across = |x: f64| [[x, -1.0], [x, 3.0]];
    let along = |y: f64| [[-1.0, y], [4.0, y]];
    let t = [[1.4, 1.0], [4.0, 1.0]];
    let mut many: Vec<Line> = (0..10).map(|k| across(0.13 + 0.29 * k as f64)).collect();
    many.extend((0..6).map(|k| along(0.17 + 0.33 * k as f64)));
    for cuts in [
        vec![across(1.4)],
        vec![across(1.4), t],
        vec![across(0.7), across(1.4), along(1.0), [[1.4, 0.2], [4.0, -0.4]]],
        many,
    ] {
        for degree in [1, 3] {
            let error = patch(&cuts, degree);
            assert!(error < 1e-13 * cuts.len().max(4) as f64, "{} cuts, degree {degree}: {error}", cuts.len());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn constant_stress_with_random_cuts(angles in proptest::collection::vec(0.0..3.1f64, 1..5), off in 0.0..1.0f64) {
        let across = |(k, angle): (usize, &f64)| {
            let (sin, cos) = angle.sin_cos();
            let [x, y] = [1.1 + 0.8 * off + 0.07 * k as f64, 0.5 + off];
            [[x - 9.0 * cos, y - 9.0 * sin], [x + 9.0 * cos, y + 9.0 * sin]]
        };
        let cuts: Vec<Line> = angles.iter().enumerate().map(across).collect();
        prop_assert!(patch(&cuts, 2) < 1e-9);
    }
}

/// A cut that ends on a held side: its node is held once, and both sides of the cut together are in equilibrium.
#[test]
fn cuts_on_held_sides() {
    let body = CutBody::new(&plate([2.0, 1.0], Vec::new()), &grid([2, 1], [2.0, 1.0]), 0.5, 3);
    let bottom = |node: usize| body.points[node][1] == 0.0;
    let held: Vec<(usize, f64)> =
        (0..body.points.len()).filter(|&k| bottom(k)).flat_map(|k| [(2 * k, 0.25), (2 * k + 1, 0.0)]).collect();
    let load: Vec<f64> = body.points.iter().flat_map(|x| [0.0, x[1]]).collect();
    let partition = Partition { held: held.clone(), ..Partition::default() };
    let material = Material::new(1.0, 0.3, Plane::Strain).expect("a material");
    let assembly = body.assembly(&material, &partition, &[]);
    let values: Vec<f64> = held.iter().map(|h| h.1).collect();
    let u = assembly.expand(&assembly.load_held(&load, &values), &[]);
    let rest: Vec<f64> = assembly.multiply(&u).iter().zip(&load).map(|(s, f)| s - f).collect();
    assert!((0..rest.len()).filter(|&k| !bottom(k / 2)).all(|k| rest[k].abs() < 1e-11), "{rest:?}");
    assert!(held.iter().all(|&(dof, value)| u[dof] == value));
    // the support carries all of the load
    let sum: f64 = (0..rest.len()).filter(|k| k % 2 == 1).map(|k| rest[k]).sum();
    let applied: f64 = load.iter().sum();
    assert!((sum + applied).abs() < 1e-11 * applied, "{sum} {applied}");
}

/// Elements of a part of a cut by the rules of a plan.
fn by_rules(rules: &CutRules, ends: [[f64; 2]; 2], degree: usize) -> Vec<Piece> {
    let breaks: Vec<f64> = [0.0].into_iter().chain(rules.breaks(ends)).chain([1.0]).collect();
    breaks.windows(2).map(|s| Piece { start: s[0], end: s[1], degree, mark: Mark::Keep }).collect()
}

fn rules_without_contact(circles: Vec<([f64; 2], f64)>, corners: &[[f64; 2]]) -> CutRules {
    CutRules {
        continuation: Continuation { singular: corners.to_vec(), circles },
        graded: corners.to_vec(),
        kept: Vec::new(),
        valleys: Vec::new(),
        peaks: Vec::new(),
        degrees: [8, 10, 6],
        of_corner: 40,
    }
}

/// A plan for a plate with holes: circles by centre and radius, and polygons.
fn planned(
    polygon: &Polygon,
    circles: &[([f64; 2], f64)],
    corners: &[[f64; 2]],
    check: impl Fn(&CutRules, &CutPlan),
) -> CutPlan {
    let [low, high] = [f64::min, f64::max].map(|of| {
        let start = if of(0.0, 1.0) == 0.0 { f64::INFINITY } else { f64::NEG_INFINITY };
        [0, 1].map(|i| polygon.edges()[polygon.loops()[0].clone()].iter().map(|e| e.start[i]).fold(start, of))
    });
    let gap = |&(c, r): &([f64; 2], f64)| {
        let others = circles.iter().filter(|other| other.0 != c).map(|(d, s)| distance(c, *d) - r - s);
        let to_edges = (0..2).flat_map(|i| [c[i] - r - low[i], high[i] - c[i] - r]);
        others.chain(to_edges).fold(f64::INFINITY, f64::min)
    };
    let circles = circles.iter().map(|circle| (circle.0, continued_radius(circle.1, gap(circle)))).collect();
    let rules = rules_without_contact(circles, corners);
    let plan = polygon.plan_cuts(&rules);
    check(&rules, &plan);
    plan
}

/// The plan for twenty circular holes: subdomains of at most 300 unknowns, and J of the plan's cuts by degrees of 14.
#[test]
fn plan_for_twenty_circular_holes() {
    let centres: Vec<[f64; 2]> = (0..20).map(|k| [(k % 5) as f64 + 0.5, (k / 5) as f64 + 0.5]).collect();
    let polygon = plate([5.0, 4.0], centres.iter().map(|&c| Loop::circle(c, 0.3, 4, "hole")).collect());
    let circles: Vec<([f64; 2], f64)> = centres.iter().map(|&c| (c, 0.3)).collect();
    let plan = planned(&polygon, &circles, &[], |rules, plan| {
        let body = CutBody::with(&polygon, &plan.lines, 0.5, 14, |ends| by_rules(rules, ends, 14));
        body.check();
        assert_eq!(body.subdomains.len(), plan.subdomains);
        let pull = |e: usize| match body.mesh.side_names[body.mesh.side[e]].as_str() {
            "right" => [1.0, 0.0],
            "left" => [-1.0, 0.0],
            _ => [0.0; 2],
        };
        let load = body.load(pull);
        let u = body.solved(&Material::new(1.0, 0.3, Plane::Strain).expect("a material"), &load);
        let j = -0.5 * dot(&load, &u);
        assert!((j / -19.184560653994 - 1.0).abs() < 1e-9, "{j}");
    });
    assert!(plan.subdomains >= 8 && plan.unknowns[1] <= 300, "{plan:?}");
    assert!(plan.cost[0] > 10.0 * plan.cost[1], "{plan:?}");
}

/// A plate of equal holes, turned by any angle: few of the subdomains are different, and those that the plan counts as such are those
/// of a mesh.
#[test]
fn plans_for_equal_holes() {
    for angle in [0.0_f64, 0.4] {
        let (sin, cos) = angle.sin_cos();
        let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
        let centres: Vec<[f64; 2]> = (0..40).map(|k| turned([(k % 8) as f64 + 0.5, (k / 8) as f64 + 0.5])).collect();
        let corners = [[0.0, 0.0], [8.0, 0.0], [8.0, 5.0], [0.0, 5.0]].map(turned).to_vec();
        let outer = Loop::straight(corners, vec!["side".to_owned(); 4]);
        let holes = centres.iter().map(|&c| Loop::circle(c, 0.3, 4, "hole")).collect();
        let polygon = Polygon::new(outer, holes).expect("a plate");
        let circles = centres.iter().map(|&c| (c, continued_radius(0.3, 0.4))).collect();
        let rules = rules_without_contact(circles, &[]);
        let plan = polygon.plan_cuts(&rules);
        assert!(3 * plan.different < plan.subdomains && plan.cost[0] > 100.0 * plan.cost[1], "{plan:?}");
        let body = CutBody::with(&polygon, &plan.lines, 0.5, 8, |ends| by_rules(&rules, ends, 8));
        let first = Subdomain::first_translates(&body.subdomains.iter().collect::<Vec<_>>());
        let different = first.iter().enumerate().filter(|(k, first)| k == *first).count();
        assert_eq!(body.subdomains.len(), plan.subdomains);
        assert!(different <= 2 * plan.different, "{different} on a mesh, {} planned", plan.different);
    }
}

/// A floor of asperities: cuts end on it in valleys and nowhere else, and without valleys not at all.
#[test]
fn cuts_end_in_valleys() {
    let polygon = plate([8.0, 2.0], Vec::new());
    let kept = polygon.side_names().iter().position(|name| name == "bottom").expect("a side");
    let at = |k: usize, off: f64| [8.0 * (k as f64 + off) / 40.0, 0.0];
    let peaks: Vec<[f64; 2]> = (0..40).map(|k| at(k, 0.5)).collect();
    let ends = |valleys: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
        let rules = CutRules {
            kept: vec![kept],
            valleys,
            continuation: Continuation { singular: peaks.clone(), circles: Vec::new() },
            peaks: peaks.clone(),
            ..rules_without_contact(Vec::new(), &[])
        };
        let plan = polygon.plan_cuts(&rules);
        plan.lines.into_iter().flatten().filter(|x| x[1].abs() < 1e-9).collect()
    };
    let valleys: Vec<[f64; 2]> = (1..40).map(|k| at(k, 0.0)).collect();
    let found = ends(valleys.clone());
    assert!(found.len() > 5, "{found:?}");
    assert!(found.iter().all(|x| valleys.iter().any(|valley| distance(*x, *valley) < 1e-9)), "{found:?}");
    assert_eq!(ends(Vec::new()), Vec::<[f64; 2]>::new());
}

/// No cuts through a square without holes.
#[test]
fn small_bodies_are_not_cut() {
    let polygon = plate([1.0, 1.0], Vec::new());
    let plan = planned(&polygon, &[], &[], |_, _| {});
    assert!(plan.lines.is_empty() && plan.subdomains == 1 && plan.cost[0] == plan.cost[1], "{plan:?}");
}

/// Centre and radius.
type Circle = ([f64; 2], f64);

/// Circles and polygons that neither touch nor overlap, at random places of a plate of 4 by 4.
fn random_holes(seed: &[f64], most: usize) -> (Vec<Circle>, Vec<Vec<[f64; 2]>>) {
    let (mut circles, mut polygons, mut all) = (Vec::new(), Vec::new(), Vec::<([f64; 2], f64)>::new());
    for x in seed.chunks_exact(5) {
        let r = 0.12 + 0.3 * x[0];
        let c = [1, 2].map(|i| r + 0.08 + (4.0 - 2.0 * r - 0.16) * x[i]);
        if all.len() == most || all.iter().any(|(d, s)| distance(c, *d) < r + s + 0.08) {
            continue;
        }
        all.push((c, r));
        if x[3] < 0.5 {
            circles.push((c, r));
            continue;
        }
        let n = 3 + (4.0 * x[4]) as usize;
        let corner = |k: usize| {
            let (sin, cos) = (7.0 * x[4] + std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
            [c[0] + r * cos, c[1] + r * sin]
        };
        polygons.push((0..n).map(corner).collect());
    }
    (circles, polygons)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Random plates are cut into as many subdomains as the plan tells, at no more cost.
    #[test]
    fn plans_for_random_plates(seed in proptest::collection::vec(0.0..1.0f64, 300), most in 6..25usize) {
        let (circles, polygons) = random_holes(&seed, most);
        let mut holes: Vec<Loop> = circles.iter().map(|&(c, r)| Loop::circle(c, r, 4, "hole")).collect();
        holes.extend(polygons.iter().map(|p| Loop::straight(p.clone(), vec!["hole".into(); p.len()])));
        let polygon = plate([4.0, 4.0], holes);
        let corners: Vec<[f64; 2]> = polygons.concat();
        let plan = planned(&polygon, &circles, &corners, |_, _| {});
        let cuts = Cuts::new(&polygon, &plan.lines).expect("subdomains");
        prop_assert_eq!(cuts.count(), plan.subdomains);
        prop_assert!(plan.cost[1] <= plan.cost[0]);
        prop_assert!(plan.unknowns[1] <= plan.unknowns[0]);
        if plan.unknowns[0] > 3000 {
            prop_assert!(plan.cost[0] > 5.0 * plan.cost[1], "{:?} {:?}", plan.unknowns, plan.cost);
        }
    }
}

/// The Bernstein parameter of an arc of a circle for a point on its ray through the middle, at the distance r from the centre of the
/// circle of radius R: in the angle from there the point is at i ln(R/r), inside and outside alike.
#[test]
fn rho_of_an_arc() {
    let holes = vec![Loop::circle([0.3, -0.2], 0.7, 4, "hole")];
    let corners = vec![[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
    let sides = ["a", "b", "c", "d"].map(str::to_owned).to_vec();
    let polygon = Polygon::new(Loop::straight(corners, sides), holes).unwrap();
    let mesh = Mesh::uniform(&polygon, 24, 1);
    let mut arcs = 0;
    for e in (0..mesh.len()).filter(|&e| !mesh.is_line(e)) {
        let [x, y] = mesh.point(e, 0.0);
        let arm = [(x - 0.3) / 0.7, (y + 0.2) / 0.7];
        let half = mesh.length(e) / 2.0 / 0.7;
        for r in [0.1, 0.4, 1.1, 1.9] {
            let singular = vec![[0.3 + r * arm[0], -0.2 + r * arm[1]]];
            let continuation = Continuation { singular, circles: Vec::new() };
            let height = (0.7f64 / r).ln().abs() / half;
            let exact = height + (1.0 + height * height).sqrt();
            let rho = continuation.rho(&mesh.curve(e));
            assert!((rho / exact - 1.0).abs() < 1e-12, "{e} {r}: {rho} {exact}");
            // an error of 1e-4 needs ρ^(1-p) of it at most
            let p = continuation.degree(&mesh.curve(e), 1e-4) as i32;
            let rho = rho.max(2.5);
            assert!(rho.powi(1 - p) <= 1e-4 * 1.001 && rho.powi(2 - p) > 1e-4, "{p} {rho}");
        }
        arcs += 1;
    }
    assert!(arcs > 3);
}
