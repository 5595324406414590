//! Bytes of fixed-length strings, and copies from file to file: the only calls straight into the HDF5 library.
//!
//! The wrapper knows strings whose length is a compile-time constant and strings of variable length. The latter are in
//! HDF5's global heap, which has no checksum and which the library trusts; so result files have strings of a fixed
//! length, known at run time.
#![allow(unsafe_code)]

use std::ffi::CString;

use hdf5::types::TypeDescriptor;
use hdf5::{Attribute, Container, Dataset, Datatype, Group, Location};
use hdf5_sys::h5a::{H5Aread, H5Awrite};
use hdf5_sys::h5d::{H5Dread, H5Dwrite};
use hdf5_sys::h5o::H5Ocopy;
use hdf5_sys::h5p::H5P_DEFAULT;
use hdf5_sys::h5s::H5S_ALL;

/// Bytes of one element, and of the whole content in memory, or an error when the product overflows.
pub(crate) fn byte_sizes(of: &Container) -> hdf5::Result<(usize, usize)> {
    let element = of.dtype()?.size();
    let total = of.space()?.shape().iter().try_fold(element, |n, &m| n.checked_mul(m));
    total.map(|total| (element, total)).ok_or_else(|| hdf5::Error::from("its size overflows"))
}

/// The caller passes a container of fixed-length strings; other types may hold pointers.
fn check(of: &Container, len: usize) -> hdf5::Result<()> {
    use hdf5::types::TypeDescriptor::{FixedAscii, FixedUnicode};
    if !matches!(of.dtype()?.to_descriptor()?, FixedAscii(_) | FixedUnicode(_)) {
        return Err("it does not hold strings of fixed length".into());
    }
    if byte_sizes(of)?.1 != len { Err("its size is not that of the buffer".into()) } else { Ok(()) }
}

fn outcome(status: i32) -> hdf5::Result<()> {
    if status < 0 { Err(hdf5::Error::query()?) } else { Ok(()) }
}

/// Makes an attribute of fixed-length strings of `size` bytes each.
pub(crate) fn create_attribute(
    at: &Location,
    name: &str,
    (size, ascii): (usize, bool),
    shape: &[usize],
    bytes: &[u8],
) -> hdf5::Result<()> {
    let kind = if ascii { TypeDescriptor::FixedAscii(size) } else { TypeDescriptor::FixedUnicode(size) };
    if shape.iter().try_fold(size, |n, &m| n.checked_mul(m)) != Some(bytes.len()) {
        return Err("its size is not that of the buffer".into());
    }
    hdf5::sync::sync(|| {
        let kind = Datatype::from_descriptor(&kind)?;
        let to = at.new_attr_builder().empty_as(&kind).shape(shape.to_vec()).create(name)?;
        // SAFETY: under the library's lock, with the type it was made with, from a buffer of its exact size.
        outcome(unsafe { H5Awrite(to.id(), kind.id(), bytes.as_ptr().cast()) })
    })
}

pub(crate) fn read_attribute(from: &Attribute) -> hdf5::Result<Vec<u8>> {
    hdf5::sync::sync(|| {
        let mut bytes = vec![0; byte_sizes(from)?.1];
        check(from, bytes.len())?;
        // SAFETY: under the library's lock, with the attribute's own type, into a buffer of its exact size.
        outcome(unsafe { H5Aread(from.id(), from.dtype()?.id(), bytes.as_mut_ptr().cast()) })?;
        Ok(bytes)
    })
}

pub(crate) fn write_dataset(to: &Dataset, bytes: &[u8]) -> hdf5::Result<()> {
    hdf5::sync::sync(|| {
        check(to, bytes.len())?;
        // SAFETY: under the library's lock, with the dataset's own type and extent, from a buffer of its exact size.
        outcome(unsafe { H5Dwrite(to.id(), to.dtype()?.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.as_ptr().cast()) })
    })
}

pub(crate) fn read_dataset(from: &Dataset) -> hdf5::Result<Vec<u8>> {
    hdf5::sync::sync(|| {
        let mut bytes = vec![0; byte_sizes(from)?.1];
        check(from, bytes.len())?;
        // SAFETY: under the library's lock, with the dataset's own type and extent, into a buffer of its exact size.
        outcome(unsafe {
            H5Dread(from.id(), from.dtype()?.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.as_mut_ptr().cast())
        })?;
        Ok(bytes)
    })
}

/// Copies the object `name` of `from` with its content to `to` under the same name.
pub(crate) fn copy(from: &Group, name: &str, to: &Group) -> hdf5::Result<()> {
    let name = CString::new(name).map_err(|e| hdf5::Error::from(e.to_string()))?;
    hdf5::sync::sync(|| {
        // SAFETY: under the library's lock, with two open groups and a text that ends in a zero.
        outcome(unsafe { H5Ocopy(from.id(), name.as_ptr(), to.id(), name.as_ptr(), H5P_DEFAULT, H5P_DEFAULT) })
    })
}
