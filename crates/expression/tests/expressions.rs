//! Expressions against a plain tree evaluator, closed forms of their kinks, and texts that must not be accepted.

use std::collections::BTreeMap;

use proptest::prelude::*;
use steklov_expression::{Enclosed, Expression, ExpressionError, Interval, Survey, Value, enclose, leaves};

fn constants() -> BTreeMap<String, f64> {
    [("F".to_owned(), 0.3), ("long_name".to_owned(), -2.0)].into()
}

fn parse(text: &str) -> Expression {
    Expression::parse(text, &constants()).unwrap_or_else(|e| panic!("{text}: {e} at {:?}", e.span))
}

fn error(text: &str) -> ExpressionError {
    Expression::parse(text, &constants()).err().unwrap_or_else(|| panic!("{text:?} was accepted"))
}

fn value(text: &str) -> f64 {
    parse(text).eval(0.5, -0.25, 0.125)
}

#[test]
fn precedence_is_that_of_the_contract() {
    for (text, expected) in [
        ("-2^2", -4.0),
        ("2^-1", 0.5),
        ("2^3^2", 512.0),
        ("2^-2^2", 0.0625),
        ("(2^3)^2", 64.0),
        ("2*3^2", 18.0),
        ("-x^2", -0.25),
        ("8/4/2", 1.0),
        ("8-4-2", 2.0),
        ("2+3*4", 14.0),
        ("2*-3", -6.0),
        ("1--1", 2.0),
        ("1+2 < 4", 1.0),
        ("(1 < 2) + 1", 2.0),
        ("1e-3", 0.001),
        (".5", 0.5),
        ("5.", 5.0),
        ("1E+2", 100.0),
        ("2*pi", std::f64::consts::TAU),
        ("x+y*s", 0.5 - 0.25 * 0.125),
        ("F*long_name", -0.6),
        ("log(exp(2))", 2.0),
        ("atan2(1, -1)", 0.75 * std::f64::consts::PI),
        ("min(3, 1, 2)", 1.0),
        ("max(3, 1, 2)", 3.0),
        ("sign(0) + 2*sign(-3)", -2.0),
        ("abs(-3) + sqrt(16)", 7.0),
        ("if(x > 0, 1/x, 1/0)", 2.0),
        ("if(x < 0, 1/0, 3)", 3.0),
        ("if(0, 1/0, 7)", 7.0),
        ("if(2, y, log(-1))", -0.25),
    ] {
        let got = value(text);
        assert!((got - expected).abs() <= 1e-15 * expected.abs(), "{text} = {got}, not {expected}");
    }
}

#[test]
fn comparisons_give_zero_or_one() {
    for (a, b) in [(1.0, 2.0), (2.0, 2.0), (2.0, 1.0)] {
        for (sign, truth) in
            [("<", a < b), ("<=", a <= b), (">", a > b), (">=", a >= b), ("==", a == b), ("!=", a != b)]
        {
            assert_eq!(value(&format!("{a} {sign} {b}")), if truth { 1.0 } else { 0.0 }, "{a} {sign} {b}");
        }
    }
}

#[test]
fn values_without_meaning_are_not_hidden() {
    for text in
        ["log(-x)", "sqrt(-x)", "min(1, log(-x))", "log(-x) < 1", "if(log(-x), 1, 2)", "if(log(-1), 1, 2)", "log(-1)^0"]
    {
        assert!(value(text).is_nan(), "{text}");
    }
    assert_eq!(value("1/(x-0.5)"), f64::INFINITY);
}

#[test]
fn constants_are_found() {
    for (text, constant) in
        [("2*F^2", Some(0.18)), ("if(F > 0, 1, x)", Some(1.0)), ("if(F > 0, x, 1)", None), ("s", None)]
    {
        let found = parse(text).constant();
        assert_eq!(found.is_some(), constant.is_some(), "{text}");
        assert!((found.unwrap_or(0.0) - constant.unwrap_or(0.0)).abs() < 1e-15, "{text}");
    }
}

#[test]
fn errors_point_at_the_place_and_name_the_remedy() {
    for (text, span, message, help) in [
        ("2*G", 2..3, "unknown name G", "known are x, y, s, pi, F, long_name"),
        ("long_nme+1", 0..8, "unknown name long_nme", "did you mean long_name?"),
        ("2*sqr(x)", 2..5, "unknown function sqr", "did you mean sqrt?"),
        ("2x", 1..2, "an operator is missing", "2*x"),
        ("x(2)", 0..1, "x is not a function", "x*(...)"),
        ("sin x", 0..3, "needs its argument in parentheses", "sin(...)"),
        ("sin(x", 5..5, "the expression ends", "one argument"),
        ("sin(x,y)", 5..6, "\",\" stands", "one argument"),
        ("atan2(x)", 7..8, "\")\" stands", "atan2(y, x)"),
        ("if(x, 1)", 7..8, "\")\" stands", "three arguments"),
        ("(1", 2..2, "ends where \")\"", "close the parenthesis"),
        ("1)", 1..2, "closes nothing", "remove it"),
        ("1,5", 1..2, "a comma outside", "decimal point"),
        ("1+", 2..2, "ends where a value", "complete it"),
        ("*2", 0..1, "a value is missing before \"*\"", "write a number"),
        ("", 0..0, "empty", "\"0\""),
        ("1 = 2", 2..3, "'='", "=="),
        ("1e", 0..2, "not a number", "1e-3"),
        (".", 0..1, "not a number", "1e-3"),
        ("1e999", 0..5, "too large", "1.8e308"),
        ("0 < x < 1", 6..7, "do not chain", "(a < x)*(x < b)"),
        ("2 & 3", 2..3, "'&'", "operators are"),
    ] {
        let e = error(text);
        assert_eq!(e.span, span, "{text}: {e}");
        assert!(e.message.contains(message), "{text}: {e}");
        assert!(e.help.contains(help), "{text}: {}", e.help);
    }
}

#[test]
fn nesting_ends_at_256_for_every_way_to_nest() {
    let nested = |open: &str, inner: &str, close: &str, n: usize| open.repeat(n) + inner + &close.repeat(n);
    for (open, inner, close) in [
        ("(", "x", ")"),
        ("-", "x", ""),
        ("+", "x", ""),
        ("1^", "x", ""),
        ("abs(", "x", ")"),
        ("1+2*(", "x", ")"),
        ("if(x,", "x", ",0)"),
    ] {
        parse(&nested(open, inner, close, 256));
        for n in [257, 100_000] {
            assert!(error(&nested(open, inner, close, n)).message.contains("256"), "{n} times {open}");
        }
    }
    let list = |n: usize| format!("min(0{})", ",x".repeat(n - 1));
    parse(&list(256));
    assert!(error(&list(257)).message.contains("256"));
    // A long sum is not deep.
    assert_eq!(value(&("1".to_owned() + &"+1".repeat(99_999))), 100_000.0);
    assert_eq!(value(&("s".to_owned() + &"*1".repeat(99_999))), 0.125);
}

fn assert_kinks(text: &str, expected: &[f64]) {
    let found = parse(text).kinks(|t| (t, 0.5, (1.0 + t) / 2.0));
    assert_eq!(found.len(), expected.len(), "{text}: {found:?}");
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() < 1e-15, "{text}: {f} is not {e}");
    }
}

#[test]
fn kinks_are_where_the_closed_form_puts_them() {
    assert_kinks("x^2 + exp(x)", &[]);
    assert_kinks("abs(x)", &[0.0]);
    assert_kinks("sign(x-0.3)", &[0.3]);
    assert_kinks("abs(x+1) + abs(x-1)", &[-1.0, 1.0]);
    assert_kinks("max(x^2, 0.5)", &[-0.5_f64.sqrt(), 0.5_f64.sqrt()]);
    assert_kinks("min(x, 0.1, -y)", &[-0.5, 0.1]);
    assert_kinks("if(x < 0.7, 1, 0)", &[0.7]);
    assert_kinks("if((x > -0.2)*(x < 0.2), 1, 0)", &[-0.2, 0.2]);
    assert_kinks("sqrt(x+0.6)", &[-0.6]);
    assert_kinks("s^1.5", &[-1.0]);
    let zeros = [-0.875, -0.625, -0.375, -0.125, 0.125, 0.375, 0.625, 0.875];
    assert_kinks("abs(sin(4*pi*(x+0.125)))", &zeros);
    assert_kinks("abs(max(x, 0.25) - 0.25)", &[0.25]);
    assert_kinks("abs(1e-20*(x-0.3))", &[0.3]);
    assert_kinks("abs((x-0.301)*(x-0.302))", &[0.301, 0.302]);
    assert_kinks("abs(log(x-0.4))", &[0.4]);
}

/// Features far narrower than any sampling: zeros of a switch, and values.
#[test]
fn nothing_hides_between_points() {
    for (width, place) in [(1e-3, 0.1234), (1e-5, -0.71), (1e-8, 0.3217)] {
        let bump = format!("exp(-((x-({place}))/{width})^2)");
        let found = parse(&format!("max({bump}, 0.5)")).kinks(|t| (t, 0.5, (1.0 + t) / 2.0));
        let reach = width * 2f64.ln().sqrt();
        assert_eq!(found.len(), 2, "{width}: {found:?}");
        assert!(
            (found[0] - place + reach).abs() < 1e-7 * width + 1e-15
                && (found[1] - place - reach).abs() < 1e-7 * width + 1e-15
        );

        let survey = Survey::new(&parse(&bump), &|t| (t, 0.5, (1.0 + t) / 2.0), [-1.0, 1.0], &[]);
        assert!(survey.is_complete() && survey.pieces.len() < 500, "{} pieces", survey.pieces.len());
        assert!(survey.sampled.high > 0.5 && survey.pieces.iter().any(|p| p.value.high >= 1.0), "{:?}", survey.sampled);
        for piece in &survey.pieces {
            let distance = (place - piece.ends[1]).max(piece.ends[0] - place).max(0.0);
            assert!(
                piece.value.high < 1e-3 + 2.0 * (-(distance / width).powi(2)).exp() || distance < width,
                "{piece:?}"
            );
        }
        let narrow = survey.narrow([-1.0, 1.0], 0.01, 1e-3);
        assert!(narrow.iter().all(|t| (t - place).abs() < 20.0 * width) && narrow.len() >= 3, "{narrow:?}");
        // two of them are two, however near in parts of the whole
        let beside = place + 100.0 * width;
        let two = format!("{bump} + exp(-((x-({beside}))/{width})^2)");
        let survey = Survey::new(&parse(&two), &|t| (t, 0.5, (1.0 + t) / 2.0), [-1.0, 1.0], &[]);
        let stretches = survey.stretches(0.01, 0.05);
        let holds = |[a, b]: &[f64; 2], x: f64| *a < x && x < *b && b - a < 40.0 * width;
        assert!(
            stretches.len() == 2 && holds(&stretches[0], place) && holds(&stretches[1], beside),
            "{place} {width}: {stretches:?}"
        );
    }
    // a peak on a slope that also changes within a piece
    for width in [1e-5, 1e-4, 1e-3] {
        let datum = format!("4*x*(1-x)*(0.5-exp(-((x-0.11925)/{width})^2))");
        let survey = Survey::new(&parse(&datum), &|t| (t, 0.5, t), [0.0, 1.0], &[]);
        let stretches = survey.stretches(0.1, 0.05);
        let about = |[a, b]: &[f64; 2]| *a < 0.11925 && 0.11925 < *b && b - a < 40.0 * width;
        assert!(stretches.iter().any(about), "{width}: {stretches:?}");
    }
    // a peak that a point of every halving lies on is as narrow as any other, and so is a front
    for (datum, place) in [("exp(-((x-0.25001)/1e-4)^2)", 0.25), ("exp(-(x/1e-5)^2)", 0.0), ("atan2(x-0.5, 1e-6)", 0.5)]
    {
        let survey = Survey::new(&parse(datum), &|t| (t, 0.5, (1.0 + t) / 2.0), [-1.0, 1.0], &[]);
        let narrow = survey.narrow([-1.0, 1.0], 0.01, 1e-3);
        let about = |side: f64| narrow.iter().any(|t| 0.0 < side * (t - place) && side * (t - place) < 0.01);
        assert!(survey.is_complete() && about(1.0) && about(-1.0), "{datum}: {narrow:?}");
    }
    assert_kinks("abs(cos(2000*pi*x))", &(0..4000).map(|k| (f64::from(k) + 0.5) / 2000.0 - 1.0).collect::<Vec<_>>());
    let touch = parse("abs((x-0.3)^2)").kinks(|t| (t, 0.5, (1.0 + t) / 2.0));
    assert!(touch.len() == 1 && (touch[0] - 0.3).abs() < 1e-7, "{touch:?}");
}

/// Monotone functions, extrema and functions of one variable are enclosed to rounding.
#[test]
fn enclosures_are_tight_where_the_closed_form_is_known() {
    for (text, low, high) in [
        ("exp(-x^2)", (-1f64).exp(), 1.0),
        ("sin(3*x)", -1.0, 1.0),
        ("cos(x)", 1f64.cos(), 1.0),
        ("1/(2+x)", 1.0 / 3.0, 1.0),
        ("atan2(x, 2)", -(0.5f64.atan()), 0.5f64.atan()),
        ("abs(x-0.25)", 0.0, 1.25),
        ("if(x < 3, x, 10)", -1.0, 1.0),
        ("min(x, 0.5)", -1.0, 0.5),
        ("sqrt(1+x)", 0.0, 2f64.sqrt()),
        ("s^0.1", 0.0, 1.0),
        ("x^3", -1.0, 1.0),
    ] {
        let path = |t: f64| (t, 0.5, (1.0 + t) / 2.0);
        let Enclosed { value, .. } = enclose([-1.0, 1.0], &|a, b| parse(text).range(&leaves(&path, a, b)));
        assert!((value.low - low).abs() < 1e-14 && (value.high - high).abs() < 1e-14, "{text}: {value:?}");
    }
    // two uses of x: the mean value form is off by the square of the length
    for length in [1e-2, 1e-4] {
        let path = |t: f64| (0.5 + length * t, 0.0, 0.5);
        let Enclosed { value, .. } = enclose([-1.0, 1.0], &|a, b| parse("x*(1-x)").range(&leaves(&path, a, b)));
        assert!(
            value.contains(0.25) && value.contains(0.25 - length * length) && value.width() < 9.0 * length * length,
            "{value:?}"
        );
    }
}

#[test]
fn a_switch_that_vanishes_on_the_path_has_no_kink() {
    assert_kinks("abs(y-0.5)", &[]);
    assert_kinks("max(x, x)", &[]);
    // A slanted path on which x + y - 1 vanishes up to rounding.
    let noise = parse("abs(x+y-1)").kinks(|t| (0.1 + 0.3 * (1.0 + t), 0.9 - 0.3 * (1.0 + t), 0.0));
    assert!(noise.is_empty(), "{noise:?}");
    let corner = parse("abs(x+y-1)").kinks(|t| (0.5 + 0.3 * t, 0.5, 0.0));
    assert!(corner.len() == 1 && corner[0].abs() < 1e-15, "{corner:?}");
}

/// The reference: the same language as a tree, printed with the fewest parentheses.
#[derive(Debug, Clone)]
enum Tree {
    Number(&'static str),
    Name(&'static str),
    Negate(Box<Tree>),
    Infix(&'static str, Box<Tree>, Box<Tree>),
    Call(&'static str, Vec<Tree>),
}

fn level(sign: &str) -> u8 {
    match sign {
        "+" | "-" => 2,
        "*" | "/" => 3,
        "^" => 5,
        _ => 1,
    }
}

impl Tree {
    fn print(&self, least: u8) -> String {
        let (own, text) = match self {
            Tree::Number(text) | Tree::Name(text) => (6, (*text).to_owned()),
            Tree::Negate(a) => (4, format!("-{}", a.print(4))),
            // A sign may follow ^ directly; what stands before it must be an operand of its own.
            Tree::Infix("^", a, b) => (5, format!("{}^{}", a.print(6), b.print(4))),
            Tree::Infix(sign, a, b) => {
                let l = level(sign);
                (l, format!("{} {sign}{}", a.print(if l == 1 { 2 } else { l }), b.print(l + 1)))
            }
            Tree::Call(name, arguments) => {
                let list: Vec<String> = arguments.iter().map(|a| a.print(1)).collect();
                (6, format!("{name}({})", list.join(", ")))
            }
        };
        if own < least { format!("({text})") } else { text }
    }

    fn eval(&self, p: [f64; 3]) -> f64 {
        let truth = |t: bool, a: f64, b: f64| {
            if (a + b).is_nan() && !(a.is_infinite() && b.is_infinite()) { f64::NAN } else { f64::from(t as u8) }
        };
        match self {
            Tree::Number(text) => text.parse().unwrap(),
            Tree::Name("x") => p[0],
            Tree::Name("y") => p[1],
            Tree::Name("s") => p[2],
            Tree::Name("pi") => std::f64::consts::PI,
            Tree::Name(name) => constants()[*name],
            Tree::Negate(a) => -a.eval(p),
            Tree::Infix(sign, a, b) => {
                let (a, b) = (a.eval(p), b.eval(p));
                match *sign {
                    "+" => a + b,
                    "-" => a - b,
                    "*" => a * b,
                    "/" => a / b,
                    "^" if a.is_nan() || b.is_nan() => f64::NAN,
                    "^" if b == 2.0 => a * a,
                    "^" if b == 3.0 => a * a * a,
                    "^" => a.powf(b),
                    "<" => truth(a < b, a, b),
                    "<=" => truth(a <= b, a, b),
                    ">" => truth(a > b, a, b),
                    ">=" => truth(a >= b, a, b),
                    "==" => truth(a == b, a, b),
                    _ => truth(a != b, a, b),
                }
            }
            Tree::Call("if", list) => match list[0].eval(p) {
                c if c.is_nan() => f64::NAN,
                0.0 => list[2].eval(p),
                _ => list[1].eval(p),
            },
            Tree::Call(name, list) => {
                let v: Vec<f64> = list.iter().map(|a| a.eval(p)).collect();
                let nan = v.iter().any(|v| v.is_nan());
                match *name {
                    _ if nan => f64::NAN,
                    "abs" => v[0].abs(),
                    "sign" => f64::from(i8::from(v[0] > 0.0) - i8::from(v[0] < 0.0)),
                    "sqrt" => v[0].sqrt(),
                    "exp" => v[0].exp(),
                    "log" => v[0].ln(),
                    "sin" => v[0].sin(),
                    "cos" => v[0].cos(),
                    "tan" => v[0].tan(),
                    "atan2" => v[0].atan2(v[1]),
                    "min" => v.iter().copied().fold(f64::INFINITY, f64::min),
                    _ => v.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                }
            }
        }
    }
}

fn trees() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        prop::sample::select(vec!["0", "1", "2", "3", "0.5", ".25", "1e-3", "7.", "2.5E1"]).prop_map(Tree::Number),
        prop::sample::select(vec!["x", "y", "s", "pi", "F", "long_name"]).prop_map(Tree::Name),
    ];
    leaf.prop_recursive(7, 60, 3, |inner| {
        let signs = vec!["+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!="];
        let one = vec!["abs", "sign", "sqrt", "exp", "log", "sin", "cos", "tan"];
        let list = |n: usize| prop::collection::vec(inner.clone(), n);
        prop_oneof![
            2 => inner.clone().prop_map(|a| Tree::Negate(Box::new(a))),
            6 => (prop::sample::select(signs), inner.clone(), inner.clone())
                .prop_map(|(sign, a, b)| Tree::Infix(sign, Box::new(a), Box::new(b))),
            2 => (prop::sample::select(one), list(1)).prop_map(|(name, list)| Tree::Call(name, list)),
            1 => list(2).prop_map(|list| Tree::Call("atan2", list)),
            2 => (prop::sample::select(vec!["min", "max"]), prop::collection::vec(inner.clone(), 2..4))
                .prop_map(|(name, list)| Tree::Call(name, list)),
            1 => list(3).prop_map(|list| Tree::Call("if", list)),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn the_tape_gives_the_bits_of_the_tree(tree in trees(), p in prop::array::uniform3(-2.0..2.0_f64)) {
        let text = tree.print(0);
        let (tape, plain) = (parse(&text).eval(p[0], p[1], p[2]), tree.eval(p));
        prop_assert!(tape == plain || (tape.is_nan() && plain.is_nan()), "{text} = {tape}, tree {plain}");
    }

    /// What no point was looked at lies in the enclosure, changes included; without a value nothing is enclosed.
    #[test]
    fn values_and_slopes_lie_in_their_enclosures(
        tree in trees(), p in prop::array::uniform3(-2.0..2.0_f64), d in prop::array::uniform3(-1.0..1.0_f64), size in -9.0..0.5_f64
    ) {
        let expression = parse(&tree.print(0));
        let path = |t: f64| {
            let step = t * 10f64.powf(size);
            (p[0] + step * d[0], p[1] + step * d[1], p[2] + step * d[2])
        };
        let Enclosed { value, .. } = enclose([-1.0, 1.0], &|a, b| expression.range(&leaves(&path, a, b)));
        let slope = expression.range(&leaves(&path, -1.0, 1.0)).slope;
        let points: Vec<f64> = (0..=40).map(|k| f64::from(k) / 20.0 - 1.0).collect();
        let values: Vec<f64> = points.iter().map(|&t| { let (x, y, s) = path(t); expression.eval(x, y, s) }).collect();
        for (t, v) in points.iter().zip(&values) {
            prop_assert!(if v.is_nan() { value == Interval::ANY } else { value.contains(*v) }, "{} at {t}: {v} not in {value:?}", tree.print(0));
        }
        let size = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        for (pair, v) in points.windows(2).zip(values.windows(2)) {
            let [low, high] = [slope.low, slope.high].map(|s| s * (pair[1] - pair[0]));
            let rounding = 1e-12 * (size + low.abs().min(1e300) * 1e-3);
            let change = v[1] - v[0];
            let inside = low - rounding <= change && change <= high + rounding;
            prop_assert!(slope == Interval::ANY || inside || !change.is_finite() || size > 1e6, "{}: {change} not in [{low}, {high}]", tree.print(0));
        }
    }

    /// Operations, switches and all else are the same, to the bit.
    #[test]
    fn other_values_of_names_give_what_their_text_would(tree in trees(), f in -2.0..2.0_f64, long in prop::sample::select(vec![-2.0, 0.0, 0.5, 2.0, f64::NAN])) {
        let text = tree.print(0);
        let expression = |f: f64, long: f64| {
            Expression::parse(&text, &[("F".to_owned(), f), ("long_name".to_owned(), long)].into()).expect("a text of a tree")
        };
        let others = [("F".to_owned(), Value::Constant(f)), ("long_name".to_owned(), Value::Constant(long))].into();
        prop_assert_eq!(format!("{:?}", parse(&text).with_values(&others)), format!("{:?}", expression(f, long)));
        let one = [("long_name".to_owned(), Value::Constant(long)), ("other".to_owned(), Value::Constant(f))].into();
        prop_assert_eq!(format!("{:?}", parse(&text).with_values(&one)), format!("{:?}", expression(0.3, long)));
    }

    #[test]
    fn kinks_never_panic_and_are_few(tree in trees(), x in -1.0..1.0_f64) {
        let kinks = parse(&tree.print(0)).kinks(|t| (x, t, (1.0 + t) / 2.0));
        prop_assert!(kinks.iter().all(|t| (-1.0..=1.0).contains(t)));
        prop_assert!(kinks.windows(2).all(|w| w[0] < w[1]));
    }

    #[test]
    fn the_kink_of_a_shifted_modulus_is_its_shift(a in -0.99..0.99_f64, slope in 1e-6..1e6_f64) {
        let kinks = parse(&format!("abs({slope:?}*(x - ({a:?}))) + y")).kinks(|t| (t, t, t));
        prop_assert!(kinks.len() == 1 && (kinks[0] - a).abs() <= 2e-16, "{kinks:?}");
    }

    #[test]
    fn no_text_panics(text in "\\PC*") {
        check_text(&text)?;
    }

    #[test]
    fn no_text_of_the_alphabet_panics(text in "[0-9.eExysFpi+*/^(),<>=! -]{0,40}|((sin|if|max|x|1|[-+*/^(),<=]){0,30})") {
        check_text(&text)?;
    }
}

fn check_text(text: &str) -> Result<(), TestCaseError> {
    match Expression::parse(text, &constants()) {
        Ok(expression) => {
            expression.eval(0.1, 0.2, 0.3);
        }
        Err(e) => {
            prop_assert!(text.get(e.span.clone()).is_some(), "{:?} is not in {text:?}", e.span);
            prop_assert!(!e.help.is_empty());
        }
    }
    Ok(())
}
