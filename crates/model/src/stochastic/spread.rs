//! Whether the spread of a quantity is more than rounding, and its mean a value that the quantity can have.

use steklov_problem::Scene;

use super::result::{Quantity, bounds};

/// Deviations below this part of the scale of a quantity are rounding: contact is solved to 1e-11.
const ROUNDED: f64 = 1e-10;
/// Part of its scale by which a mean may leave its bounds by rounding.
const BEYOND: f64 = 1e-9;

/// Last keys of paths that are components of one vector or tensor, and paths of one unit that are parts of each other.
const COMPONENTS: [&[&str]; 3] = [&["x", "y"], &["0", "1", "2"], &["xx", "yy", "xy"]];
const PARTS: [&[&str]; 2] = [
    &["energy", "strain_energy", "spring_energy", "load_work", "friction_work"],
    &["contact.length", "contact.stick", "contact.slip"],
];

/// Variance of values, as expected of samples.
pub(super) fn spread(count: usize, value: &dyn Fn(usize) -> f64) -> f64 {
    let mean = (0..count).map(value).sum::<f64>() / count as f64;
    (0..count).map(|i| (value(i) - mean).powi(2)).sum::<f64>() / (count.max(2) - 1) as f64
}

/// The paths whose largest value is the scale of a quantity: its own, and those of what it is a component or part of.
pub(super) fn of_one_scale(path: &str) -> Vec<String> {
    if let Some(parts) = PARTS.iter().find(|parts| parts.contains(&path)) {
        return parts.iter().map(|part| (*part).to_owned()).collect();
    }
    let components = path.rsplit_once('.').and_then(|(vector, last)| {
        let all = COMPONENTS.iter().find(|all| all.contains(&last))?;
        Some(all.iter().map(|component| format!("{vector}.{component}")).collect())
    });
    components.unwrap_or_else(|| vec![path.to_owned()])
}

/// Whether a spread is rounding; `scale`: the largest nominal value of those of one scale, or the mean if that is larger.
pub(super) fn is_rounding(deviation: f64, scale: f64) -> bool {
    deviation <= ROUNDED * scale
}

/// Whether polynomials miss more of a quantity than it varies by, so that they say nothing of its spread.
pub(super) fn is_missed(quantity: &Quantity, scale: f64) -> bool {
    let deviation = quantity.variance.max(0.0).sqrt();
    quantity.truncation.is_some_and(|missed| missed > deviation && !is_rounding(missed, scale.max(quantity.mean.abs())))
}

/// Takes away quantiles, density and effects of a quantity whose spread is rounding, and says where its mean is out of its
/// bounds; `scale`: the largest nominal value of those of one scale.
pub(super) fn judge(scene: &Scene, quantity: &mut Quantity, scale: f64) {
    let scale = scale.max(quantity.mean.abs());
    let values = quantity.values.iter();
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)]);
    // weights of both signs make the variance of rounding negative, which says nothing
    if quantity.variance.is_nan() && is_rounding(high - low, scale) {
        quantity.variance = 0.0;
    }
    if is_rounding(quantity.variance.max(0.0).sqrt(), scale) {
        (quantity.quantiles, quantity.density, quantity.effects) = (None, None, None);
    }
    let [low, high] = bounds(scene, &quantity.name);
    let beyond = (low - quantity.mean).max(quantity.mean - high);
    quantity.bounds_left = (beyond > BEYOND * scale).then_some([low, high]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_and_parts_have_one_scale() {
        for (path, all) in [
            ("contact.force.x", &["contact.force.x", "contact.force.y"][..]),
            ("probe.0.stress.1", &["probe.0.stress.0", "probe.0.stress.1", "probe.0.stress.2"]),
            ("probe.0.stress.xy", &["probe.0.stress.xx", "probe.0.stress.yy", "probe.0.stress.xy"]),
            ("friction_work", PARTS[0]),
            ("contact.slip", PARTS[1]),
            ("contact.max_pressure", &["contact.max_pressure"]),
        ] {
            assert_eq!(of_one_scale(path), all, "{path}");
        }
    }
}
