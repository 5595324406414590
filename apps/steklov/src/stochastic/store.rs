//! `/stochastic` of the result file.
