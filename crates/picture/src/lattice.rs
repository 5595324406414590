//! Few triangles over a grid of many cells, for pictures of a deformed body.

use std::collections::{BTreeMap, BTreeSet};

/// Triangles over a body of cells.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LatticeTriangles {
    /// Column and row of each point on the lattice of the cells' corners. Each is the corner of a cell of the body.
    pub points: Vec<[usize; 2]>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// Segments of the boundary, each loop in order with the body on its left.
    pub outline: Vec<[usize; 2]>,
}

/// Joins the cells of a body (the cells of nx × ny equal rectangles with `inside(ix, iy)`) into blocks and halves each
/// block.
///
/// There are about `at_most` points. Lines of the blocks go through all corners of the body, so that the blocks are
/// exactly the body. If that would take many more points, the lines are equally spaced; a block is then the polygon of
/// its corners in the body, if the middle of the polygon is in the body, and a rim of a block's width may be missing.
/// `spacing` is the size of a cell.
pub fn lattice_triangles(
    spacing: [f64; 2],
    cells: [usize; 2],
    inside: impl Fn(usize, usize) -> bool,
    at_most: usize,
) -> LatticeTriangles {
    let [nx, ny] = cells;
    if nx == 0 || ny == 0 {
        return LatticeTriangles::default();
    }
    let wanted = parts(spacing, cells, at_most);
    let x = cuts(nx, wanted[0], |i| (0..ny).any(|j| inside(i - 1, j) != inside(i, j)));
    let y = cuts(ny, wanted[1], |j| (0..nx).any(|i| inside(i, j - 1) != inside(i, j)));
    let touches = |i: usize, j: usize| {
        let near = |k: usize, n: usize| k.saturating_sub(1)..(k + 1).min(n);
        near(i, nx).any(|ix| near(j, ny).any(|iy| inside(ix, iy)))
    };
    let mut result = LatticeTriangles::default();
    let mut number = BTreeMap::new();
    // Directed sides whose opposite does not exist bound the body.
    let mut sides = BTreeSet::new();
    for [a, b] in (0..y.len() - 1).flat_map(|b| (0..x.len() - 1).map(move |a| [a, b])) {
        let mut corners = vec![[x[a], y[b]], [x[a + 1], y[b]], [x[a + 1], y[b + 1]], [x[a], y[b + 1]]];
        corners.retain(|&[i, j]| touches(i, j));
        let middle = |k: usize| corners.iter().map(|c| c[k]).sum::<usize>() / corners.len();
        if corners.len() < 3 || !inside(middle(0), middle(1)) {
            continue;
        }
        let corners: Vec<usize> = corners
            .iter()
            .map(|&c| {
                *number.entry(c).or_insert_with(|| {
                    result.points.push(c);
                    result.points.len() - 1
                })
            })
            .collect();
        for w in corners[1..].windows(2) {
            result.triangles.push([corners[0], w[0], w[1]]);
        }
        for (k, &p) in corners.iter().enumerate() {
            let q = corners[(k + 1) % corners.len()];
            if !sides.remove(&[q, p]) {
                sides.insert([p, q]);
            }
        }
    }
    while let Some([start, mut end]) = sides.pop_first() {
        result.outline.push([start, end]);
        while let Some(&side) = sides.range([end, 0]..[end + 1, 0]).next() {
            sides.remove(&side);
            result.outline.push(side);
            end = side[1];
        }
    }
    result
}

/// Blocks along x and y, nearly square, with about `at_most` corners.
fn parts(spacing: [f64; 2], [nx, ny]: [usize; 2], at_most: usize) -> [usize; 2] {
    let most = at_most.max(4) as f64;
    let aspect = spacing[0] * nx as f64 / (spacing[1] * ny as f64);
    let of = |wish: f64, n: usize| (wish as usize).clamp(2, n + 1);
    let x = of((most * aspect).sqrt(), nx);
    let y = of(most / x as f64, ny);
    [of(most / y as f64, nx) - 1, y - 1]
}

/// 0, n, all lines at which the body changes, and lines between them that make about `wanted` parts; equal parts if the
/// body changes at many more lines.
fn cuts(n: usize, wanted: usize, changes: impl Fn(usize) -> bool) -> Vec<usize> {
    let fixed: Vec<usize> = std::iter::once(0).chain((1..n).filter(|&i| changes(i))).chain([n]).collect();
    let split = |low: usize, high: usize, parts: usize| (0..parts).map(move |k| low + k * (high - low) / parts);
    if fixed.len() > 2 * wanted + 2 {
        return split(0, n, wanted).chain([n]).collect();
    }
    let parts = |length: usize| ((length * wanted + n / 2) / n).clamp(1, length);
    fixed.windows(2).flat_map(|w| split(w[0], w[1], parts(w[1] - w[0]))).chain([n]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Twice the area within a polygon or loops given by points on the lattice.
    fn doubled_area(points: &[[usize; 2]], sides: &[[usize; 2]]) -> i64 {
        let at = |k: usize| points[k].map(|v| v as i64);
        sides.iter().map(|s| s.map(at)).map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum()
    }

    /// Checks the properties that hold for every body; returns twice the area of the triangles.
    fn check(lattice: &LatticeTriangles, inside: impl Fn(usize, usize) -> bool, [nx, ny]: [usize; 2]) -> i64 {
        let LatticeTriangles { points, triangles, outline } = lattice;
        for &[i, j] in points {
            let cell = |di, dj| i >= di && j >= dj && i - di < nx && j - dj < ny && inside(i - di, j - dj);
            assert!(cell(0, 0) || cell(1, 0) || cell(0, 1) || cell(1, 1), "{i} {j}");
        }
        let areas: Vec<i64> =
            triangles.iter().map(|&[a, b, c]| doubled_area(points, &[[a, b], [b, c], [c, a]])).collect();
        assert!(areas.iter().all(|&a| a > 0));
        assert_eq!(doubled_area(points, outline), areas.iter().sum::<i64>());
        // loops: each segment goes on from the one before or starts where the last loop ended
        let mut start = None;
        for (k, s) in outline.iter().enumerate() {
            let first = *start.get_or_insert(s[0]);
            if outline.get(k + 1).is_none_or(|next| next[0] != s[1]) || s[1] == first {
                assert_eq!(s[1], first, "an open loop");
                start = None;
            }
        }
        areas.iter().sum()
    }

    #[test]
    fn a_large_l_is_met_exactly() {
        let inside = |ix: usize, iy: usize| ix < 700 || iy < 301;
        let lattice = lattice_triangles([1.0, 2.0], [2000, 1000], inside, 800);
        assert_eq!(check(&lattice, inside, [2000, 1000]), 2 * (2_000_000 - 1300 * 699));
        assert!((400..=900).contains(&lattice.points.len()), "{}", lattice.points.len());
        // one block has two triangles, four points and four sides
        let whole = lattice_triangles([1.0; 2], [5, 3], |_, _| true, 4);
        assert_eq!(whole.points, [[0, 0], [5, 0], [5, 3], [0, 3]]);
        assert_eq!(
            (whole.triangles, whole.outline),
            (vec![[0, 1, 2], [0, 2, 3]], vec![[0, 1], [1, 2], [2, 3], [3, 0]])
        );
    }

    #[test]
    fn a_disc_of_many_steps_is_met_nearly_and_extreme_shapes_have_few_points() {
        let inside = |ix: usize, iy: usize| (ix as f64 - 499.5).hypot(iy as f64 - 499.5) < 500.0;
        let lattice = lattice_triangles([1.0; 2], [1000, 1000], inside, 800);
        let share = check(&lattice, inside, [1000, 1000]) as f64 / 2e6;
        // a polygon with corners in the disc that contains all points deeper than the diagonal of one of 27 blocks
        let bounds = [(1.0 - 2.0 * 2f64.sqrt() / 27.0).powi(2), 1.0].map(|b| b * std::f64::consts::FRAC_PI_4);
        assert!(bounds[0] < share && share < bounds[1], "{share}");
        assert!(lattice.points.len() <= 850);
        for cells in [[6000, 100], [1, 100_000], [1, 1]] {
            let lattice = lattice_triangles([1.0; 2], cells, |_, _| true, 800);
            assert_eq!(check(&lattice, |_, _| true, cells), 2 * (cells[0] * cells[1]) as i64);
            assert!(lattice.points.len() <= 820, "{cells:?}: {}", lattice.points.len());
        }
        assert_eq!(lattice_triangles([1.0; 2], [0, 3], |_, _| true, 800), LatticeTriangles::default());
        assert_eq!(lattice_triangles([1.0; 2], [3, 3], |_, _| false, 800), LatticeTriangles::default());
    }

    proptest! {
        #[test]
        fn any_small_body_is_met_exactly(mask in prop::collection::vec(any::<bool>(), 30), at_most in 42usize..99) {
            let inside = |ix: usize, iy: usize| mask[ix * 5 + iy];
            let lattice = lattice_triangles([1.0; 2], [6, 5], inside, at_most);
            prop_assert_eq!(check(&lattice, inside, [6, 5]), 2 * mask.iter().filter(|m| **m).count() as i64);
        }

        #[test]
        fn no_point_leaves_the_body_however_few_there_are(mask in prop::collection::vec(any::<bool>(), 120), at_most in 0usize..40) {
            let inside = |ix: usize, iy: usize| mask[ix * 10 + iy];
            check(&lattice_triangles([1.0; 2], [12, 10], inside, at_most), inside, [12, 10]);
        }
    }
}
