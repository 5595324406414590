//! Rows of the pointwise Steklov-Poincaré trace.

use proptest::prelude::*;
use steklov_bem_operators::proptest::{material, polygon_and_mesh};
use steklov_bem_operators::{BoundaryField, Domain, Operators, Space, Steklov, steklov_trace_rows};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// One field's trace is judged by its own tests; the rows give the same of any displacement.
    #[test]
    fn rows_times_a_displacement_are_its_trace(
        (_, mesh) in polygon_and_mesh(4), material in material(), t in -1.0..1.0f64,
        values in proptest::collection::vec(-1.0..1.0f64, 61),
    ) {
        let space = Space::new(&mesh);
        let operators = Operators::assemble(&mesh, &space, &material, None).expect("operators");
        let length = operators.length;
        let map = Steklov::new(operators, Domain::Interior).expect("V is positive").traction;
        let u: Vec<f64> = (0..space.dofs()).map(|i| values[i % 61] + values[(i / 61) % 61]).collect();
        let field = BoundaryField::new(&mesh, &space, &material, &u, &map.apply(&u), length);
        let points: Vec<(usize, f64)> = (0..mesh.len()).flat_map(|e| [(e, t), (e, -0.999_999)]).collect();
        let rows = steklov_trace_rows(&mesh, &space, &material, &map, &points).expect("no fault");
        prop_assert_eq!((rows.nrows(), rows.ncols()), (2 * points.len(), space.dofs()));
        for (i, &(e, t)) in points.iter().enumerate() {
            let want = field.steklov_trace(e, t);
            for k in 0..2 {
                let (mut got, mut size) = (0.0, 0.0);
                for (j, u) in u.iter().enumerate() {
                    got += rows[(2 * i + k, j)] * u;
                    size += (rows[(2 * i + k, j)] * u).abs();
                }
                prop_assert!((got - want[k]).abs() <= 1e-11 * size, "element {} at {}: {} {}", e, t, got, want[k]);
            }
        }
    }
}
