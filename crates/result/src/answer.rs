//! The file of an answer that was kept in memory.

use std::path::Path;

use steklov_document::Document;
use steklov_io::{File, IoError, create_atomically};
use steklov_model::run::adaptive_loop::Run;
use steklov_model::summary::Summary;
use steklov_model::{Answer, AnyRun};
use steklov_plan::plan;

use crate::keep::Keep;
use crate::record::Record;
use crate::store::{StepQueue, write};

/// Writes the result file of an answer, whole or not at all: the file that the command writes for this document.
///
/// # Errors
/// [`IoError::Exists`] if there is a file of that name and `overwrite` does not hold; those of
/// [`create_atomically`].
pub fn save(path: &Path, overwrite: bool, document: &Document, answer: &Answer) -> Result<(), IoError> {
    create_atomically(path, overwrite, |file| match &answer.run {
        AnyRun::BoundaryElements(run) => save_run(file, path, document, run, answer),
        AnyRun::OnGrid(run) => save_run(file, path, document, run, answer),
    })
}

fn save_run<M: Keep>(
    file: &File,
    path: &Path,
    document: &Document,
    run: &Run<M>,
    answer: &Answer,
) -> Result<(), IoError> {
    let queue = StepQueue::new(file);
    for step in &run.progress.steps {
        queue.push(step.clone());
        queue.write_next();
    }
    queue.finish()?;
    let mut record = Record::new(&document.scene, plan(&document.scene), run, answer.outcomes.clone(), path, 0.0);
    record.summary = Summary { file: path.display().to_string(), ..answer.summary.clone() };
    write(file, &record, &document.source)
}
