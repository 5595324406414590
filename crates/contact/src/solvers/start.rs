//! Where a contact solver starts.

use crate::{ContactError, Problem};

/// Where a solver starts: a displacement and multipliers of the shapes of [`crate::Solution`].
#[derive(Debug, Clone, Copy)]
pub struct Start<'a> {
    /// Unknowns v.
    pub displacement: &'a [f64],
    /// `[λ_n, λ_t]` of each condition.
    pub multipliers: &'a [[f64; 2]],
}

impl Start<'_> {
    /// Bᵀλ, what R = f - S v would be if the start were the solution.
    pub(crate) fn nodal_force(&self, problem: &Problem) -> Result<Vec<f64>, ContactError> {
        let count: usize = problem.nodes.iter().map(|n| n.conditions.len()).sum();
        if self.displacement.len() != problem.load.len() || self.multipliers.len() != count {
            let (v, l, m) = (self.displacement.len(), self.multipliers.len(), problem.load.len());
            return Err(ContactError::Inconsistent {
                what: format!("the start has {v} displacements and {l} multipliers, the problem {m} and {count}"),
            });
        }
        let numbers = self.displacement.iter().chain(self.multipliers.iter().flatten());
        if let Some(x) = numbers.copied().find(|x| !x.is_finite()) {
            return Err(ContactError::Inconsistent { what: format!("the start contains {x}") });
        }
        let mut force = vec![0.0; self.displacement.len()];
        let conditions = problem.nodes.iter().flat_map(|n| n.conditions.iter().map(move |c| (n, c)));
        for ((node, c), [normal, shear]) in conditions.zip(self.multipliers) {
            for i in 0..node.unknowns {
                force[node.first + i] +=
                    c.normal_weight * normal * c.normal[i] + c.tangent_weight * shear * c.tangent[i];
            }
        }
        Ok(force)
    }
}
