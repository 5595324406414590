//! The words of an expression: numbers, names and signs.

use std::ops::Range;

use super::ExpressionError;

/// One word.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    Sign(&'static str),
    End,
}

/// The token of `text` that comes first at or after byte `from`, and its bytes.
pub(super) fn next_token(text: &str, from: usize) -> Result<(Token<'_>, Range<usize>), ExpressionError> {
    const SIGNS: [&str; 14] = ["<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "^", "(", ")", ","];
    let start = text.len() - text[from..].trim_start().len();
    let rest = &text[start..];
    let Some(first) = rest.chars().next() else { return Ok((Token::End, start..start)) };
    let wrong = |length: usize, message: String, help: &str| {
        Err(ExpressionError { message, span: start..start + length, help: help.to_owned() })
    };
    if first.is_ascii_digit() || first == '.' {
        let length = number_length(rest);
        match rest[..length].parse::<f64>() {
            Ok(value) if value.is_finite() => Ok((Token::Number(value), start..start + length)),
            Ok(_) => wrong(length, "this number is too large".into(), "the largest number is about 1.8e308"),
            Err(_) => wrong(length, "this is not a number".into(), "write numbers like 2, 0.5, .5 or 1e-3"),
        }
    } else if first.is_alphabetic() || first == '_' {
        let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        Ok((Token::Name(&rest[..length]), start..start + length))
    } else if let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
        Ok((Token::Sign(sign), start..start + sign.len()))
    } else {
        let help = match first {
            '=' => "equality is written ==",
            _ => "operators are + - * / ^ ( ) , and < <= > >= == !=",
        };
        wrong(first.len_utf8(), format!("the character {first:?} has no meaning here"), help)
    }
}

/// Length of the number at the start of `text`: digits, a point, an exponent.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| from + text.as_bytes()[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let byte = |at: usize| text.as_bytes().get(at);
    let mut at = digits(0);
    if byte(at) == Some(&b'.') {
        at = digits(at + 1);
    }
    if matches!(byte(at), Some(b'e' | b'E')) {
        let signed = at + 1 + usize::from(matches!(byte(at + 1), Some(b'+' | b'-')));
        at = digits(signed);
    }
    at
}
