//! `study --what inf-sup`.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use steklov_io::{IoError, create_atomically};

use super::super::{Failure, NOT_REACHED, explained, interrupts, say, stem};
use super::{StudyArgs, Watch, check_folder, not_written, scene};
use crate::explain::too_many_dofs;
use crate::picture;
use crate::plan::plan;
use crate::scene::SceneErrorKind;
use crate::study::contact_sides;
use crate::study::inf_sup::{InfSup, csv, json, pairs, pictures, pressures, settings, text, write};

/// Tells which multipliers are stable.
pub(super) fn inf_sup(args: &StudyArgs) -> Result<u8, Failure> {
    let scene = scene(args, |_| settings(&args.overrides))?;
    if contact_sides(&scene).is_empty() {
        let message = "inf-sup constants are about multipliers of contact, and no side is in contact".to_owned();
        let help = "give a side contact = { gap = \"0\" }, or study --what convergence or stability";
        return Err(Failure(scene.error_at(SceneErrorKind::Unsupported, &[vec!["sides"]], message, help).render()));
    }
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-inf-sup", stem(&args.scene))));
    check_folder(&out, args.force)?;
    let cost = plan(&scene).cost;
    if cost.dofs > scene.method.max_dofs {
        return Err(Failure(too_many_dofs(&scene, cost.dofs).render()));
    }
    let stop = interrupts(args.quiet)?;
    let watch = Watch::new(args.quiet, 3);
    let tell = &mut |what: &str, detail: &str| watch.show(what, detail);
    let pressures = pressures(&scene, &stop, tell).map_err(|error| explained(&scene, error))?;
    let points = pairs(&scene, &stop, tell).map_err(|error| explained(&scene, error))?;
    watch.show("files", "");
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = InfSup { scene: &scene, points: &points, pressures: &pressures, interrupted };
    let files = store(&study, &out)?;
    watch.finish();
    if args.json {
        let mut object = json(&study);
        object["files"] = files.iter().map(|f| f.display().to_string()).collect();
        say(&serde_json::to_string_pretty(&object)?);
    } else {
        say(text(&study).trim_end());
        say(&format!("files       {} in {}", files.len(), out.display()));
    }
    Ok(if study.complete() { 0 } else { NOT_REACHED })
}

/// Writes `inf-sup.h5`, the CSV tables and the pictures.
fn store(study: &InfSup<'_>, out: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |e: std::io::Error| not_written(out, &e);
    std::fs::create_dir_all(out).map_err(failed)?;
    let mut files = vec![out.join("inf-sup.h5")];
    create_atomically(&files[0], true, |file| -> Result<(), IoError> { write(file, study) })?;
    for (name, table) in csv(study) {
        let path = out.join(name);
        picture::replace(out, &path, table.as_bytes()).map_err(failed)?;
        files.push(path);
    }
    files.extend(pictures(study, out)?);
    Ok(files)
}
