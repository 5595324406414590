//! What makes an estimate unreliable: the word of the JSON object, what it means, and what to do about it.

use std::fmt;

macro_rules! doubts {
    ($($(#[$doc:meta])+ $name:ident: $word:literal, $meaning:literal, $remedy:literal;)+) => {
        /// Why an estimate is not to be trusted.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Doubt {
            $($(#[$doc])+ $name,)+
        }

        impl Doubt {
            /// All doubts.
            pub const ALL: &[Self] = &[$(Self::$name),+];

            /// The word of the JSON object.
            pub fn word(self) -> &'static str {
                match self { $(Self::$name => $word,)+ }
            }

            /// What is in doubt.
            pub fn meaning(self) -> &'static str {
                match self { $(Self::$name => $meaning,)+ }
            }

            /// What to do about it.
            pub fn remedy(self) -> &'static str {
                match self { $(Self::$name => $remedy,)+ }
            }
        }
    };
}

doubts! {
    /// A transition of contact or stick lies inside an element: the frozen sets hide its error.
    Transition: "transition",
        "an end of contact or of stick lies inside an element, which hides its error",
        "`refine = \"hp\"` puts a vertex there, or a smaller tolerance";
    /// The contact sets are still changing from mesh to mesh, or zones press by no more than the error: rounding decides
    /// whether these are closed.
    Sets: "sets",
        "which nodes touch, stick or slip is not settled: it changed since the step before, there is no such step, sides overlap \
         between nodes, or they press by no more than the error",
        "a smaller tolerance settles it, with `refine` other than \"none\"; sides that hardly press may keep it";
    /// The mesh is too coarse about singular points for one bubble an element to show the error: an element lies between two of
    /// them, where its error may have the other parity, or one next to them is of high degree, where the next one adds
    /// little. Or elements are longer than the body is thick there.
    Coarse: "coarse",
        "at a corner or a jump of the data elements are too long or of too high a degree to show their error, or they are longer \
         than the body is thick",
        "a smaller tolerance, or more `method.elements`";
    /// The loads vary within elements more than their degree resolves: no bubble sees their effect.
    Data: "data",
        "loads, gaps, friction bounds or prescribed displacements vary within elements more than their degrees follow",
        "a smaller tolerance, or more `method.elements`";
    /// Coulomb's law has several solutions on this mesh: another was found, or the fixed point leaves this one along a direction.
    Several: "several",
        "Coulomb friction has another solution on this mesh, or is expected to have one",
        "a smaller friction coefficient has one solution; which of several a body takes the history of its loads decides, which is \
         not modelled";
    /// The error is down at rounding errors, or forces are out of balance by more than rounding may do.
    Roundoff: "roundoff",
        "the error is down at rounding errors, or forces balance to few digits (the audit's equilibrium)",
        "no smaller tolerance helps; where forces are out of balance bring lengths, gaps, loads and moduli nearer to each other";
    /// Outcomes of random input show contact, slip or data that the points at which it is solved do not.
    Outcomes: "outcomes",
        "random outcomes show, or may show, contact, slip or data that none of the points that were solved has, or a mean is out of its bounds",
        "`stochastic.refine = \"adaptive\"`, a higher `stochastic.degree` or `level`, or more `samples`";
    /// Gaps or prescribed displacements turn or deform a body more than small strains describe.
    Large: "large",
        "a body turns by more than 0.15 radian, or deforms by more than 0.15 of its diameter: small strains mean little there",
        "smaller gaps or prescribed displacements; large deformations are not modelled";
    /// The outline is a polygon that stands for a curve.
    Facets: "facets",
        "the outline has a row of short edges that stands for a curve, and the error to that curve is not estimated",
        "write `circle`, `ellipse`, `arcs` or `fillet`; `steklov plan` names the key";
    /// Forces on an unbounded medium leave a resultant.
    Length: "length",
        "the forces on the unbounded medium do not balance, so that displacements, and with held or touching sides forces too, \
         depend on the length L",
        "balance the loads, hold a point that is known not to move, or compare displacements of two points";
    /// Moduli differ so much that residuals do not see the error of the cells.
    Contrast: "contrast",
        "moduli differ so much inside coarse cells, along their edges or from corner to corner of a checkerboard that the estimate \
         is too small",
        "align the coarse cells with the stiff parts, or take finer cells; `model = \"fem\"`, with a `method.max_dofs` that allows it, where only the coarse cells are to blame";
    /// The directions of contact are uncertain by more than the tolerance.
    Normals: "normals",
        "the normals of two sides in contact differ so much that J is uncertain by more than the tolerance",
        "draw the bodies nearer to where they meet";
    /// Bodies lie in each other where there is no interface.
    Reach: "reach",
        "two bodies lie in each other at a place that no interface names",
        "name the sides that meet there in an `[[interface]]`; a crack by `on`, with `contact` in place of loads on its faces";
}

impl Doubt {
    /// The doubt of a word of the JSON object; None if the word stands for none.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|doubt| doubt.word() == word)
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}. Remedy: {}", self.word(), self.meaning(), self.remedy())
    }
}
