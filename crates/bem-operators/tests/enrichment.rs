//! The enriched matrices against those of the mesh whose degrees are one higher, and the cache against none.

use faer::Mat;
use steklov_bem_operators::{
    Bubbles, Domain, Enriched, EnrichedSteklov, Enrichment, Mesh, Operators, PairCache, Polygon, Raised, Space, Steklov,
};
use steklov_elastic::{Material, Plane};
use steklov_quadrature::legendre_p;

fn l_shape() -> Polygon {
    crate::common::polygon(&[[0.0, 0.0], [0.0, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, 0.0]], &[])
}

fn mixed_mesh() -> Mesh {
    let mesh = Mesh::graded(&l_shape(), &[(0, 0.0), (2, 0.3)], 3, 0.15, |j| 1 + j).expect("a mesh");
    assert!(mesh.degree.contains(&1) && mesh.degree.contains(&4));
    mesh
}

fn material() -> Material {
    Material::new(210.0, 0.3, Plane::Strain).expect("a material")
}

/// Enriched displacement unknowns in terms of the nodal ones of the raised mesh: (N+n)×(N+n).
fn prolongation(space: &Space, raised: &Space) -> Mat<f64> {
    let (n, elements) = (space.dofs(), space.offset.len() - 1);
    let mut t = Mat::zeros(raised.dofs(), n + 2 * elements);
    let mut legendre = [0.0; 16];
    for e in 0..elements {
        let p = space.degree(e);
        let mut phi = vec![0.0; p + 1];
        for (k, node) in raised.element_nodes(e).enumerate() {
            let x = raised.basis(e).nodes[k];
            space.basis(e).evaluate(x, &mut phi);
            legendre_p(x, &mut legendre);
            let bubble = (legendre[p + 1] - legendre[p - 1]) / (2 * p + 1) as f64;
            for i in 0..2 {
                for (j, coarse) in space.element_nodes(e).enumerate() {
                    t[(2 * node + i, 2 * coarse + i)] = phi[j];
                }
                t[(2 * node + i, n + 2 * e + i)] = bubble;
            }
        }
    }
    t
}

/// Traction coefficients in the enriched order: the base, then the top ones.
fn traction_order(space: &Space, raised: &Space) -> Vec<usize> {
    let elements = space.offset.len() - 1;
    let base = (0..elements).flat_map(|e| (0..2 * space.degree(e)).map(move |m| 2 * raised.offset[e] + m));
    let top = (0..elements).flat_map(|e| (0..2).map(move |i| 2 * (raised.offset[e] + space.degree(e)) + i));
    base.chain(top).collect()
}

fn difference(a: &Mat<f64>, b: impl Fn(usize, usize) -> f64) -> f64 {
    let scale = a.norm_max();
    let mut worst: f64 = 0.0;
    for i in 0..a.nrows() {
        for j in 0..a.ncols() {
            worst = worst.max((a[(i, j)] - b(i, j)).abs() / scale);
        }
    }
    worst
}

fn assembled(mesh: &Mesh, cache: &mut PairCache) -> (Operators, Enrichment, Bubbles) {
    let space = Space::new(mesh);
    let operators = Operators::to_enrich(mesh, &space, &material(), None, cache).expect("operators");
    let length = operators.length;
    let (enrichment, _) = Enrichment::assemble(mesh, &space, &material(), length, cache).expect("enrichment");
    (operators, enrichment, Bubbles::assemble(mesh, &space, &material(), length, cache).expect("bubbles"))
}

#[test]
fn the_enriched_matrices_are_those_of_one_degree_more() {
    let mesh = mixed_mesh();
    let raised_mesh = mesh.raised(&vec![true; mesh.len()]);
    let (space, raised) = (Space::new(&mesh), Space::new(&raised_mesh));
    let whole = Operators::assemble(&raised_mesh, &raised, &material(), None).expect("operators");
    let (base, extra, bubbles) = assembled(&mesh, &mut PairCache::default());
    let n = space.dofs();
    let stacked = |a: &Mat<f64>, b: &Mat<f64>| {
        Mat::from_fn(n + b.nrows(), a.ncols(), |i, j| if i < n { a[(i, j)] } else { b[(i - n, j)] })
    };
    let (v_extra, k_extra) = (stacked(&extra.v, &extra.v_corner), stacked(&extra.k, &extra.k_corner));
    let w_extra = stacked(&bubbles.w, &bubbles.w_corner);
    let (t, rows) = (prolongation(&space, &raised), traction_order(&space, &raised));
    let permuted = |a: &Mat<f64>, columns: usize| Mat::from_fn(rows.len(), columns, |i, j| a[(rows[i], j)]);
    let v = Mat::from_fn(rows.len(), rows.len(), |i, j| whole.v[(rows[i], rows[j])]);
    let k = permuted(&whole.k, raised.dofs()) * &t;
    let w = t.transpose() * &whole.w * &t;
    let mut dense = Mat::zeros(raised.dofs(), raised.dofs());
    for (&value, (i, j)) in &whole.mass {
        dense[(i, j)] = value;
    }
    let m = permuted(&dense, raised.dofs()) * &t;

    let of = |a: &Mat<f64>, i: usize, j: usize, full: &Mat<f64>| if j < n { a[(i, j)] } else { full[(i, j - n)] };
    assert!(difference(&v.submatrix(0, 0, n, v.ncols()).to_owned(), |i, j| of(&base.v, i, j, &v_extra)) < 1e-13);
    assert!(difference(&v.submatrix(0, n, v.nrows(), v.ncols() - n).to_owned(), |i, j| v_extra[(i, j)]) < 1e-13);
    assert!(difference(&w.submatrix(0, 0, n, w.ncols()).to_owned(), |i, j| of(&base.w, i, j, &w_extra)) < 1e-12);
    assert!(difference(&w.submatrix(0, n, w.nrows(), w.ncols() - n).to_owned(), |i, j| w_extra[(i, j)]) < 1e-12);
    assert!(difference(&k.submatrix(0, 0, n, k.ncols()).to_owned(), |i, j| of(&base.k, i, j, &k_extra)) < 1e-13);
    let corner = |i: usize, j: usize| if j < n { extra.k_top[(i, j)] } else { k_extra[(n + i, j - n)] };
    assert!(difference(&k.submatrix(n, 0, k.nrows() - n, k.ncols()).to_owned(), corner) < 1e-13);
    let sparse = |a: &sprs::CsMat<f64>, i: usize, j: usize| a.get(i, j).copied().unwrap_or(0.0);
    let mass = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => sparse(&base.mass, i, j),
        (false, true) => sparse(&extra.mass_top, i - n, j),
        (true, false) => sparse(&extra.mass, i, j - n),
        (false, false) => 0.0,
    };
    assert!(difference(&m, mass) < 1e-14);
}

#[test]
fn the_enriched_stiffness_is_that_of_one_degree_more() {
    let mesh = mixed_mesh();
    let raised_mesh = mesh.raised(&vec![true; mesh.len()]);
    let (space, raised) = (Space::new(&mesh), Space::new(&raised_mesh));
    let whole = Operators::assemble(&raised_mesh, &raised, &material(), None).expect("operators");
    let v_whole = whole.v.clone();
    let k_whole = whole.k.clone();
    let whole = Steklov::new(whole, Domain::Interior).expect("S");
    let mut cache = PairCache::default();
    let base = Operators::to_enrich(&mesh, &space, &material(), None, &mut cache).expect("operators");
    let length = base.length;
    let steklov = Steklov::new(base, Domain::Interior).expect("S");
    let enriched =
        EnrichedSteklov::new(&mesh, &space, &material(), length, &steklov.traction, &mut cache, true).expect("S₊");
    let (n, t) = (space.dofs(), prolongation(&space, &raised));
    let s = t.transpose() * &whole.matrix * &t;
    let scale = s.norm_max();
    for j in 0..s.ncols() {
        let unit = |i: usize| if i == j { 1.0 } else { 0.0 };
        let v = Enriched { base: (0..n).map(unit).collect(), extra: (n..s.ncols()).map(unit).collect() };
        let force: Vec<f64> = (0..n).map(|i| if j < n { steklov.matrix[(i, j)] } else { 0.0 }).collect();
        let product = enriched.multiply(&v, &force);
        for (i, value) in product.base.iter().chain(&product.extra).enumerate() {
            assert!((value - s[(i, j)]).abs() < 1e-12 * scale, "{i} {j}: {value} {}", s[(i, j)]);
        }
        if j < n {
            let excess = enriched.excess(&v.base);
            for (i, value) in excess.base.iter().enumerate() {
                assert!((value + force[i] - s[(i, j)]).abs() < 1e-12 * scale);
            }
            for (i, value) in excess.extra.iter().enumerate() {
                assert!((value - s[(n + i, j)]).abs() < 1e-12 * scale);
            }
        }
    }
    for e in 0..mesh.len() {
        let block = enriched.stiffness_block(e);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            assert!((block[i][j] - s[(n + 2 * e + i, n + 2 * e + j)]).abs() < 1e-12 * scale);
        }
    }
    // tractions of the enriched spaces are those of one degree more
    let v = Enriched {
        base: (0..n).map(|i| (0.7 * i as f64).sin()).collect(),
        extra: (n..s.ncols()).map(|i| (1.3 * i as f64).cos()).collect(),
    };
    let found = Raised::new(&mesh, &space, &v, &enriched.traction(&steklov.traction, &v).expect("tractions"));
    let all: Vec<f64> = v.base.iter().chain(&v.extra).copied().collect();
    let nodal: Vec<f64> = (0..raised.dofs()).map(|i| (0..all.len()).map(|j| t[(i, j)] * all[j]).sum()).collect();
    let expected = whole.traction.apply(&nodal);
    let size = expected.iter().fold(0.0f64, |m, r| m.max(r.abs()));
    assert_eq!((&found.mesh.degree, &found.space.offset), (&raised_mesh.degree, &raised.offset));
    for (found, expected) in found.displacement.iter().zip(&nodal) {
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    }
    for (found, expected) in found.traction.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-11 * size, "{found} {expected} of {size}");
    }
    // the residuals of the extra functions, from the raised operators themselves
    let u: Vec<f64> = (0..n).map(|i| (1.7 * i as f64).sin()).collect();
    let psi = steklov.traction.apply(&u);
    let rows = traction_order(&space, &raised);
    let raised_u: Vec<f64> = (0..raised.dofs()).map(|i| (0..n).map(|j| t[(i, j)] * u[j]).sum()).collect();
    let found = enriched.traction_residual(&u);
    let size = found.iter().fold(0.0f64, |m, r| m.max(r.abs()));
    for (x, &row) in rows[n..].iter().enumerate() {
        let mut r: f64 = (0..raised.dofs()).map(|j| k_whole[(row, j)] * raised_u[j]).sum();
        for e in 0..mesh.len() {
            for (a, node) in raised.element_nodes(e).enumerate() {
                let m = space.degree(e);
                if row / 2 == raised.offset[e] + m {
                    let value = mesh.length(e) / (2 * m + 1) as f64 * raised.basis(e).to_legendre[(m, a)];
                    r += 0.5 * value * raised_u[2 * node + row % 2];
                }
            }
        }
        r -= (0..n).map(|j| v_whole[(row, rows[j])] * psi[j]).sum::<f64>();
        assert!((r - found[x]).abs() < 1e-12 * size.max(1.0), "{r} {}", found[x]);
    }
}

#[test]
fn a_cache_changes_no_bit() {
    let mesh = mixed_mesh();
    let mut cache = PairCache::default();
    assembled(&mesh, &mut cache);
    assert_eq!(cache.reused(), 0);
    // one element halved, one degree raised
    let mut marked = vec![false; mesh.len()];
    marked[3] = true;
    let (mut finer, _) = mesh.bisected(&marked);
    finer.degree[7] += 1;
    let (cached, cached_extra, cached_bubbles) = assembled(&finer, &mut cache);
    assert!(cache.reused() > mesh.len() * mesh.len() / 4, "{}", cache.reused());
    let (fresh, fresh_extra, fresh_bubbles) = assembled(&finer, &mut PairCache::default());
    assert!(cached.v == fresh.v && cached.k == fresh.k && cached.w == fresh.w);
    assert!(
        cached_extra.v == fresh_extra.v && cached_extra.k == fresh_extra.k && cached_extra.k_top == fresh_extra.k_top
    );
    assert!(cached_extra.v_corner == fresh_extra.v_corner && cached_extra.k_corner == fresh_extra.k_corner);
    assert!(cached_bubbles.w == fresh_bubbles.w && cached_bubbles.w_corner == fresh_bubbles.w_corner);
}
