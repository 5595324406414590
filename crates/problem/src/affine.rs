//! Moduli that are affine in the germs, and whether a scene is linear and affine in them.

use steklov_expression::Expression;
use steklov_msfem::Grid;

use super::{
    CellModuli, DataError, DataErrorKind as Kind, Model, Random, Sampling, Scene, Stochastic, Uses, grid_of, moduli,
};

/// What to do where Galerkin's equations of all outcomes cannot be made.
const CORRECTED: &str = "take method = \"corrected\", which solves outcome by outcome";

/// Young's modulus (stress) of every cell of a grid as an affine function of the germs: E(ξ) = E_0 + Σ_m (ξ_m - E ξ_m) E_m.
#[derive(Debug, Clone, PartialEq)]
pub struct AffineModuli {
    /// E_0, then E_m of each germ (stress per unit of the germ); what dropped cells have is not checked.
    pub parts: Vec<Vec<f64>>,
    /// The largest part of its mean that a modulus in the body loses where germs are at their ends, below 1.
    pub largest_loss: f64,
}

impl Scene {
    /// Whether [`Sampling::Galerkin`] solves the scene, of a body on a grid that supports hold, with moduli that stay positive.
    pub fn takes_galerkin(&self) -> bool {
        let mut scene = self.clone();
        let Some(random) = &mut scene.random else { return false };
        let stochastic =
            Stochastic { method: Sampling::Galerkin, elements: 1, refine: false, ..random.stochastic.clone() };
        random.stochastic = stochastic;
        let Some(random) = &scene.random else { return false };
        let positive = || grid_of(&scene).is_ok_and(|grid| scene.affine_moduli(random, &grid).is_ok());
        let held = scene.free_of_supports(None).is_empty();
        held && scene.is_on_grid() && scene.check_affine(random).is_ok() && positive()
    }

    /// Whether Galerkin in polynomials of all germs can solve the scene on a grid: linear and, in the germs, affine.
    ///
    /// # Errors
    /// What it has that this cannot treat, with its place and what to take instead.
    pub(super) fn check_affine(&self, random: &Random) -> Result<(), DataError> {
        let refuse = |keys: &[Vec<&str>], message: &str, help: &str| {
            Err(DataError::at(Kind::Unsupported, keys, format!("galerkin on a grid {message}"), help))
        };
        let (method, names) = (vec!["stochastic", "method"], vec!["random"]);
        if self.model() != Model::Fem {
            let help = "set method.model = \"fem\" and leave out [exterior], or take method = \"corrected\"";
            return refuse(&[method, names], "is of bilinear elements alone", help);
        }
        if let Some((side, _)) = self.contacts().next() {
            let side = self.problem.sides[side].name.as_str();
            let keys = [vec!["sides", side, "contact"], vec!["sides", side], method];
            return refuse(&keys, "is for linear problems, and in contact outcomes differ", CORRECTED);
        }
        if let Some(side) = self.problem.sides.iter().find(|side| side.springs.is_some()) {
            let keys = [vec!["sides", side.name.as_str(), "springs"], method];
            return refuse(&keys, "has no springs", CORRECTED);
        }
        for (is_given, key) in [(random.stochastic.elements > 1, "elements"), (random.stochastic.refine, "refine")] {
            if is_given {
                let help = "leave it out and raise stochastic.degree, the total degree";
                return refuse(&[vec!["stochastic", key]], "has one polynomial over all germs", help);
            }
        }
        let Uses { loads, contact, held, springs, ties, .. } = self.uses(random);
        let uses = [(loads, "loads"), (contact, "contact"), (held, "prescribed displacements")];
        for (is_random, what) in uses.into_iter().chain([(springs, "springs"), (ties, "ties")]) {
            if is_random {
                return refuse(&[names, method], &format!("has random moduli alone, and {what} are random"), CORRECTED);
            }
        }
        if let Some(germ) = random.germs.iter().find(|g| !g.variable.germ_support().iter().all(|x| x.is_finite())) {
            let message = format!("needs bounded germs, and {:?} has no bounds: a modulus may be negative", germ.label);
            let help =
                format!("bound it by low = .. and high = .., of a field variables = \"uniform\"; or {CORRECTED}");
            return refuse(&[vec!["random", &germ.label], names, method], &message, &help);
        }
        self.young_expression(random).map_or(Ok(()), |young| check_young(random, young))?;
        let of_cells = self.body().cells().and_then(|cells| cells.poisson.as_ref());
        match of_cells {
            Some(CellModuli::Expression(e)) if random.names.iter().any(|name| e.uses(name.name())) => {
                let message =
                    "galerkin on a grid needs moduli that are affine in the germs, and Poisson's ratio is random";
                Err(DataError::new(Kind::Unsupported, e.place, message, CORRECTED))
            }
            _ => Ok(()),
        }
    }

    /// The random Young's modulus of the body on the grid.
    fn young_expression<'a>(&'a self, random: &'a Random) -> Option<&'a Expression> {
        match self.body().cells().map(|cells| &cells.young) {
            Some(CellModuli::Expression(young)) => Some(young),
            Some(_) => None,
            None => random.constants.young.get(&0),
        }
    }

    /// Young's modulus of every cell of a grid in the germs, of a scene with [`Sampling::Galerkin`] on a grid.
    ///
    /// Exact but for rounding: the expression is affine by its form, so that one difference for each germ is the slope.
    ///
    /// # Errors
    /// Those of [`moduli`]; a modulus in the body that some combination of the germs' ends makes 0 or negative, with its place.
    pub fn affine_moduli(&self, random: &Random, grid: &Grid) -> Result<AffineModuli, DataError> {
        let means: Vec<f64> = random.germs.iter().map(|g| g.variable.mean()).collect();
        let at = |germs: &[f64]| moduli(&self.outcome(germs)?, grid);
        let mean = at(&means)?;
        let mut lowest = mean.clone();
        let mut parts = vec![mean];
        for (m, germ) in random.germs.iter().enumerate() {
            let off = germ.variable.germ_support().map(|end| end - means[m]);
            let mut germs = means.clone();
            germs[m] += off[1];
            let slope: Vec<f64> = at(&germs)?.iter().zip(&parts[0]).map(|(e, e0)| (e - e0) / off[1]).collect();
            lowest.iter_mut().zip(&slope).for_each(|(low, s)| *low += (s * off[0]).min(s * off[1]));
            parts.push(slope);
        }
        match grid.body_cells().find(|&c| lowest[c].is_nan() || lowest[c] <= 0.0) {
            None => {
                let loss = |c: usize| 1.0 - lowest[c] / parts[0][c];
                let largest_loss = grid.body_cells().map(loss).fold(0.0, f64::max);
                Ok(AffineModuli { parts, largest_loss })
            }
            Some(cell) => {
                let ([x, y], value) = (grid.centre(cell), lowest[cell]);
                let message = format!(
                    "Young's modulus is {value} in the cell around ({x}, {y}) where all germs are at their ends"
                );
                let help = "no outcome may reach 0: take a smaller deviation or fewer modes, or a lognormal modulus and \
                            method = \"corrected\"";
                Err(match self.young_expression(random) {
                    Some(young) => DataError::new(Kind::Data, young.place, message, help),
                    None => DataError::at(Kind::Data, &[vec!["random"]], message, help),
                })
            }
        }
    }

    /// Whether one system of equations, on a grid, is of all outcomes.
    pub fn is_of_all_outcomes(&self, random: &Random) -> bool {
        random.stochastic.method == Sampling::Galerkin && self.is_on_grid()
    }
}

/// Whether a modulus is affine in the germs.
fn check_young(random: &Random, young: &Expression) -> Result<(), DataError> {
    let refuse = |why: &str| {
        let text = young.text();
        let message = format!("galerkin on a grid needs a modulus that is affine in the germs, and {text:?} {why}");
        let help = format!("write it as a sum of products of at most one random name each; or {CORRECTED}");
        Err(DataError::new(Kind::Unsupported, young.place, message, help))
    };
    let used = |label: &str| young.uses(label);
    if let Some(germ) = random.germs.iter().find(|g| !g.variable.is_affine() && used(&g.label)) {
        return refuse(&format!("uses {}, which is the exponential of its germ", germ.label));
    }
    match young.is_affine_in(random.names.iter().map(|name| name.name())) {
        true => Ok(()),
        false => refuse("is not"),
    }
}
