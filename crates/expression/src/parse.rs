//! Precedence climbing from the text straight to the tape.
//!
//! From loose to tight: comparisons (they do not chain), `+ -`, `* /`, unary `+ -`, `^` (right-associative).

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::foreign::translated;
use super::operation::{One, Two};
use super::tape::Op;
use super::token::{Token, next_token};
use super::{ExpressionError, FieldValue, Profile, Value};

/// Deepest nesting of parentheses, function calls, signs and powers.
const DEEPEST: usize = 256;

const COMPARISON: u8 = 1;
const SUM: u8 = 2;
const PRODUCT: u8 = 3;
const SIGN: u8 = 4;
const POWER: u8 = 5;

/// Names with a fixed meaning.
pub(super) const VARIABLES: [&str; 4] = ["x", "y", "s", "pi"];
/// Names of the functions.
pub(super) const FUNCTIONS: [&str; 12] =
    ["abs", "sign", "sqrt", "exp", "log", "sin", "cos", "tan", "atan2", "min", "max", "if"];

/// The result of the parser.
#[derive(Default)]
pub(super) struct Parsed {
    /// The tape, in which all names are open.
    pub(super) ops: Vec<Op>,
    /// Constants and fields that are used, and their values.
    pub(super) names: Vec<String>,
    pub(super) values: Vec<Value>,
}

struct Parser<'a> {
    text: &'a str,
    constants: &'a BTreeMap<String, f64>,
    fields: &'a BTreeMap<String, Arc<FieldValue>>,
    profiles: &'a BTreeMap<String, Arc<Profile>>,
    /// The token that comes next, and where it stands.
    token: Token<'a>,
    span: Range<usize>,
    depth: usize,
    out: Parsed,
}

pub(super) fn parse(
    text: &str,
    constants: &BTreeMap<String, f64>,
    fields: &BTreeMap<String, Arc<FieldValue>>,
    profiles: &BTreeMap<String, Arc<Profile>>,
) -> Result<Parsed, ExpressionError> {
    parsed(text, constants, fields, profiles).map_err(|error| translated(text, error))
}

fn parsed(
    text: &str,
    constants: &BTreeMap<String, f64>,
    fields: &BTreeMap<String, Arc<FieldValue>>,
    profiles: &BTreeMap<String, Arc<Profile>>,
) -> Result<Parsed, ExpressionError> {
    let out = Parsed::default();
    let mut parser = Parser { text, constants, fields, profiles, token: Token::End, span: 0..0, depth: 0, out };
    parser.advance()?;
    parser.expression(COMPARISON)?;
    match parser.token {
        Token::End => Ok(parser.out),
        Token::Sign(")") => Err(parser.error("this ) closes nothing", "remove it, or open a parenthesis before it")),
        Token::Sign(",") => Err(parser.error("a comma outside of a function", "write the decimal point as a point")),
        _ => Err(parser.error("an operator is missing here", "write products with a star: 2*x")),
    }
}

impl<'a> Parser<'a> {
    fn error(&self, message: impl Into<String>, help: impl Into<String>) -> ExpressionError {
        ExpressionError { message: message.into(), span: self.span.clone(), help: help.into() }
    }

    /// Reads the next token.
    fn advance(&mut self) -> Result<(), ExpressionError> {
        (self.token, self.span) = next_token(self.text, self.span.end)?;
        Ok(())
    }

    fn expect(&mut self, sign: &'static str, help: &str) -> Result<(), ExpressionError> {
        if self.token != Token::Sign(sign) {
            let found = match self.token {
                Token::End => "the expression ends".to_owned(),
                _ => format!("{:?} stands", &self.text[self.span.clone()]),
            };
            return Err(self.error(format!("{found} where {sign:?} is expected"), help));
        }
        self.advance()
    }

    fn deeper(&mut self, level: u8) -> Result<(), ExpressionError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.error(
                format!("nested deeper than {DEEPEST}"),
                "name parts of the expression in [parameters], or simplify it",
            ));
        }
        self.expression(level)?;
        self.depth -= 1;
        Ok(())
    }

    /// An operand and the operators that bind at least as tightly as `level`.
    fn expression(&mut self, level: u8) -> Result<(), ExpressionError> {
        self.operand()?;
        loop {
            let Token::Sign(sign) = self.token else { return Ok(()) };
            let (operator, binds) = match sign {
                "<" => (Two::Less, COMPARISON),
                "<=" => (Two::LessEqual, COMPARISON),
                ">" => (Two::Greater, COMPARISON),
                ">=" => (Two::GreaterEqual, COMPARISON),
                "==" => (Two::Equal, COMPARISON),
                "!=" => (Two::NotEqual, COMPARISON),
                "+" => (Two::Add, SUM),
                "-" => (Two::Subtract, SUM),
                "*" => (Two::Multiply, PRODUCT),
                "/" => (Two::Divide, PRODUCT),
                "^" => (Two::Power, POWER),
                _ => return Ok(()),
            };
            if binds < level {
                return Ok(());
            }
            self.advance()?;
            match binds {
                POWER => self.deeper(SIGN)?,
                _ => self.expression(binds + 1)?,
            }
            self.out.ops.push(Op::Two(operator));
            if let (COMPARISON, Token::Sign("<" | "<=" | ">" | ">=" | "==" | "!=")) = (binds, self.token) {
                return Err(self.error("comparisons do not chain", "write a < x and x < b as (a < x)*(x < b)"));
            }
        }
    }

    fn operand(&mut self) -> Result<(), ExpressionError> {
        match self.token {
            Token::Number(value) => {
                self.out.ops.push(Op::Constant(value));
                self.advance()
            }
            Token::Name(name) => {
                let span = self.span.clone();
                self.advance()?;
                if self.token == Token::Sign("(") { self.call(name, span) } else { self.name(name, span) }
            }
            Token::Sign("(") => {
                self.advance()?;
                self.deeper(COMPARISON)?;
                self.expect(")", "close the parenthesis")
            }
            Token::Sign("+") => {
                self.advance()?;
                self.deeper(SIGN)
            }
            Token::Sign("-") => {
                self.advance()?;
                self.deeper(SIGN)?;
                self.out.ops.push(Op::One(One::Negate));
                Ok(())
            }
            Token::Sign(sign) => {
                Err(self
                    .error(format!("a value is missing before {sign:?}"), "write a number, a name or a parenthesis"))
            }
            Token::End if self.text.trim().is_empty() => {
                Err(self.error("the expression is empty", "write \"0\" for nothing"))
            }
            Token::End => Err(self.error("the expression ends where a value is expected", "complete it")),
        }
    }

    fn name(&mut self, name: &str, span: Range<usize>) -> Result<(), ExpressionError> {
        let op = match name {
            "x" => Op::X,
            "y" => Op::Y,
            "s" => Op::S,
            "pi" => Op::Constant(std::f64::consts::PI),
            _ => match (self.constants.get(name), self.fields.get(name)) {
                (Some(&value), _) => self.known(name, Value::Constant(value)),
                (None, Some(field)) => self.known(name, Value::Field(field.clone())),
                (None, None) if FUNCTIONS.contains(&name) => {
                    let message = format!("the function {name} needs its argument in parentheses");
                    return Err(ExpressionError { message, span, help: format!("write {name}(...)") });
                }
                (None, None) if self.profiles.contains_key(name) => {
                    let message = format!("the profile {name} needs its argument in parentheses");
                    return Err(ExpressionError { message, span, help: format!("write {name}(x) or {name}(s)") });
                }
                (None, None) => {
                    let names = self.constants.keys().chain(self.fields.keys()).map(String::as_str);
                    let known = VARIABLES.into_iter().chain(names);
                    let help = match nearest(name, known.clone().chain(FUNCTIONS)) {
                        Some(near) => format!("did you mean {near}? Other names must be defined in [parameters]"),
                        None => {
                            format!("define it in [parameters]; known are {}", known.collect::<Vec<_>>().join(", "))
                        }
                    };
                    return Err(ExpressionError { message: format!("unknown name {name}"), span, help });
                }
            },
        };
        self.out.ops.push(op);
        Ok(())
    }

    /// A name that has a value.
    fn known(&mut self, name: &str, value: Value) -> Op {
        let Parsed { names, values, .. } = &mut self.out;
        let index = names.iter().position(|known| known == name).unwrap_or_else(|| {
            names.push(name.to_owned());
            values.push(value);
            names.len() - 1
        });
        Op::Name(index)
    }

    /// A function call; the next token is its opening parenthesis.
    fn call(&mut self, name: &str, span: Range<usize>) -> Result<(), ExpressionError> {
        if let (false, Some(profile)) = (FUNCTIONS.contains(&name), self.profiles.get(name)) {
            let Op::Name(index) = self.known(name, Value::Profile(profile.clone())) else { return Ok(()) };
            self.advance()?;
            self.deeper(COMPARISON)?;
            self.expect(")", &format!("{name} takes one argument"))?;
            self.out.ops.push(Op::Call(index));
            return Ok(());
        }
        if !FUNCTIONS.contains(&name) {
            let known =
                VARIABLES.contains(&name) || self.constants.contains_key(name) || self.fields.contains_key(name);
            let functions = FUNCTIONS.into_iter().chain(self.profiles.keys().map(String::as_str));
            let help = match nearest(name, functions) {
                _ if known => format!("write a product with a star: {name}*(...)"),
                Some(near) => format!("did you mean {near}?"),
                None => format!("the functions are {}", FUNCTIONS.join(", ")),
            };
            let message = if known { format!("{name} is not a function") } else { format!("unknown function {name}") };
            return Err(ExpressionError { message, span, help });
        }
        self.advance()?;
        if name == "if" {
            return self.conditional();
        }
        self.deeper(COMPARISON)?;
        let one = match name {
            "abs" => Some(One::Abs),
            "sign" => Some(One::Sign),
            "sqrt" => Some(One::Sqrt),
            "exp" => Some(One::Exp),
            "log" => Some(One::Log),
            "sin" => Some(One::Sin),
            "cos" => Some(One::Cos),
            "tan" => Some(One::Tan),
            _ => None,
        };
        if let Some(function) = one {
            self.expect(")", &format!("{name} takes one argument"))?;
            self.out.ops.push(Op::One(function));
            return Ok(());
        }
        let (function, help) = match name {
            "min" => (Two::Min, "min takes two or more arguments: min(a, b)"),
            "max" => (Two::Max, "max takes two or more arguments: max(a, b)"),
            _ => (Two::Atan2, "atan2 takes two arguments: atan2(y, x)"),
        };
        let mut count = 1;
        loop {
            self.expect(",", help)?;
            count += 1;
            if count > DEEPEST {
                let message = format!("more than {DEEPEST} arguments");
                return Err(self.error(message, "nest a few calls: max(max(a, b, ...), max(c, d, ...))"));
            }
            self.deeper(COMPARISON)?;
            self.out.ops.push(Op::Two(function));
            if self.token != Token::Sign(",") || function == Two::Atan2 {
                return self.expect(")", help);
            }
        }
    }

    /// The three arguments of `if`.
    fn conditional(&mut self) -> Result<(), ExpressionError> {
        const HELP: &str = "if takes three arguments: if(condition, value, otherwise)";
        self.deeper(COMPARISON)?;
        self.expect(",", HELP)?;
        let branch = self.out.ops.len();
        self.out.ops.push(Op::Branch { otherwise: 0, end: 0 });
        self.deeper(COMPARISON)?;
        self.expect(",", HELP)?;
        let jump = self.out.ops.len();
        self.out.ops.push(Op::Jump(0));
        self.deeper(COMPARISON)?;
        self.expect(")", HELP)?;
        let end = self.out.ops.len();
        self.out.ops[branch] = Op::Branch { otherwise: jump - branch, end: end - branch - 1 };
        self.out.ops[jump] = Op::Jump(end - jump - 1);
        Ok(())
    }
}

/// The candidate most like `word`, if any is like it.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    candidates
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(&lower, &candidate.to_lowercase()), candidate))
        .filter(|&(distance, candidate)| {
            let length = candidate.chars().count().max(word.chars().count());
            distance < length && distance <= 1.max(length / 3)
        })
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}
