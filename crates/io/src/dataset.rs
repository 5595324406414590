//! Arrays of numbers: typed, labelled, with a checksum.

use hdf5::filters::Filter::{Deflate, Fletcher32, Shuffle};
use hdf5::types::{H5Type, TypeDescriptor};
use hdf5::{Dataset, Group};
use ndarray::{ArrayView2, s};

use crate::attribute::{read_names_attribute, read_text_attribute, write_names_attribute, write_text_attribute};
use crate::deflated::{self, Storage};
use crate::error::{IoError, damaged, invalid, mismatch, missing, write_error};
use crate::raw::byte_sizes;

/// The description of a dataset's numbers, stored in its attributes `unit`, `meaning` and `axes`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Label<'a> {
    /// Unit in terms of the scene's own (`length`, `stress`, `force/length`), `1` for pure numbers.
    pub unit: &'a str,
    /// Its meaning, with the sign convention.
    pub meaning: &'a str,
    /// A name for each axis.
    pub axes: &'a [&'a str],
}

/// A [`Label`] with this unit, meaning and axes.
pub fn label<'a>(unit: &'a str, meaning: &'a str, axes: &'a [&'a str]) -> Label<'a> {
    Label { unit, meaning, axes }
}

/// Attributes `unit`, `meaning` and `axes` as they were read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredLabel {
    /// Unit.
    pub unit: String,
    /// Meaning.
    pub meaning: String,
    /// Names of the axes.
    pub axes: Vec<String>,
}

/// Largest number of values in a chunk: 1 MiB of f64. Each chunk has a Fletcher-32 checksum.
pub(crate) const CHUNK: usize = 1 << 17;

/// Rows of a chunk: as many as it may hold, but distributed evenly over the chunks, because the last one takes the
/// space of a whole one.
fn chunk_rows(shape: &[usize]) -> usize {
    let columns = shape[1..].iter().product::<usize>().max(1);
    let chunks = shape[0].div_ceil((CHUNK / columns).max(1)).max(1);
    shape[0].div_ceil(chunks).max(1)
}

/// Makes a dataset of any type: chunked with a checksum, or without space in the file if it is empty (the checksum of
/// the object header covers the extents).
pub(crate) fn create(
    at: &Group,
    name: &str,
    kind: TypeDescriptor,
    shape: &[usize],
    label: &Label<'_>,
    storage: Storage,
) -> Result<Dataset, IoError> {
    if label.axes.len() != shape.len() {
        return Err(write_error(at, name, format!("it has {} axes and {} names", shape.len(), label.axes.len())));
    }
    let builder = at.new_dataset_builder().obj_track_times(false).empty_as(kind).shape(shape.to_vec());
    let builder = if shape.is_empty() || shape.contains(&0) {
        builder.no_chunk()
    } else {
        let builder = if storage.deflates(shape) { builder.shuffle().deflate(deflated::LEVEL) } else { builder };
        let mut chunk = shape.to_vec();
        chunk[0] = chunk_rows(shape);
        if let Some(last) = chunk[1..].last_mut() {
            *last = (*last).min(CHUNK);
        }
        builder.chunk(chunk).fletcher32()
    };
    let dataset = builder.create(name).map_err(|e| write_error(at, name, e))?;
    write_text_attribute(&dataset, "unit", label.unit)?;
    write_text_attribute(&dataset, "meaning", label.meaning)?;
    if !label.axes.is_empty() {
        write_names_attribute(&dataset, "axes", label.axes)?;
    }
    Ok(dataset)
}

/// Opens a dataset and checks that its whole content is in the file, so that no size from a damaged header is
/// allocated.
pub(crate) fn open(at: &Group, name: &str) -> Result<Dataset, IoError> {
    if !at.link_exists(name) {
        // A damaged list of links is not a missing dataset.
        at.member_names().map_err(|e| damaged(at, "", e))?;
        return Err(missing(at, name));
    }
    if at.loc_type_by_name(name).map_err(|e| damaged(at, name, e))? != hdf5::LocationType::Dataset {
        return Err(mismatch(at, name, "a dataset", "another object"));
    }
    let dataset = at.dataset(name).map_err(|e| damaged(at, name, e))?;
    let (_, wanted) = byte_sizes(&dataset).map_err(|e| damaged(at, name, e))?;
    let stored = dataset.storage_size();
    let filters = dataset.dcpl().and_then(|d| d.get_filters()).map_err(|e| damaged(at, name, e))?;
    let file = at.file().map_err(|e| damaged(at, name, e))?.size();
    match filters[..] {
        [] | [Fletcher32] => {}
        [Shuffle, Deflate(_), Fletcher32] => {
            deflated::check(at, name, &dataset)?;
            return Ok(dataset);
        }
        _ => return Err(mismatch(at, name, "plain or deflated data", "data of other filters")),
    }
    if stored > file || (wanted as u64) > stored {
        return Err(damaged(at, name, format!("{wanted} bytes are wanted, {stored} stored, the file has {file}")));
    }
    Ok(dataset)
}

/// Writes numbers given row by row.
pub(crate) fn write_numbers<T: H5Type>(
    at: &Group,
    name: &str,
    shape: &[usize],
    data: &[T],
    label: &Label<'_>,
    storage: Storage,
) -> Result<(), IoError> {
    let dataset = create(at, name, T::type_descriptor(), shape, label, storage)?;
    if data.is_empty() {
        return Ok(());
    }
    dataset.write_raw(data).map_err(|e| write_error(at, name, e))
}

/// Reads shape and numbers, row by row, of a dataset of exactly this type and rank.
pub(crate) fn read_numbers<T: H5Type>(at: &Group, name: &str, rank: usize) -> Result<(Vec<usize>, Vec<T>), IoError> {
    let dataset = open_numbers::<T>(at, name, rank)?;
    let data = dataset.read_raw().map_err(|e| damaged(at, name, e))?;
    Ok((dataset.shape(), data))
}

fn open_numbers<T: H5Type>(at: &Group, name: &str, rank: usize) -> Result<Dataset, IoError> {
    let dataset = open(at, name)?;
    let found = dataset.dtype().and_then(|t| t.to_descriptor()).map_err(|e| damaged(at, name, e))?;
    if found != T::type_descriptor() {
        return Err(mismatch(at, name, T::type_descriptor(), found));
    }
    if dataset.ndim() != rank {
        return Err(mismatch(at, name, format!("{rank} dimensions"), dataset.ndim()));
    }
    Ok(dataset)
}

/// Writes an n×m array that `rows` delivers in blocks of whole rows, without a second copy of it.
pub(crate) fn write_rows(
    at: &Group,
    name: &str,
    [n, m]: [usize; 2],
    label: &Label<'_>,
    mut rows: impl FnMut(std::ops::Range<usize>) -> Vec<f64>,
) -> Result<(), IoError> {
    let mut written = Rows::new(at, name, [n, m], label)?;
    for start in (0..n).step_by(written.block) {
        written.push(&rows(start..(start + written.block).min(n)))?;
    }
    written.finish()
}

/// An n×m array that is written row by row, from the first to the last.
pub struct Rows {
    at: Group,
    name: String,
    dataset: Dataset,
    shape: [usize; 2],
    /// Number of rows that are written at a time.
    block: usize,
    written: usize,
    /// Rows that are not written yet.
    waiting: Vec<f64>,
}

impl Rows {
    /// Makes the dataset.
    pub(crate) fn new(at: &Group, name: &str, [n, m]: [usize; 2], label: &Label<'_>) -> Result<Self, IoError> {
        let dataset = create(at, name, f64::type_descriptor(), &[n, m], label, Storage::Plain)?;
        let block = chunk_rows(&[n, m]);
        let (at, name) = (at.clone(), name.to_owned());
        Ok(Self { at, name, dataset, shape: [n, m], block, written: 0, waiting: Vec::new() })
    }

    /// Adds the next rows, one after the other.
    ///
    /// # Errors
    /// [`IoError::Write`], also for more rows than the array has, or for a part of a row.
    pub fn push(&mut self, rows: &[f64]) -> Result<(), IoError> {
        let [n, m] = self.shape;
        self.waiting.extend_from_slice(rows);
        if self.waiting.len() > (n - self.written) * m || !rows.len().is_multiple_of(m) {
            let why = format!("{} numbers for {} rows of {m}", self.waiting.len(), n - self.written);
            return Err(write_error(&self.at, &self.name, why));
        }
        let whole = self.waiting.len() / (self.block * m).max(1) * self.block;
        self.write(whole)
    }

    /// Writes `count` of the waiting rows, block by block.
    fn write(&mut self, count: usize) -> Result<(), IoError> {
        let (m, failed) = (self.shape[1], |e: &dyn std::fmt::Display| write_error(&self.at, &self.name, e));
        for block in self.waiting[..count * m].chunks((self.block * m).max(1)) {
            let rows = block.len() / m;
            let view = ArrayView2::from_shape((rows, m), block).map_err(|e| failed(&e))?;
            let end = self.written + rows;
            self.dataset.write_slice(view, s![self.written..end, ..]).map_err(|e| failed(&e))?;
            self.written = end;
        }
        self.waiting.drain(..count * m);
        Ok(())
    }

    /// Writes the remaining rows.
    ///
    /// # Errors
    /// [`IoError::Write`], also if rows are missing.
    pub fn finish(mut self) -> Result<(), IoError> {
        let [n, m] = self.shape;
        self.write(self.waiting.len() / m.max(1))?;
        if m > 0 && self.written != n {
            return Err(write_error(&self.at, &self.name, format!("{} of {n} rows", self.written)));
        }
        Ok(())
    }
}

/// Reads an n×m array in blocks of rows: `start(n, m)` makes the result that `row(i, values)` fills.
pub(crate) fn read_rows<A>(
    at: &Group,
    name: &str,
    start: impl FnOnce(usize, usize) -> A,
    mut row: impl FnMut(&mut A, usize, &[f64]),
) -> Result<A, IoError> {
    let dataset = open_numbers::<f64>(at, name, 2)?;
    let shape = dataset.shape();
    let (n, m) = (shape[0], shape[1]);
    let mut all = start(n, m);
    if n > 0 && m > 0 {
        let step = chunk_rows(&shape);
        for first in (0..n).step_by(step) {
            let end = (first + step).min(n);
            let block = dataset.read_slice_2d::<f64, _>(s![first..end, ..]).map_err(|e| damaged(at, name, e))?;
            for (i, values) in block.rows().into_iter().enumerate() {
                row(
                    &mut all,
                    first + i,
                    values.as_slice().ok_or_else(|| damaged(at, name, "rows are not contiguous"))?,
                );
            }
        }
    }
    Ok(all)
}

/// Reads the attributes `unit`, `meaning` and `axes` of the dataset `name` in `at`.
///
/// # Errors
/// [`IoError::Missing`], [`IoError::Mismatch`], [`IoError::Damaged`], [`IoError::Invalid`].
pub fn load_label(at: &Group, name: &str) -> Result<StoredLabel, IoError> {
    let dataset = open(at, name)?;
    let axes = if dataset.ndim() == 0 { vec![] } else { read_names_attribute(&dataset, "axes")? };
    if axes.len() != dataset.ndim() {
        return Err(invalid(at, name, format!("{} dimensions but {} names of axes", dataset.ndim(), axes.len())));
    }
    Ok(StoredLabel {
        unit: read_text_attribute(&dataset, "unit")?,
        meaning: read_text_attribute(&dataset, "meaning")?,
        axes,
    })
}
