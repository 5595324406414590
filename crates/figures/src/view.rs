//! The part of a result that pictures show.

use steklov_elastic::plane::norm;
use steklov_elastic::principal;
use steklov_picture::Colours;

/// The content of pictures of fields; the default is the whole body, coloured by von Mises stress.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct View {
    /// The field that colours the body.
    pub scalar: Scalar,
    /// Values of the outer colours, the smaller one first, in the unit of the field; values beyond an end have its
    /// colour. None: the picture chooses them from the field.
    pub range: Option<[f64; 2]>,
    /// Lower left and upper right corner of the part of the undeformed body that is shown; on a grid, the cells that
    /// meet it. None: all.
    pub window: Option<[[f64; 2]; 2]>,
    /// Factor > 0 at which displacements are drawn, 1 to scale. None: the picture chooses one that makes them visible.
    pub enlarge: Option<f64>,
    /// Whether fields on grids are drawn without the lines of coarse cells.
    pub hides_cells: bool,
}

impl View {
    /// The colours of the field of the body.
    pub(crate) fn colours(&self) -> Colours {
        match self.range {
            Some(ends) => Colours::Range(ends),
            None if self.scalar.is_signed() => Colours::WithZero,
            None => Colours::Automatic,
        }
    }
}

/// A scalar of displacement u and stress σ at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scalar {
    /// Von Mises stress.
    #[default]
    VonMises,
    /// σ_xx, positive in tension.
    Xx,
    /// σ_yy.
    Yy,
    /// σ_xy.
    Xy,
    /// The larger principal stress in the plane, σ_1.
    Principal1,
    /// The smaller principal stress in the plane, σ_2.
    Principal2,
    /// u_x.
    DisplacementX,
    /// u_y.
    DisplacementY,
    /// |u|.
    Displacement,
}

/// The unit of a scalar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// The unit of E.
    Stress,
    /// The unit of coordinates.
    Length,
}

impl Scalar {
    /// All scalars.
    pub const ALL: [Self; 9] = [
        Self::VonMises,
        Self::Xx,
        Self::Yy,
        Self::Xy,
        Self::Principal1,
        Self::Principal2,
        Self::DisplacementX,
        Self::DisplacementY,
        Self::Displacement,
    ];

    /// Its word on the command line, its label in pictures, its unit, and whether it may have either sign.
    const fn facts(self) -> (&'static str, &'static str, Unit, bool) {
        match self {
            Self::VonMises => ("von-mises", "von Mises stress", Unit::Stress, false),
            Self::Xx => ("xx", "stress σxx", Unit::Stress, true),
            Self::Yy => ("yy", "stress σyy", Unit::Stress, true),
            Self::Xy => ("xy", "stress σxy", Unit::Stress, true),
            Self::Principal1 => ("principal-1", "larger principal stress σ₁", Unit::Stress, true),
            Self::Principal2 => ("principal-2", "smaller principal stress σ₂", Unit::Stress, true),
            Self::DisplacementX => ("u-x", "displacement ux", Unit::Length, true),
            Self::DisplacementY => ("u-y", "displacement uy", Unit::Length, true),
            Self::Displacement => ("displacement", "displacement |u|", Unit::Length, false),
        }
    }

    /// Its word on the command line.
    pub const fn name(self) -> &'static str {
        self.facts().0
    }

    /// The scalar of a word.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scalar| scalar.name() == name)
    }

    /// Its label in pictures, with its symbol.
    pub const fn label(self) -> &'static str {
        self.facts().1
    }

    /// Its unit.
    pub const fn unit(self) -> Unit {
        self.facts().2
    }

    /// Whether it may have either sign.
    pub const fn is_signed(self) -> bool {
        self.facts().3
    }

    /// Noun for its values in a sentence.
    pub(crate) const fn noun(self) -> &'static str {
        match self.unit() {
            Unit::Stress => "stress",
            Unit::Length => "displacement",
        }
    }

    /// Its value for u, `[σ_xx, σ_yy, σ_xy]` and their von Mises stress, which depends on the material.
    pub fn of(self, u: [f64; 2], stress: [f64; 3], von_mises: f64) -> f64 {
        match self {
            Self::VonMises => von_mises,
            Self::Xx => stress[0],
            Self::Yy => stress[1],
            Self::Xy => stress[2],
            Self::Principal1 => principal(stress)[0],
            Self::Principal2 => principal(stress)[1],
            Self::DisplacementX => u[0],
            Self::DisplacementY => u[1],
            Self::Displacement => norm(u),
        }
    }
}
