//! Truncated, altered and foreign files give an error or the identical content, never a panic or another number.

use std::io::Write as _;
use std::path::Path;

use crate::common::{bits, dense_bits, place, sparse};
use faer::Mat;
use hdf5::types::VarLenUnicode;
use steklov_io::*;

/// A file with an object of every kind.
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

/// The whole content as one comparable text.
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

/// One byte is changed at every seventh place, which is no multiple of a word, or with `STEKLOV_TESTS=full` at every third; then random
/// bytes over 2 to 64 places; then blocks of zeros.
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
    let full = std::env::var("STEKLOV_TESTS").is_ok_and(|value| value == "full");
    let (apart, count) = if full { (3, 600) } else { (7, 250) };
    for at in (0..whole.len()).step_by(apart) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 + (random(&mut state) % 255) as u8;
        check("one byte", at, &bytes);
    }
    for _ in 0..count {
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

/// A checksum covers every byte of data: none can change unnoticed.
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

/// Extents larger than the content of the file are refused before memory is requested.
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

/// A full matrix of few different numbers.
fn recurring() -> sprs::CsMat<f64> {
    let mut entries = sprs::TriMat::new((100, 110));
    (0..100 * 110).for_each(|k| entries.add_triplet(k / 110, k % 110, 0.5 + (k % 13) as f64));
    entries.to_csr()
}

/// Writes deflated arrays: integers over several chunks of few and of all bits, and a sparse matrix.
fn write_deflated(path: &Path) {
    let list = Label { unit: "1", meaning: "a list", axes: &["entry"] };
    let table = Label { unit: "stress", meaning: "a table", axes: &["row", "column"] };
    let rising: Vec<usize> = (0..300_000).map(|i| i / 7).collect();
    let mut state = 5;
    let any: Vec<usize> = (0..9000).map(|_| (random(&mut state) >> 1) as usize).collect();
    create_atomically(path, true, |f| {
        save_integers(f, "rising", &rising, &list)?;
        save_integers(f, "any", &any, &list)?;
        save_sparse(f, "sparse", &recurring(), &table)
    })
    .unwrap();
}

/// Two lists of integers and a sparse matrix.
type Deflated = (Vec<usize>, Vec<usize>, sprs::CsMat<f64>);

/// Reads the file of [`write_deflated`].
fn read_deflated(path: &Path) -> Result<Deflated, IoError> {
    let f = open(path)?;
    Ok((load_integers(&f, "rising")?, load_integers(&f, "any")?, load_sparse(&f, "sparse")?))
}

#[test]
fn every_byte_of_deflated_data_counts() {
    let (folder, path) = place();
    write_deflated(&path);
    let whole = std::fs::read(&path).unwrap();
    let content = read_deflated(&path).unwrap();
    assert!(content.0.iter().enumerate().all(|(i, &k)| k == i / 7) && content.2 == recurring());
    let other = folder.path().join("other.vtkhdf");
    write_deflated(&other);
    assert!(std::fs::read(other).unwrap() == whole, "equal content, other bytes");

    let f = open(&path).unwrap();
    let mut chunks = Vec::new();
    for name in ["rising", "any", "sparse/indices", "sparse/data"] {
        let set = f.dataset(name).unwrap();
        assert_eq!(set.filters().len(), 3, "{name} is plain");
        chunks.extend((0..set.num_chunks().unwrap()).map(|k| (name, set.chunk_info(k).unwrap())));
    }
    assert!(chunks.iter().filter(|(name, _)| *name == "rising").count() == 3);
    let stored: u64 = chunks.iter().map(|(_, info)| info.size).sum();
    assert!(stored < 8 * (300_000 + 9000) / 5, "{stored} bytes");
    f.close().unwrap();
    let mut state = 2;
    for (name, info) in chunks {
        // the first bytes and the last, where the checksum is, one by one
        let (start, end) = (info.addr as usize, (info.addr + info.size) as usize);
        let sparsely = (start..end).step_by(((end - start) / 25).max(1));
        for at in (start..start + 12).chain(end - 12..end).chain(sparsely) {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 + (random(&mut state) % 255) as u8;
            std::fs::write(&path, &bytes).unwrap();
            let read = read_deflated(&path);
            assert!(matches!(read, Err(IoError::Damaged { .. })), "{name}: byte {} unseen", at - start);
        }
    }
}

/// HDF5's checksum of a chunk.
fn fletcher32(bytes: &[u8]) -> [u8; 4] {
    let (mut one, mut two) = (0_u64, 0_u64);
    for word in bytes.chunks(2) {
        one = (one + (u64::from(word[0]) << 8 | word.get(1).map_or(0, |&b| u64::from(b)))) % 65535;
        two = (two + one) % 65535;
    }
    ((two << 16 | one) as u32).to_le_bytes()
}

/// A chunk that inflates to more or less than its shape, with a valid checksum.
#[test]
fn chunks_of_another_size_are_refused() {
    let (_folder, path) = place();
    write_deflated(&path);
    let info = open(&path).unwrap().dataset("any").unwrap().chunk_info(0).unwrap();
    let (start, end) = (info.addr as usize, (info.addr + info.size) as usize - 4);
    let whole = std::fs::read(&path).unwrap();
    let altered = |values: usize| {
        let mut deflate = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        deflate.write_all(&vec![0; 8 * values]).unwrap();
        let mut stream = deflate.finish().unwrap();
        assert!(stream.len() <= end - start, "{} bytes", stream.len());
        stream.resize(end - start, 0);
        let mut bytes = whole.clone();
        bytes[start..end].copy_from_slice(&stream);
        bytes[end..end + 4].copy_from_slice(&fletcher32(&stream));
        std::fs::write(&path, bytes).unwrap();
        load_integers(&open(&path).unwrap(), "any")
    };
    // the right number of values: only the values are wrong
    assert_eq!(altered(9000).unwrap(), [0; 9000]);
    for values in [0, 1, 8999, 9001, 8_000_000] {
        let error = altered(values).unwrap_err();
        assert!(error.to_string().contains("the 72000 bytes of its shape"), "{values}: {error}");
    }
}

/// Deflated datasets with missing chunks, with chunks that are too large, or with other filters.
#[test]
fn other_deflated_datasets_are_refused() {
    let (_folder, path) = place();
    let f = hdf5::File::create(&path).unwrap();
    write_text_attribute(&f, "format", FORMAT).unwrap();
    write_integer_attribute(&f, "format_version", &[i64::from(FORMAT_VERSION)]).unwrap();
    let new = |chunk: usize| f.new_dataset::<f64>().chunk([chunk]).shuffle().deflate(1).fletcher32();
    new(1 << 17).shape([1_usize << 40]).create("absent").unwrap();
    new(1000).shape([3000]).create("part").unwrap().write_slice(&[1.0; 1000], 0..1000).unwrap();
    new(1 << 18).shape([1 << 18]).create("large").unwrap().write_raw(&vec![1.0; 1 << 18]).unwrap();
    let plain = || f.new_dataset::<f64>().chunk([1000]).shape([1000]);
    plain().deflate(1).create("unchecked").unwrap().write_raw(&[1.0; 1000]).unwrap();
    plain().shuffle().fletcher32().create("shuffled").unwrap().write_raw(&[1.0; 1000]).unwrap();
    new(1000).shape([1500]).create("whole").unwrap().write_raw(&[1.5; 1500]).unwrap();
    f.close().unwrap();
    let f = open(&path).unwrap();
    assert_eq!(load_vector(&f, "whole").unwrap(), [1.5; 1500]);
    for (name, wanted) in [
        ("absent", "8388608 chunks are wanted"),
        ("part", "3 chunks are wanted, at most 65536, and 1 stored"),
        ("large", "at most 1048576 bytes"),
        ("unchecked", "other filters"),
        ("shuffled", "other filters"),
    ] {
        let error = load_vector(&f, name).unwrap_err();
        assert!(error.to_string().contains(wanted) && error.to_string().contains(name), "{error}");
    }
}
