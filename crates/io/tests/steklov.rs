//! Spaces, Steklov-Poincaré matrices and condensations come back with the same bits, satisfy the formulas in the file,
//! and are refused when damaged.

use crate::common::{
    bits, check_damage_is_refused, check_round_trip, dense_bits, place, python, stored_twice, written,
};
use faer::{Col, Mat, Scale};
use proptest::prelude::*;
use steklov_algebra::Cholesky;
use steklov_bem_operators::{Condensation, Domain, Loop, Mesh, Operators, Partition, Polygon, Space, Steklov};
use steklov_elastic::{Material, Plane};
use steklov_io::*;

fn ring(corners: &[[f64; 2]]) -> Loop {
    Loop::straight(corners.to_vec(), vec!["all".to_owned(); corners.len()])
}

/// The boundary of a body for a domain: a trapezium of some size with a hole, or without a hole if the body is outside
/// of it, or the plane around a triangle. It is cut into elements of two degrees.
fn mesh(size: f64, domain: Domain, parts: usize, degree: usize) -> Mesh {
    let outer: Vec<[f64; 2]> = [[0.0, 0.0], [1.0, 0.1], [0.9, 1.0], [0.0, 1.0]].map(|x| x.map(|x| size * x)).to_vec();
    let inner: Vec<[f64; 2]> = [[0.3, 0.3], [0.4, 0.7], [0.6, 0.3]].map(|x| x.map(|x| size * x)).to_vec();
    let polygon = match domain {
        Domain::Interior => Polygon::new(ring(&outer), vec![ring(&inner)]),
        Domain::BoundedAtInfinity => Polygon::outside(vec![ring(&inner)]),
        _ => Polygon::new(ring(&outer), vec![]),
    };
    let polygon = polygon.unwrap();
    let mesh = Mesh::uniform(&polygon, parts, degree);
    let marked: Vec<bool> = (0..mesh.len()).map(|e| e % 3 == 0).collect();
    mesh.raised(&marked)
}

fn operators(mesh: &Mesh) -> Operators {
    let material = Material::new(200.0, 0.3, Plane::Strain).unwrap();
    Operators::assemble(mesh, &Space::new(mesh), &material, None).unwrap()
}

/// A nodal vector without a pattern.
fn field(n: usize, seed: usize) -> Vec<f64> {
    (0..n).map(|i| ((i * i + 7 * seed + 3) as f64).sin()).collect()
}

const DOMAINS: [Domain; 4] =
    [Domain::Interior, Domain::Exterior, Domain::BoundedAtInfinity, Domain::ExteriorBoundedAtInfinity];

/// Largest difference over the largest entry of the second.
fn apart(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    assert_eq!((a.nrows(), a.ncols()), (b.nrows(), b.ncols()));
    (a - b).norm_max() / b.norm_max()
}

/// S of the operators by different algebra from that of `steklov-bem-operators`.
fn by_hand(operators: &Operators, domain: Domain) -> Mat<f64> {
    let sign = if matches!(domain, Domain::Interior | Domain::BoundedAtInfinity) { 1.0 } else { -1.0 };
    let mut h = Mat::from_fn(operators.k.nrows(), operators.k.ncols(), |i, j| sign * operators.k[(i, j)]);
    operators.mass.iter().for_each(|(value, (i, j))| h[(i, j)] += 0.5 * value);
    let s = &operators.w + h.transpose() * Cholesky::new(operators.v.as_ref()).unwrap().solve(h.as_ref());
    if matches!(domain, Domain::Interior | Domain::Exterior) {
        return s;
    }
    let ones = Mat::from_fn(s.nrows(), 2, |i, j| if i % 2 == j { 1.0 } else { 0.0 });
    let moved = &s * &ones;
    let resistance = ones.transpose() * &moved;
    &s - &moved * Cholesky::new(resistance.as_ref()).unwrap().solve(moved.transpose())
}

/// Some unknowns kept, some held at values, two nodes turned.
fn partition(n: usize, kept: usize) -> Partition {
    let (c, s) = (0.3f64.cos(), 0.3f64.sin());
    let kept: Vec<usize> = (0..kept).map(|k| 2 * (kept - k) + k % 2).collect();
    let held = [(n - 1, 0.25), (n - 2, -0.0), (n / 4 * 2, 1e-3), (n / 4 * 2 + 1, 0.1)]
        .into_iter()
        .filter(|(dof, _)| !kept.contains(dof))
        .collect();
    Partition { kept, held, frames: vec![(1, [[c, s], [-s, c]]), (n / 2 - 1, [[s, -c], [c, s]])] }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn spaces_matrices_and_condensations(
        size in 1e-3_f64..1e3, parts in 7_usize..12, degree in 1_usize..4, domain in 0_usize..4, kept in 0_usize..7, free: bool,
    ) {
        let mesh = mesh(size, DOMAINS[domain], parts, degree);
        let space = check_round_trip(&Space::new(&mesh));
        prop_assert_eq!((0..mesh.len()).map(|e| space.degree(e)).collect::<Vec<_>>(), mesh.degree.clone());
        prop_assert_eq!(dense_bits(&space.basis(0).differentiation), dense_bits(&Space::new(&mesh).basis(0).differentiation));

        let steklov = Steklov::new(operators(&mesh), DOMAINS[domain]).unwrap();
        let back = stored_twice(&steklov);
        let u = field(space.dofs(), parts);
        prop_assert_eq!(dense_bits(&back.matrix), dense_bits(&steklov.matrix));
        prop_assert_eq!(bits(&back.traction.apply(&u)), bits(&steklov.traction.apply(&u)));
        prop_assert_eq!(bits(&back.traction.at_infinity(&u)), bits(&steklov.traction.at_infinity(&u)));

        let n = space.dofs();
        let motions = if free { vec![space.interpolate(|_| [1.0, 0.0]), space.interpolate(|[x, y]| [-y, x])] } else { vec![] };
        let condensation = Condensation::new(steklov.matrix, &partition(n, kept), &motions).unwrap();
        let back = stored_twice(&condensation);
        let load = field(n, 5);
        let (one, other) = (condensation.load(&load), back.load(&load));
        prop_assert_eq!(bits(&one.kept), bits(&other.kept));
        let v = field(kept, 8);
        prop_assert_eq!(bits(&condensation.expand(&one, &v)), bits(&back.expand(&other, &v)));
        prop_assert_eq!(bits(&condensation.multiply(&u)), bits(&back.multiply(&u)));
        prop_assert_eq!(dense_bits(&condensation.stiffness().unwrap()), dense_bits(&back.stiffness().unwrap()));
    }
}

/// Checks S against the stored V, K, W and M, V against the stored factor, and H against both factors.
#[test]
fn the_matrix_is_that_of_the_stored_operators() {
    let mut worst = [0.0f64; 3];
    for domain in DOMAINS {
        let mesh = mesh(2.0, domain, 9, 2);
        let (_folder, file) = written(|f| {
            save(f, "operators", &operators(&mesh))?;
            save(f, "steklov", &Steklov::new(operators(&mesh), domain).unwrap())
        });
        let stored: Operators = load(&file, "operators").unwrap();
        let steklov: Steklov = load(&file, "steklov").unwrap();
        let s = by_hand(&stored, domain);
        worst[0] = worst[0].max(apart(&steklov.matrix, &s));
        let parts = steklov.traction.parts();
        let p = parts.factor.nrows();
        let l = Mat::from_fn(p, p, |i, j| if i < j { 0.0 } else { parts.factor[(i, j)] });
        worst[1] = worst[1].max(apart(&(&l * l.transpose()), &stored.v));
        // V t = ±H (u - a)
        let u = field(stored.w.nrows(), 2);
        let t = steklov.traction.apply(&u);
        let sign = if matches!(domain, Domain::Interior | Domain::BoundedAtInfinity) { 1.0 } else { -1.0 };
        let a = steklov.traction.at_infinity(&u);
        let moved = Col::from_fn(u.len(), |i| u[i] - a[i % 2]);
        let mut right = &stored.k * &moved * Scale(sign);
        stored.mass.iter().for_each(|(value, (i, j))| right[i] += 0.5 * value * moved[j]);
        let left = &stored.v * Col::from_fn(t.len(), |i| t[i]);
        worst[2] = worst[2].max((&left - &right * Scale(sign)).norm_max() / right.norm_max());
    }
    eprintln!("S {:.1e}, V {:.1e}, V t = H u {:.1e}", worst[0], worst[1], worst[2]);
    assert!(worst.iter().all(|w| *w < 1e-11), "{worst:?}");
}

/// The rows and columns of a matrix.
fn block(s: &Mat<f64>, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) -> Mat<f64> {
    Mat::from_fn(rows.len(), columns.len(), |i, j| s[(rows.start + i, columns.start + j)])
}

/// Checks S_c and the condensed load against the stored S, by another factor.
#[test]
fn what_is_condensed_is_the_schur_complement_of_the_stored_matrix() {
    let mesh = mesh(2.0, Domain::Interior, 9, 2);
    let steklov = Steklov::new(operators(&mesh), Domain::Interior).unwrap();
    let n = steklov.matrix.nrows();
    let condensation = Condensation::new(steklov.matrix, &partition(n, 6), &[]).unwrap();
    let (_folder, file) = written(|f| save(f, "value", &condensation));
    let group = open_group(&file, "value").unwrap();
    let (s, condensed) = (load_dense(&group, "S").unwrap(), load_dense(&group, "condensed").unwrap());
    let lists = ["eliminated", "kept", "held"].map(|name| load_integers(&group, name).unwrap());
    let [r, k] = [lists[0].len(), lists[1].len()];
    let s_rr = block(&s, 0..r, 0..r);
    let s_rk = block(&s, 0..r, r..r + k);
    let factor = Cholesky::new(s_rr.as_ref()).unwrap();
    let by_hand = block(&s, r..r + k, r..r + k) - s_rk.transpose() * factor.solve(s_rk.as_ref());
    let schur = apart(&condensed, &by_hand);

    let (load, held) = (field(n, 4), load_vector(&group, "held_values").unwrap());
    let (nodes, frames) = (load_integers(&group, "frame_nodes").unwrap(), load_points(&group, "frames").unwrap());
    let mut turned = load.clone();
    for (node, d) in nodes.iter().zip(frames.chunks(2)) {
        for (i, d) in d.iter().enumerate() {
            turned[2 * node + i] = d[0] * load[2 * node] + d[1] * load[2 * node + 1];
        }
    }
    let u_h = Mat::from_fn(held.len(), 1, |i, _| held[i]);
    let of = |list: &[usize]| Mat::from_fn(list.len(), 1, |i, _| turned[list[i]]);
    let f_r = of(&lists[0]) - block(&s, 0..r, r + k..n) * &u_h;
    let f_k = of(&lists[1]) - block(&s, r..r + k, r + k..n) * &u_h - s_rk.transpose() * factor.solve(f_r.as_ref());
    let read: Condensation = load_it(&file);
    let kept = read.load(&load).kept;
    let loads = apart(&Mat::from_fn(k, 1, |i, _| kept[i]), &f_k);

    // the displacement of a solution of the condensed system is in equilibrium: S u = f at eliminated and kept unknowns
    let v = Cholesky::new(by_hand.as_ref()).unwrap().solve(f_k.as_ref());
    let u = read.expand(&read.load(&load), &(0..k).map(|i| v[(i, 0)]).collect::<Vec<_>>());
    let forces = read.multiply(&u);
    let free = |dof: &usize| !lists[2].contains(dof) && !nodes.contains(&(dof / 2));
    let rest = (0..n).filter(free).fold(0.0f64, |m, i| m.max((forces[i] - load[i]).abs()));
    eprintln!("S_c {schur:.1e}, condensed load {loads:.1e}, equilibrium {rest:.1e}");
    assert!(schur < 1e-11 && loads < 1e-11 && rest < 1e-9, "{schur:e} {loads:e} {rest:e}");
}

fn load_it<T: Persist>(file: &File) -> T {
    load(file, "value").unwrap()
}

#[test]
fn damaged_files_are_refused() {
    check_damage_is_refused(&Space::new(&mesh(1.0, Domain::Interior, 8, 2)), &["offset", "points"]);
    for domain in DOMAINS {
        let mesh = mesh(1.0, domain, 8, 2);
        let steklov = Steklov::new(operators(&mesh), domain).unwrap();
        check_damage_is_refused(&steklov, &[]);
    }
    let mesh = mesh(1.0, Domain::Interior, 8, 2);
    let steklov = Steklov::new(operators(&mesh), Domain::Interior).unwrap();
    let n = steklov.matrix.nrows();
    let condensation = Condensation::new(steklov.matrix, &partition(n, 5), &[]).unwrap();
    check_damage_is_refused(&condensation, &["held_values"]);
}

/// `read_steklov.py` checks the formulas with numpy.
#[test]
fn numpy_finds_the_formulas() {
    let mesh = mesh(2.0, Domain::Interior, 9, 2);
    let (_folder, path) = place();
    create_atomically(&path, false, |f| {
        save(f, "operators", &operators(&mesh))?;
        let steklov = Steklov::new(operators(&mesh), Domain::Interior).unwrap();
        save(f, "steklov", &steklov)?;
        let n = steklov.matrix.nrows();
        save(f, "condensation", &Condensation::new(steklov.matrix, &partition(n, 6), &[]).unwrap())
    })
    .unwrap();
    python("read_steklov.py", &path);
}
