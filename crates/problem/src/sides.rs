//! What holds, loads or touches each side.

use steklov_expression::Expression;

/// Condition on a side; n points out of the body. Sides that meet an obstacle or another body are free besides.
#[derive(Debug, Clone)]
pub enum Condition {
    /// No traction.
    Free,
    /// Traction t = (t_x, t_y) (stress).
    Traction([Expression; 2]),
    /// Pressure q (stress): t = -q n.
    Pressure(Expression),
    /// Prescribed displacement (length) of the components that are held, at least one.
    Displacement {
        /// Value of each component; `None` where it is free.
        values: [Option<Expression>; 2],
        /// Traction (stress) on the free component; the held one is 0.
        traction: Option<[Expression; 2]>,
    },
}

impl Condition {
    /// No displacement.
    pub fn held() -> Self {
        Self::Displacement { values: [Some(Expression::number(0.0)), Some(Expression::number(0.0))], traction: None }
    }
}

/// Contact of sides with a rigid obstacle.
#[derive(Debug, Clone)]
pub struct Contact {
    /// Distance to the obstacle along n from the undeformed point (length); negative is an overlap.
    pub gap: Expression,
    /// Law of friction.
    pub friction: Friction,
}

impl Contact {
    /// Their gap and the bound or coefficient of their law.
    pub fn data(&self) -> Vec<(&'static str, &Expression)> {
        let friction = match &self.friction {
            Friction::None => None,
            Friction::Tresca(bound) => Some(("friction bound", bound)),
            Friction::Coulomb(coefficient) => Some(("friction coefficient", coefficient)),
        };
        [("gap", &self.gap)].into_iter().chain(friction).collect()
    }
}

/// Law of friction of a contact side.
#[derive(Debug, Clone)]
pub enum Friction {
    /// Frictionless.
    None,
    /// Tresca: |λ_t| ≤ F with a given bound F ≥ 0 (stress).
    Tresca(Expression),
    /// Coulomb: |λ_t| ≤ μ λ_n with a given coefficient μ ≥ 0.
    Coulomb(Expression),
}

impl Friction {
    /// The bound of Tresca's law.
    pub fn bound(&self) -> Option<&Expression> {
        if let Self::Tresca(bound) = self { Some(bound) } else { None }
    }

    /// The coefficient of Coulomb's law.
    pub fn coefficient(&self) -> Option<&Expression> {
        if let Self::Coulomb(coefficient) = self { Some(coefficient) } else { None }
    }
}

/// A side of the body: all edges of one name.
#[derive(Debug, Clone)]
pub struct Side {
    /// Its name.
    pub name: String,
    /// What acts on it.
    pub condition: Condition,
}

impl Side {
    /// Whether it holds a component of the displacement.
    pub fn holds(&self, component: usize) -> bool {
        matches!(&self.condition, Condition::Displacement { values, .. } if values[component].is_some())
    }
}

/// A body and a medium that are tied, up to jumps.
#[derive(Debug, Clone, Default)]
pub struct Tie {
    /// u - u_c where body and medium meet (length).
    pub displacement_jump: Option<[Expression; 2]>,
    /// σ(u)n - σ(u_c)n there (stress), n out of the body.
    pub traction_jump: Option<[Expression; 2]>,
    /// The same as a tensor xx, yy, xy (stress) that is applied to n; both are added.
    pub stress_jump: Option<[Expression; 3]>,
}
