//! Seconds of the assembly of V, K, W, and of the dense algebra that follows.
//!
//! `cargo bench -p steklov-bem-operators --bench assembly`

use std::time::Instant;

use steklov_bem_operators::{Condensation, Domain, Loop, Mesh, Operators, Partition, Polygon, Space, Steklov};
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

fn square() -> Polygon {
    let corners = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let sides = ["a", "b", "c", "d"].map(String::from).to_vec();
    Polygon::new(Loop::straight(corners, sides), vec![]).expect("a square")
}

fn main() {
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
