//! `study --what stochastic`.

use std::sync::atomic::Ordering;

use steklov_model::error::SolveError;
use steklov_model::run::adaptive_loop::{Event, Progress, run};
use steklov_model::stage::Stage;
use steklov_problem::{DataError, DataErrorKind};
use steklov_study::Watch;
use steklov_study::settings;
use steklov_study::stochastic::{FAMILIES, Stochastic, chance, pictures, report, solvers, space};

use super::super::{Failure, explained, interrupts};
use super::{Bar, StudyArgs, document, finish, folder};

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
    let bar = Bar::new(args.quiet, FAMILIES.len() + 8);
    let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
    let watch = &mut Watch::new(&stop, tell);
    let failed = |error: SolveError| explained(&document, error);
    let last = run(scene, Progress::first(scene), &stop, &mut |step, event| {
        if let Event::Stage(Stage::Progress(part, _)) = event {
            bar.show("mesh", &format!("step {}, {part}", step + 1));
        }
        Ok(())
    });
    let chance = chance(scene, random, &mut last.map_err(failed)?, watch).map_err(failed)?;
    let space = space(scene, random, watch).map_err(failed)?;
    let solvers = solvers(scene, random, watch).map_err(failed)?;
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = Stochastic {
        scene,
        source: &document.source,
        chance: &chance,
        space: &space,
        solvers: solvers.as_ref(),
        interrupted,
    };
    finish(args, &out, "stochastic", &bar, &report(&study), &|out| pictures(&study, out))
}
