//! Faults made on purpose, for tests: without the feature `faults` nothing is done.

/// Lets tests spoil a result before it is checked; `lower`: the upper triangle is not part of it.
#[cfg(not(feature = "faults"))]
#[inline(always)]
pub fn spoil(_: faer::MatMut<'_, f64>, _lower: bool) {}

#[cfg(feature = "faults")]
pub use armed::{Spoiler, disarm, spoil};

#[cfg(feature = "faults")]
mod armed {
    use std::sync::Mutex;

    use faer::MatMut;
    use steklov_quadrature::{splitmix64, unit_uniform};

    /// A fault that is to come.
    #[derive(Debug, Clone, Copy)]
    pub struct Spoiler {
        /// Number of results that stay intact before it.
        pub after: usize,
        /// The bit of a number that is flipped, from 0 to 62; 63 makes it NaN, 64 makes a column 0 from there on.
        pub kind: u32,
        /// Where it is.
        pub seed: u64,
        /// Whether all later results are spoilt as well.
        pub lasting: bool,
    }

    struct State {
        spoiler: Option<Spoiler>,
        results: usize,
        faults: usize,
    }

    static STATE: Mutex<State> = Mutex::new(State { spoiler: None, results: 0, faults: 0 });

    impl Spoiler {
        /// Counts results from now on, and spoils one.
        pub fn arm(self) {
            *STATE.lock().unwrap_or_else(|e| e.into_inner()) = State { spoiler: Some(self), results: 0, faults: 0 };
        }
    }

    /// Ends it: the number of results and of faults.
    pub fn disarm() -> (usize, usize) {
        let mut state = STATE.lock().unwrap_or_else(|e| e.into_inner());
        state.spoiler = None;
        (state.results, state.faults)
    }

    /// Spoils a result if it is its turn.
    pub fn spoil(mut a: MatMut<'_, f64>, lower: bool) {
        let mut state = STATE.lock().unwrap_or_else(|e| e.into_inner());
        let Some(Spoiler { after, kind, seed, lasting }) = state.spoiler else { return };
        if a.nrows() == 0 || a.ncols() == 0 {
            return;
        }
        state.results += 1;
        if state.results <= after || !lasting && state.faults > 0 {
            return;
        }
        state.faults += 1;
        let at = |k: u64, n: usize| ((unit_uniform(splitmix64(seed, 7), k) * n as f64) as usize).min(n - 1);
        let (mut i, mut j) = (at(0, a.nrows()), at(1, a.ncols()));
        if lower && i < j {
            (i, j) = (j.min(a.nrows() - 1), i);
        }
        match kind {
            64 => (i..a.nrows()).for_each(|i| a[(i, j)] = 0.0),
            63 => a[(i, j)] = f64::NAN,
            bit => a[(i, j)] = f64::from_bits(a[(i, j)].to_bits() ^ 1 << bit),
        }
    }
}
