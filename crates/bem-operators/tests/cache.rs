//! Moments kept from mesh to mesh: the bits of a run without, whatever the cache has seen.

use std::collections::HashSet;

use crate::common::{L_SHAPE, SQUARE, polygon};
use proptest::collection::vec;
use proptest::prelude::*;
use steklov_bem_operators::proptest::{material, polygon_and_mesh};
use steklov_bem_operators::{
    Bubbles, Enrichment, Grading, Loop, Mark, Mesh, Operators, PairCache, Polygon, Space, Subdivision,
};
use steklov_elastic::{Material, Plane};

type Matrices = (Operators, Enrichment, Bubbles);

fn assembled(mesh: &Mesh, material: &Material, length: Option<f64>, cache: &mut PairCache) -> Matrices {
    let space = Space::new(mesh);
    let operators = Operators::to_enrich(mesh, &space, material, length, cache).expect("operators");
    let length = operators.length;
    let (enrichment, _) = Enrichment::assemble(mesh, &space, material, length, cache).expect("enrichment");
    (operators, enrichment, Bubbles::assemble(mesh, &space, material, length, cache).expect("bubbles"))
}

fn same_bits((a, b, c): &Matrices, (d, e, f): &Matrices) -> bool {
    let base = a.v == d.v && a.k == d.k && a.w == d.w;
    let layers = b.v == e.v && b.k == e.k && b.k_top == e.k_top && b.v_corner == e.v_corner && b.k_corner == e.k_corner;
    base && layers && c.w == f.w && c.w_corner == f.w_corner
}

/// Whether `cache` gives the matrices that an empty one gives, to the bit.
fn changes_no_bit(mesh: &Mesh, material: &Material, length: Option<f64>, cache: &mut PairCache) -> bool {
    let got = assembled(mesh, material, length, cache);
    same_bits(&got, &assembled(mesh, material, length, &mut PairCache::default()))
}

/// Pairs of elements, each with itself too, that two meshes have in common: both have the same ends and the same even
/// order, the first from p + 1 on: 2 for degree 1, 4 for 2 and 3.
fn common_pairs(one: &Mesh, two: &Mesh) -> usize {
    let elements = |mesh: &Mesh| -> HashSet<([[u64; 2]; 2], usize)> {
        (0..mesh.len()).map(|e| (mesh.ends(e).map(|x| x.map(f64::to_bits)), mesh.degree[e] / 2)).collect()
    };
    let n = elements(one).intersection(&elements(two)).count();
    n * (n + 1) / 2
}

/// Marks true are halved, false raised; they are repeated to the end of the mesh.
fn refined(mesh: &Mesh, polygon: &Polygon, marks: &[Option<bool>]) -> Mesh {
    let mark = |m: &Option<bool>| m.map_or(Mark::Keep, |rough| Mark::refine(rough, 1.0));
    let marks: Vec<Mark> = marks.iter().map(mark).cycle().take(mesh.len()).collect();
    Subdivision::new(mesh, &marks).refined_by_mark(&Grading::default()).mesh(polygon).expect("a mesh")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Three meshes, each refined from the one before, in any order, now and then the same one twice.
    #[test]
    fn meshes_in_any_order(
        (polygon, first) in polygon_and_mesh(3),
        marks in [vec(proptest::option::weighted(0.3, any::<bool>()), 1..12), vec(proptest::option::of(any::<bool>()), 1..12)],
        order in vec(0..3usize, 2..6),
        material in material(),
    ) {
        let second = refined(&first, &polygon, &marks[0]);
        let third = refined(&second, &polygon, &marks[1]);
        let meshes = [first, second, third];
        let mut cache = PairCache::default();
        let mut before: Option<&Mesh> = None;
        for k in order {
            prop_assert!(changes_no_bit(&meshes[k], &material, None, &mut cache));
            prop_assert_eq!(cache.reused(), before.map_or(0, |b| common_pairs(b, &meshes[k])));
            before = Some(&meshes[k]);
        }
    }

    /// Moments know neither the material nor the length in log(L/r).
    #[test]
    fn another_material_and_another_length((_, mesh) in polygon_and_mesh(2), two in [material(), material()], ten in -2.0..2.0f64) {
        let mut cache = PairCache::default();
        assembled(&mesh, &two[0], None, &mut cache);
        prop_assert!(changes_no_bit(&mesh, &two[1], Some(mesh.diameter() * 10f64.powf(ten)), &mut cache));
        prop_assert_eq!(cache.reused(), mesh.len() * (mesh.len() + 1) / 2);
    }
}

/// The square and the L have two whole edges in common; a body listed from another corner has its pairs in another order.
#[test]
fn another_body_and_another_first_corner() {
    let material = Material::new(2.5, 0.3, Plane::Strain).expect("valid");
    let mut corners = L_SHAPE.to_vec();
    corners.rotate_left(2);
    let sides = (0..6).map(|k| format!("side{k}")).collect();
    let turned = Polygon::new(Loop::straight(corners, sides), Vec::new()).expect("valid");
    let uneven = |polygon: &Polygon| {
        let edges = polygon.edges().len();
        Mesh::from_breaks(polygon, &vec![vec![0.3, 0.5]; edges], &vec![vec![1, 3, 2]; edges]).expect("a mesh")
    };
    let meshes = [polygon(&L_SHAPE, &[]), turned, polygon(&SQUARE, &[])].map(|p| uneven(&p));
    let mut cache = PairCache::default();
    assembled(&meshes[0], &material, None, &mut cache);
    for (k, common) in [(1, 18), (2, 6), (0, 6), (2, 6), (1, 6)] {
        assert!(changes_no_bit(&meshes[k], &material, None, &mut cache), "mesh {k}");
        assert_eq!(cache.reused(), common * (common + 1) / 2, "mesh {k}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit_of_what_is_kept() {
    let material = Material::new(2.5, 0.3, Plane::Strain).expect("valid");
    let l_shape = polygon(&L_SHAPE, &[]);
    let mesh = Mesh::uniform(&l_shape, 60, 2);
    let finer = refined(&mesh, &l_shape, &[None, Some(true), None, Some(false), None]);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let mut cache = PairCache::default();
            assembled(&mesh, &material, None, &mut cache);
            assert!(changes_no_bit(&finer, &material, None, &mut cache));
            assembled(&finer, &material, None, &mut cache)
        })
    };
    assert!(same_bits(&on(1), &on(4)));
}
