//! A field given at the corners of triangles, cut into bands of equal steps, and the colours of the bands.

use kuva::plot::ColorMap;
use kuva::render::color::Color;

/// Number of bands: fine enough to look smooth.
pub const BANDS: usize = 32;

/// Colour of band k: viridis, whose lightness rises with k.
pub(super) fn colour(k: usize) -> Color {
    Color::from(ColorMap::Viridis.map((k as f64 + 0.5) / BANDS as f64))
}

/// Values beyond this many times the largest of the other values belong to singular points.
const FAR_BEYOND: f64 = 4.0;
/// The part of the weight that the other values have.
const MOST: f64 = 0.98;

/// Interval of the colours of a field over triangles, given by its values at the P points.
///
/// If values on 2 % of the area or less are far beyond all others, as at the tip of a crack, the interval ends at twice
/// the largest of the others.
pub fn colour_interval(points: &[[f64; 2]], triangles: &[[usize; 3]], values: &[f64]) -> [f64; 2] {
    interval(&weighted(points, triangles, values))
}

/// The value at each of the P points with its weight, twice the area of the triangles around the point.
pub(super) fn weighted(points: &[[f64; 2]], triangles: &[[usize; 3]], values: &[f64]) -> Vec<(f64, f64)> {
    let mut weighted: Vec<(f64, f64)> = values.iter().map(|&v| (v, 0.0)).collect();
    for t in triangles {
        let [a, b, c] = t.map(|i| points[i]);
        let area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        t.iter().for_each(|&i| weighted[i].1 += area);
    }
    weighted
}

/// Interval [low, high] of the colours of values with their weights: from 0 to the largest value, or from the smallest
/// one if the values vary by more than 1e-3 but less than half of the largest. [0, 1] if there is no positive value. If
/// values with 2 % of the weight or less are far beyond all others, it ends at twice the largest of the others.
pub(super) fn interval(values: &[(f64, f64)]) -> [f64; 2] {
    let mut values: Vec<(f64, f64)> = values.iter().copied().filter(|(v, _)| v.is_finite()).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let low = values.first().map_or(f64::INFINITY, |v| v.0);
    let mut high = values.last().map_or(0.0, |v| v.0.max(0.0));
    let all: f64 = values.iter().map(|v| v.1).sum();
    let mut sum = 0.0;
    let beyond = values.iter().find(|v| {
        sum += v.1;
        sum > MOST * all
    });
    let most = beyond.map_or(high, |v| v.0);
    if most > 0.0 && high > FAR_BEYOND * most {
        high = 2.0 * most;
    }
    if high <= 0.0 {
        [0.0, 1.0]
    } else if low > 0.5 * high && high - low > 1e-3 * high {
        [low, high]
    } else {
        [0.0, high]
    }
}

/// A value before interpolation: limited to a distance of one interval length from the interval, so that infinite
/// values do no harm.
pub fn limited(value: f64, [low, high]: [f64; 2]) -> f64 {
    value.clamp(2.0 * low - high, 2.0 * high - low)
}

/// The convex polygons in which the linear interpolant of the [`limited`] `values` lies in band k of `interval`, for each k.
///
/// Values outside the interval belong to the bands at its ends; a triangle with a NaN is left out.
pub(super) fn bands(
    points: &[[f64; 2]],
    triangles: &[[usize; 3]],
    values: &[f64],
    [low, high]: [f64; 2],
) -> Vec<Vec<Vec<[f64; 2]>>> {
    let mut result = vec![Vec::new(); BANDS];
    for t in triangles.iter().filter(|t| t.iter().all(|&i| !values[i].is_nan())) {
        // In units of a band: band k is [k, k+1].
        let level = |i: usize| (limited(values[i], [low, high]) - low) / (high - low) * BANDS as f64;
        let corner = t.map(|i| (points[i], level(i)));
        let least = corner.iter().map(|c| c.1).fold(f64::INFINITY, f64::min);
        let most = corner.iter().map(|c| c.1).fold(0.0, f64::max);
        let first = (least.max(0.0) as usize).min(BANDS - 1);
        let last = (most.ceil() as usize).clamp(first + 1, BANDS);
        for k in first..last {
            let mut piece = corner.to_vec();
            if k > 0 {
                piece = cut(&piece, k as f64, 1.0);
            }
            if k + 1 < BANDS {
                piece = cut(&piece, (k + 1) as f64, -1.0);
            }
            if piece.len() >= 3 {
                result[k].push(piece.into_iter().map(|c| c.0).collect());
            }
        }
    }
    result
}

/// Part of a convex polygon where sign·(value - level) ≥ 0.
fn cut(polygon: &[([f64; 2], f64)], level: f64, sign: f64) -> Vec<([f64; 2], f64)> {
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (i, &(p, v)) in polygon.iter().enumerate() {
        let (q, w) = polygon[(i + 1) % polygon.len()];
        let (a, b) = (sign * (v - level), sign * (w - level));
        if a >= 0.0 {
            part.push((p, v));
        }
        if a * b < 0.0 {
            let s = a / (a - b);
            part.push(([p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])], level));
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(polygon: &[[f64; 2]]) -> f64 {
        let n = polygon.len();
        (0..n).map(|i| (polygon[i], polygon[(i + 1) % n])).map(|(a, b)| (a[0] * b[1] - a[1] * b[0]) / 2.0).sum()
    }

    #[test]
    fn a_linear_field_has_bands_of_equal_area() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let b = bands(&points, &[[0, 1, 2], [0, 2, 3]], &[0.0, 3.0, 3.0, 0.0], [0.0, 3.0]);
        for band in b {
            let total: f64 = band.iter().map(|p| area(p)).sum();
            assert!((total - 1.0 / BANDS as f64).abs() < 1e-14);
        }
    }

    #[test]
    fn constants_zero_and_infinities() {
        let interval = |values: &[f64]| interval(&values.iter().map(|&v| (v, 1.0)).collect::<Vec<_>>());
        assert_eq!(interval(&[0.0, 0.0]), [0.0, 1.0]);
        assert_eq!(interval(&[2.0, 2.0 + 1e-13]), [0.0, 2.0 + 1e-13]);
        assert_eq!(interval(&[8.0, 9.0, f64::NAN, f64::INFINITY]), [8.0, 9.0]);
        assert_eq!(interval(&[1.0, 9.0]), [0.0, 9.0]);
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let whole = |v: [f64; 3], k: usize| {
            let b = bands(&points, &[[0, 1, 2]], &v, [0.0, 1.0]);
            assert_eq!(b[k].len(), 1);
            assert_eq!(b.iter().map(Vec::len).sum::<usize>(), 1);
        };
        whole([0.0; 3], 0);
        whole([1.0; 3], BANDS - 1);
        whole([f64::INFINITY; 3], BANDS - 1);
        assert!(bands(&points, &[[0, 1, 2]], &[0.0, f64::NAN, 1.0], [0.0, 1.0]).iter().all(Vec::is_empty));
    }

    #[test]
    fn lightness_rises_from_dark_to_bright() {
        let lightness: Vec<f64> = (0..BANDS)
            .map(|k| match colour(k) {
                Color::Rgb(r, g, b) => 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b),
                other => panic!("not a plain colour: {other:?}"),
            })
            .collect();
        assert!(lightness.windows(2).all(|w| w[1] > w[0]));
        assert!(lightness[0] < 50.0 && lightness[BANDS - 1] > 200.0);
    }

    #[test]
    fn values_beyond_the_interval_move_no_level_line() {
        // values 3x over the interval [1, 2]: its ends are at x = 1/3 and x = 2/3
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let b = bands(&points, &[[0, 1, 2], [0, 2, 3]], &[0.0, 3.0, 3.0, 0.0], [1.0, 2.0]);
        let of = |k: usize| b[k].iter().map(|p| area(p)).sum::<f64>();
        let step = 1.0 / 3.0 / BANDS as f64;
        assert!((of(0) - 1.0 / 3.0 - step).abs() < 1e-14 && (of(BANDS - 1) - 1.0 / 3.0 - step).abs() < 1e-14);
        assert!((of(1) - step).abs() < 1e-14);
    }

    #[test]
    fn values_are_few_by_their_area() {
        // a square of two triangles, and a thousandth of it with the other values
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.001, 0.0], [1.001, 1.0]];
        let triangles = [[0, 1, 2], [0, 2, 3], [1, 4, 5]];
        let values = [1.0, 1.0, 1.0, 1.0, 100.0, 100.0];
        assert_eq!(colour_interval(&points, &triangles, &values), [0.0, 2.0]);
        assert_eq!(interval(&values.map(|v| (v, 1.0))), [0.0, 100.0]);
    }

    proptest! {
        #[test]
        fn bands_fill_the_triangle_and_hold_their_values(v in prop::array::uniform3(0.0f64..1.0)) {
            // The values are the barycentric interpolant on the reference triangle, so each piece can be checked.
            let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            let b = bands(&points, &[[0, 1, 2]], &v, [0.0, 1.0]);
            let total: f64 = b.iter().flatten().map(|p| area(p)).sum();
            prop_assert!((total - 0.5).abs() < 1e-13);
            for (k, band) in b.iter().enumerate() {
                for [x, y] in band.iter().flatten() {
                    let value = (v[0] + x * (v[1] - v[0]) + y * (v[2] - v[0])) * BANDS as f64;
                    prop_assert!(value > k as f64 - 1e-9 && value < (k + 1) as f64 + 1e-9);
                }
            }
        }
    }
}
