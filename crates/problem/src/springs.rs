//! The conditions beside which sides cannot have springs, and how stiff these may be.

use super::{Condition, DataError, DataErrorKind as Kind, Scene, Springs};

/// Stiffness times the size of the body over Young's modulus beyond which springs are as good as a held side.
const STIFFEST: f64 = 1e15;
/// The same where normal and tangent are not x and y: d·u is a difference, and rounding leaves it 1e-16 of u.
const STIFFEST_TURNED: f64 = 1e9;

impl Scene {
    /// Whether springs can be solved together with the other conditions.
    pub(super) fn check_beside_springs(&self) -> Result<(), DataError> {
        // problems without a body are refused as such
        let sides = if self.problem.bodies.is_empty() { &[] } else { self.problem.sides.as_slice() };
        for (index, side) in sides.iter().enumerate() {
            let Some(springs) = &side.springs else { continue };
            let refuse = |kind: Kind, why: &str, help: &str| {
                let place = springs.stiffnesses()[0].place;
                Err(DataError::new(kind, place, format!("side {:?} has springs {why}", side.name), help))
            };
            if matches!(side.condition, Condition::Displacement { .. }) {
                let help = "remove displacement or springs; traction or pressure may stand beside springs";
                return refuse(Kind::Conflict, "and a displacement", help);
            }
            let met = self.problem.interfaces().iter().any(|interface| {
                interface.sides.contains(&index) || self.problem.facing_sides(interface).contains(&index)
            });
            if met {
                let help = "remove the springs, or divide the side where contact or the interface ends";
                return refuse(Kind::Conflict, "and is in contact or meets another body", help);
            }
            if self.far().is_some() {
                let help = "leave the springs out, or solve a bounded body";
                return refuse(Kind::Unsupported, "beside an unbounded medium", help);
            }
            if self.is_on_grid() {
                let help = "give one material and a body force a + b*x + c*y, which boundary elements solve, or leave them out";
                return refuse(Kind::Unsupported, "on a grid of finite elements", help);
            }
            if let Some(random) = &self.random {
                let uses = self.uses(random);
                if uses.young || uses.springs {
                    let help = "leave Young's modulus and the stiffness of springs without random names: loads, gaps and friction may have them";
                    return refuse(Kind::Unsupported, "beside a random Young's modulus, or random ones", help);
                }
            }
        }
        Ok(())
    }

    /// Whether numbers have the digits for all springs.
    pub(super) fn check_stiffness(&self) -> Result<(), DataError> {
        let all = self.problem.sides.iter().enumerate();
        let mut springs = all.filter_map(|(index, side)| Some((index, side.springs.as_ref()?)));
        springs.try_for_each(|(index, springs)| self.check_stiffness_of(index, springs))
    }

    fn check_stiffness_of(&self, index: usize, springs: &Springs) -> Result<(), DataError> {
        let body = self.problem.body_of_side(index);
        let unit = self.problem.bodies[body].material().young / self.problem.outline.diameter();
        let name = &self.problem.sides[index].name;
        for edge in self.problem.outline.edges().iter().filter(|edge| edge.side == index) {
            let [x, y] = edge.normal(0.5);
            let turned = matches!(springs, Springs::Normal { .. }) && !(edge.is_line() && (x == 0.0 || y == 0.0));
            let most = if turned { STIFFEST_TURNED } else { STIFFEST };
            for stiffness in springs.stiffnesses() {
                let largest = self.check_along(edge, name, super::STIFFNESS, stiffness)?;
                if largest > most * unit {
                    let message = format!(
                        "the stiffness of springs of side {name:?} is {largest:e}, more than {most:e} times Young's modulus \
                         over the size of the body: expression {:?}",
                        stiffness.text()
                    );
                    let help = match turned {
                        true => {
                            "along normals that are neither x nor y such springs leave no digits: lower the stiffness"
                        }
                        false => "such springs are as good as a held side: write displacement, or lower the stiffness",
                    };
                    return Err(DataError::new(Kind::Data, stiffness.place, message, help));
                }
            }
        }
        Ok(())
    }
}
