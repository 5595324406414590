//! Functions of one and of two values.

/// Functions of one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum One {
    Negate,
    Abs,
    Sign,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tan,
}

/// Functions of two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Two {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Atan2,
    Min,
    Max,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

impl One {
    pub(super) fn apply(self, a: f64) -> f64 {
        match self {
            One::Negate => -a,
            One::Abs => a.abs(),
            One::Sign if a == 0.0 => 0.0,
            One::Sign => a.signum(),
            One::Sqrt => a.sqrt(),
            One::Exp => a.exp(),
            One::Log => a.ln(),
            One::Sin => a.sin(),
            One::Cos => a.cos(),
            One::Tan => a.tan(),
        }
    }
}

impl Two {
    /// A NaN operand gives NaN, also where the floating-point unit would choose the other operand or "false".
    pub(super) fn apply(self, a: f64, b: f64) -> f64 {
        let truth = |t: bool| if a.is_nan() || b.is_nan() { f64::NAN } else { f64::from(u8::from(t)) };
        match self {
            Two::Add => a + b,
            Two::Subtract => a - b,
            Two::Multiply => a * b,
            Two::Divide => a / b,
            Two::Power => power(a, b),
            Two::Atan2 => a.atan2(b),
            Two::Min if a.is_nan() || b.is_nan() => f64::NAN,
            Two::Min => a.min(b),
            Two::Max if a.is_nan() || b.is_nan() => f64::NAN,
            Two::Max => a.max(b),
            Two::Less => truth(a < b),
            Two::LessEqual => truth(a <= b),
            Two::Greater => truth(a > b),
            Two::GreaterEqual => truth(a >= b),
            Two::Equal => truth(a == b),
            Two::NotEqual => truth(a != b),
        }
    }

    pub(super) fn is_comparison(self) -> bool {
        matches!(self, Two::Less | Two::LessEqual | Two::Greater | Two::GreaterEqual | Two::Equal | Two::NotEqual)
    }
}

/// aᵇ; squares and cubes, the common powers, by multiplication. NaN⁰ stays NaN.
fn power(a: f64, b: f64) -> f64 {
    if b == 2.0 {
        a * a
    } else if b == 3.0 {
        a * a * a
    } else if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.powf(b)
    }
}
