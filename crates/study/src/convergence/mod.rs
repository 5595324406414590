//! Strategies of refinement compared on one scene: true errors and estimates over unknowns and seconds.
//!
//! ```text
//! settings ─► Reference ─► strategy by strategy: runs, true errors ─► Study ─► report, draw
//! ```

mod strategy;
mod report;
mod draw;

use steklov_document::Source;
use steklov_problem::{Multiplier, Refine, Scene};

use crate::error::StudyError;
use crate::reference::{EnergySource, Reference};
use crate::watch::Watch;

pub use draw::{mesh_picture, pictures};
pub use report::report;
pub use strategy::{Constants, End, MULTIPLIERS, NAMES, Point, Strategy, strategy};

pub(crate) use strategy::for_truth;

/// Largest number of steps of a strategy whose true errors are measured, and which are printed.
const MEASURED: usize = 10;

/// A finished comparison.
#[derive(Debug)]
pub struct Study<'a> {
    /// The scene as it was run, [`crate::settings`] included.
    pub scene: &'a Scene,
    /// The texts from which it was read.
    pub source: &'a Source,
    /// The reference against which errors are measured.
    pub reference: Reference,
    /// The strategies in the requested order.
    pub strategies: Vec<Strategy>,
    /// Number of runs of each strategy; its seconds are their medians.
    pub repeat: usize,
    /// Whether the user stopped it.
    pub interrupted: bool,
}

/// A strategy to run: its name, refinement and multiplier.
pub type Chosen = (String, Refine, Multiplier);

/// The strategies of these names, all if there are none, each with every multiplier of these names, or with that of the scene.
pub fn strategies<S: AsRef<str>>(scene: &Scene, names: &[S], multipliers: &[S]) -> Vec<Chosen> {
    let is_in = |list: &[S], name: &str| list.iter().any(|wanted| wanted.as_ref() == name);
    let mut all = Vec::new();
    for (name, refine) in NAMES.into_iter().filter(|(name, _)| names.is_empty() || is_in(names, name)) {
        if multipliers.is_empty() {
            all.push((name.to_owned(), refine, scene.method.multiplier));
        }
        let chosen = MULTIPLIERS.into_iter().filter(|(word, _)| is_in(multipliers, word));
        all.extend(chosen.map(|(word, multiplier)| (format!("{name}, {word}"), refine, multiplier)));
    }
    all
}

/// Runs strategies, each a name, a refinement and a multiplier, `repeat` times. After a request to stop no more of them
/// are run.
///
/// # Errors
/// As [`Reference::new`].
pub fn study<'a>(
    scene: &'a Scene,
    source: &'a Source,
    chosen: &[Chosen],
    repeat: usize,
    watch: &mut Watch<'_>,
) -> Result<Study<'a>, StudyError> {
    let reference = Reference::new(&for_truth(scene), watch.interrupts, &mut |step, event| {
        watch.tell_step("reference", "", step, &event);
        Ok(())
    })?;
    let mut strategies = Vec::new();
    for (name, refine, multiplier) in chosen {
        if !watch.stopped() {
            let mut scene = scene.clone();
            scene.method.multiplier = *multiplier;
            strategies.push(strategy(&scene, (name, *refine), &reference, repeat, watch));
        }
    }
    Ok(Study { scene, source, reference, strategies, repeat, interrupted: watch.stopped() })
}

impl Study<'_> {
    /// Whether nobody stopped it and every strategy reached its tolerance or a limit.
    pub fn complete(&self) -> bool {
        !self.interrupted && self.strategies.iter().all(Strategy::complete)
    }

    /// The J that energy errors refer to, in words.
    fn energy_source(&self) -> String {
        match &self.reference.source {
            EnergySource::Own => "the study's own finest solution".into(),
            EnergySource::Expected { source } if source.is_empty() => "the scene's [expect]".into(),
            EnergySource::Expected { source } => format!("the scene's [expect]: {source}"),
            EnergySource::Contradicted { expected } => format!(
                "the study's own finest solution; the scene's [expect] energy = {expected:?} is {:.1e} off",
                (expected - self.reference.own_energy).abs()
            ),
        }
    }
}

/// At most `most` of these steps: the first, the last, and some between that are evenly spaced in log N.
fn chosen(dofs: &[usize], most: usize) -> Vec<usize> {
    let (Some(&first), Some(&last)) = (dofs.first(), dofs.last()) else { return Vec::new() };
    let (low, high) = ((first as f64).ln(), (last as f64).ln());
    let places = (0..most).map(|k| low + (high - low) * k as f64 / (most.max(2) - 1) as f64);
    let nearest = |x: f64| {
        let off = |k: &usize| ((dofs[*k] as f64).ln() - x).abs();
        (0..dofs.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
    };
    let mut chosen: Vec<usize> =
        if dofs.len() <= most { (0..dofs.len()).collect() } else { places.filter_map(nearest).collect() };
    chosen.dedup();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_steps_are_the_ends_and_some_between() {
        let dofs = |n: usize| -> Vec<usize> { (1..=n).map(|k| 32 * k).collect() };
        assert_eq!(chosen(&dofs(0), 6), Vec::<usize>::new());
        assert_eq!(chosen(&dofs(1), 6), [0]);
        assert_eq!(chosen(&dofs(6), 6), [0, 1, 2, 3, 4, 5]);
        // 32 to 1024 dofs by factors of two
        assert_eq!(chosen(&dofs(32), 6), [0, 1, 3, 7, 15, 31]);
        let some = chosen(&dofs(40), 5);
        assert_eq!((some.len(), some[0], some[4]), (5, 0, 39));
        // a step that repeats its dofs
        assert_eq!(chosen(&[8, 8, 8], 2), [0]);
    }
}
