//! Keys of materials and of the moduli of cells.

use steklov_elastic::Plane;

use super::{ANY, LENGTH, NATURAL, POSITIVE, RATIO, key, table};
use crate::body::PLANES;
use crate::form::Form::{self, Expression, List, OneOf, Text, Words};
use crate::form::{Key, Table, quoted, words};
use crate::grid::ORDERS;

pub(super) const POISSON: Key =
    key("poisson", Expression(RATIO), "", "Poisson's ratio, one value above -1 and below 1/2.");
pub(super) const PLANE: Key = key("plane", Words(&words(&PLANES)), "", "Plane strain or plane stress.");

pub(crate) static MATERIAL: Table = table(
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

pub(crate) static CELLS: Table = table(
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

pub(crate) static RATIOS: Table = table(
    "material.cells.poisson",
    "Poisson's ratios that are drawn at random, by uniform and seed, or read from a file, by file, dataset and order, or from a picture, by image, low and high.",
    &[
        key("uniform", List(&Form::Number(RATIO), Some(2)), "", "The lowest and the highest ratio.")
            .without("required without `file` and `image`"),
        CELL_SEED,
        CELL_FILE,
        CELL_DATASET,
        CELL_ORDER,
        CELL_IMAGE,
        key("low", Form::Number(RATIO), "", "Ratio of black, of an image.").without("required with `image`"),
        key("high", Form::Number(RATIO), "", "Ratio of white.").without("required with `image`"),
    ],
);

const CELL_SEED: Key =
    key("seed", Form::Whole(NATURAL), "", "Seed of the random numbers of `uniform`.").or(|| "0".to_owned());
const CELL_FILE: Key = key("file", Text, "", "An HDF5 file, by its path from the folder of the scene.")
    .without("required without `uniform` and `image`");
const CELL_DATASET: Key = key("dataset", Text, "", "Name of the array in the file.").without("required with `file`");
const CELL_ORDER: Key = key(
    "order",
    Words(&words(&ORDERS)),
    "",
    "How the array lies: first index along x and second along y upwards, or rows from the top.",
)
.without("what the attribute `axes` of the array says, else xy");

const CELL_IMAGE: Key = key(
    "image",
    Text,
    "",
    "A PNG of grey levels, by its path from the folder of the scene: a pixel for each cell, as it is seen, its first row on top.",
)
.without("required without `uniform` and `file`");

pub(crate) static MODULI: Table = table(
    "material.cells.young",
    "Moduli that are drawn at random, by uniform and seed, or read from a file, by file, dataset and order, or from a picture, by image, low and high.",
    &[
        key("uniform", List(&Form::Number(POSITIVE), Some(2)), "stress", "The lowest and the highest modulus.")
            .without("required without `file` and `image`"),
        CELL_SEED,
        CELL_FILE,
        CELL_DATASET,
        CELL_ORDER,
        CELL_IMAGE,
        key("low", Form::Number(POSITIVE), "stress", "Modulus of black, of an image.").without("required with `image`"),
        key("high", Form::Number(POSITIVE), "stress", "Modulus of white.").without("required with `image`"),
    ],
);
