//! V, K, W and M of an L-shaped body, stored in HDF5 and read back. With G(x,y) the displacement at x of a force at y (Kelvin),
//!
//! V φ = ∫ G φ,   K u = ∫ (T_y G)ᵀ u,   W u = -T_x ∫ (T_y G)ᵀ u,   M u = u on the boundary, each against test functions.
//!
//! A rigid motion r has no traction, so that K r = -½ M r and W r = 0 (Hsiao and Wendland, *Boundary Integral Equations*,
//! chapter 2); r = 1 is a translation.

use std::error::Error;

use steklov_bem_operators::{Loop, Mesh, Operators, Polygon, Space};
use steklov_elastic::{Material, Plane};
use steklov_io::{create_atomically, load, open, save};

fn main() -> Result<(), Box<dyn Error>> {
    let corners = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let body = Polygon::new(Loop::straight(corners, vec!["rim".to_owned(); 6]), vec![])?;
    let mesh = Mesh::uniform(&body, 24, 3);
    let space = Space::new(&mesh);
    let operators = Operators::assemble(&mesh, &space, &Material::new(200.0, 0.3, Plane::Strain)?, None)?;

    let folder = tempfile::tempdir()?;
    let path = folder.path().join("operators.h5");
    create_atomically(&path, false, |file| {
        save(file, "mesh", &mesh)?;
        save(file, "operators", &operators)
    })?;
    let file = open(&path)?;
    let stored: Operators = load(&file, "operators")?;
    assert!(stored.v == operators.v && stored.k == operators.k && stored.w == operators.w);
    assert!(stored.mass == operators.mass);

    let (n, size) = (space.dofs(), |a: f64, b: f64| a.max(b.abs()));
    let largest = (0..n * n).map(|i| stored.w[(i / n, i % n)]).fold(0.0, size);
    for (name, [a, b, c]) in [("along x", [1.0, 0.0, 0.0]), ("along y", [0.0, 1.0, 0.0]), ("rotation", [0.0, 0.0, 1.0])]
    {
        let r = space.interpolate(|[x, y]| [a - c * y, b + c * x]);
        let mut sum: Vec<f64> = (0..n).map(|i| (0..n).map(|j| stored.k[(i, j)] * r[j]).sum()).collect();
        stored.mass.iter().for_each(|(m, (i, j))| sum[i] += 0.5 * m * r[j]);
        let of_k = sum.iter().copied().fold(0.0, size);
        let of_w = (0..n).map(|i| (0..n).map(|j| stored.w[(i, j)] * r[j]).sum()).fold(0.0, size);
        println!("{name:8}: |K r + ½ M r| = {of_k:.1e}, |W r| = {of_w:.1e}, entries of W up to {largest:.1}");
        assert!(of_k < 1e-13 && of_w < 1e-12 * largest);
    }
    Ok(())
}
