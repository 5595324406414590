//! One outcome of random input as a problem of its own.

use steklov_elastic::Material;
use steklov_expression::Expression;

use super::model::check_coefficients;
use super::{
    CellModuli, Cells, Condition, Contact, DataError, DataErrorKind as Kind, Friction, Law, Random, Scene, Springs,
    Substance,
};

impl Scene {
    /// The outcome of the random input for these germs; the scene itself if it has none.
    ///
    /// # Errors
    /// A value that is impossible, such as a modulus that is not positive.
    pub fn outcome(&self, germs: &[f64]) -> Result<Self, DataError> {
        let Some(random) = &self.random else { return Ok(self.clone()) };
        self.outcome_of(random, germs).map_err(|error| DataError {
            message: format!("for {}: {}", random.outcome_name(germs), error.message),
            ..error
        })
    }

    fn outcome_of(&self, random: &Random, germs: &[f64]) -> Result<Self, DataError> {
        let values = random.values(germs);
        let take = |expression: &mut Expression| *expression = expression.with_values(&values);
        let value = |expression: &Expression| expression.with_values(&values).constant().unwrap_or(f64::NAN);
        let mut outcome = Self { random: None, unused: Vec::new(), ..self.clone() };
        let problem = &mut outcome.problem;
        problem.paired_by = (0..problem.bodies.len()).map(|body| problem.pairing_modulus(body)).collect();
        for (&body, young) in &random.constants.young {
            let material = with_young(&self.problem.bodies[body].material(), value(young), young)?;
            problem.bodies[body].substance = Substance::Homogeneous(material);
        }
        if let Substance::Cells(Cells { young, poisson, .. }) = &mut problem.bodies[0].substance {
            for of_cells in std::iter::once(young).chain(poisson) {
                if let CellModuli::Expression(value) = of_cells {
                    take(value);
                }
            }
        }
        for side in &mut problem.sides {
            side.condition.expressions_mut().for_each(take);
            side.springs.iter_mut().flat_map(Springs::stiffnesses_mut).for_each(take);
        }
        for law in problem.laws_mut() {
            match law {
                Law::Contact(contact) => contact.expressions_mut().for_each(take),
                Law::Tied(tie) => tie.expressions_mut().for_each(take),
            }
        }
        let medium = problem.bodies.iter_mut().find_map(|body| body.far.as_mut());
        if let (Some(far), Some(stress)) = (medium, &random.constants.remote_stress) {
            far.remote_stress = stress.each_ref().map(value);
            if far.remote_stress.iter().any(|s| !s.is_finite()) {
                let message = format!("exterior.remote_stress is {:?}", far.remote_stress);
                let key = vec!["exterior", "remote_stress"];
                return Err(DataError::at(Kind::Value, &[key], message, "it must be finite"));
            }
        }
        for force in problem.bodies.iter_mut().filter_map(|body| body.force.as_mut()) {
            force.iter_mut().for_each(take);
            check_coefficients(force)?;
        }
        Ok(outcome)
    }
}

/// The material with another modulus, which `young` gives.
fn with_young(material: &Material, value: f64, young: &Expression) -> Result<Material, DataError> {
    Material::new(value, material.poisson, material.plane).map_err(|e| {
        let help = "no outcome may reach that: bound what is random by low = .. or high = .., take distribution = \"lognormal\", \
                    which is positive, or a smaller deviation";
        DataError::new(Kind::Value, young.place, e.to_string(), help)
    })
}

impl Condition {
    /// The expressions of the condition.
    fn expressions_mut(&mut self) -> Box<dyn Iterator<Item = &mut Expression> + '_> {
        match self {
            Self::Free => Box::new(std::iter::empty()),
            Self::Traction(traction) => Box::new(traction.iter_mut()),
            Self::Pressure(pressure) => Box::new(std::iter::once(pressure)),
            Self::Displacement { values, traction } => {
                Box::new(values.iter_mut().flatten().chain(traction.iter_mut().flatten()))
            }
        }
    }
}

impl Springs {
    fn stiffnesses_mut(&mut self) -> [&mut Expression; 2] {
        match self {
            Self::Axes([x, y]) => [x, y],
            Self::Normal { normal, tangential } => [normal, tangential],
        }
    }
}

impl Contact {
    /// The expressions of gap and friction.
    fn expressions_mut(&mut self) -> impl Iterator<Item = &mut Expression> {
        let law = match &mut self.friction {
            Friction::None => None,
            Friction::Tresca(of) | Friction::Coulomb(of) => Some(of),
        };
        std::iter::once(&mut self.gap).chain(law)
    }
}
