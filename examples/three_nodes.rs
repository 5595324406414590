//! Contact of three nodes under Coulomb's law, by hand and by every solver: S u + λ = f, u_n ≤ 0 ≤ λ_n, λ_n u_n = 0, |λ_t| ≤ μ λ_n
//! and u_t = α λ_t with α ≥ 0, which is 0 where |λ_t| < μ λ_n.
//!
//! Along the normal and the tangent alike S = tridiag(-1, [3, 4, 3], -1), so that S 1 = 2; μ = ½, f_n = (4, 3, -3), f_t = (-2, 12, 0).
//!
//! Let nodes 1 and 2 touch: u_n3 = -3/3 = -1, λ_n1 = 4, λ_n2 = 3 + u_n3 = 2. Let node 1 stick and node 2 slip along +t: λ_t2 = ½ 2 = 1,
//! 4 u_t2 - u_t3 = 12 - 1 and -u_t2 + 3 u_t3 = 0 give u_t2 = 3, u_t3 = 1, and λ_t1 = -2 + u_t2 = 1, which is below ½ 4. All signs are as
//! they must be.

use std::error::Error;

use steklov_contact::Status::{Apart, SlipPlus, Stick};
use steklov_contact::faer::Mat;
use steklov_contact::{Condition, ContactNode, Problem, active_set, fixed_point, interior_point, kkt, newton, uzawa};

fn main() -> Result<(), Box<dyn Error>> {
    let condition = Condition {
        normal: [1.0, 0.0],
        tangent: [0.0, 1.0],
        normal_weight: 1.0,
        tangent_weight: 1.0,
        gap: 0.0,
        slip_offset: 0.0,
        bound: 0.0,
        coefficient: 0.5,
    };
    let node = |k: usize| ContactNode { first: 2 * k, unknowns: 2, conditions: vec![condition.clone()] };
    let chain = [[3.0, -1.0, 0.0], [-1.0, 4.0, -1.0], [0.0, -1.0, 3.0]];
    let problem = Problem {
        stiffness: Mat::from_fn(6, 6, |i, j| if i % 2 == j % 2 { chain[i / 2][j / 2] } else { 0.0 }).into(),
        load: vec![4.0, -2.0, 3.0, 12.0, -3.0, 0.0],
        nodes: (0..3).map(node).collect(),
    };
    let answers = [
        ("interior point", interior_point(&problem)?, 1e-12),
        ("semi-smooth Newton", newton(&problem, None)?, 1e-12),
        ("active set", active_set(&problem, None)?, 1e-12),
        ("fixed point", fixed_point(&problem, None)?, 1e-12),
        ("Uzawa", uzawa(&problem, None, None)?, 1e-9),
    ];
    for (name, answer, tolerance) in answers {
        let by_hand = [0.0, 0.0, 0.0, 3.0, -1.0, 1.0, 4.0, 1.0, 2.0, 1.0, 0.0, 0.0];
        let found = answer.displacement.iter().chain(answer.multipliers.as_flattened());
        let error = found.zip(by_hand).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{name:18}: {:3} iterations, error {error:.1e}, {:?}", answer.iterations, answer.status);
        assert!(error < tolerance && kkt(&problem, &answer).worst() < tolerance);
        assert_eq!(answer.status, [Stick, SlipPlus, Apart]);
    }
    Ok(())
}
