//! The settings of a study in `[method]` of a scene.

use std::fmt;

use steklov_problem::Method;

use self::Setting::{Degree, Elements, MaxDofs, Tolerance};

/// A key of `[method]` and its value, shown as the override `KEY=VALUE`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Setting {
    /// Elements of the first mesh.
    Elements(usize),
    /// Degree of the first mesh.
    Degree(usize),
    /// Wanted relative error in the energy norm.
    Tolerance(f64),
    /// Largest number of displacement unknowns.
    MaxDofs(usize),
}

impl Setting {
    /// Gives the key its value.
    pub fn apply(self, method: &mut Method) {
        match self {
            Elements(elements) => method.elements = Some(elements),
            Degree(degree) => method.degree = degree,
            Tolerance(tolerance) => method.tolerance = Some(tolerance),
            MaxDofs(max_dofs) => method.max_dofs = Some(max_dofs),
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Elements(elements) => write!(f, "method.elements={elements}"),
            Degree(degree) => write!(f, "method.degree={degree}"),
            Tolerance(tolerance) => write!(f, "method.tolerance={tolerance:e}"),
            MaxDofs(max_dofs) => write!(f, "method.max_dofs={max_dofs}"),
        }
    }
}

/// First mesh of every strategy: a comparison needs meshes from coarse to fine.
const FIRST: [Setting; 2] = [Elements(16), Degree(1)];
/// Relative error (energy norm) at which a strategy ends, if the scene has no tolerance.
const TOLERANCE: f64 = 1e-6;
/// Largest number of displacement unknowns, if the scene does not allow fewer.
const MAX_DOFS: usize = 1100;

/// The settings of a study on adaptive meshes, unless the user overrides them: a coarse first mesh, and limits with
/// which all strategies end within a minute or two. `method` is the method of the scene, overrides included.
pub fn settings(method: &Method) -> Vec<Setting> {
    let tolerance = method.tolerance.is_none().then_some(Tolerance(TOLERANCE));
    let max_dofs = method.max_dofs.is_none_or(|given| given > MAX_DOFS).then_some(MaxDofs(MAX_DOFS));
    FIRST.into_iter().chain(tolerance).chain(max_dofs).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_keeps_its_tolerance_and_lower_limits() {
        let of = |method: Method, more: &[Setting]| assert_eq!(settings(&method), [&FIRST, more].concat());
        let (tolerance, max_dofs) = (Tolerance(1e-6), MaxDofs(1100));
        let default = Method::default();
        of(default, &[tolerance, max_dofs]);
        of(Method { tolerance: Some(1e-4), ..default }, &[max_dofs]);
        of(Method { max_dofs: Some(1100), elements: Some(64), ..default }, &[tolerance]);
        of(Method { max_dofs: Some(1101), ..default }, &[tolerance, max_dofs]);
    }

    #[test]
    fn a_setting_is_shown_as_the_override_that_does_the_same() {
        let scene = "body.corners = [[0, 0], [2, 0], [2, 1], [0, 1]]\nbody.sides = [\"a\", \"b\", \"c\", \"d\"]\n\
                     material = { young = 1, poisson = 0.3 }\nsides.a.displacement = [0, 0]\nsides.c.pressure = 1\n";
        for setting in [Elements(48), Degree(3), Tolerance(1e-3), Tolerance(2.5e-7), MaxDofs(100_000)] {
            let mut method = Method::default();
            setting.apply(&mut method);
            let read = steklov_document::parse(scene, "scene", &[setting.to_string()]).unwrap().method;
            assert!(method != Method::default() && method == read, "{setting}");
        }
        assert_eq!(Tolerance(1e-3).to_string(), "method.tolerance=1e-3");
    }
}
