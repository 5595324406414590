//! Scenes solved in process.

use std::path::Path;
use std::sync::atomic::AtomicUsize;

use steklov_bem_operators::{Mark, Mesh, Subdivision};
use steklov_document::{Document, SceneError};
use steklov_model::answer::report::{contact_summary, located};
use steklov_model::error::SolveError;
use steklov_model::grid::OnGrid;
use steklov_model::mesh::first_mesh::first_mesh;
use steklov_model::mesh::layout::Layout;
use steklov_model::run::adaptive_loop::{Progress, Run, run};
use steklov_model::run::boundary_elements::BoundaryElements;
use steklov_model::solve::contact_rows::{ContactRow, contact_rows};
use steklov_model::solve::solution::Solved;
use steklov_model::summary::{ContactSummary, Summary};
use steklov_problem::{Model, Refine, Scene};

/// A solved scene with its contact table.
pub struct Answer {
    /// The scene.
    pub scene: Scene,
    /// The solved mesh.
    pub solved: Solved,
    /// Rows of the contact table; none without contact.
    pub rows: Vec<ContactRow>,
    /// Contact in numbers; none without contact.
    pub summary: Option<ContactSummary>,
}

impl Answer {
    /// Contact in numbers.
    ///
    /// # Panics
    /// If the scene has no contact side.
    pub fn contact(&self) -> &ContactSummary {
        self.summary.as_ref().expect("the scene has a contact side")
    }

    /// Iterations of the contact solver and the worst of the judge's five measures.
    ///
    /// # Panics
    /// If the scene has no contact side.
    pub fn judged(&self) -> (usize, f64) {
        let contact = self.solved.contact.as_ref().expect("the scene has a contact side");
        (contact.solution.iterations, contact.audit.worst())
    }

    /// Whether the contact solver reached its criterion; true without contact.
    pub fn converged(&self) -> bool {
        self.solved.contact.as_ref().is_none_or(|c| c.solution.converged())
    }
}

/// A scene from TOML text and overrides `KEY=VALUE`.
///
/// # Errors
/// Those of [`steklov_document::parse`].
pub fn parse(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    steklov_document::parse(text, "test.toml", &overrides)
}

/// A scene of the gallery, `scenes/NAME.toml` or `scenes/NN-NAME.toml`, with overrides.
///
/// # Panics
/// If there is no such scene or it is wrong.
pub fn scene(name: &str, overrides: &[&str]) -> Scene {
    document(name, overrides).scene
}

/// The same with its text.
///
/// # Panics
/// As [`scene`].
pub fn document(name: &str, overrides: &[&str]) -> Document {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let files = std::fs::read_dir(&folder).expect("the folder of scenes");
    let mut paths = files.map(|f| f.expect("an entry of the folder").path());
    let wanted = |stem: &str| stem == name || stem.strip_suffix(name).is_some_and(|number| number.ends_with('-'));
    let path = paths.find(|p| p.file_stem().and_then(|s| s.to_str()).is_some_and(wanted)).expect("the scene exists");
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    Document::read(&path, &overrides).unwrap_or_else(|e| panic!("{}", e.render()))
}

/// The scenes of the gallery on boundary elements by name, in order; links to them are left out.
///
/// # Panics
/// If one is wrong.
pub fn gallery() -> Vec<(String, Scene)> {
    scenes(&[]).into_iter().filter(|(_, scene)| scene.model() == Model::Bem).collect()
}

/// All scenes of the gallery and their names, with keys that are set in them.
pub fn scenes(overrides: &[&str]) -> Vec<(String, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let files = std::fs::read_dir(&folder).expect("the folder of scenes");
    let mut paths: Vec<_> = files.map(|f| f.expect("an entry of the folder").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml") && !path.is_symlink());
    paths.sort();
    let overrides: Vec<String> = overrides.iter().map(|&set| set.to_owned()).collect();
    let named = paths.iter().map(|path| {
        let name = path.file_stem().expect("a file name").to_string_lossy().into_owned();
        (name, steklov_document::read(path, &overrides).unwrap_or_else(|e| panic!("{}", e.render())))
    });
    named.collect()
}

/// Solves a scene as its method says, mesh by mesh.
///
/// # Errors
/// Those of [`run`].
pub fn adapt(scene: &Scene) -> Result<Run<BoundaryElements>, SolveError> {
    run(scene, Progress::first(scene), &AtomicUsize::new(0), &mut |_, _| Ok(()))
}

/// Solves a scene by finite elements, grid by grid.
///
/// # Errors
/// Those of [`run`].
pub fn attempt_grid(scene: &Scene) -> Result<Run<OnGrid>, SolveError> {
    run(scene, Progress::<OnGrid>::new(scene, Vec::new())?, &AtomicUsize::new(0), &mut |_, _| Ok(()))
}

/// The summary of a scene that is solved adaptively.
///
/// # Panics
/// If it has no solution.
pub fn summary(scene: &Scene) -> Summary {
    let run = adapt(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title));
    Summary::of_run(scene, &run, None)
}

/// The summary of a scene that is solved by finite elements.
///
/// # Panics
/// If it has no solution.
pub fn on_grid(scene: &Scene) -> Summary {
    let run = attempt_grid(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.title));
    Summary::of_run(scene, &run, None)
}

/// Solves a scene on a mesh.
///
/// # Errors
/// Those of [`run`].
pub fn attempt(scene: &Scene, mesh: Mesh) -> Result<Answer, SolveError> {
    let mut once = scene.clone();
    once.method.refine = Refine::None;
    let subdivision = Subdivision::new(&mesh, &vec![Mark::Keep; mesh.len()]);
    let progress = Progress { steps: Vec::new(), next: Layout { subdivision, tips: Vec::new(), cuts: None } };
    let run: Run<BoundaryElements> = run(&once, progress, &AtomicUsize::new(0), &mut |_, _| Ok(()))?;
    let (rows, summary) = match &run.last.contact {
        None => (Vec::new(), None),
        Some(contact) => {
            let rows = contact_rows(run.last.trace(), contact);
            let summary =
                contact_summary(&once, run.last.trace(), contact, &rows, located(&once, &run.step().layout.located));
            (rows, Some(summary))
        }
    };
    Ok(Answer { scene: scene.clone(), solved: run.last, rows, summary })
}

/// Solves a scene on a mesh.
///
/// # Panics
/// If it has no solution.
pub fn answer_on(scene: &Scene, mesh: Mesh) -> Answer {
    attempt(scene, mesh).unwrap_or_else(|e| panic!("{e}"))
}

/// Solves a scene on its first mesh.
///
/// # Panics
/// If it has no solution.
pub fn answer(scene: &Scene) -> Answer {
    answer_on(scene, first_mesh(scene))
}
