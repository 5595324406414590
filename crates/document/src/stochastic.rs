//! `[stochastic]`: how a problem with random input is solved, and what is chosen where the scene leaves it open.

use steklov_problem::{DataErrorKind, GridInput, Model, Sampling, Scene, Stochastic};

use super::error::ReadError;
use super::fields::{Field, Fields};
use super::keys;

/// Every choice of outcomes and its word; none is chosen by what a scene has.
pub(super) const SAMPLINGS: [(&str, Option<Sampling>); 7] = [
    ("auto", None),
    ("galerkin", Some(Sampling::Galerkin)),
    ("collocation", Some(Sampling::Collocation)),
    ("sparse", Some(Sampling::Sparse)),
    ("corrected", Some(Sampling::Corrected)),
    ("monte-carlo", Some(Sampling::MonteCarlo)),
    ("multilevel", Some(Sampling::Multilevel)),
];
/// Whether stochastic elements are split, and the words.
pub(super) const SPLITS: [(&str, bool); 2] = [("none", false), ("adaptive", true)];
/// Keys of rules, and the method that has them.
const RULES: [(&str, Sampling); 4] = [
    ("degree", Sampling::Galerkin),
    ("elements", Sampling::Galerkin),
    ("refine", Sampling::Galerkin),
    ("level", Sampling::Sparse),
];
/// Standard errors of means over deviations, of methods that work towards one.
const TOLERANCE: f64 = 0.01;
/// Root mean square truncation of stochastic elements over the deviation: means are off by a small part of it.
const TRUNCATION: f64 = 0.05;
/// Most outcomes of multilevel Monte Carlo.
const MOST: usize = 10_000_000;
/// Tolerance below which an affine modulus of few germs would need level 3 of a sparse grid, and the most germs of them.
const TIGHT: f64 = 0.005;
const AT_ONCE: usize = 8;
/// Most germs for which stochastic elements are chosen: 256 points of the first one.
const FEW: usize = 4;
/// Germs from which on differences between grids are chosen: a sparse grid of level 1 has more than 200 points.
const MANY: usize = 100;
/// Most germs on a grid for which level 2 of a sparse grid is the default: 221 points.
const LEVEL_TWO: usize = 10;

/// What a scene asks for.
pub(super) struct Asked<'a> {
    settings: Stochastic,
    given: Option<Fields<'a>>,
    method: Option<Sampling>,
}

impl<'a> Asked<'a> {
    /// Reads `[stochastic]`.
    pub(super) fn read(field: Option<&Field<'a>>) -> Result<Self, ReadError> {
        let mut settings = Stochastic::default();
        let Some(field) = field else { return Ok(Self { settings, given: None, method: None }) };
        let table = Fields::new(field, &keys::STOCHASTIC)?;
        let mut method = None;
        for (key, _, field) in table.all() {
            match key {
                "method" => method = field.choice(&SAMPLINGS)?,
                "degree" => settings.degree = field.whole(keys::DEGREE_FROM_0)?,
                "elements" => settings.elements = field.whole(keys::ELEMENTS)?,
                "level" => settings.level = field.whole(keys::LEVEL)?,
                "refine" => settings.refine = field.choice(&SPLITS)?,
                "tolerance" => settings.tolerance = field.number_in(&keys::FRACTION)?,
                "max_nodes" => settings.max_nodes = field.whole(keys::NODES)?,
                "samples" => settings.samples = field.whole(keys::SAMPLES)?,
                "seed" => settings.seed = field.whole(keys::NATURAL)? as u64,
                "quantiles" => {
                    let numbers = field.list()?;
                    let number = |q: &Field<'_>| q.number_in(&keys::FRACTION);
                    settings.quantiles = numbers.iter().map(number).collect::<Result<_, _>>()?;
                }
                _ => {
                    let paths = field.list()?;
                    let text = |q: &Field<'_>| q.text().map(str::to_owned);
                    settings.quantities = Some(paths.iter().map(text).collect::<Result<_, _>>()?);
                }
            }
        }
        let rule = RULES.iter().find_map(|(key, method)| Some((table.get(key)?, *method)));
        if let (None, Some(auto), Some((field, _))) = (method, table.get("method"), &rule) {
            let message = format!("{} stands beside {} = \"auto\", which chooses it", field.name, auto.name);
            let help = "leave one of the two out, or name the method";
            return Err(ReadError::new(DataErrorKind::Conflict, field.item.place, message, help));
        }
        let method = method.or(rule.map(|(_, method)| method));
        let only_point = match method {
            Some(Sampling::Galerkin | Sampling::Collocation) => {
                settings.degree == 0 && settings.elements == 1 && !settings.refine
            }
            Some(Sampling::Sparse) => settings.level == 0,
            _ => false,
        };
        if let Some(field) = table.get("degree").or(table.get("level")).filter(|_| only_point) {
            let message = format!("{} is 0: one point stands for all outcomes, and every deviation is 0", field.name);
            return Err(field.problem(message, "it must be 1 or more"));
        }
        Ok(Self { settings, given: Some(table), method })
    }

    /// Whether it asks for a product of rules of the germs.
    pub(super) fn is_product(&self) -> bool {
        matches!(self.method, Some(Sampling::Galerkin | Sampling::Collocation))
    }

    /// The settings for the random input of a scene. Where no method is asked for: stochastic elements that are refined for few germs
    /// by boundary elements, differences between grids for very many, or for fields that are drawn as a whole, on one without
    /// contact, polynomials of all outcomes at once for tight tolerances where they can be, else a sparse grid that fresh
    /// outcomes correct. None without random input.
    pub(super) fn chosen(self, scene: &Scene) -> Option<Stochastic> {
        let Self { mut settings, given, method: asked } = self;
        let (random, problem, method) = (scene.random.as_ref()?, &scene.problem, &scene.method);
        let (germs, drawn) = (random.germs.len(), !random.drawn_germs().is_empty());
        let open = |key: &str| given.as_ref().is_none_or(|given| given.get(key).is_none());
        let grid = problem.bodies[0].grid.as_ref();
        let halved = |cells: [usize; 2]| cells.iter().all(|n| n.is_multiple_of(4));
        let fem = |grid: &GridInput| method.model == Model::Fem || method.model == Model::Auto && grid.fine == [1, 1];
        let family = grid.is_some_and(|grid| fem(grid) && halved(grid.cells()) && problem.interfaces().is_empty());
        let tight = !open("tolerance") && settings.tolerance < TIGHT;
        let at_once = || tight && germs <= AT_ONCE && grid.is_some_and(fem) && scene.takes_galerkin();
        settings.method = asked.unwrap_or(match grid {
            None if germs <= FEW => Sampling::Galerkin,
            Some(_) if at_once() => Sampling::Galerkin,
            Some(_) if (germs > MANY || drawn) && family => Sampling::Multilevel,
            _ => Sampling::Corrected,
        });
        let on_grid = grid.is_some() && scene.is_on_grid();
        if asked.is_none() && settings.method == Sampling::Galerkin {
            (settings.refine, settings.of_deviation) = (!on_grid, true);
        }
        let to_degree = settings.method == Sampling::Galerkin && on_grid && open("degree");
        settings.of_deviation |= to_degree;
        let works_towards = to_degree || matches!(settings.method, Sampling::Corrected | Sampling::Multilevel);
        if open("tolerance") && works_towards {
            settings.tolerance = TOLERANCE;
        }
        if open("tolerance") && settings.of_deviation && !to_degree {
            settings.tolerance = TRUNCATION;
        }
        if open("max_nodes") && settings.method == Sampling::Multilevel {
            settings.max_nodes = MOST;
        }
        if open("level") && grid.is_some() && germs > LEVEL_TWO {
            settings.level = 1;
        }
        Some(settings)
    }
}
