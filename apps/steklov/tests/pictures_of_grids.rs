//! Pictures of fields on grids of rectangles. With `STEKLOV_PICTURES=DIR` the files stay in DIR to be looked at.

use crate::frame::{check, check_up_to};
use steklov_picture::{BasisFunction, Body, CellField, Colours, Largest, basis, body, cell_fields, lattice_triangles};

/// Values of cells (ix, iy) at ix·ny + iy from a function of their centres in the unit square.
fn values([nx, ny]: [usize; 2], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let at = |c: usize| f(((c / ny) as f64 + 0.5) / nx as f64, ((c % ny) as f64 + 0.5) / ny as f64);
    (0..nx * ny).map(at).collect()
}

/// A number in [0, 1) that looks random (Weyl sequence).
fn rough(x: f64, y: f64) -> f64 {
    (1e4 * (x * 12.9898 + y * 78.233).sin()).rem_euclid(1.0)
}

fn rectangles([nx, ny]: [usize; 2], size: [f64; 2]) -> Vec<[[f64; 2]; 2]> {
    let at = |i: usize, j: usize| [size[0] * i as f64 / nx as f64, size[1] * j as f64 / ny as f64];
    (0..nx * ny).map(|c| (c / ny, c % ny)).map(|(i, j)| [at(i, j), at(i + 1, j + 1)]).collect()
}

/// A field on [0, width] × [0, height].
fn field<'a>(label: &'a str, size: [f64; 2], cells: [usize; 2], values: &'a [f64]) -> CellField<'a> {
    let spacing = [size[0] / cells[0] as f64, size[1] / cells[1] as f64];
    CellField {
        caption: "",
        label,
        length: None,
        origin: [0.0; 2],
        spacing,
        cells,
        values,
        colours: Colours::Automatic,
        coarse: &[],
    }
}

#[test]
fn modulus_and_stress_of_a_bar() {
    let (size, cells) = ([6.0, 1.0], [192, 32]);
    let modulus = values(cells, |x, y| 1000.0 + 3000.0 * rough(x, y));
    let stress = values(cells, |x, y| 1e6 * (0.2 + (1.0 - x) * (2.0 * y - 1.0).abs()));
    let coarse = rectangles([24, 4], size);
    let fields = [
        CellField { coarse: &coarse, ..field("Young's modulus in N/mm²", size, cells, &modulus) },
        CellField { caption: "coupled", ..field("von Mises stress in N/mm²", size, cells, &stress) },
    ];
    let picture = cell_fields("Bar 6 × 1, clamped at the left", &fields, false).unwrap();
    check("cells-bar", &picture);
    for text in [">Young&apos;s modulus in N/mm²<", ">coupled: von Mises stress in N/mm² (×10⁶)<", ">x<", ">y<"] {
        assert!(picture.svg.contains(text), "{text}");
    }
    assert_eq!(picture.svg.matches("<image ").count(), 2);
}

#[test]
fn lines_of_more_than_thirty_coarse_cells_along_an_axis_are_not_drawn() {
    let (size, cells) = ([6.0, 1.0], [192, 32]);
    let stress = values(cells, |x, y| x + y);
    let corners = |coarse: [usize; 2]| {
        let coarse = rectangles(coarse, size);
        let picture =
            cell_fields("", &[CellField { coarse: &coarse, ..field("", size, cells, &stress) }], false).unwrap();
        let white =
            picture.svg.split("<path").filter(|path| path.contains("#ffffff")).map(|path| path.matches('M').count());
        white.sum::<usize>()
    };
    assert_eq!(corners([30, 5]), 150);
    assert_eq!(corners([32, 5]), 0);
}

#[test]
fn runs_that_share_their_colours() {
    for count in [2, 3, 6] {
        let (size, cells) = ([6.0, 1.0], [96, 16]);
        let names = ["fine", "linear", "coupled", "oscillatory", "oversampled", "periodic"];
        let all: Vec<Vec<f64>> =
            (0..count).map(|k| values(cells, |x, y| (k + 1) as f64 * (1.0 - x) * (2.0 * y - 1.0).abs())).collect();
        let fields: Vec<CellField<'_>> = (0..count)
            .map(|k| CellField { caption: names[k], ..field("von Mises stress in MPa", size, cells, &all[k]) })
            .collect();
        let picture = cell_fields("Stresses by kinds of basis functions", &fields, true).unwrap();
        check_up_to(&format!("cells-shared-{count}"), &picture, 1250.0);
        assert_eq!(picture.svg.matches(">colours: von Mises stress in MPa<").count(), 1);
        assert_eq!(picture.svg.matches("fill=\"#f3e51e\"").count(), 1, "one colour bar");
    }
}

#[test]
fn bodies_of_every_shape() {
    let l = values([40, 40], |x, y| if x > 0.5 && y > 0.5 { f64::NAN } else { 1.0 / (x - 0.5).hypot(y - 0.5) });
    let coarse: Vec<_> =
        rectangles([8, 8], [2.0, 2.0]).into_iter().filter(|r| !(r[0][0] > 0.9 && r[0][1] > 0.9)).collect();
    let shape = CellField { coarse: &coarse, ..field("indicator", [2.0, 2.0], [40, 40], &l) };
    check("cells-l", &cell_fields("L-shaped body", &[shape], false).unwrap());
    let four = [shape; 4].map(|f| CellField { caption: "a run with a name that is not short at all", ..f });
    check_up_to("cells-l-4", &cell_fields("Four runs", &four, false).unwrap(), 1250.0);
    check_up_to("cells-l-4-shared", &cell_fields("Four runs", &four, true).unwrap(), 1250.0);
    let wave = values([600, 10], |x, y| (40.0 * x).sin() + y);
    check("cells-flat", &cell_fields("Flat", &[field("shear in kPa", [60.0, 1.0], [600, 10], &wave)], false).unwrap());
    let tall = values([10, 600], |x, y| (40.0 * y).sin() + x);
    let tall = field("shear in kPa", [1.0, 60.0], [10, 600], &tall);
    for count in [1, 3] {
        check(&format!("cells-tall-{count}"), &cell_fields("Tall", &vec![tall; count], false).unwrap());
    }
    check("cells-tall-shared", &cell_fields("Tall", &[tall; 3], true).unwrap());
    check("cells-one", &cell_fields("One", &[field("E", [2.0, 1.0], [1, 1], &[3.5])], false).unwrap());
    let thin = field("E", [1e4, 1.0], [4, 1], &[1.0, 2.0, 3.0, 4.0]);
    check("cells-line", &cell_fields("A line", &[thin], false).unwrap());
    check("cells-none", &cell_fields("", &[], true).unwrap());
}

#[test]
fn extreme_values_and_places() {
    let long = "a title that no line could hold ".repeat(12);
    let cases: [(&str, [f64; 2], &[f64]); 8] = [
        ("constant", [1.0, 1.0], &[7.25; 4]),
        ("zero", [1.0, 1.0], &[0.0; 4]),
        ("negative", [1.0, 1.0], &[-2.0; 4]),
        ("small", [1e-9, 1e-9], &[1e-9, 2e-9, 3e-9, 4e-9]),
        ("large", [1e9, 1e9], &[1e9, 2e9, -3e9, 4e9]),
        ("wide", [1.0, 0.5], &[1e-9, 1e9, 1.0, 2.0]),
        ("unbounded", [1.0, 1.0], &[1.0, f64::INFINITY, f64::NAN, 2.0]),
        ("unknown", [1.0, 1.0], &[f64::NAN; 4]),
    ];
    for (name, size, values) in cases {
        let f = CellField { caption: name, ..field(&long, size, [2, 2], values) };
        check(&format!("cells-{name}"), &cell_fields(&long, &[f], false).unwrap());
        let far = CellField { origin: [1e6 * size[0], -1e6 * size[1]], ..f };
        check_up_to(&format!("cells-{name}-far"), &cell_fields(&long, &[far, f, far], true).unwrap(), 1250.0);
    }
}

#[test]
fn more_cells_than_pixels() {
    for (name, cells) in [("cells-many", [2500, 2000]), ("cells-million", [1000, 1000])] {
        let noise = values(cells, |x, y| rough(x, y) + 3.0 * x * y);
        let picture = cell_fields("Many cells", &[field("E in GPa", [2.5, 2.0], cells, &noise)], false).unwrap();
        check(name, &picture);
        assert!(picture.svg.len() < 3_000_000, "not an element for each cell");
    }
}

/// A bar and an L of a million cells each, bent.
#[test]
fn deformed_grids_of_many_cells() {
    let l = |ix: usize, iy: usize| ix < 400 || iy < 250;
    for (name, size, cells, l_shaped) in
        [("grid-bar", [6.0, 1.0], [2400, 400], false), ("grid-l", [2.0, 2.0], [1000; 2], true)]
    {
        let spacing = [size[0] / cells[0] as f64, size[1] / cells[1] as f64];
        let lattice = lattice_triangles(spacing, cells, |ix, iy| !l_shaped || l(ix, iy), 800);
        let points: Vec<_> = lattice.points.iter().map(|p| [0, 1].map(|k| p[k] as f64 * spacing[k])).collect();
        let bent = |&[x, y]: &[f64; 2]| [0.01 * x * (y - size[1] / 2.0), -0.005 * x * x];
        let stress: Vec<f64> = points.iter().map(|[x, y]| (size[0] - x) * (y - size[1] / 2.0).abs()).collect();
        let picture = body(&Body {
            title: "Bent grid",
            points: &points,
            displacement: &points.iter().map(bent).collect::<Vec<_>>(),
            largest: 0.0,
            triangles: &lattice.triangles,
            values: &stress,
            infinite: &[],
            label: "von Mises stress",
            noun: "stress",
            colours: Colours::Automatic,
            outline: &lattice.outline,
            obstacles: &[],
            window: None,
            most: Largest::NONE,
            enlarge: None,
            units: [None; 2],
        })
        .unwrap();
        check(name, &picture);
    }
}

/// The hat of the upper right corner with a bubble of a given height in the other component.
fn hat(cells: [usize; 2], bubble: f64) -> [Vec<f64>; 2] {
    let at = |k: usize| [(k % (cells[0] + 1)) as f64 / cells[0] as f64, (k / (cells[0] + 1)) as f64 / cells[1] as f64];
    let nodes = || (0..(cells[0] + 1) * (cells[1] + 1)).map(at);
    let cross = nodes().map(|[x, y]| bubble * 16.0 * x * y * (1.0 - x) * (y - 1.0) * (x - y)).collect();
    [nodes().map(|[x, y]| x * y).collect(), cross]
}

#[test]
fn basis_functions_by_kinds() {
    let names = ["linear", "coupled", "oscillatory", "oversampled", "periodic"];
    for (name, size, cells, kinds) in [
        ("basis-square", [1.0, 1.0], [16, 16], 5),
        ("basis-two", [0.25, 0.25], [32, 32], 2),
        ("basis-flat", [3.0, 0.5], [12, 2], 3),
        ("basis-tall", [1e-4, 3e-3], [1, 1], 1),
    ] {
        let parts: Vec<[Vec<f64>; 2]> =
            (0..kinds).map(|k| hat(cells, if k == 0 { 0.0 } else { 0.1 / k as f64 })).collect();
        let functions: Vec<BasisFunction<'_>> = (0..kinds)
            .map(|k| BasisFunction { name: names[k], size, cells, x: &parts[k][0], y: &parts[k][1] })
            .collect();
        let picture = basis("Basis function of the upper right corner, displacement x", &functions).unwrap();
        check_up_to(name, &picture, 1250.0);
        for kind in &names[..kinds] {
            for component in ["x", "y"] {
                assert!(picture.svg.contains(&format!(">{kind}: component {component}")), "{kind}");
            }
        }
    }
    check("basis-none", &basis("", &[]).unwrap());
}
