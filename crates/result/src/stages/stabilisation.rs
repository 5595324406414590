//! Stabilised multipliers of a step and their equations.

use steklov_contact::ContactNode;
use steklov_io::{
    Group, IoError, create_group, label, save, save_dense, save_integers, save_number, save_points, save_vector,
};
use steklov_model::solve::stabilised::StabilisedSystem;

use super::STABILISATION;

const DISPLACEMENT: &str = "displacement unknown: nodes in the order of /solution/points, component fastest";
const NODE: &str = "multiplier node";
const POINT: &str = "quadrature point";

/// The equations, their data and their solution; the attribute `meaning` of `S` and `multipliers` has the formulas.
pub(super) fn save_system(step: &Group, system: &StabilisedSystem<'_>) -> Result<(), IoError> {
    let StabilisedSystem { forms, stiffness, load, held, particular, contact } = system;
    let at = create_group(step, STABILISATION)?;
    save(&at, "space", &contact.space)?;
    save(&at, "forms", *forms)?;
    save_number(
        &at,
        "gamma",
        contact.gamma,
        "1/stress",
        "gamma_0 of gamma = gamma_0 h/p^2, of B_gamma, C_gamma, D_gamma",
    )?;
    let meaning =
        "the largest gamma_0 for which S - gamma_0 B is not negative on the unknowns that are not held, within 1 %";
    save_number(&at, "critical_gamma", contact.critical, "1/stress", meaning)?;

    let meaning = "S, that of springs and what holds rigid motions that nothing resists in it: (S - gamma B) u + E_n^T lambda_n + E_t^T lambda_t = f + gamma (T_n^T tau_n + T_t^T tau_t) \
                   on unknowns that are not held, with gamma = gamma_0, E = pairing - gamma C";
    save_dense(&at, "S", stiffness.as_ref(), &label("stress", meaning, &[DISPLACEMENT, DISPLACEMENT]))?;
    save_vector(&at, "f", load, &label("force/thickness", "f, without contact", &[DISPLACEMENT]))?;
    let (unknowns, values): (Vec<usize>, Vec<f64>) = held.iter().copied().unzip();
    let axes = &["held unknown"];
    save_integers(&at, "held", &unknowns, &label("1", "displacement unknowns that are held", axes))?;
    save_vector(&at, "held_values", &values, &label("length", "what they are held at", axes))?;
    for (name, tau) in ["tau_n", "tau_t"].into_iter().zip(particular) {
        let meaning =
            "(w h/p^2)^(1/2) tau, of n with Q: traction of a particular solution less sigma^h of its nodal values";
        save_vector(&at, name, tau, &label("stress*length", meaning, &[POINT]))?;
    }

    save_vector(&at, "displacement", &contact.displacement, &label("length", "u, held values in it", &[DISPLACEMENT]))?;
    let meaning = "lambda_n, lambda_t: with r = E u - gamma D lambda - gamma M^T tau of n and of t, lambda_n >= 0, \
                   r_n <= weight gap, lambda_n (r_n - weight gap) = 0, |lambda_t| <= F = bound + coefficient lambda_n, \
                   r_t lambda_t >= 0, r_t = 0 where |lambda_t| < F";
    let axes = &[NODE, "normal, tangential"];
    save_points(&at, "multipliers", &contact.solution.multipliers, &label("stress", meaning, axes))?;
    save_vector(&at, "gap", &contact.gaps, &label("length", "int g mu_i ds over int mu_i ds", &[NODE]))?;
    let condition = |node: &ContactNode| node.conditions.first().map_or([0.0; 2], |c| [c.bound, c.coefficient]);
    let (bound, coefficient): (Vec<f64>, Vec<f64>) =
        contact.nodes.iter().map(condition).map(|[bound, coefficient]| (bound, coefficient)).unzip();
    save_vector(&at, "bound", &bound, &label("stress", "friction bound of the node", &[NODE]))?;
    let meaning = "coefficient of friction of the node";
    save_vector(&at, "coefficient", &coefficient, &label("1", meaning, &[NODE]))
}
