//! Truncated, altered and foreign files give an error or the identical content, never a panic or another number.

mod common;

use std::path::Path;

use common::{bits, dense_bits, place, sparse};
use faer::Mat;
use hdf5::types::VarLenUnicode;
use steklov_io::*;

/// A file with an object of every sort.
fn write(path: &Path) {
    let numbers: Vec<f64> = (0..60).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let table = Label { unit: "stress", meaning: "a table", axes: &["row", "column"] };
    let list = Label { unit: "length", meaning: "a list", axes: &["entry"] };
    create_atomically(path, true, |f| {
        write_text_attribute(f, "program_version", "1.2.3")?;
        write_integer_attribute(f, "threads", &[2])?;
        save_text(f, "scene", "title = \"Größe\"\n[body]\n", "the scene")?;
        let g = create_group(f, "solution")?;
        save_vector(&g, "vector", &numbers, &list)?;
        save_vector(&g, "empty", &[], &list)?;
        save_points(&g, "points", &[[0.5, 1.5], [2.5, -3.5]], &table)?;
        save_integers(&g, "integers", &[3, 1, 4, 1, 5], &list)?;
        save_texts(&g, "names", &["floor".into(), "türe".into()], "names", "side")?;
        save_dense(&g, "dense", Mat::from_fn(4, 3, |i, j| (i * 3 + j) as f64 + 0.25).as_ref(), &table)?;
        save_sparse(&g, "sparse", &sparse(5, 4), &table)?;
        let field = |components: usize, n: usize| vtkhdf::Field {
            name: "stress".into(),
            unit: "stress".into(),
            components,
            values: numbers[..components * n].to_vec(),
        };
        vtkhdf::write(
            f,
            &vtkhdf::Grid {
                points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
                lines: vec![[0, 1], [1, 2]],
                triangles: vec![[0, 1, 2]],
                quads: vec![[0, 1, 2, 2]],
                point_data: vec![field(3, 3)],
                cell_data: vec![field(1, 4)],
            },
        )
    })
    .unwrap();
}

/// All of it, as one comparable text.
fn read(path: &Path) -> Result<String, IoError> {
    let f = open(path)?;
    let g = open_group(&f, "solution")?;
    let mut labels = Vec::new();
    for name in ["vector", "empty", "points", "integers", "names", "dense", "sparse/data", "sparse/indices"] {
        labels.push(load_label(&g, name)?);
    }
    Ok(format!(
        "{:?}",
        (
            (
                read_text_attribute(&f, "program_version")?,
                read_integer_attribute(&f, "threads")?,
                load_text(&f, "scene")?
            ),
            (bits(&load_vector(&g, "vector")?), bits(&load_vector(&g, "empty")?), load_points(&g, "points")?),
            (load_integers(&g, "integers")?, load_texts(&g, "names")?, dense_bits(&load_dense(&g, "dense")?)),
            (load_sparse(&g, "sparse")?, vtkhdf::read(&f)?, labels),
        )
    ))
}

/// The generator splitmix64, so that the places are the same on every run.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn equal_content_gives_equal_bytes() {
    let (folder, path) = place();
    write(&path);
    let other = folder.path().join("other.vtkhdf");
    write(&other);
    assert!(std::fs::read(&path).unwrap() == std::fs::read(&other).unwrap());
}

#[test]
fn a_truncated_file_is_an_error() {
    let (_folder, path) = place();
    write(&path);
    let whole = std::fs::read(&path).unwrap();
    assert!(read(&path).is_ok());
    let cuts = (0..16).map(|k| whole.len() * k / 16).chain([1, 7, 8, 9, 47, 48, whole.len() - 1]);
    for cut in cuts {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let error = read(&path).expect_err("a truncated file was read");
        assert!(error.to_string().contains("a result.vtkhdf"), "cut at {cut}: {error}");
    }
}

/// One byte changed at every third place; then random bytes over 2 to 64 places; then blocks of zeros.
#[test]
fn an_altered_file_is_noticed_or_harmless() {
    let (_folder, path) = place();
    write(&path);
    let whole = std::fs::read(&path).unwrap();
    let content = read(&path).unwrap();
    let mut state = 1;
    let (mut noticed, mut harmless) = (0, 0);
    let mut check = |what: &str, at: usize, bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        match read(&path) {
            Err(_) => noticed += 1,
            Ok(found) => {
                assert_eq!(found, content, "{what} at {at} went unnoticed");
                harmless += 1;
            }
        }
    };
    for at in (0..whole.len()).step_by(3) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 + (random(&mut state) % 255) as u8;
        check("one byte", at, &bytes);
    }
    for _ in 0..600 {
        let mut bytes = whole.clone();
        let length = 2 + (random(&mut state) % 63) as usize;
        let at = (random(&mut state) as usize) % (whole.len() - length);
        bytes[at..at + length].fill_with(|| random(&mut state) as u8);
        check("random bytes", at, &bytes);
    }
    for at in (0..whole.len()).step_by(512) {
        let mut bytes = whole.clone();
        let end = (at + 512).min(whole.len());
        bytes[at..end].fill(0);
        check("zeros", at, &bytes);
    }
    eprintln!("{} bytes: {noticed} changes noticed, {harmless} harmless", whole.len());
    assert!(noticed > harmless, "{noticed} noticed, {harmless} harmless");
}

/// Every byte that holds data is under a checksum: none can change unseen.
#[test]
fn every_byte_of_data_counts() {
    let (_folder, path) = place();
    let marks: Vec<f64> = (0..40).map(|i| f64::from_bits(0x7e57_da7a_0000_0000 + i)).collect();
    let text = "a text that is easy to find in the bytes of the file".repeat(3);
    let label =
        Label { unit: "an unmistakable unit", meaning: "an unmistakable meaning", axes: &["unmistakable axis"] };
    create_atomically(&path, false, |f| {
        save_vector(f, "v", &marks, &label)?;
        save_text(f, "t", &text, "meaning")
    })
    .unwrap();
    let whole = std::fs::read(&path).unwrap();
    let vector: Vec<u8> = marks.iter().flat_map(|m| m.to_le_bytes()).collect();
    for wanted in
        [&vector[..], text.as_bytes(), label.unit.as_bytes(), label.meaning.as_bytes(), label.axes[0].as_bytes()]
    {
        let start =
            whole.windows(wanted.len()).position(|w| w == wanted).expect("the data are in the file as they are");
        for at in start..start + wanted.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x41;
            std::fs::write(&path, &bytes).unwrap();
            let f = open(&path);
            let all = f.and_then(|f| Ok((load_vector(&f, "v")?, load_text(&f, "t")?, load_label(&f, "v")?)));
            assert!(all.is_err(), "byte {at} changed unseen");
        }
    }
}

#[test]
fn foreign_files_are_refused() {
    let (folder, path) = place();
    let error = |path: &Path| open(path).map(drop).unwrap_err();
    assert!(matches!(error(&path), IoError::System { action: "open", .. }));
    assert!(matches!(error(folder.path()), IoError::NotHdf5 { .. }));
    for content in [&b""[..], b"\x89HDF\r\n\x1a\n", b"title = \"no result\"", &[0; 5000]] {
        std::fs::write(&path, content).unwrap();
        assert!(matches!(error(&path), IoError::NotHdf5 { .. }));
    }
    hdf5::File::create(&path).unwrap().close().unwrap();
    assert!(error(&path).to_string().contains("there is none"));

    let f = hdf5::File::create(&path).unwrap();
    write_text_attribute(&f, "format", "another").unwrap();
    f.close().unwrap();
    assert!(error(&path).to_string().contains("\"another\""));

    let f = hdf5::File::create(&path).unwrap();
    let text: VarLenUnicode = "steklov".parse().unwrap();
    f.new_attr::<VarLenUnicode>().create("format").unwrap().write_scalar(&text).unwrap();
    f.close().unwrap();
    assert!(matches!(error(&path), IoError::Foreign { .. }));

    let f = hdf5::File::create(&path).unwrap();
    write_text_attribute(&f, "format", FORMAT).unwrap();
    write_integer_attribute(&f, "format_version", &[99]).unwrap();
    f.close().unwrap();
    assert!(matches!(error(&path), IoError::Version { found: 99, known: FORMAT_VERSION, .. }));
}

/// Extents that promise more than the file holds are refused before memory is asked for.
#[test]
fn absurd_extents_are_refused() {
    let (_folder, path) = place();
    let f = hdf5::File::create(&path).unwrap();
    write_text_attribute(&f, "format", FORMAT).unwrap();
    write_integer_attribute(&f, "format_version", &[i64::from(FORMAT_VERSION)]).unwrap();
    f.new_dataset::<f64>().shape([1_usize << 40]).chunk([1_usize << 20]).create("v").unwrap();
    f.new_dataset::<f64>().shape([1_usize << 31, 1 << 31]).chunk([1_usize, 1 << 20]).create("a").unwrap();
    f.close().unwrap();
    let f = open(&path).unwrap();
    assert!(matches!(load_vector(&f, "v"), Err(IoError::Damaged { .. })));
    assert!(matches!(load_dense(&f, "a"), Err(IoError::Damaged { .. })));
}
