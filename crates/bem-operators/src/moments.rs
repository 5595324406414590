//! Moments of a pair of elements: one complex matrix from which V, K and W follow.
//!
//! Outer element a with parameter s, inner element b with parameter t, z(s) = (x(s) - c_b)/d_b:
//!
//! ```text
//! q[m,n] = ∫ P_m(s) Q_n(z(s)) ds            l0[m] = ∫ P_m(s) ( 2 Re Q_1(z) + log|z-1| + log|z+1| ) ds
//! ```
//! The inner integral is exact, ∫ P_n(t)/(z-t) dt = 2 Q_n(z); the outer one is a quadrature whose only singular points
//! are those where z(s) = ±1. The outer element is the shorter one, so that z varies little.

use num_complex::Complex64;

use crate::near;

/// Numbers that are computed side by side.
pub(crate) const LANES: usize = 8;

/// End points of a straight element as complex numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Start point.
    pub start: Complex64,
    /// End point.
    pub end: Complex64,
}

impl Segment {
    /// Half the vector from start to end, d.
    pub fn half(&self) -> Complex64 {
        (self.end - self.start) / 2.0
    }
}

/// q (m = 0..=rows-1, n = 0..=cols-1, row-major) and l0 of a pair; `outer` and `inner` say which element is which.
#[derive(Debug, Clone)]
pub struct PairMoments {
    /// The outer element, whose degrees are the rows.
    pub outer: Segment,
    /// The inner element, whose degrees are the columns.
    pub inner: Segment,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub cols: usize,
    /// l0(m), `rows` entries.
    pub l0: Vec<f64>,
    /// q(m,n) at m*cols + n.
    pub q: Vec<Complex64>,
}

impl PairMoments {
    /// Moments of two different elements that may touch at an end point, at any distance; the shorter one becomes the
    /// outer element. Degrees 0..=`degree_a` on a and 0..=`degree_b` on b.
    pub fn new(a: Segment, b: Segment, degree_a: usize, degree_b: usize) -> Self {
        let (outer, inner, m, n) =
            if first_is_outer(a, b) { (a, b, degree_a, degree_b) } else { (b, a, degree_b, degree_a) };
        let (rows, cols) = (m + 1, n + 1);
        let mut buffer = vec![0.0; storage(m, n)];
        near::moments(outer, inner, rows, cols, &mut buffer);
        Self::from_buffer(outer, inner, rows, cols, &buffer)
    }

    /// Moments of an element with itself, in closed form: q(m,n) = 2/((m-n)(m+n+1)) for m+n odd.
    pub fn same(a: Segment, degree: usize) -> Self {
        let mut buffer = vec![0.0; storage(degree, degree)];
        same(degree + 1, degree + 1, &mut buffer);
        Self::from_buffer(a, a, degree + 1, degree + 1, &buffer)
    }

    fn from_buffer(outer: Segment, inner: Segment, rows: usize, cols: usize, buffer: &[f64]) -> Self {
        let q = buffer[rows..][..2 * rows * cols].chunks_exact(2).map(|c| Complex64::new(c[0], c[1])).collect();
        Self { outer, inner, rows, cols, l0: buffer[..rows].to_vec(), q }
    }
}

/// Whether the first element of an unordered pair is the outer one: the shorter one is, or the first if both are equally long.
pub(crate) fn first_is_outer(a: Segment, b: Segment) -> bool {
    a.half().norm_sqr() <= b.half().norm_sqr()
}

/// Length of the buffer `l0, re q(0,0), im q(0,0), re q(0,1), …` of degrees `0..=m` and `0..=n`, whichever is outer.
pub(crate) fn storage(m: usize, n: usize) -> usize {
    2 * (m + 1) * (n + 1) + (m + 1) + (n + 1)
}

/// Moments of an element with itself into a buffer laid out as [`storage`] says.
pub(crate) fn same(rows: usize, cols: usize, out: &mut [f64]) {
    let q = |m: usize, n: usize| {
        if (m + n) % 2 == 1 { 2.0 / ((m as f64 - n as f64) * (m + n + 1) as f64) } else { 0.0 }
    };
    for m in 0..rows {
        out[m] = match m {
            0 => 4.0 * std::f64::consts::LN_2 - 6.0,
            _ => 2.0 / (2 * m + 1) as f64 * (q(0, m + 1) - q(0, m - 1)),
        };
        for n in 0..cols {
            out[rows + 2 * (m * cols + n)] = q(m, n);
            out[rows + 2 * (m * cols + n) + 1] = 0.0;
        }
    }
}

/// Real moments of an ordered pair, test element × trial element, degrees 0..test and 0..trial (exclusive).
///
/// ```text
/// log = ∫∫ P_m P_n log|x-y|,  xx, xy = ∫∫ P_m P_n r_x r_x/r², r_x r_y/r²,  d = ∫∫ P_m P_n (x-y)·n_y |d_trial|/r²
/// ```
/// all over the reference square; yy = 4 δ_m0 δ_n0 - xx. (m, n) is at n `stride` + m; `d` has one column n more than the others.
#[derive(Debug, Clone, Default)]
pub struct Tables {
    /// Number of test degrees.
    pub test: usize,
    /// The same, rounded up to a multiple of 8; the rows from `test` on are 0.
    pub stride: usize,
    /// Number of trial degrees (`d` has one more).
    pub trial: usize,
    /// ∫∫ P_m P_n log|x-y|.
    pub log: Vec<f64>,
    /// ∫∫ P_m P_n r_x²/r².
    pub xx: Vec<f64>,
    /// ∫∫ P_m P_n r_x r_y/r².
    pub xy: Vec<f64>,
    /// ∫∫ P_m P_n (x-y)·n_y |d_trial|/r².
    pub d: Vec<f64>,
}

impl Tables {
    /// Tables with the outer element as test element; needs `test < rows` and `trial < cols` (degree + 1 of each).
    pub fn outer_test(pair: &PairMoments, test: usize, trial: usize) -> Self {
        let mut tables = Self::default();
        let buffer = pair.buffer();
        tables.fill(&Geometry::new(pair.outer, pair.inner), pair.rows, pair.cols, &buffer, true, test, trial);
        tables
    }

    /// Tables with the inner element as test element; needs `test < cols` and `trial < rows`.
    pub fn inner_test(pair: &PairMoments, test: usize, trial: usize) -> Self {
        let mut tables = Self::default();
        let buffer = pair.buffer();
        tables.fill(&Geometry::new(pair.outer, pair.inner), pair.rows, pair.cols, &buffer, false, test, trial);
        tables
    }

    #[inline(always)]
    fn clear(&mut self, test: usize, trial: usize) {
        let stride = test.next_multiple_of(LANES);
        (self.test, self.stride, self.trial) = (test, stride, trial);
        for table in [&mut self.log, &mut self.xx, &mut self.xy] {
            table.clear();
            table.resize(stride * trial, 0.0);
        }
        self.d.clear();
        self.d.resize(stride * (trial + 1), 0.0);
    }

    /// From a buffer laid out as [`storage`] says.
    #[inline(always)]
    pub(crate) fn fill(
        &mut self,
        g: &Geometry,
        rows: usize,
        cols: usize,
        buffer: &[f64],
        outer_is_test: bool,
        test: usize,
        trial: usize,
    ) {
        let (m_end, n_end) = if outer_is_test { (test, trial) } else { (trial, test) };
        debug_assert!(m_end < rows && n_end < cols);
        let (l0, q) = (&buffer[..rows], &buffer[rows..]);
        let at = |m: usize, n: usize| {
            let k = 2 * (m * cols + n);
            Complex64::new(q[k], q[k + 1])
        };
        self.clear(test, trial);
        let stride = self.stride;
        for m in 0..m_end {
            let scale = 1.0 / (2 * m + 1) as f64;
            for n in 0..n_end {
                let one = if m == 0 && n == 0 { 4.0 } else { 0.0 };
                let log = if n == 0 {
                    l0[m] + one * g.log_inner
                } else {
                    2.0 / (2 * n + 1) as f64 * (at(m, n + 1).re - at(m, n - 1).re)
                };
                let mut sp = at(m + 1, n) * (m + 1) as f64;
                if m > 0 {
                    sp += at(m - 1, n) * m as f64;
                }
                // E = (d_b/d̄_b)(4δ + 4i conj t), t = ∫ P_m Im z Q_n
                let t = at(m, n) * g.alpha + sp * (g.beta * scale);
                let e = g.turn * Complex64::new(one + 4.0 * t.im, 4.0 * t.re);
                let k = if outer_is_test { n * stride + m } else { m * stride + n };
                self.log[k] = log;
                self.xx[k] = 0.5 * (one + e.re);
                self.xy[k] = 0.5 * e.im;
            }
        }
        if outer_is_test {
            for m in 0..test {
                for n in 0..=trial {
                    self.d[n * stride + m] = 2.0 * at(m, n).im;
                }
            }
        } else {
            for n in 0..test {
                for m in 0..=trial {
                    self.d[m * stride + n] = -2.0 * (g.ratio * at(m, n)).im;
                }
            }
        }
    }
}

impl Tables {
    /// From the tables of a pair with a curved element, `rows` × `cols` with the first element first; needs `test` and `trial`
    /// below their degrees.
    #[inline(always)]
    pub(crate) fn fill_curved(
        &mut self,
        log_length: f64,
        rows: usize,
        cols: usize,
        buffer: &[f64],
        first_is_test: bool,
        test: usize,
        trial: usize,
    ) {
        let part = |k: usize| &buffer[k * rows * cols..][..rows * cols];
        let at = |test: usize, trial: usize| if first_is_test { test * cols + trial } else { trial * cols + test };
        self.clear(test, trial);
        let stride = self.stride;
        let double = part(if first_is_test { 3 } else { 4 });
        for m in 0..test {
            for n in 0..trial {
                let (k, one) = (at(m, n), if m == 0 && n == 0 { 4.0 } else { 0.0 });
                self.log[n * stride + m] = part(0)[k] - one * log_length;
                self.xx[n * stride + m] = 0.5 * (one + part(1)[k]);
                self.xy[n * stride + m] = 0.5 * part(2)[k];
            }
            for n in 0..=trial {
                self.d[n * stride + m] = double[at(m, n)];
            }
        }
    }
}

impl PairMoments {
    fn buffer(&self) -> Vec<f64> {
        self.l0.iter().copied().chain(self.q.iter().flat_map(|c| [c.re, c.im])).collect()
    }
}

/// Numbers of an outer and an inner element that the tables need: Im z(s) = α + β s, d_a/d_b, d_b/d̄_b, log|d_b|.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Geometry {
    alpha: f64,
    beta: f64,
    ratio: Complex64,
    turn: Complex64,
    log_inner: f64,
}

impl Geometry {
    pub(crate) fn new(outer: Segment, inner: Segment) -> Self {
        let db = inner.half();
        Self::with_log(outer, inner, db.norm().ln())
    }

    /// As `new`, with log|d_b| known.
    #[inline(always)]
    pub(crate) fn with_log(outer: Segment, inner: Segment, log_inner: f64) -> Self {
        let (da, db) = (outer.half(), inner.half());
        let inverse = 1.0 / db.norm_sqr();
        let ratio = da * db.conj() * inverse;
        // vertex differences: full relative accuracy for small elements far from the origin
        let centre = ((outer.start - inner.start) + (outer.end - inner.end)) * 0.5;
        let alpha = (centre * db.conj()).im * inverse;
        Self { alpha, beta: ratio.im, ratio, turn: db * db * inverse, log_inner }
    }
}
