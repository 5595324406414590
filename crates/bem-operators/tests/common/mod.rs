//! Gold values and small reference formulas shared by the tests of this crate.

use num_complex::Complex64;
use serde_json::Value;
use steklov_bem_operators::{Loop, PairMoments, Polygon, Segment, Tables};
use steklov_elastic::{Material, Plane};

/// Degrees of the gold blocks V, W, K.
pub const K_DEGREES: usize = 4;

pub struct Gold {
    pub young: f64,
    pub poisson: f64,
    pub length: f64,
    pub pairs: Vec<GoldPair>,
    pub steklov: Vec<(String, String, f64)>,
}

pub struct GoldPair {
    pub name: String,
    pub a: Segment,
    pub b: Segment,
    pub log: Vec<f64>,
    pub xx: Vec<f64>,
    pub xy: Vec<f64>,
    pub dab: Vec<f64>,
    pub dba: Vec<f64>,
    pub v: Vec<f64>,
    pub w: Vec<f64>,
    pub k: Vec<f64>,
}

fn number(v: &Value) -> f64 {
    v.as_f64().or_else(|| v.as_str().and_then(|s| s.parse().ok())).expect("a number")
}

fn flatten(v: &Value, out: &mut Vec<f64>) {
    match v {
        Value::Array(items) => items.iter().for_each(|i| flatten(i, out)),
        _ => out.push(number(v)),
    }
}

fn flat(v: &Value) -> Vec<f64> {
    let mut out = Vec::new();
    flatten(v, &mut out);
    out
}

fn segment(v: &Value) -> Segment {
    let x = flat(v);
    Segment { start: Complex64::new(x[0], x[1]), end: Complex64::new(x[2], x[3]) }
}

impl Gold {
    pub fn read() -> Self {
        let root: Value = serde_json::from_str(include_str!("../data/bem-moments.json")).expect("gold data");
        let pairs = root["pairs"].as_array().expect("pairs").iter().map(|p| GoldPair {
            name: p["name"].as_str().expect("name").to_owned(),
            a: segment(&p["A"]),
            b: segment(&p["B"]),
            log: flat(&p["LOG"]),
            xx: flat(&p["XX"]),
            xy: flat(&p["XY"]),
            dab: flat(&p["DAB"]),
            dba: flat(&p["DBA"]),
            v: flat(&p["V"]),
            w: flat(&p["W"]),
            k: flat(&p["K_gunter"]),
        });
        let text = |v: &Value| v.as_str().expect("text").to_owned();
        let steklov = root["steklov"].as_array().expect("steklov");
        Self {
            young: number(&root["E"]),
            poisson: number(&root["nu"]),
            length: number(&root["L"]),
            pairs: pairs.collect(),
            steklov: steklov.iter().map(|s| (text(&s["polygon"]), text(&s["field"]), number(&s["energy"]))).collect(),
        }
    }

    pub fn material(&self) -> Material {
        Material::new(self.young, self.poisson, Plane::Strain).expect("gold material")
    }
}

impl GoldPair {
    pub fn yy(&self) -> Vec<f64> {
        self.xx.iter().enumerate().map(|(i, x)| if i == 0 { 4.0 - x } else { -x }).collect()
    }

    pub fn moments(&self, degree_a: usize, degree_b: usize) -> PairMoments {
        if self.a == self.b {
            PairMoments::same(self.a, degree_a)
        } else {
            PairMoments::new(self.a, self.b, degree_a, degree_b)
        }
    }

    /// Tables with test element A and with test element B.
    pub fn tables(&self, pair: &PairMoments, a: usize, b: usize) -> (Tables, Tables) {
        if pair.outer == self.a {
            (Tables::outer_test(pair, a, b), Tables::inner_test(pair, b, a))
        } else {
            (Tables::inner_test(pair, a, b), Tables::outer_test(pair, b, a))
        }
    }
}

/// Blocks V, W, K of test element a and trial element b in Legendre coefficients, index [m][n][i][j], as the gold data
/// define them, straight from the formulas.
pub fn blocks_of(
    material: &Material,
    length: f64,
    t: &Tables,
    a: Segment,
    b: Segment,
) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let pi = std::f64::consts::PI;
    let (mu, nu, kappa) = (material.mu(), material.nu(), material.kappa());
    let c_v = 1.0 / (8.0 * pi * mu * (1.0 - nu));
    let c_w = mu / (2.0 * pi * (1.0 - nu));
    let (da, db) = (a.half().norm(), b.half().norm());
    let one = |m: usize, n: usize| if m == 0 && n == 0 { 4.0 } else { 0.0 };
    let g = |m: usize, n: usize, log_factor: f64| {
        let at = n * t.stride + m;
        let log = log_factor * (t.log[at] - one(m, n) * length.ln());
        let (xx, xy) = (t.xx[at], t.xy[at]);
        [[xx - log, xy], [xy, one(m, n) - xx - log]]
    };
    let laplace = |m: usize, n: usize| (t.log[n * t.stride + m] - one(m, n) * length.ln()) / (2.0 * pi);
    let (mut v, mut w, mut k) = (Vec::new(), Vec::new(), Vec::new());
    for m in 0..t.test {
        for n in 0..t.trial {
            // d/dt P_n = Σ (2l+1) P_l, n-l odd
            let derivative: Vec<usize> = (0..n).filter(|l| (n - l) % 2 == 1).collect();
            for i in 0..2 {
                for j in 0..2 {
                    v.push(da * db * c_v * g(m, n, kappa)[i][j]);
                    w.push(c_w * g(m, n, 1.0)[i][j]);
                    let mut sum = if i == j { t.d[n * t.stride + m] / (2.0 * pi) } else { 0.0 };
                    for &l in &derivative {
                        let h = |i: usize, j: usize| {
                            2.0 * mu * c_v * g(m, l, kappa)[i][j] + if i == j { laplace(m, l) } else { 0.0 }
                        };
                        // (H J)_i0 = H_i1, (H J)_i1 = -H_i0
                        sum += (2 * l + 1) as f64 * if j == 0 { h(i, 1) } else { -h(i, 0) };
                    }
                    k.push(da * sum);
                }
            }
        }
    }
    (v, w, k)
}

/// A potential and its derivatives.
type Potential<const N: usize> = fn(Complex64) -> [Complex64; N];

/// Displacement and traction fields from Kolosov-Muskhelishvili potentials: 2μ(u+iv) = κφ - z conj(φ') - conj(ψ).
pub struct Field {
    phi: Potential<3>,
    psi: Potential<2>,
    kappa: f64,
    mu: f64,
    kelvin: bool,
}

/// Force and place of the Kelvin source of the gold data.
const FORCE: Complex64 = Complex64::new(1.0, 0.5);
const SOURCE: Complex64 = Complex64::new(0.9, 0.35);

impl Field {
    /// "linear", "cubic", "exp" or "kelvin".
    pub fn new(name: &str, material: &Material) -> Self {
        let (kappa, mu) = (material.kappa(), material.mu());
        let (phi, psi): (Potential<3>, Potential<2>) = match name {
            "linear" => (
                |z| [z * 0.7, Complex64::new(0.7, 0.0), Complex64::ZERO],
                |z| {
                    let a = Complex64::new(0.3, 0.4);
                    [a * z, a]
                },
            ),
            "cubic" => (
                |z| {
                    let a = Complex64::new(1.0, 2.0);
                    [z * z * z + a * z * z, z * z * 3.0 + a * z * 2.0, z * 6.0 + a * 2.0]
                },
                |z| {
                    let a = Complex64::new(2.0, -1.0);
                    [a * z * z - z, a * z * 2.0 - 1.0]
                },
            ),
            "exp" => (|z| [z.exp(); 3], |z| [z.sin(), z.cos()]),
            _ => (|_| [Complex64::ZERO; 3], |_| [Complex64::ZERO; 2]),
        };
        Self { phi, psi, kappa, mu, kelvin: name == "kelvin" }
    }

    fn potentials(&self, z: Complex64) -> ([Complex64; 3], [Complex64; 2]) {
        if !self.kelvin {
            return ((self.phi)(z), (self.psi)(z));
        }
        let k = -FORCE / (2.0 * std::f64::consts::PI * (1.0 + self.kappa));
        let r = z - SOURCE;
        (
            [k * r.ln(), k / r, -k / (r * r)],
            [
                -self.kappa * k.conj() * r.ln() - SOURCE.conj() * k / r,
                -self.kappa * k.conj() / r + SOURCE.conj() * k / (r * r),
            ],
        )
    }

    pub fn displacement(&self, x: [f64; 2]) -> [f64; 2] {
        let z = Complex64::new(x[0], x[1]);
        let (f, g) = self.potentials(z);
        let w = (self.kappa * f[0] - z * f[1].conj() - g[0].conj()) / (2.0 * self.mu);
        [w.re, w.im]
    }

    /// σ_xx + σ_yy = 4 Re φ', σ_yy - σ_xx + 2iσ_xy = 2(conj(z)φ'' + ψ').
    pub fn stress(&self, x: [f64; 2]) -> [f64; 3] {
        let z = Complex64::new(x[0], x[1]);
        let (f, g) = self.potentials(z);
        let (sum, difference) = (4.0 * f[1].re, 2.0 * (z.conj() * f[2] + g[1]));
        [(sum - difference.re) / 2.0, (sum + difference.re) / 2.0, difference.im / 2.0]
    }

    pub fn traction(&self, x: [f64; 2], n: [f64; 2]) -> [f64; 2] {
        let [xx, yy, xy] = self.stress(x);
        [xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]]
    }
}

pub const SQUARE: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
pub const L_SHAPE: [[f64; 2]; 6] = [[0.0, 0.0], [0.0, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, 0.0]];

/// A polygon whose edges are all sides of their own.
pub fn polygon(outer: &[[f64; 2]], holes: &[&[[f64; 2]]]) -> Polygon {
    let one = |corners: &[[f64; 2]], tag: &str| {
        Loop::straight(corners.to_vec(), (0..corners.len()).map(|k| format!("{tag}{k}")).collect())
    };
    let holes = holes.iter().enumerate().map(|(h, c)| one(c, &format!("hole{h}-"))).collect();
    Polygon::new(one(outer, "side"), holes).expect("a valid polygon")
}

/// Largest absolute value.
pub fn max_abs(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// S u for a full matrix.
pub fn product(a: &faer::Mat<f64>, u: &[f64]) -> Vec<f64> {
    (0..a.nrows()).map(|i| (0..a.ncols()).map(|j| a[(i, j)] * u[j]).sum()).collect()
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
