//! Keys of bodies, loops, curves, interfaces and cracks.

use super::material::MATERIAL;
use super::{CONTACT, NATURAL, NUMBER, POSITIVE, TENSOR, VECTOR, key, names, table};
use crate::exterior::RADIATIONS;
use crate::form::Form::{self, Flag, List, OneOf, Point, Refused, Text, True, Words};
use crate::form::{Key, Table, words};

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

pub(crate) static BODY: Table = table(
    "body",
    "One body: a polygon, curves between its corners, or a circle or an ellipse.",
    &[CORNERS, SIDE_NAMES, HOLES, CRACKS, ARCS_KEY, CURVES_KEY, FILLET_KEY, CIRCLE_KEY, ELLIPSE_KEY, WHOLE_SIDE],
);

/// One of several bodies.
pub(crate) static BODIES: Table = table(
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
pub(crate) static MEDIUM: Table =
    table("body.medium", "What an unbounded one of several bodies does far away.", &[REMOTE_STRESS, AT_INFINITY]);

pub(super) const REMOTE_STRESS: Key =
    key("remote_stress", TENSOR, "stress", "Stress far away, entries xx, yy and xy; one value each.")
        .or(|| "[0, 0, 0]".to_owned());
pub(super) const AT_INFINITY: Key = key(
    "at_infinity",
    Words(&words(&RADIATIONS)),
    "",
    "What the displacement does far away: vanish if the loads balance, or be constant.",
)
.without("decaying; bounded where sides of a hole are held or touch");

pub(crate) static INTERFACE: Table = table(
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

pub(crate) static TIED: Table = table(
    "interface.tied",
    "Jumps across a tie, the first side less the second.",
    &[
        key("displacement_jump", VECTOR, "length", "Jump of the displacement, components x and y.").without("no jump"),
        key("traction_jump", VECTOR, "stress", "Jump of the traction, components x and y.").without("no jump"),
    ],
);

pub(crate) static CRACK: Table = table(
    "body.cracks",
    "A table `[[body.cracks]]` for each crack.",
    &[
        key("points", List(&Point, None), "length", "Points of the crack, which is straight between them.").required(),
        key("side", Text, "", "Name of the crack; its faces are NAME.left and NAME.right.")
            .without("crack, crack-2, ..."),
    ],
);

/// A hole.
pub(crate) static LOOP: Table = table(
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

pub(crate) static ARC: Table = table(
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
pub(crate) static CURVE: Table = table(
    "body.curves.NAME",
    "A cubic Bézier curve between both corners of its edge.",
    &[EDGE, key("control", List(&Point, Some(2)), "length", "The two control points.").required()],
);
pub(crate) static CIRCLE: Table = table(
    "body.circle",
    "A circle as a whole loop.",
    &[
        key("centre", Point, "length", "Its centre.").required(),
        key("radius", Form::Number(POSITIVE), "length", "Its radius.").required(),
    ],
);
pub(crate) static ELLIPSE: Table = table(
    "body.ellipse",
    "An ellipse as a whole loop.",
    &[
        key("centre", Point, "length", "Its centre.").required(),
        key("radii", List(&Form::Number(POSITIVE), Some(2)), "length", "Its half axes.").required(),
        key("angle", NUMBER, "degree", "Angle of the first half axis to x.").or(|| "0.0".to_owned()),
    ],
);
