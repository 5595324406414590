//! What holds, loads or touches each side.

use steklov_expression::Expression;

/// Condition on a side; n points out of the body. Sides that meet an obstacle or another body are free besides.
#[derive(Debug, Clone, Default)]
pub enum Condition {
    /// No traction.
    #[default]
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

/// Springs between a side and ground that does not move: beside what is given the traction -K u acts on the body, K of two
/// stiffnesses k ≥ 0 (stress/length), K u = Σ k_i (d_i·u) d_i.
#[derive(Debug, Clone)]
pub enum Springs {
    /// Along x and y.
    Axes([Expression; 2]),
    /// Along the normal and the tangent of the side.
    Normal {
        /// k_n.
        normal: Expression,
        /// k_t.
        tangential: Expression,
    },
}

impl Springs {
    /// The same stiffness in all directions.
    pub fn both(stiffness: Expression) -> Self {
        Self::Axes([stiffness.clone(), stiffness])
    }

    /// k_1 and k_2.
    pub fn stiffnesses(&self) -> [&Expression; 2] {
        match self {
            Self::Axes([x, y]) => [x, y],
            Self::Normal { normal, tangential } => [normal, tangential],
        }
    }

    /// d_1 and d_2 where the side has this unit normal.
    pub fn directions(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        match self {
            Self::Axes(_) => [[1.0, 0.0], [0.0, 1.0]],
            Self::Normal { .. } => [[x, y], [-y, x]],
        }
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
    /// Springs that hold it besides; the condition is then a load, or free.
    pub springs: Option<Springs>,
}

impl Side {
    /// A side on which nothing acts.
    pub fn free(name: &str) -> Self {
        Self { name: name.to_owned(), condition: Condition::Free, springs: None }
    }

    /// Whether nothing acts on it, interfaces apart.
    pub fn is_free(&self) -> bool {
        matches!(self.condition, Condition::Free) && self.springs.is_none()
    }

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
