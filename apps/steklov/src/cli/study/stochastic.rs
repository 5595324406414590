//! `study --what stochastic`.

use std::sync::atomic::Ordering;

use steklov_model::run::{Progress, run};
use steklov_model::solve::{SolveError, Stage};
use steklov_problem::{DataError, DataErrorKind};
use steklov_study::settings;
use steklov_study::stochastic::{FAMILIES, Stochastic, chance, csv, json, pictures, solvers, space, text, write};

use super::super::{Failure, NOT_REACHED, explained, interrupts};
use super::{StudyArgs, Watch, document, folder, store, tell_results};

/// Tells how statistics converge, and what they cost.
pub(super) fn stochastic(args: &StudyArgs) -> Result<u8, Failure> {
    let document = document(args, |method| settings(method, &args.overrides))?;
    let scene = &document.scene;
    let Some(random) = &scene.random else {
        let message = "the study is about random input, and no datum of the scene uses any".to_owned();
        let help =
            "declare a name under [random] and use it in the modulus, a load or a gap, or study --what convergence";
        let keys = &[vec!["random"], vec!["material", "young"]];
        return Err(Failure(document.error(DataError::at(DataErrorKind::Unsupported, keys, message, help)).render()));
    };
    let out = folder(args, &document, "stochastic")?;
    let stop = interrupts(args.quiet)?;
    let watch = Watch::new(args.quiet, FAMILIES.len() + 8);
    let tell = &mut |what: &str, detail: &str| watch.show(what, detail);
    let failed = |error: SolveError| explained(&document, error);
    let last = run(scene, Progress::first(scene), &stop, &mut |step, stage| {
        if let Stage::Progress(part, _) = stage {
            watch.show("mesh", &format!("step {}, {part}", step + 1));
        }
        Ok(())
    });
    let chance = chance(scene, random, &mut last.map_err(failed)?, &stop, tell).map_err(failed)?;
    let space = space(scene, random, &stop, tell).map_err(failed)?;
    let solvers = solvers(scene, random, &stop, tell).map_err(failed)?;
    watch.show("files", "");
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = Stochastic {
        scene,
        source: &document.source,
        chance: &chance,
        space: &space,
        solvers: solvers.as_ref(),
        interrupted,
    };
    let files = store(&out, "stochastic", &|file| write(file, &study), &csv(&study), &|out| pictures(&study, out))?;
    watch.finish();
    tell_results(args, &out, &files, || json(&study), || text(&study))?;
    Ok(if study.complete() { 0 } else { NOT_REACHED })
}
