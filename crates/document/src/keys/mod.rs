//! The keys of the tables of a scene, all in one place.

mod geometry;
mod material;
mod random;

use steklov_problem::{
    BASES, BasisInput, CUTTINGS, INDICATORS, MODELS, MOST_CELLS, MOST_POINTS, MULTIPLIER_MESHES, MULTIPLIERS, Method,
    REFINES, SOLVERS,
};
use steklov_stochastic::Kernel;

use crate::form::Fallback::{Required, Said, Value};
use crate::form::Form::{self, Expression, Flag, List, OneOf, Point, Text, Words};
use crate::form::{Key, Range, Table, Whole, quoted, words};
use crate::method::{AUTO, MULTIPLIER_DEGREES};
use crate::probe::POINTS;

pub(super) use geometry::{ARC, BODIES, BODY, CIRCLE, CRACK, CURVE, ELLIPSE, INTERFACE, LOOP, MEDIUM, TIED};
use geometry::{AT_INFINITY, REMOTE_STRESS};
pub(super) use material::{CELLS, MATERIAL, MODULI, RATIOS};
use material::{PLANE, POISSON};
use random::RANDOM;
pub(super) use random::{FIELD, STOCHASTIC, VARIABLE_BETA, VARIABLE_LOGNORMAL, VARIABLE_NORMAL, VARIABLE_UNIFORM};

const INF: f64 = f64::INFINITY;
pub(super) const FINITE: Range = Range::open(-INF, INF, "finite");
pub(super) const POSITIVE: Range = Range::open(0.0, INF, "positive and finite");
pub(super) const LENGTH: Range = Range::open(0.0, INF, "a positive length");
pub(super) const LENGTHS: Range = Range::open(0.0, INF, "a positive length, or one for each axis");
pub(super) const ABOVE_ZERO: Range = Range::open(0.0, INF, "above 0");
pub(super) const FRACTION: Range = Range::open(0.0, 1.0, "above 0 and below 1");
pub(super) const SHARE: Range = Range { low: 0.0, high: 1.0, closed: [false, true], wanted: "above 0 and at most 1" };
pub(super) const SMOOTHNESS: Range =
    Range { low: Kernel::ROUGHEST, high: Kernel::SMOOTHEST, closed: [true, true], wanted: "from 0.5 to 10" };
pub(super) const NOT_NEGATIVE: Range =
    Range { low: 0.0, high: INF, closed: [true, false], wanted: "finite and not negative" };
/// Poisson's ratios.
pub(super) const RATIO: Range = Range::open(-1.0, 0.5, "above -1 and below 0.5");

pub(super) const ELEMENTS: Whole = Whole(1, 1_000_000);
pub(super) const DEGREE: Whole = Whole(1, 64);
/// Degrees from 0, constants, on.
pub(super) const DEGREE_FROM_0: Whole = Whole(0, 64);
pub(super) const DOFS: Whole = Whole(1, 100_000_000);
pub(super) const STEPS: Whole = Whole(1, 1_000_000);
pub(super) const LEVEL: Whole = Whole(0, 12);
pub(super) const NODES: Whole = Whole(1, 10_000_000);
pub(super) const SAMPLES: Whole = Whole(2, 10_000_000);
pub(super) const MODES: Whole = Whole(1, 10_000);
pub(super) const CELL_COUNT: Whole = Whole(1, MOST_CELLS);
pub(super) const OVERSAMPLE: Whole = Whole(0, MOST_CELLS);
pub(super) const LINE_POINTS: Whole = Whole(2, MOST_POINTS);
/// All whole numbers that TOML has.
pub(super) const NATURAL: Whole = Whole(0, i64::MAX as usize);

const NUMBER: Form = Form::Number(FINITE);
const ANY: Form = Expression(FINITE);
/// Two expressions, of x and y.
const VECTOR: Form = List(&ANY, Some(2));
/// Three expressions, of xx, yy and xy.
const TENSOR: Form = List(&ANY, Some(3));

const fn key(name: &'static str, form: Form, unit: &'static str, what: &'static str) -> Key {
    Key { name, form, default: Said("none"), unit, what }
}

impl Key {
    const fn required(self) -> Self {
        Self { default: Required, ..self }
    }

    const fn or(self, value: fn() -> String) -> Self {
        Self { default: Value(value), ..self }
    }

    const fn without(self, said: &'static str) -> Self {
        Self { default: Said(said), ..self }
    }
}

/// A table of fixed keys.
const fn table(name: &'static str, what: &'static str, keys: &'static [Key]) -> Table {
    Table { name, what, keys, names: None }
}

/// A table of names that the user chooses.
const fn names(name: &'static str, what: &'static str, form: Form, of: &'static str) -> Table {
    Table { name, what, keys: &[], names: Some((form, of)) }
}

pub(super) static SCENE: Table = table(
    "scene",
    "The keys at the top of a scene.",
    &[
        key("title", Text, "", "Title of summaries, pictures and reports.").without("name of the file"),
        key("units", Form::Table(&UNITS), "", "Names of the units."),
        key(
            "body",
            OneOf(&[Form::Table(&BODY), List(&Form::Table(&BODIES), None)]),
            "",
            "The body, or a list of several bodies.",
        )
        .required(),
        key("material", Form::Table(&MATERIAL), "", "The material of all bodies that have none of their own.")
            .without("each body has its own, or the body is a hole in the medium of `exterior`"),
        key("parameters", Form::Table(&PARAMETERS), "", "Numbers that expressions may use by their names."),
        key(
            "profiles",
            Form::Table(&PROFILES),
            "",
            "Functions by their values at points, which expressions may use: `NAME(x)`.",
        ),
        key(
            "sides",
            OneOf(&[Form::Table(&SIDES), Form::Table(&SIDES_OF_BODIES)]),
            "",
            "What holds, loads or touches each side.",
        )
        .without("every side is free of traction"),
        key(
            "body_force",
            Form::Table(&BODY_FORCE),
            "",
            "A force on the whole of all bodies that have none of their own.",
        ),
        key("probe", Form::Table(&PROBE), "", "Points, lines and sides at which results are wanted."),
        key("quantities", Form::Table(&QUANTITIES), "", "Numbers that are wanted, by names."),
        key("method", Form::Table(&METHOD), "", "How the problem is solved.").without("the defaults of its keys"),
        key("expect", Form::Table(&EXPECT), "", "Numbers that the result is compared with."),
        key("random", Form::Table(&RANDOM), "", "Random numbers and fields that expressions may use by their names."),
        key("stochastic", Form::Table(&STOCHASTIC), "", "How a problem with random input is solved.")
            .without("the defaults of its keys"),
        key("grid", Form::Table(&GRID), "", "A grid of finite elements over a body whose modulus or force varies."),
        key("exterior", Form::Table(&EXTERIOR), "", "The unbounded material around the body, or around a hole."),
        key("interface", List(&Form::Table(&INTERFACE), None), "", "What acts between sides of bodies, and on cracks."),
    ],
);

pub(super) static UNITS: Table = table(
    "units",
    "Names of the units for pictures and summaries; nothing is converted.",
    &[
        key("length", Text, "", "Name of the unit of lengths, such as mm."),
        key("stress", Text, "", "Name of the unit of stresses, such as MPa."),
    ],
);

static PARAMETERS: Table = names(
    "parameters",
    "Names for use in expressions.",
    ANY,
    "A name of letters, digits and _; the value is a number or an expression of the parameters above it.",
);

static PROFILES: Table = names(
    "profiles",
    "Measured heights, or other functions of one value, by their names.",
    Form::Table(&PROFILE),
    "A name of letters, digits and _, for use in expressions as a function of one value: `NAME(x)`, `NAME(s)`.",
);
pub(super) static PROFILE: Table = table(
    "profiles.NAME",
    "A continuous function by its values at knots, without values beyond the first and the last one.",
    &[
        key(
            "file",
            Text,
            "",
            "A text file by its path from the folder of the scene, a line for each knot: its position, a comma, semicolon or tab, its value; a line of names may come first.",
        )
        .without("required without `points`"),
        key("points", List(&Point, None), "", "Position and value of each knot, by rising positions.")
            .without("required without `file`"),
        key(
            "smooth",
            Flag,
            "",
            "Whether cubics with a continuous slope run between the knots, which rise and fall only where the values do.",
        )
        .without("false: straight lines"),
        key(
            "slopes",
            List(&Point, None),
            "",
            "Slopes before and behind each knot of `points`, for cubics between them; other slopes on both sides are a kink.",
        ),
    ],
);

pub(super) static SIDES: Table = names(
    "sides",
    "A table for each side on which something happens.",
    Form::Table(&SIDE),
    "Name of a side or of a crack.",
);
pub(super) static SIDES_OF_BODIES: Table = names(
    "sides (of several bodies)",
    "A table for each body, with one for each of its sides on which something happens.",
    Form::Table(&SIDES),
    "Name of a body.",
);

pub(super) static SIDE: Table = table(
    "sides.NAME",
    "One condition of a side: contact, displacement, pressure or traction; a side without one is free.",
    &[
        key("contact", Form::Table(&CONTACT), "", "The side may touch a rigid obstacle."),
        key(
            "displacement",
            VECTOR,
            "length",
            "Displacement that the side is held at, components x and y; \"free\" for one that may move.",
        ),
        key("pressure", ANY, "stress", "Load against the outward normal."),
        key(
            "traction",
            VECTOR,
            "stress",
            "Traction, components x and y; beside a displacement it loads the free component.",
        ),
        key(
            "springs",
            OneOf(&[ANY, VECTOR, Form::Table(&SPRINGS)]),
            "stress/length",
            "Springs to ground of a side that is free or loaded: one stiffness, those along x and y, or a table.",
        ),
    ],
);
pub(super) static SPRINGS: Table = table(
    "sides.NAME.springs",
    "Stiffnesses of springs along the normal and the tangent of a side.",
    &[
        key("normal", ANY, "stress/length", "Stiffness along the normal.").or(|| "0".to_owned()),
        key("tangential", ANY, "stress/length", "Stiffness along the tangent.").or(|| "0".to_owned()),
    ],
);
pub(super) static CONTACT: Table = table(
    "sides.NAME.contact",
    "Contact with a rigid obstacle, or of the two sides of an interface.",
    &[
        key(
            "gap",
            ANY,
            "length",
            "Distance to the obstacle along the outward normal, negative where they overlap; between bodies it is added to \
             the distance as drawn.",
        )
        .or(|| "0".to_owned()),
        key("friction", Form::Table(&FRICTION), "", "Law of friction.").without("no friction"),
    ],
);
pub(super) static FRICTION: Table = table(
    "sides.NAME.contact.friction",
    "One of two laws of friction.",
    &[
        key("tresca", ANY, "stress", "Largest shear, whatever the pressure."),
        key("coulomb", ANY, "", "Largest shear as a multiple of the pressure."),
    ],
);
pub(super) static BODY_FORCE: Table = table(
    "body_force",
    "A force on the whole body.",
    &[key(
        "value",
        VECTOR,
        "stress/length",
        "Force per area, components x and y: a + b x + c y, or with a `[grid]` any expressions of x and y.",
    )
    .required()],
);

pub(super) static PROBE: Table = table(
    "probe",
    "Where displacement and stress are wanted.",
    &[
        key("points", List(&Point, None), "length", "Points of the body, or of the medium around it.")
            .without("required without `lines` and `sides`"),
        key("lines", List(&Form::Table(&PROBE_LINE), None), "", "Lines at whose points results are wanted."),
        key("sides", List(&Text, None), "", "Names of sides along which results are wanted."),
    ],
);
pub(super) static PROBE_LINE: Table = table(
    "probe.lines",
    "A table for each line.",
    &[
        key("from", Point, "length", "Its first point.").required(),
        key("to", Point, "length", "Its last point.").required(),
        key("points", Form::Whole(LINE_POINTS), "", "Number of its points, ends included.").or(|| POINTS.to_string()),
    ],
);

static QUANTITIES: Table = names(
    "quantities",
    "Numbers of the result by names of one's own, of boundary elements.",
    Form::Table(&QUANTITY),
    "A name of letters, digits and _. The JSON object has the number as `pressure.NAME`, `mean_displacement.NAME`, `moment.NAME`, \
     `weighted_force.NAME` or `opening.NAME`.",
);
pub(super) static QUANTITY: Table = table(
    "quantities.NAME",
    "One of the numbers below.",
    &[
        key("pressure_at", Point, "length", "A point of the boundary: the pressure on it, -n·σn.")
            .without("one of the five is required"),
        key("mean_displacement", Text, "", "A side: the mean of its displacement over its length, x and y.")
            .without("one of the five is required"),
        key(
            "moment",
            Text,
            "",
            "A side: the moment, anticlockwise, of what a support, springs, an obstacle or another body do to it.",
        )
        .without("one of the five is required"),
        key("about", Point, "length", "The point about which `moment` is taken.").without("required with `moment`"),
        key("weighted_force", Text, "", "A side: ∫ w·t over it of the same traction t, w the `weight`.")
            .without("one of the five is required"),
        key("weight", VECTOR, "", "Both components of w, of x and y.").without("required with `weighted_force`"),
        key(
            "opening_at",
            Point,
            "length",
            "A point of a crack or of a side that may touch something: the distance of both surfaces after the deformation.",
        )
        .without("one of the five is required"),
    ],
);

/// A number as TOML text.
fn number(value: f64) -> String {
    format!("{value:?}")
}

pub(super) static METHOD: Table = table(
    "method",
    "How the problem is solved.",
    &[
        key("model", Words(&words(&MODELS)), "", "Discretisation; auto takes the least that the scene needs.")
            .or(|| quoted(&MODELS, Method::default().model)),
        key("tolerance", Form::Number(FRACTION), "", "Wanted relative error in the energy norm.")
            .or(|| number(Method::default().tolerance())),
        key("refine", Words(&words(&REFINES)), "", "How the mesh is refined.")
            .or(|| quoted(&REFINES, Method::default().refine)),
        key("elements", Form::Whole(ELEMENTS), "", "Number of elements of the first mesh, at least one for each edge.")
            .or(|| Method::default().elements().to_string()),
        key("degree", Form::Whole(DEGREE), "", "Polynomial degree of the first mesh.")
            .or(|| Method::default().degree.to_string()),
        key(
            "max_dofs",
            Form::Whole(DOFS),
            "",
            "Most displacement unknowns; where it is not given, also as many as the memory holds.",
        )
        .or(|| Method::default().max_dofs().to_string()),
        key("max_steps", Form::Whole(STEPS), "", "Most adaptive steps.").or(|| Method::default().max_steps.to_string()),
        key(
            "cuts",
            Words(&words(&CUTTINGS)),
            "",
            "Whether the body is cut into subdomains; auto does so where it costs less.",
        )
        .or(|| quoted(&CUTTINGS, Method::default().cuts)),
        key("indicator", Words(&words(&INDICATORS)), "", "Error indicator of refine = \"hp-decay\" and \"h\".")
            .or(|| quoted(&INDICATORS, Method::default().indicator)),
        key("estimators", Flag, "", "Whether residual estimators are told beside the estimate.")
            .or(|| Method::default().estimators.to_string()),
        key(
            "marking",
            OneOf(&[Words(&[AUTO]), Form::Number(SHARE)]),
            "",
            "Share of the estimated error that is refined at once; auto is 0.95 for hp and 0.5 for the others.",
        )
        .or(|| Method::default().marking.map_or(format!("{AUTO:?}"), number)),
        key("smoothness", Form::Number(SHARE), "", "Decay of Legendre coefficients that decides between h and p.")
            .or(|| number(Method::default().smoothness)),
        key("multiplier", Words(&words(&MULTIPLIERS)), "", "Multipliers of contact.")
            .or(|| quoted(&MULTIPLIERS, Method::default().multiplier)),
        key(
            "gamma",
            OneOf(&[Words(&[AUTO]), Form::Number(ABOVE_ZERO)]),
            "1/stress",
            "γ₀ in γ = γ₀ h/p² of stabilised multipliers; auto is half of the critical value of each mesh.",
        )
        .or(|| Method::default().gamma.map_or(format!("{AUTO:?}"), number)),
        key(
            "multiplier_mesh",
            Words(&words(&MULTIPLIER_MESHES)),
            "",
            "Mesh of stabilised multipliers, against that of the displacement.",
        )
        .or(|| quoted(&MULTIPLIER_MESHES, Method::default().multiplier_mesh)),
        key(
            "multiplier_degree",
            OneOf(&[Words(&words(&MULTIPLIER_DEGREES)), Form::Whole(DEGREE_FROM_0)]),
            "",
            "Degree of stabilised multipliers: auto is that of the displacement, continuous is piecewise linear.",
        )
        .or(|| quoted(&MULTIPLIER_DEGREES, Method::default().multiplier_degree)),
        key("solver", Words(&words(&SOLVERS)), "", "Solver of contact.")
            .or(|| quoted(&SOLVERS, Method::default().solver)),
    ],
);

static EXPECT: Table = Table {
    name: "expect",
    what: "Numbers that the result is compared with, by their paths in the JSON object, in quotes or as nested tables.",
    keys: &[],
    names: Some((
        OneOf(&[Form::Table(&EXPECTATION), Form::Table(&EXPECT)]),
        "A path in the JSON object, or a part of one.",
    )),
};
pub(super) static EXPECTATION: Table = table(
    "expect.PATH",
    "A number that the result must have.",
    &[
        key("value", NUMBER, "that of the number", "The number.").required(),
        key("tol", Form::Number(NOT_NEGATIVE), "that of the number", "How far the result may be off.").required(),
        key("source", Text, "", "Where the number comes from.").or(|| "\"\"".to_owned()),
    ],
);

pub(super) static GRID: Table = table(
    "grid",
    "Rectangles over the bounding box of the body, whose corners are grid points.",
    &[
        key("coarse", List(&Form::Whole(CELL_COUNT), Some(2)), "", "Coarse cells along x and along y.").required(),
        key(
            "fine",
            List(&Form::Whole(CELL_COUNT), Some(2)),
            "",
            "Fine cells in each coarse cell, along x and along y.",
        )
        .required(),
        key("basis", Words(&words(&BASES)), "", "Multiscale basis of the coarse cells.")
            .or(|| quoted(&BASES, BasisInput::Coupled)),
        key("oversample", Form::Whole(OVERSAMPLE), "", "Fine cells that basis = \"oversampled\" adds on each side.")
            .without("as many as a coarse cell has"),
    ],
);

pub(super) static EXTERIOR: Table = table(
    "exterior",
    "The unbounded material around the body; without `[material]` the outline of the body is a hole in it.",
    &[
        key("young", Expression(POSITIVE), "stress", "Young's modulus of the medium, one value.").required(),
        POISSON.required(),
        PLANE.without("that of the body, else strain"),
        key(
            "displacement_jump",
            VECTOR,
            "length",
            "Displacement of the body less that of the medium, where both meet.",
        )
        .without("no jump"),
        key("traction_jump", VECTOR, "stress", "The same of tractions, on the normal out of the body.")
            .without("no jump"),
        key("stress_jump", TENSOR, "stress", "The same as a tensor, entries xx, yy and xy, applied to that normal.")
            .without("no jump"),
        REMOTE_STRESS,
        AT_INFINITY,
    ],
);
