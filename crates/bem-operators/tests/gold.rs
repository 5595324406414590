//! Moments and blocks of element pairs against values computed with 45 digits (`data/bem-moments.json`).

use crate::common::{Gold, K_DEGREES, blocks_of};
use steklov_bem_operators::{PairMoments, Tables};

/// Largest difference over the largest value of the block.
fn error(got: impl Iterator<Item = f64>, want: impl Iterator<Item = f64>, scale: f64) -> f64 {
    got.zip(want).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
}

/// (m, n) at m × 13 + n.
fn rows<'t>(tables: &'t Tables, table: &'t [f64]) -> impl Iterator<Item = f64> + 't {
    (0..13 * 13).map(|k| table[k % 13 * tables.stride + k / 13])
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

#[test]
fn moments_of_every_pair_agree_to_1e_13_of_the_block_maximum() {
    let mut worst: f64 = 0.0;
    for pair in Gold::read().pairs {
        let moments = pair.moments(13, 13);
        let (ab, ba) = pair.tables(&moments, 13, 13);
        let xx_scale = largest(&pair.xx).max(largest(pair.yy().iter()));
        let errors = [
            ("LOG", error(rows(&ab, &ab.log), pair.log.iter().copied(), largest(&pair.log))),
            ("XX", error(rows(&ab, &ab.xx), pair.xx.iter().copied(), xx_scale)),
            ("XY", error(rows(&ab, &ab.xy), pair.xy.iter().copied(), largest(&pair.xy).max(xx_scale * 1e-16))),
            ("DAB", error(rows(&ab, &ab.d), pair.dab.iter().copied(), largest(&pair.dab).max(1e-300))),
            // gold: row m on A, column n on B; ours: test on B
            (
                "DBA",
                error(
                    (0..13 * 13).map(|k| ba.d[k / 13 * ba.stride + k % 13]),
                    pair.dba.iter().copied(),
                    largest(&pair.dba).max(1e-300),
                ),
            ),
        ];
        for (name, e) in errors {
            println!("{:28} {name:4} {e:.1e}", pair.name);
            assert!(e < 1e-13, "{} {name}: {e:e}", pair.name);
            worst = worst.max(e);
        }
    }
    println!("worst {worst:.1e}");
}

#[test]
fn blocks_of_v_w_and_k_agree_to_1e_13_of_the_block_maximum() {
    let gold = Gold::read();
    for pair in &gold.pairs {
        let moments = pair.moments(K_DEGREES + 1, K_DEGREES + 1);
        let (ab, _) = pair.tables(&moments, K_DEGREES, K_DEGREES);
        let (v, w, k) = blocks_of(&gold.material(), gold.length, &ab, pair.a, pair.b);
        for (name, got, want) in [("V", v, &pair.v), ("W", w, &pair.w), ("K", k, &pair.k)] {
            let e = error(got.into_iter(), want.iter().copied(), largest(want).max(1e-300));
            println!("{:28} {name} {e:.1e}", pair.name);
            assert!(e < 1e-13, "{} {name}: {e:e}", pair.name);
        }
    }
}

#[test]
fn the_choice_of_the_outer_element_does_not_matter() {
    for pair in Gold::read().pairs.iter().filter(|p| p.a != p.b) {
        let one = PairMoments::new(pair.a, pair.b, 9, 9);
        let two = PairMoments::new(pair.b, pair.a, 9, 9);
        let (a, b) = (pair.tables(&one, 8, 8), pair.tables(&two, 8, 8));
        for (x, y) in [(&a.0, &b.0), (&a.1, &b.1)] {
            let pick = |t: &Tables| [t.log.clone(), t.xx.clone(), t.xy.clone()].concat();
            assert!(error(pick(x).into_iter(), pick(y).into_iter(), largest(&pick(x))) < 1e-14);
        }
    }
}
