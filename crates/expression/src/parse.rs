//! Precedence climbing from the text straight to the tape; constants are folded on the way.
//!
//! From loose to tight: comparisons (they do not chain), `+ -`, `* /`, unary `+ -`, `^` (right-associative).

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::foreign::translated;
use super::tape::{One, Op, Two};
use super::token::{Token, next_token};
use super::{ExpressionError, FieldValue, Switch};

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

/// What the parser leaves behind: the tape and its switches.
pub(super) struct Parsed {
    pub(super) ops: Vec<Op>,
    pub(super) switches: Vec<Switch>,
    /// Constants and fields that are used.
    pub(super) names: Vec<String>,
    pub(super) fields: Vec<Arc<FieldValue>>,
}

struct Parser<'a> {
    text: &'a str,
    constants: &'a BTreeMap<String, f64>,
    fields: &'a BTreeMap<String, Arc<FieldValue>>,
    /// Names without a value.
    free: &'a [String],
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
    free: &[String],
) -> Result<Parsed, ExpressionError> {
    parsed(text, constants, fields, free).map_err(|error| translated(text, error))
}

fn parsed(
    text: &str,
    constants: &BTreeMap<String, f64>,
    fields: &BTreeMap<String, Arc<FieldValue>>,
    free: &[String],
) -> Result<Parsed, ExpressionError> {
    let out = Parsed { ops: Vec::new(), switches: Vec::new(), names: Vec::new(), fields: Vec::new() };
    let mut parser = Parser { text, constants, fields, free, token: Token::End, span: 0..0, depth: 0, out };
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
        let left = self.out.ops.len();
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
            let right = self.out.ops.len();
            match binds {
                POWER => self.deeper(SIGN)?,
                _ => self.expression(binds + 1)?,
            }
            self.two(operator, left, right);
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
                let start = self.out.ops.len();
                self.deeper(SIGN)?;
                self.one(One::Negate, start);
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
                _ if self.free.iter().any(|free| free == name) => {
                    self.out.names.push(name.to_owned());
                    Op::Name(self.free.iter().position(|free| free == name).unwrap_or_default())
                }
                (Some(&value), _) => {
                    self.out.names.push(name.to_owned());
                    Op::Constant(value)
                }
                (None, Some(field)) => {
                    self.out.names.push(name.to_owned());
                    self.out.fields.push(field.clone());
                    Op::Field(self.out.fields.len() - 1)
                }
                (None, None) if FUNCTIONS.contains(&name) => {
                    let message = format!("the function {name} needs its argument in parentheses");
                    return Err(ExpressionError { message, span, help: format!("write {name}(...)") });
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

    /// A function call; the next token is its opening parenthesis.
    fn call(&mut self, name: &str, span: Range<usize>) -> Result<(), ExpressionError> {
        if !FUNCTIONS.contains(&name) {
            let known =
                VARIABLES.contains(&name) || self.constants.contains_key(name) || self.fields.contains_key(name);
            let help = match nearest(name, FUNCTIONS) {
                _ if known => format!("write a product with a star: {name}*(...)"),
                Some(near) => format!("did you mean {near}?"),
                None => format!("the functions are {}", FUNCTIONS.join(", ")),
            };
            let message = if known { format!("{name} is not a function") } else { format!("unknown function {name}") };
            return Err(ExpressionError { message, span, help });
        }
        self.advance()?;
        let start = self.out.ops.len();
        if name == "if" {
            return self.conditional(start);
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
            self.one(function, start);
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
            let right = self.out.ops.len();
            self.deeper(COMPARISON)?;
            self.two(function, start, right);
            if self.token != Token::Sign(",") || function == Two::Atan2 {
                return self.expect(")", help);
            }
        }
    }

    /// The three arguments of `if`; a branch that a constant condition rules out leaves nothing on the tape.
    fn conditional(&mut self, start: usize) -> Result<(), ExpressionError> {
        const HELP: &str = "if takes three arguments: if(condition, value, otherwise)";
        self.deeper(COMPARISON)?;
        let fixed = self.constant(start);
        let condition = &self.out.ops[start..];
        let compared = matches!(condition.last(), Some(Op::Two(two)) if two.is_comparison())
            && !condition.iter().any(|op| matches!(op, Op::Branch { .. }));
        if fixed.is_none() && !compared {
            self.out.switches.push(Switch { left: start..self.out.ops.len(), right: None });
        }
        self.expect(",", HELP)?;
        let branch = self.out.ops.len();
        self.out.ops.push(Op::Branch { otherwise: 0, end: 0 });
        let switches = self.out.switches.len();
        self.deeper(COMPARISON)?;
        self.expect(",", HELP)?;
        let jump = self.out.ops.len();
        self.out.ops.push(Op::Jump(0));
        let second_switches = self.out.switches.len();
        self.deeper(COMPARISON)?;
        self.expect(")", HELP)?;
        let end = self.out.ops.len();
        let Some(condition) = fixed else {
            self.out.ops[branch] = Op::Branch { otherwise: jump - branch, end: end - branch - 1 };
            self.out.ops[jump] = Op::Jump(end - jump - 1);
            return Ok(());
        };
        // Keep only the branch that is taken, moved to where the condition stood.
        let (kept, kept_switches) = match condition {
            c if c.is_nan() => {
                self.out.ops[start] = Op::Constant(f64::NAN);
                (start..start + 1, 0..0)
            }
            0.0 => (jump + 1..end, second_switches..self.out.switches.len()),
            _ => (branch + 1..jump, switches..second_switches),
        };
        let moved = kept.start - start;
        let moved_switches: Vec<Switch> =
            self.out.switches[kept_switches].iter().map(|switch| switch.moved_back(moved)).collect();
        self.out.switches.truncate(switches);
        self.out.switches.extend(moved_switches);
        self.out.ops.copy_within(kept.clone(), start);
        self.out.ops.truncate(start + kept.len());
        Ok(())
    }

    /// Value of the operand that starts at `start` and ends the tape, if it is constant.
    fn constant(&self, start: usize) -> Option<f64> {
        match self.out.ops[start..] {
            [Op::Constant(value)] => Some(value),
            _ => None,
        }
    }

    /// Applies a function to the operand that starts at `start`.
    fn one(&mut self, function: One, start: usize) {
        if let Some(value) = self.constant(start) {
            self.out.ops[start] = Op::Constant(function.apply(value));
            return;
        }
        if matches!(function, One::Abs | One::Sign | One::Sqrt) {
            self.out.switches.push(Switch { left: start..self.out.ops.len(), right: None });
        }
        self.out.ops.push(Op::One(function));
    }

    /// Applies a function to the operands that start at `left` and at `right`.
    fn two(&mut self, function: Two, left: usize, right: usize) {
        let end = self.out.ops.len();
        let exponent = self.constant(right);
        if let ([Op::Constant(a)], Some(b)) = (&self.out.ops[left..right], exponent) {
            self.out.ops[left] = Op::Constant(function.apply(*a, b));
            self.out.ops.truncate(left + 1);
            return;
        }
        let switch = match function {
            Two::Add | Two::Subtract | Two::Multiply | Two::Divide => None,
            // A whole power is smooth, or has a pole; any other has a branch point where its base is 0.
            Two::Power if exponent.is_some_and(|b| b.fract() == 0.0) => None,
            // atan2(y, x) jumps across y = 0, x < 0.
            Two::Power | Two::Atan2 => Some(Switch { left: left..right, right: None }),
            _ => Some(Switch { left: left..right, right: Some(right..end) }),
        };
        self.out
            .switches
            .extend(switch.filter(|s| s.right.is_some() || !matches!(self.out.ops[left..right], [Op::Constant(_)])));
        self.out.ops.push(Op::Two(function));
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
