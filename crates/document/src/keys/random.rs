//! Keys of random input and of how it is solved.

use steklov_problem::Stochastic;

use super::{
    DEGREE_FROM_0, ELEMENTS, FRACTION, LENGTHS, LEVEL, MODES, NATURAL, NODES, NOT_NEGATIVE, NUMBER, POSITIVE, SAMPLES,
    SMOOTHNESS, key, names, number, table,
};
use crate::form::Form::{self, List, OneOf, Text, Words};
use crate::form::{Key, Table, quoted, words};
use crate::method::AUTO;
use crate::random::{BETA, LOGNORMAL, NORMAL, UNIFORM};
use crate::random_field::{ALL, CAPTURED, FAMILIES, VARIABLES};
use crate::stochastic::{SAMPLINGS, SPLITS};

pub(super) static RANDOM: Table = names(
    "random",
    "Independent random input by its names.",
    OneOf(&[
        Form::Table(&VARIABLE_UNIFORM),
        Form::Table(&VARIABLE_NORMAL),
        Form::Table(&VARIABLE_LOGNORMAL),
        Form::Table(&VARIABLE_BETA),
        Form::Table(&FIELD),
    ]),
    "A name of letters, digits and _, for use in expressions.",
);
const MEAN: Key = key("mean", NUMBER, "", "Mean of the variable before bounds cut it off.").required();
const DEVIATION: Key =
    key("deviation", Form::Number(POSITIVE), "", "Standard deviation of the variable before bounds cut it off.")
        .required();
const LOW: Key = key("low", NUMBER, "", "Least value.").required();
const HIGH: Key = key("high", NUMBER, "", "Greatest value, above `low`.").required();
/// The law of a variable.
const fn distribution(word: &'static [&'static str]) -> Key {
    key("distribution", Words(word), "", "Law of the variable.").required()
}

pub(crate) static VARIABLE_UNIFORM: Table = table(
    "random.NAME (uniform)",
    "A variable that has all values between two bounds alike.",
    &[distribution(&[UNIFORM]), LOW, HIGH],
);
pub(crate) static VARIABLE_NORMAL: Table = table(
    "random.NAME (normal)",
    "A normal variable, cut off at bounds if they are given.",
    &[distribution(&[NORMAL]), MEAN, DEVIATION, LOW.without("no bound"), HIGH.without("no bound")],
);
pub(crate) static VARIABLE_LOGNORMAL: Table = table(
    "random.NAME (lognormal)",
    "A variable whose logarithm is normal, cut off at bounds if they are given.",
    &[
        distribution(&[LOGNORMAL]),
        Key { form: Form::Number(POSITIVE), ..MEAN },
        DEVIATION,
        Key { form: Form::Number(NOT_NEGATIVE), ..LOW }.without("0"),
        HIGH.without("no bound"),
    ],
);
pub(crate) static VARIABLE_BETA: Table = table(
    "random.NAME (beta)",
    "A variable of the beta law between two bounds.",
    &[
        distribution(&[BETA]),
        key("alpha", Form::Number(POSITIVE), "", "First exponent of the law.").required(),
        key("beta", Form::Number(POSITIVE), "", "Second exponent of the law.").required(),
        LOW,
        HIGH,
    ],
);
pub(crate) static FIELD: Table = table(
    "random.NAME (field)",
    "A random field of mean 0 and variance 1, by its Karhunen-Loève expansion.",
    &[
        key(
            "covariance",
            Words(&words(&FAMILIES)),
            "",
            "Covariance of the values at two points; independent: of no two modulus cells.",
        )
        .required(),
        key("smoothness", Form::Number(SMOOTHNESS), "", "ν of matern, which has derivatives up to an order below ν.")
            .without("required by matern"),
        key(
            "correlation",
            OneOf(&[Form::Number(LENGTHS), List(&Form::Number(LENGTHS), Some(2))]),
            "length",
            "Correlation length, or one for each of x and y.",
        )
        .without("required, but not by independent"),
        key("on", Text, "", "Name of the side that the field lives on, or \"body\".").required(),
        key(
            "captured",
            Form::Number(FRACTION),
            "",
            "Share of the variance that the kept modes carry; not beside `modes`.",
        )
        .or(|| number(CAPTURED)),
        key(
            "modes",
            OneOf(&[Words(&[AUTO, ALL]), Form::Whole(MODES)]),
            "",
            "Number of modes that are kept. Of a field of cells \"auto\": as many as there are up to 400; \"all\": the field is drawn without truncation, by monte-carlo and multilevel.",
        )
        .without("as many as `captured` needs"),
        key("variables", Words(&words(&VARIABLES)), "", "Law of the modes: uniform between -√3 and √3, or normal.")
            .without("\"uniform\"; with modes = \"all\" \"normal\""),
    ],
);

pub(crate) static STOCHASTIC: Table = table(
    "stochastic",
    "How a problem with random input is solved.",
    &[
        key("method", Words(&words(&SAMPLINGS)), "", "Which outcomes are solved, and what is made of them.")
            .or(|| quoted(&SAMPLINGS, None)),
        key("degree", Form::Whole(DEGREE_FROM_0), "", "Polynomial degree in each germ, of galerkin and collocation; of galerkin on a grid the total degree.")
            .without("3; of galerkin on a grid as high as the tolerance needs"),
        key("elements", Form::Whole(ELEMENTS), "", "Stochastic elements of each germ, of galerkin and collocation.")
            .or(|| Stochastic::default().elements.to_string()),
        key("level", Form::Whole(LEVEL), "", "Level of the sparse grid.")
            .without("2, on a grid 1 with more than 10 germs"),
        key("refine", Words(&words(&SPLITS)), "", "Whether stochastic elements are split where contact changes.")
            .or(|| quoted(&SPLITS, Stochastic::default().refine)),
        key(
            "tolerance",
            Form::Number(FRACTION),
            "",
            "Wanted truncation of refine = \"adaptive\", by auto over the deviation; of corrected and multilevel the standard errors of means over the deviations, of galerkin on a grid without degree the square of the truncation over the deviation.",
        )
        .without("0.01; of galerkin by auto 0.05, where refine is given 1e-4"),
        key("max_nodes", Form::Whole(NODES), "", "Most outcomes that refine = \"adaptive\", corrected and multilevel solve.")
            .without("10000, of multilevel 10 million"),
        key(
            "samples",
            Form::Whole(SAMPLES),
            "",
            "Number of samples of monte-carlo, and of those that quantiles are read from.",
        )
        .or(|| Stochastic::default().samples.to_string()),
        key("seed", Form::Whole(NATURAL), "", "Seed of the samples.").or(|| Stochastic::default().seed.to_string()),
        key("quantiles", List(&Form::Number(FRACTION), None), "", "Probabilities whose quantiles are told.")
            .or(|| format!("{:?}", Stochastic::default().quantiles)),
        key(
            "quantities",
            List(&Text, None),
            "",
            "Paths in the JSON object of the numbers whose statistics are wanted.",
        )
        .without("the numbers that the scene has"),
    ],
);
