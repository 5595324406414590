//! Other programs read the file: h5py, scipy with its layout of sparse matrices, VTK.

use crate::common::{place, python, sparse};
use faer::Mat;
use steklov_io::{
    Label, create_atomically, create_group, save_dense, save_integers, save_points, save_sparse, save_text, save_texts,
    save_vector, vtkhdf, write_integer_attribute, write_text_attribute,
};

/// `read_back.py` knows the same formulas.
#[test]
fn h5py_and_vtk_read_what_was_written() {
    let (_folder, path) = place();
    let entry = Label { unit: "stress", meaning: "pressure λ_n ≥ 0", axes: &["node"] };
    let table = Label { unit: "length", meaning: "points", axes: &["node", "xy"] };
    let field = |name: &str, components: usize, n: usize| vtkhdf::Field {
        name: name.into(),
        unit: "length".into(),
        components,
        values: (0..components * n).map(|i| i as f64 / 8.0).collect(),
    };
    let grid = vtkhdf::Grid {
        points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]],
        lines: vec![[0, 1], [1, 2], [2, 3], [3, 0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        quads: vec![[1, 4, 5, 2]],
        point_data: vec![field("displacement", 3, 6), field("temperature", 1, 6)],
        cell_data: vec![field("von Mises", 1, 7)],
    };
    create_atomically(&path, false, |f| {
        write_text_attribute(f, "program_version", "0.1.0")?;
        write_integer_attribute(f, "threads", &[2])?;
        save_text(f, "scene", "title = \"Größe λ\"\n", "the scene")?;
        let g = create_group(f, "things")?;
        save_vector(&g, "vector", &(0..200_000).map(|i| f64::from(i).sqrt()).collect::<Vec<_>>(), &entry)?;
        save_vector(&g, "empty", &[], &entry)?;
        save_points(&g, "points", &[[0.5, 1.5], [2.5, -3.5], [4.5, f64::INFINITY]], &table)?;
        save_integers(&g, "integers", &[3, 1, 4, 1, 5], &entry)?;
        save_texts(&g, "names", &["floor".into(), "türe".into(), String::new()], "names", "side")?;
        save_dense(&g, "dense", Mat::from_fn(4, 3, |i, j| (10 * i + j) as f64).as_ref(), &table)?;
        save_dense(&g, "no_rows", Mat::zeros(0, 3).as_ref(), &table)?;
        save_sparse(&g, "sparse", &sparse(5, 4), &table)?;
        vtkhdf::write(f, &grid)
    })
    .unwrap();
    assert_eq!(vtkhdf::read(&steklov_io::open(&path).unwrap()).unwrap(), grid);
    python("read_back.py", &path);
}

/// A grid without a body, one without anything, and n × n quadrilaterals over more than one chunk of each array open too.
#[test]
fn vtk_reads_grids_of_one_kind_of_cell_and_without_cells() {
    let line = vtkhdf::Grid { points: vec![[0.0, 0.0], [1.0, 2.0]], lines: vec![[0, 1]], ..vtkhdf::Grid::default() };
    let n = 400;
    let lattice = (0..(n + 1) * (n + 1)).map(|p| [(p % (n + 1)) as f64 / 8.0, (p / (n + 1)) as f64]);
    let first = (0..n * n).map(|c| c / n * (n + 1) + c % n);
    let square = vtkhdf::Grid {
        points: lattice.collect(),
        quads: first.map(|p| [p, p + 1, p + n + 2, p + n + 1]).collect(),
        ..vtkhdf::Grid::default()
    };
    for grid in [line, vtkhdf::Grid::default(), square] {
        let (_folder, path) = place();
        create_atomically(&path, false, |f| vtkhdf::write(f, &grid)).unwrap();
        assert_eq!(vtkhdf::read(&steklov_io::open(&path).unwrap()).unwrap(), grid);
        python("open_grid.py", &path);
    }
}

#[test]
fn a_grid_that_does_not_fit_is_refused() {
    let grid = vtkhdf::Grid { points: vec![[0.0; 2]; 3], triangles: vec![[0, 1, 2]], ..vtkhdf::Grid::default() };
    let field = vtkhdf::Field { name: "f".into(), unit: "1".into(), components: 1, values: vec![1.0; 2] };
    let cases = [
        (vtkhdf::Grid { triangles: vec![[0, 1, 3]], ..grid.clone() }, "point 3 of 3"),
        (vtkhdf::Grid { quads: vec![[0, 1, 2, 3]], ..grid.clone() }, "point 3 of 3"),
        (vtkhdf::Grid { lines: vec![[3, 0]], ..grid.clone() }, "point 3 of 3"),
        (vtkhdf::Grid { point_data: vec![field.clone()], ..grid.clone() }, "2 values for 3"),
        (
            vtkhdf::Grid {
                cell_data: vec![vtkhdf::Field { name: "part".into(), values: vec![1.0], ..field.clone() }],
                ..grid.clone()
            },
            "part",
        ),
        (vtkhdf::Grid { point_data: vec![vtkhdf::Field { name: "a/b".into(), ..field }], ..grid }, "no name"),
    ];
    for (grid, wanted) in cases {
        let (_folder, path) = place();
        let error = create_atomically(&path, false, |f| vtkhdf::write(f, &grid)).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
}

/// Other programs read a dense matrix by slices of rows and need the memory of a slice.
#[test]
fn h5py_reads_slices_of_a_matrix_in_little_memory() {
    let (_folder, path) = place();
    let table = Label { unit: "1", meaning: "1000 row + column", axes: &["row", "column"] };
    let a = Mat::from_fn(1100, 1000, |i, j| (1000 * i + j) as f64);
    create_atomically(&path, false, |f| save_dense(f, "a", a.as_ref(), &table)).unwrap();
    python("read_slices.py", &path);
}
