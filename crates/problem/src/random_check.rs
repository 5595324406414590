//! How the expressions of a scene use its random input.

use steklov_expression::{Expression, Value};

use super::check::STIFFNESS;
use super::medium::DISPLACEMENT_JUMP;
use super::{CellModuli, DataError, DataErrorKind as Kind, Random, RandomName, Sampling, Scene};

/// The data of an outcome that are made anew where they use random names.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Datum {
    Young,
    Load,
    Contact,
    Held,
    Springs,
    Ties,
    /// It is always that of the outcome.
    Remote,
}

/// Which data of a scene use random names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Uses {
    /// Young's modulus.
    pub young: bool,
    /// Tractions, pressures, body force.
    pub loads: bool,
    /// Gaps and friction.
    pub contact: bool,
    /// Prescribed displacements.
    pub held: bool,
    /// Stiffnesses of springs.
    pub springs: bool,
    /// Jumps of the displacement across ties.
    pub ties: bool,
}

impl Scene {
    /// The expressions that may use random names, and what they give.
    fn expressions<'a>(&'a self, random: &'a Random) -> Vec<(Datum, &'a Expression)> {
        let mut all: Vec<(Datum, &Expression)> = Vec::new();
        all.extend(random.constants.young.values().map(|e| (Datum::Young, e)));
        all.extend(random.constants.remote_stress.iter().flatten().map(|e| (Datum::Remote, e)));
        all.extend(self.body().cell_expressions().map(|e| (Datum::Young, e)));
        all.extend(self.problem.bodies.iter().flat_map(|body| &body.force).flatten().map(|e| (Datum::Load, e)));
        for side in 0..self.problem.sides.len() {
            all.extend(self.problem.side_data(side).into_iter().map(|(what, e)| match what {
                "traction" | "pressure" => (Datum::Load, e),
                "displacement" => (Datum::Held, e),
                STIFFNESS => (Datum::Springs, e),
                _ => (Datum::Contact, e),
            }));
        }
        all.extend(self.problem.jumps_of_ties().map(|(_, what, e)| match what {
            DISPLACEMENT_JUMP => (Datum::Ties, e),
            _ => (Datum::Load, e),
        }));
        all
    }

    /// Which data use random names.
    pub fn uses(&self, random: &Random) -> Uses {
        let all = self.expressions(random);
        let varies = |e: &Expression| random.names.iter().any(|name| e.uses(name.name()));
        let uses = |datum| all.iter().any(|(of, e)| *of == datum && varies(e));
        Uses {
            young: uses(Datum::Young),
            loads: uses(Datum::Load),
            contact: uses(Datum::Contact),
            held: uses(Datum::Held),
            springs: uses(Datum::Springs),
            ties: uses(Datum::Ties),
        }
    }

    /// Whether a name moves Young's moduli of the cells of the body, and nothing else.
    pub fn moves_cell_moduli_alone(&self, random: &Random, name: &str) -> bool {
        let users = self.expressions(random).into_iter().filter(|(_, e)| e.uses(name)).count();
        let young = self.body().cells().map(|cells| &cells.young);
        users == 1 && matches!(young, Some(CellModuli::Expression(young)) if young.uses(name))
    }

    /// Names that have their germs, moduli whose bodies are there, and expressions whose names are there: others would be solved
    /// with their nominal values.
    pub(super) fn check_random(&self) -> Result<(), DataError> {
        let Some(random) = &self.random else { return Ok(()) };
        let refuse = |message: String, help: &str| Err(DataError::at(Kind::Conflict, &[vec!["random"]], message, help));
        let count = random.germs.len();
        for name in &random.names {
            let germs = match name {
                RandomName::Variable { germ, .. } => *germ..*germ + 1,
                RandomName::Field { field, first } => *first..*first + field.expansion.len(),
            };
            if germs.end > count {
                let message = format!("{} has the germs {germs:?}, and random.germs has {count}", name.name());
                return refuse(message, "give each variable one germ, and each field one for every mode");
            }
        }
        let of_samples = [Sampling::MonteCarlo, Sampling::Multilevel, Sampling::Corrected];
        if let Some(&germ) = random.drawn_germs().first()
            && !of_samples.contains(&random.stochastic.method)
        {
            let label = &random.germs[germ].label;
            let message = format!(
                "the field {label} is drawn without truncation, and this stochastic.method has a rule of points"
            );
            let help = "give it a number of modes, or take method = \"monte-carlo\", \"multilevel\" or \"corrected\"";
            return Err(DataError::at(Kind::Conflict, &[vec!["stochastic", "method"]], message, help));
        }
        let bodies = self.problem.bodies.len();
        if let Some(body) = random.constants.young.keys().find(|&&body| body >= bodies) {
            let message = format!("random.constants.young has the body {body}, and the problem has {bodies}");
            return refuse(message, "bodies are numbered from 0");
        }
        let known = |name: &String| {
            self.parameters.contains_key(name) || random.names.iter().any(|random| random.name() == name)
        };
        for (_, expression) in self.expressions(random) {
            let open = expression.names().iter().zip(expression.values());
            let mut open = open.filter(|(_, value)| !matches!(value, Value::Profile(_))).map(|(name, _)| name);
            if let Some(name) = open.find(|name| !known(name)) {
                let message = format!("{:?} uses {name}, which is neither random nor a parameter", expression.text());
                let help = "add it to random.names, or to the parameters of the scene";
                return Err(DataError::new(Kind::Conflict, expression.place, message, help));
            }
        }
        Ok(())
    }
}
