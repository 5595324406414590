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

#[derive(Clone, Copy)]
enum Shape {
    Lines,
    Arcs,
    Curves,
}

/// Equal elements around a circle, or an ellipse with axes 1.2 : 1.
fn ring(shape: Shape, elements: usize) -> Polygon {
    let mut outline = match shape {
        Shape::Curves => Loop::ellipse([0.0; 2], [1.2, 1.0], 0.0, elements, "rim"),
        _ => Loop::circle([0.0; 2], 1.0, elements, "rim"),
    };
    if let Shape::Lines = shape {
        outline.paths.clear();
    }
    Polygon::new(outline, vec![]).expect("a ring")
}

fn main() {
    let material = Material::new(200.0, 0.3, Plane::Strain).expect("material");
    let threads = rayon::current_num_threads();
    println!("pairs of elements of a ring, {threads} threads: microseconds a pair, columns included");
    for (elements, p) in [(16, 8), (16, 12), (96, 4), (96, 8), (96, 12)] {
        let seconds = [Shape::Lines, Shape::Arcs, Shape::Curves].map(|shape| {
            let mesh = Mesh::uniform(&ring(shape, elements), elements, p);
            let space = Space::new(&mesh);
            seconds(5, || Operators::assemble(&mesh, &space, &material, None).expect("operators"))
        });
        let pairs = (elements * (elements + 1) / 2) as f64;
        let [lines, arcs, curves] = seconds.map(|s| 1e6 * s / pairs);
        println!(
            "  {elements} elements, p = {p}: lines {lines:.2}, arcs {arcs:.2} ({:.1} times), curves {curves:.2} ({:.1} times)",
            arcs / lines,
            curves / lines
        );
    }
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
                    std::hint::black_box(condensation.stiffness().expect("no fault"));
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
