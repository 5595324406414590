//! Tables of other programs: numbers of any type are read as f64, all else is refused with a message.

use crate::common::{bits, place};
use hdf5::File;
use hdf5::types::VarLenUnicode;
use ndarray::{Array2, Array3, arr0, arr1};
use proptest::prelude::*;
use steklov_io::{IoError, load_foreign_table};

#[test]
fn numbers_of_any_type_are_read_row_by_row() {
    let (_folder, path) = place();
    let file = File::create(&path).unwrap();
    let group = file.create_group("rock").unwrap();
    let table = Array2::from_shape_fn((3, 2), |(i, j)| 1.5 + (2 * i + j) as f64);
    group.new_dataset_builder().with_data(&table).create("double").unwrap();
    group.new_dataset_builder().with_data(&table).chunk((2, 2)).shuffle().create("chunks").unwrap();
    group.new_dataset_builder().with_data(&table.mapv(|v| v as f32)).create("single").unwrap();
    group.new_dataset_builder().with_data(&table.mapv(|v| v as i32)).create("int").unwrap();
    group.new_dataset_builder().with_data(&table.mapv(|v| v as u8)).create("byte").unwrap();
    drop((group, file));
    let wanted = [1.5, 2.5, 3.5, 4.5, 5.5, 6.5];
    for name in ["/rock/double", "rock/double", "/rock/chunks", "/rock/single"] {
        assert_eq!(load_foreign_table(&path, name, [3, 2]).unwrap(), wanted, "{name}");
    }
    for name in ["/rock/int", "/rock/byte"] {
        assert_eq!(load_foreign_table(&path, name, [3, 2]).unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{name}");
    }
}

#[test]
fn what_is_no_such_table_is_refused() {
    let (folder, path) = place();
    let file = File::create(&path).unwrap();
    file.create_group("group").unwrap();
    file.new_dataset_builder().with_data(&Array2::<f64>::ones((3, 2))).create("table").unwrap();
    file.new_dataset_builder().with_data(&Array3::<f64>::ones((3, 2, 1))).create("cube").unwrap();
    file.new_dataset_builder().with_data(&arr0(1.0)).create("number").unwrap();
    file.new_dataset_builder().with_data(&arr1(&[true, false])).create("flags").unwrap();
    let word: VarLenUnicode = "steel".parse().unwrap();
    file.new_dataset_builder().with_data(&arr1(&[word])).create("words").unwrap();
    drop(file);
    for (name, message) in [
        ("/none", "has no /none"),
        ("group/none", "has no /group/none"),
        ("none/none", "has no /none/none"),
        ("", "has no /"),
        ("ta\0ble", "has no"),
        ("group", "/group of"),
        ("table", "expected 2 by 3 numbers, found 3 by 2, which is the transposed shape"),
        ("cube", "expected 2 by 3 numbers, found 3 by 2 by 1"),
        ("number", "expected 2 by 3 numbers, found a single number"),
        ("flags", "expected numbers, found bool"),
        ("words", "expected numbers, found unicode"),
    ] {
        let error = load_foreign_table(&path, name, [2, 3]).unwrap_err();
        assert!(matches!(error, IoError::Missing { .. } | IoError::Mismatch { .. }), "{name:?}: {error:?}");
        assert!(error.to_string().contains(message), "{name:?}: {error}");
    }
    let text = folder.path().join("text");
    std::fs::write(&text, "no HDF5").unwrap();
    assert!(matches!(load_foreign_table(&text, "table", [3, 2]), Err(IoError::NotHdf5 { .. })));
    for path in [folder.path().join("none"), folder.path().to_owned()] {
        assert!(matches!(load_foreign_table(&path, "table", [3, 2]), Err(IoError::System { .. })));
    }
}

/// Opening a pipe to which nothing writes would wait for ever.
#[cfg(unix)]
#[test]
fn a_pipe_is_refused_at_once() {
    let (folder, _) = place();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let error = load_foreign_table(&pipe, "table", [3, 2]).unwrap_err();
    assert!(error.to_string().contains("it is no regular file"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// A truncated file gives an error or the same numbers. So does a file with an altered byte, or other numbers if
    /// the byte is in the data, which have no checksum here.
    #[test]
    fn damaged_files_never_panic(at in 0.0..1.0_f64, byte in 0..=255_u8) {
        let (folder, path) = place();
        let file = File::create(&path).unwrap();
        file.new_dataset_builder().with_data(&Array2::<f64>::ones((3, 2))).create("table").unwrap();
        drop(file);
        let whole = std::fs::read(&path).unwrap();
        let at = (at * whole.len() as f64) as usize;
        let damaged = folder.path().join("damaged");
        std::fs::write(&damaged, &whole[..at]).unwrap();
        if let Ok(numbers) = load_foreign_table(&damaged, "table", [3, 2]) {
            prop_assert_eq!(bits(&numbers), bits(&[1.0; 6]));
        }
        let mut altered = whole;
        altered[at] = byte;
        std::fs::write(&damaged, &altered).unwrap();
        if let Ok(numbers) = load_foreign_table(&damaged, "table", [3, 2]) {
            prop_assert_eq!(numbers.len(), 6);
        }
    }
}
