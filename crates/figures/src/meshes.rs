//! The meshes of steps of a run.

use std::path::{Path, PathBuf};

use steklov_bem_operators::Mesh;
use steklov_picture::{MeshFigure, MeshPanel, Picture, PictureError, meshes, write};

/// The mesh of a step.
#[derive(Debug, Clone, Copy)]
pub struct StepMesh<'a> {
    /// Its number, from 0.
    pub step: usize,
    /// Unknown displacements.
    pub dofs: usize,
    /// The mesh.
    pub mesh: &'a Mesh,
}

/// Draws the meshes of steps below each other.
///
/// # Errors
/// When the picture cannot be drawn.
pub fn mesh_picture(title: &str, steps: &[StepMesh<'_>]) -> Result<Picture, PictureError> {
    let ends = |s: &StepMesh<'_>| -> Vec<_> { (0..s.mesh.len()).map(|e| s.mesh.ends(e)).collect() };
    let elements: Vec<Vec<[[f64; 2]; 2]>> = steps.iter().map(ends).collect();
    let caption = |s: &StepMesh<'_>| format!("step {}: {} elements, {} dofs", s.step, s.mesh.len(), s.dofs);
    let captions: Vec<String> = steps.iter().map(caption).collect();
    let panels = steps.iter().zip(elements.iter().zip(&captions)).map(|(s, (elements, caption))| MeshPanel {
        caption,
        elements,
        degree: &s.mesh.degree,
        side: &s.mesh.side,
    });
    let side_names = steps.first().map_or(&[][..], |s| s.mesh.side_names.as_slice());
    meshes(&MeshFigure { title, side_names, panels: &panels.collect::<Vec<_>>() })
}

/// Draws the meshes of steps of a run into a folder, as `NAME-meshes`; returns the files.
///
/// # Errors
/// When the picture cannot be drawn or written.
pub fn mesh_pictures(
    title: &str,
    steps: &[StepMesh<'_>],
    folder: &Path,
    name: &str,
) -> Result<[PathBuf; 2], PictureError> {
    write(folder, &format!("{name}-meshes"), &mesh_picture(&format!("{title}: meshes"), steps)?)
}
