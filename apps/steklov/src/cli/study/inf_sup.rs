//! `study --what inf-sup`.

use std::sync::atomic::Ordering;

use steklov_problem::{DataError, DataErrorKind};
use steklov_study::Watch;
use steklov_study::contact_sides;
use steklov_study::inf_sup::{InfSup, pairs, pictures, pressures, report, settings};

use super::super::{Failure, explained, interrupts};
use super::{Bar, StudyArgs, document, finish, folder};

/// Tells which multipliers are stable.
pub(super) fn inf_sup(args: &StudyArgs) -> Result<u8, Failure> {
    let document = document(args, |_| settings(&args.overrides))?;
    let scene = &document.scene;
    if contact_sides(scene).is_empty() {
        let message = "inf-sup constants are about multipliers of contact, and no side is in contact".to_owned();
        let help = "give a side contact = { gap = \"0\" }, or study --what convergence or stability";
        return Err(Failure(
            document.error(DataError::at(DataErrorKind::Unsupported, &[vec!["sides"]], message, help)).render(),
        ));
    }
    let out = folder(args, &document, "inf-sup")?;
    let stop = interrupts(args.quiet)?;
    let bar = Bar::new(args.quiet, 3);
    let tell = &mut |what: &str, detail: &str| bar.show(what, detail);
    let watch = &mut Watch::new(&stop, tell);
    let pressures = pressures(scene, watch).map_err(|error| explained(&document, error))?;
    let points = pairs(scene, watch).map_err(|error| explained(&document, error))?;
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = InfSup { scene, source: &document.source, points: &points, pressures: &pressures, interrupted };
    finish(args, &out, "inf-sup", &bar, &report(&study), &|out| pictures(&study, out))
}
