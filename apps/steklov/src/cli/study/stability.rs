//! `study --what stability`.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use steklov_io::{IoError, create_atomically};

use super::super::{Failure, NOT_REACHED, interrupts, say, stem};
use super::{StudyArgs, Watch, check_folder, not_written, scene, unreferenced};
use crate::explain::too_many_dofs;
use crate::picture;
use crate::plan::plan;
use crate::study::stability::{
    POISSON, Stability, csv, incompressible, json, pictures, read_beside, settings, single_layer, stabilisation, text,
    write,
};

/// Looks for trouble where such methods may have it.
pub(super) fn stability(args: &StudyArgs) -> Result<u8, Failure> {
    let scene = scene(args, |text| settings(text, &args.overrides))?;
    let beside = args.beside.as_deref().map_or(Ok(Vec::new()), read_beside)?;
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-stability", stem(&args.scene))));
    check_folder(&out, args.force)?;
    let cost = plan(&scene).cost;
    if cost.dofs > scene.method.max_dofs {
        return Err(Failure(too_many_dofs(&scene, cost.dofs).render()));
    }
    let stop = interrupts(args.quiet)?;
    let watch = Watch::new(args.quiet, POISSON.len() + 3);
    let tell = &mut |what: &str, detail: &str| watch.show(what, detail);
    let incompressible = incompressible(&scene, &stop, tell).map_err(|error| unreferenced(&scene, error))?;
    let single_layer = single_layer(&scene, &stop, tell)?;
    let stabilisation = stabilisation(&scene, &stop, tell);
    watch.show("files", "");
    let interrupted = stop.load(Ordering::Relaxed) > 0;
    let study = Stability {
        scene: &scene,
        incompressible: &incompressible,
        beside: &beside,
        single_layer: &single_layer,
        stabilisation: stabilisation.as_ref(),
        interrupted,
    };
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

/// Writes `stability.h5`, the CSV tables and the pictures.
fn store(study: &Stability<'_>, out: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |e: std::io::Error| not_written(out, &e);
    std::fs::create_dir_all(out).map_err(failed)?;
    let mut files = vec![out.join("stability.h5")];
    create_atomically(&files[0], true, |file| -> Result<(), IoError> { write(file, study) })?;
    for (name, table) in csv(study) {
        let path = out.join(name);
        picture::replace(out, &path, table.as_bytes()).map_err(failed)?;
        files.push(path);
    }
    files.extend(pictures(study, out)?);
    Ok(files)
}
