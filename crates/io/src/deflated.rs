//! Arrays with many equal bytes, for example indices: shuffled, deflated, and then with the same checksum as all
//! others.
//!
//! The library inflates a chunk to any size that its bytes ask for, up to a thousand times their number. So a deflated
//! dataset is first inflated here without keeping the bytes, and each chunk must give exactly the bytes of its shape.

use std::collections::HashSet;
use std::fs;
use std::io::{self, BufReader, Read as _, Seek as _, SeekFrom};

use flate2::bufread::ZlibDecoder;
use hdf5::filters::deflate_available;
use hdf5::{Dataset, Group};

use crate::dataset::CHUNK;
use crate::error::{IoError, damaged, mismatch, no_deflate};
use crate::raw::byte_sizes;

/// The storage of the chunks of a dataset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Storage {
    /// Plain bytes.
    Plain,
    /// Deflated, if there are enough values and the library has zlib.
    Deflated,
}

/// Level of deflation: higher levels take several times as long and save a tenth of the bytes.
pub(crate) const LEVEL: u8 = 1;
/// Smallest number of values that are deflated: 64 KiB.
const LEAST: usize = 1 << 13;
/// Largest number of chunks of a deflated dataset, 64 GiB of values: the library takes as many steps to find a chunk as
/// there are chunks.
const MOST_CHUNKS: usize = 1 << 16;
/// Bytes of the checksum at the end of a chunk.
const CHECKSUM: u64 = 4;
/// Bytes by which a deflated chunk may grow, besides a thousandth of its size: a chunk that would grow more stays
/// plain.
const GROWTH: u64 = 13;
/// Bit of deflation, the second filter, in the mask of filters that a chunk skips because it would grow.
const NOT_DEFLATED: u32 = 1 << 1;

/// Number of values in the middle that are compared.
const SAMPLE: usize = 4096;

impl Storage {
    /// Deflated if the same numbers recur often, as in the stiffness of a few materials. Other values would shrink by a
    /// quarter in ten times the time.
    pub(crate) fn of(values: &[f64]) -> Self {
        let sample = &values[values.len() / 2..][..SAMPLE.min(values.len() / 2)];
        let different = sample.iter().map(|x| x.to_bits()).collect::<HashSet<_>>().len();
        if 5 * different < 2 * sample.len() { Self::Deflated } else { Self::Plain }
    }

    /// Whether an array of this shape is deflated.
    pub(crate) fn deflates(self, shape: &[usize]) -> bool {
        self == Self::Deflated && shape.iter().product::<usize>() >= LEAST && deflate_available()
    }
}

/// Checks that the chunks of a deflated dataset are all there and give the bytes of its shape, so that reading takes
/// the memory of the shape and of one chunk.
pub(crate) fn check(at: &Group, name: &str, dataset: &Dataset) -> Result<(), IoError> {
    if !deflate_available() {
        return Err(no_deflate(at, name));
    }
    let failed = |why: &str| damaged(at, name, why);
    let (element, _) = byte_sizes(dataset).map_err(|e| damaged(at, name, e))?;
    let (shape, chunk) = (dataset.shape(), dataset.chunk().ok_or_else(|| failed("it is deflated but not in chunks"))?);
    let bytes = chunk.iter().try_fold(element, |n, &m| n.checked_mul(m)).filter(|n| (1..=8 * CHUNK).contains(n));
    let Some(bytes) = bytes.map(|bytes| bytes as u64) else {
        let found = format!("{chunk:?} values of {element} bytes");
        return Err(mismatch(at, name, format!("deflated chunks of at most {} bytes", 8 * CHUNK), found));
    };
    let counts = shape.iter().zip(&chunk).map(|(&n, &m)| n.div_ceil(m));
    let wanted = counts.fold(1_usize, |n, m| n.saturating_mul(m));
    let found = dataset.num_chunks().unwrap_or(0);
    if found != wanted || wanted > MOST_CHUNKS {
        return Err(damaged(
            at,
            name,
            format!("{wanted} chunks are wanted, at most {MOST_CHUNKS}, and {found} stored"),
        ));
    }
    let path = at.filename();
    let mut file =
        fs::File::open(&path).map_err(|source| IoError::System { action: "open", path: path.into(), source })?;
    let mut places = HashSet::new();
    for k in 0..wanted {
        let info = dataset.chunk_info(k).ok_or_else(|| damaged(at, name, format!("chunk {k} cannot be found")))?;
        let inside = info.offset.iter().zip(&chunk).zip(&shape).all(|((&o, &m), &n)| o % m as u64 == 0 && o < n as u64);
        if !inside || !places.insert(info.offset) {
            return Err(damaged(at, name, format!("chunk {k} is not in its place")));
        }
        let stored = info.size.saturating_sub(CHECKSUM);
        let given = match info.filter_mask {
            _ if stored > bytes + bytes / 1000 + GROWTH => Ok(stored),
            0 => inflated(&mut file, info.addr, stored, bytes),
            NOT_DEFLATED => Ok(stored),
            mask => Err(io::Error::other(format!("filters {mask:b} are left out"))),
        };
        let given = given.map_err(|why| damaged(at, name, format!("chunk {k}: {why}")))?;
        if given != bytes {
            return Err(damaged(at, name, format!("chunk {k} does not hold the {bytes} bytes of its shape")));
        }
    }
    Ok(())
}

/// Number of bytes to which a stream at a place in a file inflates; any larger number if it is above `most`.
fn inflated(file: &mut fs::File, at: u64, length: u64, most: u64) -> io::Result<u64> {
    file.seek(SeekFrom::Start(at))?;
    let stream = ZlibDecoder::new(BufReader::new(file.take(length)));
    io::copy(&mut stream.take(most + 1), &mut io::sink())
}
