//! What a study sets in a scene.

use steklov_problem::Method;

/// First mesh of every strategy: a comparison needs the way from coarse to fine.
const FIRST: [&str; 2] = ["method.elements=16", "method.degree=1"];
/// Relative error (energy norm) at which a strategy is done, if the scene names none.
const TOLERANCE: &str = "method.tolerance=1e-6";
/// Largest number of displacement unknowns, if the scene does not allow fewer.
const MAX_DOFS: usize = 1100;

/// The overrides of a study: a coarse first mesh, and limits that let all strategies end within a minute or two, where
/// the user sets nothing else; then those of the user. `method` is that of the scene.
pub fn settings(method: &Method, user: &[String]) -> Vec<String> {
    let mut all: Vec<String> = FIRST.map(String::from).to_vec();
    if method.tolerance.is_none() {
        all.push(TOLERANCE.into());
    }
    if method.max_dofs.is_none_or(|given| given > MAX_DOFS) {
        all.push(format!("method.max_dofs={MAX_DOFS}"));
    }
    all.iter().rev().fold(user.to_vec(), |all, own| unless_set(own, &all))
}

/// A study's own override where the user does not set its key, then those of the user.
pub(crate) fn unless_set(own: &str, user: &[String]) -> Vec<String> {
    let key = |o: &str| o.split('=').next().unwrap_or_default().trim().to_owned();
    let own = user.iter().all(|u| key(u) != key(own)).then(|| own.to_owned());
    own.into_iter().chain(user.iter().cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scene_keeps_its_tolerance_and_lower_limits_and_the_user_wins() {
        let user = ["method.degree =3".to_owned()];
        let first = ["method.elements=16"];
        let of = |method: Method, more: &[&str]| {
            let expected: Vec<&str> = first.iter().chain(more).copied().chain(["method.degree =3"]).collect();
            assert_eq!(settings(&method, &user), expected);
        };
        let default = Method::default();
        of(default, &["method.tolerance=1e-6", "method.max_dofs=1100"]);
        of(Method { tolerance: Some(1e-4), ..default }, &["method.max_dofs=1100"]);
        of(Method { max_dofs: Some(1100), elements: Some(64), ..default }, &["method.tolerance=1e-6"]);
        let more = Method { max_dofs: Some(1101), ..default };
        of(more, &["method.tolerance=1e-6", "method.max_dofs=1100"]);
    }
}
