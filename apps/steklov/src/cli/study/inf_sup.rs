//! `study --what inf-sup`.

use std::sync::atomic::Ordering;

use steklov_problem::{DataError, DataErrorKind};
use steklov_study::contact_sides;
use steklov_study::inf_sup::{InfSup, csv, json, pairs, pictures, pressures, settings, text, write};

use super::super::{Failure, NOT_REACHED, explained, interrupts};
use super::{StudyArgs, Watch, document, folder, store, tell_results};

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
    let watch = Watch::new(args.quiet, 3);
    let tell = &mut |what: &str, detail: &str| watch.show(what, detail);
    let pressures = pressures(scene, &stop, tell).map_err(|error| explained(&document, error))?;
    let points = pairs(scene, &stop, tell).map_err(|error| explained(&document, error))?;
    watch.show("files", "");
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = InfSup { scene, source: &document.source, points: &points, pressures: &pressures, interrupted };
    let files = store(&out, "inf-sup", &|file| write(file, &study), &csv(&study), &|out| pictures(&study, out))?;
    watch.finish();
    tell_results(args, &out, &files, || json(&study), || text(&study))?;
    Ok(if study.complete() { 0 } else { NOT_REACHED })
}
