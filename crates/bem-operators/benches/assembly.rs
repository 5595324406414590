//! Seconds beside error: moments of far pairs, assembly of V, K, W, and the dense algebra that follows.
//!
//! `cargo bench -p steklov-bem-operators --bench assembly`

use std::time::Instant;

use num_complex::Complex64;
use steklov_bem_operators::{
    Condensation, Domain, Loop, Mesh, Operators, PairMoments, Partition, Polygon, Segment, Space, Steklov, far_moments,
};
use steklov_elastic::{Material, Plane};

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn seconds<T>(runs: usize, mut f: impl FnMut() -> T) -> f64 {
    median(
        (0..runs)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(f());
                start.elapsed().as_secs_f64()
            })
            .collect(),
    )
}

/// Pairs of equal elements of a circle-like ring, as far apart as most pairs of a mesh are.
fn far_pairs(count: usize) -> Vec<(Segment, Segment)> {
    let corner = |k: usize| Complex64::from_polar(1.0, std::f64::consts::TAU * k as f64 / 400.0);
    let segment = |k: usize| Segment { start: corner(k), end: corner(k + 1) };
    let pair = |i: usize| PairMoments::new(segment(i % 400), segment((i % 400) + 12 + (i * 7) % 370), 1, 1);
    (0..count).map(pair).map(|pair| (pair.outer, pair.inner)).collect()
}

fn square() -> Polygon {
    let corners = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let sides = ["a", "b", "c", "d"].map(String::from).to_vec();
    Polygon::new(Loop { corners, sides }, vec![]).expect("a square")
}

fn main() {
    println!("far pairs, one core: microseconds a pair, largest error over the block maximum of q");
    for p in [1, 2, 4, 8] {
        let pairs = far_pairs(20_000);
        let mut out = Vec::new();
        let time = seconds(9, || far_moments(&pairs, p, &mut out)) / pairs.len() as f64;
        far_moments(&pairs, p, &mut out);
        let size = out.len() / pairs.len();
        let mut worst: f64 = 0.0;
        for (i, &(a, b)) in pairs.iter().enumerate().step_by(97) {
            let exact = PairMoments::new(a, b, p, p);
            let want: Vec<f64> = exact.l0.iter().copied().chain(exact.q.iter().flat_map(|q| [q.re, q.im])).collect();
            let scale = want.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let got = &out[i * size..];
            worst = got.iter().zip(&want).fold(worst, |m, (g, w)| m.max((g - w).abs() / scale));
        }
        println!("  p = {p}: {:.3} us, error {worst:.1e}", 1e6 * time);
    }

    let material = Material::new(200.0, 0.3, Plane::Strain).expect("material");
    let threads = rayon::current_num_threads();
    println!("square, about 1500 dofs, {threads} threads: assembly of V, K, W and the dense algebra after it, seconds");
    for p in [1, 2, 4, 8] {
        let mesh = Mesh::uniform(&square(), 4 * (1500 / (8 * p)), p);
        let space = Space::new(&mesh);
        let assembly = seconds(7, || Operators::assemble(&mesh, &space, &material, None).expect("operators"));
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        // one side kept (contact), one held
        let mut partition = Partition::default();
        for e in 0..mesh.len() {
            for node in space.element_nodes(e) {
                for dof in [2 * node, 2 * node + 1] {
                    if mesh.side[e] == 0 && !partition.kept.contains(&dof) {
                        partition.kept.push(dof);
                    } else if mesh.side[e] == 2 && !partition.held.iter().any(|h| h.0 == dof) {
                        partition.held.push((dof, 0.0));
                    }
                }
            }
        }
        let dense = median(
            (0..7)
                .map(|_| {
                    let operators = operators.clone();
                    let start = Instant::now();
                    let steklov = Steklov::new(operators, Domain::Interior).expect("S");
                    let condensation = Condensation::new(steklov.matrix, &partition, &[]).expect("condensation");
                    std::hint::black_box(condensation.stiffness());
                    start.elapsed().as_secs_f64()
                })
                .collect(),
        );
        println!(
            "  p = {p}, {} dofs: assembly {assembly:.4}, dense {dense:.4}, ratio {:.2}",
            space.dofs(),
            assembly / dense
        );
    }
}
