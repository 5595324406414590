//! Ratio of the residual indicators of the coupling to the error: term by term, on finer grids and over the contrast.

use steklov_bem_operators::Polygon;
use steklov_coupling::{
    CellIndicators, CouplingError, Form, InterfaceIndicators, Interior, Jumps, Radiation, Transmission,
};
use steklov_elastic::Material;

use super::convergence::ENERGY;
use super::grids::Level;
use super::manufactured::{Manufactured, Pair};
use crate::table::Column;
use crate::watch::Watch;

/// The forms whose indicators differ, and their names.
pub const INDICATED: [(&str, Form); 2] = [("two-field, Schur", Form::TwoField), ("three-field", Form::ThreeField)];

/// The terms and their names.
pub const TERMS: [&str; 5] = [
    "force in the cells",
    "jumps between cells",
    "balance of tractions",
    "equation of displacements",
    "equation with W",
];

/// Decimal logarithms of the contrasts.
const POWERS: std::ops::RangeInclusive<i32> = -3..=3;
/// u0 is interpolated on quarters of the elements.
const HALVINGS: usize = 2;

/// The indicators of one solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indicated {
    /// Number of the pair.
    pub pair: usize,
    /// Number in [`INDICATED`].
    pub form: usize,
    /// E of the body over that of the medium.
    pub contrast: f64,
    /// Cells along x and y, over the bounding box.
    pub cells: [usize; 2],
    /// Root of the sum of the squared errors of the body, energy norm, and of the traction, norm of V ((force length/thickness)^½).
    pub error: f64,
    /// Root of the sum of each term over the error; NaN for a term that the form does not have.
    pub terms: [f64; 5],
    /// Root of the sum of all terms over the error.
    pub whole: f64,
}

/// Columns of the indicators.
pub(super) const INDICATORS: [Column<Indicated>; 12] = [
    ("pair", "1", "number of the pair of materials", |i| i.pair as f64),
    ("form", "1", "0 two-field and Schur, 1 three-field", |i| i.form as f64),
    ("contrast", "1", "modulus of the body over that of the medium", |i| i.contrast),
    ("cells_x", "1", "cells along x", |i| i.cells[0] as f64),
    ("cells_y", "1", "cells along y", |i| i.cells[1] as f64),
    ("error", ENERGY, "error of body and traction, energy norm and norm of V", |i| i.error),
    ("volume", "1", "residual of the body force in the cells over the error", |i| i.terms[0]),
    ("jump", "1", "jumps of tractions between cells over the error", |i| i.terms[1]),
    ("balance", "1", "balance of tractions on the interface over the error", |i| i.terms[2]),
    ("displacement", "1", "equation of displacements of the medium over the error", |i| i.terms[3]),
    ("hypersingular", "1", "equation of the medium with W over the error; NaN of two fields", |i| i.terms[4]),
    ("effectivity", "1", "root of the sum of all terms over the error", |i| i.whole),
];

/// Effectivities on finer grids, and over the contrast.
#[derive(Debug, Clone, Default)]
pub struct Effectivity {
    /// Effectivities by pair, grid and form.
    pub grids: Vec<Indicated>,
    /// Effectivities by contrast and form.
    pub contrasts: Vec<Indicated>,
    /// The failures, each with its reason.
    pub failures: Vec<(String, String)>,
}

impl Effectivity {
    /// The points of a pair and a form.
    pub fn of(&self, pair: usize, form: usize) -> impl Iterator<Item = &Indicated> {
        self.grids.iter().filter(move |i| (i.pair, i.form) == (pair, form))
    }

    /// The points of a form over the contrast.
    pub fn over_contrast(&self, form: usize) -> impl Iterator<Item = &Indicated> {
        self.contrasts.iter().filter(move |i| i.form == form)
    }
}

/// Estimates the errors of all pairs on all grids, and of the last pair at all contrasts on the last grid but one.
/// After a request to stop nothing more is solved.
pub fn effectivity(polygon: &Polygon, pairs: &[Pair], levels: &[Level], watch: &mut Watch<'_>) -> Effectivity {
    let mut all = Effectivity::default();
    let mut estimate = |number: usize, pair: &Pair, level: &Level, failures: &mut Vec<(String, String)>| {
        if watch.stopped() {
            return Vec::new();
        }
        let [x, y] = level.grid.cells;
        let contrast = pair.body.young / pair.medium.young;
        let at = format!("indicators, contrast {contrast:.1e}, {x} by {y} cells");
        watch.tell("indicators", &at);
        let found = indicated(&Manufactured::new(polygon, pair), level);
        let found = found.map_err(|error| failures.push((at, error.to_string())));
        found.map_or(Vec::new(), |points| points.map(|point| Indicated { pair: number, ..point }).to_vec())
    };
    for (number, pair) in pairs.iter().enumerate() {
        for level in levels {
            all.grids.extend(estimate(number, pair, level, &mut all.failures));
        }
    }
    if let (Some(own), Some(level)) = (pairs.last(), levels.iter().rev().nth(1).or(levels.last())) {
        for power in POWERS {
            let young = own.medium.young * 10f64.powi(power);
            let pair = Pair { body: Material { young, ..own.body }, ..own.clone() };
            all.contrasts.extend(estimate(pairs.len() - 1, &pair, level, &mut all.failures));
        }
    }
    all
}

/// The indicators of one pair on one grid, by both forms.
fn indicated(exact: &Manufactured<'_>, level: &Level) -> Result<[Indicated; 2], CouplingError> {
    let problem = exact.problem(&level.grid)?;
    let interior = Interior::fine(&problem.body, &problem.loads)?;
    let exterior = exact.exterior(&interior)?;
    let transmission = Transmission::new(interior, &exterior)?;
    let nodal = exterior.space.interpolate(|x| exact.jump(x));
    let (u0, t0) = (|x: [f64; 2]| exact.jump(x), |x: [f64; 2], n: [f64; 2]| exact.traction_jump(x, n));
    let jumps = Jumps { displacement: &u0, traction: &t0, halvings: HALVINGS };
    let one = |number: usize| -> Result<Indicated, CouplingError> {
        let form = INDICATED[number].1;
        let solved = transmission.solve(&nodal, form, Radiation::Decaying)?;
        let u = &solved.displacement;
        let [energy, _] = exact.energy_error(&problem.body, u);
        let traction = exact.traction_error(&exterior, &solved.traction);
        let error = energy.hypot(traction);
        let inside = CellIndicators::new(&problem.body, u, &|x| exact.body_force(x), &|_, _| [None; 2]);
        let on = InterfaceIndicators::new(&exterior, &problem.body, u, &solved, form, &jumps)?;
        let sum = |terms: &[f64]| terms.iter().sum::<f64>();
        let hypersingular = on.hypersingular.as_ref().map_or(f64::NAN, |h| sum(h));
        let squared = [sum(&inside.volume), sum(&inside.jump), sum(&on.traction), sum(&on.displacement), hypersingular];
        Ok(Indicated {
            pair: 0,
            form: number,
            contrast: exact.pair.body.young / exact.pair.medium.young,
            cells: level.grid.cells,
            error,
            terms: squared.map(|s| s.sqrt() / error),
            whole: squared.iter().filter(|s| s.is_finite()).sum::<f64>().sqrt() / error,
        })
    };
    Ok([one(0)?, one(1)?])
}
