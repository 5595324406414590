//! The keys of the tables of a scene, all in one place.

use steklov_elastic::Plane;
use steklov_problem::{
    BASES, BasisInput, INDICATORS, MODELS, MOST_CELLS, MOST_POINTS, MULTIPLIER_MESHES, MULTIPLIERS, Method, REFINES,
    SOLVERS, Stochastic,
};
use steklov_stochastic::Kernel;

use super::body::PLANES;
use super::exterior::RADIATIONS;
use super::form::Fallback::{Required, Said, Value};
use super::form::Form::{self, Expression, Flag, List, OneOf, Point, Refused, Text, True, Words};
use super::form::{Key, Range, Table, Whole, quoted, words};
use super::grid::ORDERS;
use super::method::{AUTO, MULTIPLIER_DEGREES};
use super::probe::POINTS;
use super::random::{BETA, LOGNORMAL, NORMAL, UNIFORM};
use super::random_field::{ALL, CAPTURED, FAMILIES, VARIABLES};
use super::stochastic::{SAMPLINGS, SPLITS};

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
const RATIO: Range = Range::open(-1.0, 0.5, "above -1 and below 0.5");

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

// forms for the constants below, which may refer to statics but not to values made of references to statics
static ARC_FORMS: [Form; 2] = [Form::Table(&ARCS), List(&Form::Table(&ARC), None)];
static CURVE_FORMS: [Form; 2] = [Form::Table(&CURVES), List(&Form::Table(&CURVE), None)];
static HOLE: Form = Form::Table(&LOOP);
static CRACK_FORM: Form = Form::Table(&CRACK);

const CORNERS: Key = key(
    "corners",
    List(&Point, None),
    "length",
    "Corners of the outline, counter-clockwise (in either order for a hole).",
)
.without("required without `circle` and `ellipse`");
const SIDE_NAMES: Key = key(
    "sides",
    List(&Text, None),
    "",
    "Names of the sides: side k runs from corner k to the next, and names may repeat.",
)
.without("required with `corners`");
const ARCS_KEY: Key = key(
    "arcs",
    OneOf(&ARC_FORMS),
    "",
    "Edges that are circular or elliptic arcs: by side name or edge number, or a list with `edge`.",
);
const CURVES_KEY: Key = key(
    "curves",
    OneOf(&CURVE_FORMS),
    "",
    "Edges that are cubic Bézier curves: by side name or edge number, or a list with `edge`.",
);
const FILLET_KEY: Key = key("fillet", Form::Table(&FILLET), "", "Corners between straight edges that are rounded.");
const CIRCLE_KEY: Key = key("circle", Form::Table(&CIRCLE), "", "The whole loop is a circle, in place of corners.");
const ELLIPSE_KEY: Key =
    key("ellipse", Form::Table(&ELLIPSE), "", "The whole loop is an ellipse, in place of corners.");
const WHOLE_SIDE: Key = key("side", Text, "", "Name of the side that a circle or an ellipse is.")
    .without("required with `circle` or `ellipse`");
const HOLES: Key = key("holes", List(&HOLE, None), "", "Holes, any number.");
const CRACKS: Key = key("cracks", List(&CRACK_FORM, None), "", "Cracks, whose faces are in contact.");

pub(super) static BODY: Table = table(
    "body",
    "One body: a polygon, curves between its corners, or a circle or an ellipse.",
    &[CORNERS, SIDE_NAMES, HOLES, CRACKS, ARCS_KEY, CURVES_KEY, FILLET_KEY, CIRCLE_KEY, ELLIPSE_KEY, WHOLE_SIDE],
);

/// One of several bodies.
pub(super) static BODIES: Table = table(
    "body (one of several)",
    "A table `[[body]]` for each of several bodies.",
    &[
        key("name", Text, "", "Name of the body, without dots; its sides are called BODY.SIDE.").required(),
        CORNERS,
        SIDE_NAMES,
        HOLES,
        ARCS_KEY,
        CURVES_KEY,
        FILLET_KEY,
        CIRCLE_KEY,
        ELLIPSE_KEY,
        WHOLE_SIDE,
        key("material", Form::Table(&MATERIAL), "", "Material of this body.").without("that of `[material]`"),
        key(
            "medium",
            Form::Table(&MEDIUM),
            "",
            "The body is the unbounded plane around its holes, without an outline.",
        ),
        CRACKS,
        key("grid", Refused, "", "Grids are not solved among several bodies."),
        key("body_force", VECTOR, "stress/length", "Force per area on this body, components x and y.")
            .without("that of `[body_force]`"),
    ],
);

/// The far field of an unbounded body among several.
pub(super) static MEDIUM: Table =
    table("body.medium", "What an unbounded one of several bodies does far away.", &[REMOTE_STRESS, AT_INFINITY]);

const REMOTE_STRESS: Key =
    key("remote_stress", TENSOR, "stress", "Stress far away, entries xx, yy and xy; one value each.")
        .or(|| "[0, 0, 0]".to_owned());
const AT_INFINITY: Key = key(
    "at_infinity",
    Words(&words(&RADIATIONS)),
    "",
    "What the displacement does far away: vanish if the loads balance, or be constant.",
)
.without("decaying; bounded where sides of a hole are held or touch");

pub(super) static INTERFACE: Table = table(
    "interface",
    "A table `[[interface]]` for each pair of sides that touch or are tied, and for each crack with friction.",
    &[
        key(
            "between",
            List(&OneOf(&[Text, List(&Text, None)]), Some(2)),
            "",
            "The two sides that meet, as BODY.SIDE; each may be a list of sides.",
        )
        .without("required without `on`"),
        key(
            "contact",
            OneOf(&[True, Form::Table(&CONTACT)]),
            "",
            "The sides are in contact: true without friction, or a table.",
        )
        .without("required without `tied`"),
        key("tied", OneOf(&[True, Form::Table(&TIED)]), "", "The sides are tied: true, or a table of jumps.")
            .without("required without `contact`"),
        key("multiplier", Text, "", "The side that carries pressure and shear.").without("chosen by the program"),
        key("name", Text, "", "Name of the interface in the result.").without("made of the names of the sides"),
        key("on", Text, "", "The crack whose faces meet here, in place of `between`."),
    ],
);

pub(super) static TIED: Table = table(
    "interface.tied",
    "Jumps across a tie, the first side less the second.",
    &[
        key("displacement_jump", VECTOR, "length", "Jump of the displacement, components x and y.").without("no jump"),
        key("traction_jump", VECTOR, "stress", "Jump of the traction, components x and y.").without("no jump"),
    ],
);

pub(super) static CRACK: Table = table(
    "body.cracks",
    "A table `[[body.cracks]]` for each crack.",
    &[
        key("points", List(&Point, None), "length", "Points of the crack, which is straight between them.").required(),
        key("side", Text, "", "Name of the crack; its faces are NAME.left and NAME.right.")
            .without("crack, crack-2, ..."),
    ],
);

/// A hole.
pub(super) static LOOP: Table = table(
    "body.holes",
    "A table `[[body.holes]]` for each hole.",
    &[CORNERS, SIDE_NAMES, ARCS_KEY, CURVES_KEY, FILLET_KEY, CIRCLE_KEY, ELLIPSE_KEY, WHOLE_SIDE],
);

static ARCS: Table = names(
    "body.arcs",
    "Arcs by the edges that they replace.",
    Form::Table(&ARC),
    "Name of a side of one edge, or number of an edge from 0 on.",
);
static CURVES: Table = names(
    "body.curves",
    "Bézier curves by the edges that they replace.",
    Form::Table(&CURVE),
    "Name of a side of one edge, or number of an edge from 0 on.",
);
static FILLET: Table = names(
    "body.fillet",
    "Radii of rounded corners.",
    Form::Number(POSITIVE),
    "Number of a corner from 0 on; the value is the radius.",
);
const EDGE: Key = key("edge", Form::Whole(NATURAL), "", "Number of the edge, in a list of such tables.")
    .without("the name or number that the table stands at");

pub(super) static ARC: Table = table(
    "body.arcs.NAME",
    "An arc: one of bulge, centre, radius and through; centre with radii is an ellipse.",
    &[
        EDGE,
        key("bulge", NUMBER, "", "Tangent of a quarter of the angle of the arc, positive counter-clockwise."),
        key("centre", Point, "length", "Centre of the circle or the ellipse."),
        key("radius", NUMBER, "length", "Radius of the circle, negative for clockwise."),
        key("large", Flag, "", "Whether the longer arc is taken.").or(|| "false".to_owned()),
        key("through", Point, "length", "A point on the arc between both corners."),
        key("radii", List(&Form::Number(POSITIVE), Some(2)), "length", "Half axes of the ellipse about `centre`."),
        key("angle", NUMBER, "degree", "Angle of the first half axis to x.").or(|| "0.0".to_owned()),
    ],
);
pub(super) static CURVE: Table = table(
    "body.curves.NAME",
    "A cubic Bézier curve between both corners of its edge.",
    &[EDGE, key("control", List(&Point, Some(2)), "length", "The two control points.").required()],
);
pub(super) static CIRCLE: Table = table(
    "body.circle",
    "A circle as a whole loop.",
    &[
        key("centre", Point, "length", "Its centre.").required(),
        key("radius", Form::Number(POSITIVE), "length", "Its radius.").required(),
    ],
);
pub(super) static ELLIPSE: Table = table(
    "body.ellipse",
    "An ellipse as a whole loop.",
    &[
        key("centre", Point, "length", "Its centre.").required(),
        key("radii", List(&Form::Number(POSITIVE), Some(2)), "length", "Its half axes.").required(),
        key("angle", NUMBER, "degree", "Angle of the first half axis to x.").or(|| "0.0".to_owned()),
    ],
);

const POISSON: Key = key("poisson", Expression(RATIO), "", "Poisson's ratio, one value above -1 and below 1/2.");
const PLANE: Key = key("plane", Words(&words(&PLANES)), "", "Plane strain or plane stress.");

pub(super) static MATERIAL: Table = table(
    "material",
    "An isotropic elastic material.",
    &[
        key("young", Expression(POSITIVE), "stress", "Young's modulus, one value; random names may be in it.")
            .without("required without `cells`"),
        POISSON.without("required without `material.cells.poisson`"),
        PLANE.or(|| quoted(&PLANES, Plane::Strain)),
        key(
            "cells",
            Form::Table(&CELLS),
            "",
            "A modulus for each of many cells, in place of `young`; needs a `[grid]`.",
        ),
    ],
);

pub(super) static CELLS: Table = table(
    "material.cells",
    "Squares over the bounding box of the body, each with its own Young's modulus.",
    &[
        key("size", Form::Number(LENGTH), "length", "Edge length of a cell.").required(),
        key(
            "young",
            OneOf(&[ANY, Form::Table(&MODULI)]),
            "stress",
            "Young's moduli: an expression of x and y at the centres of the cells, or a table.",
        )
        .required(),
        key(
            "poisson",
            OneOf(&[ANY, Form::Table(&RATIOS)]),
            "",
            "Poisson's ratios of the cells, in place of `material.poisson`: an expression of x and y at their centres, or a table.",
        )
        .without("`material.poisson` in all of them"),
    ],
);

pub(super) static RATIOS: Table = table(
    "material.cells.poisson",
    "Poisson's ratios that are drawn at random, by uniform and seed, or read from a file, by file, dataset and order.",
    &[
        key("uniform", List(&Form::Number(RATIO), Some(2)), "", "The lowest and the highest ratio.")
            .without("required without `file`"),
        CELL_SEED,
        CELL_FILE,
        CELL_DATASET,
        CELL_ORDER,
    ],
);

const CELL_SEED: Key =
    key("seed", Form::Whole(NATURAL), "", "Seed of the random numbers of `uniform`.").or(|| "0".to_owned());
const CELL_FILE: Key = key("file", Text, "", "An HDF5 file, by its path from the folder of the scene.")
    .without("required without `uniform`");
const CELL_DATASET: Key = key("dataset", Text, "", "Name of the array in the file.").without("required with `file`");
const CELL_ORDER: Key = key(
    "order",
    Words(&words(&ORDERS)),
    "",
    "How the array lies: first index along x and second along y upwards, or rows from the top.",
)
.without("what the attribute `axes` of the array says, else xy");

pub(super) static MODULI: Table = table(
    "material.cells.young",
    "Moduli that are drawn at random, by uniform and seed, or read from a file, by file, dataset and order.",
    &[
        key("uniform", List(&Form::Number(POSITIVE), Some(2)), "stress", "The lowest and the highest modulus.")
            .without("required without `file`"),
        CELL_SEED,
        CELL_FILE,
        CELL_DATASET,
        CELL_ORDER,
    ],
);

static PARAMETERS: Table = names(
    "parameters",
    "Names for use in expressions.",
    ANY,
    "A name of letters, digits and _; the value is a number or an expression of the parameters above it.",
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

static RANDOM: Table = names(
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

pub(super) static VARIABLE_UNIFORM: Table = table(
    "random.NAME (uniform)",
    "A variable that has all values between two bounds alike.",
    &[distribution(&[UNIFORM]), LOW, HIGH],
);
pub(super) static VARIABLE_NORMAL: Table = table(
    "random.NAME (normal)",
    "A normal variable, cut off at bounds if they are given.",
    &[distribution(&[NORMAL]), MEAN, DEVIATION, LOW.without("no bound"), HIGH.without("no bound")],
);
pub(super) static VARIABLE_LOGNORMAL: Table = table(
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
pub(super) static VARIABLE_BETA: Table = table(
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
pub(super) static FIELD: Table = table(
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

pub(super) static STOCHASTIC: Table = table(
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
