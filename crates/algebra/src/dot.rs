/// a·b = Σ a_i b_i, added from the first to the last; what is longer ends with the shorter.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 is lost beside 2^53, but not behind -2^53.
    #[test]
    fn products_are_added_from_the_first_to_the_last() {
        let large = 2f64.powi(53);
        assert_eq!(dot(&[large, 1.0, 1.0], &[1.0, 1.0, -large]), 0.0);
        assert_eq!(dot(&[large, 1.0, 1.0], &[1.0, -large, 1.0]), 1.0);
        assert_eq!(dot(&[1.0, 2.0, 3.0], &[4.0, -5.0]), -6.0);
    }
}
