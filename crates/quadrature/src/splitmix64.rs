//! The random numbers of all crates: functions of a seed and an index, the same on every machine.

/// Number i of the splitmix64 generator with a seed: 64 random bits.
///
/// Source: Steele, Lea and Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
pub fn splitmix64(seed: u64, i: u64) -> u64 {
    let mut z = seed.wrapping_add(i.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Number i of a seed, uniform in [0, 1): the upper 53 bits of [`splitmix64`] times 2⁻⁵³.
pub fn unit_uniform(seed: u64, i: u64) -> f64 {
    (splitmix64(seed, i) >> 11) as f64 * 2f64.powi(-53)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_the_data_file() {
        let reference = [
            (7, [0.3898297484, 0.01678829453, 0.9007606806, 0.582930293]),
            (2014, [0.7727061408, 0.01060959718, 0.6281408531, 0.07629860571]),
            (99, [0.2615304716, 0.03165776109, 0.8347597245, 0.1023193963]),
        ];
        for (seed, values) in reference {
            for (i, wanted) in values.into_iter().enumerate() {
                let got = unit_uniform(seed, i as u64);
                assert!((got - wanted).abs() < 1e-10, "seed {seed}, number {i}: {got}");
            }
        }
    }
}
