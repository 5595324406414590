//! Types that are stored as a group of datasets.

use hdf5::{Group, LocationType};

use crate::attribute::{read_integer_attribute, read_text_attribute, write_integer_attribute, write_text_attribute};
use crate::error::{IoError, damaged, mismatch, missing, system_reason, write_error};
use crate::{raw, room};

/// A type that can be stored in a group and read back with the same bits.
///
/// `write` fills an empty group; `read` checks everything on which later code relies (lengths, indices), because the
/// file may come from anywhere. Increase [`Persist::VERSION`] when the layout changes.
pub trait Persist: Sized {
    /// Name of the type in files.
    const KIND: &'static str;
    /// Version of its layout.
    const VERSION: u32;
    /// The oldest version that is read, with all later ones.
    const OLDEST: u32 = Self::VERSION;

    /// The version of this value: the oldest that can represent it, so that older programs read as much as possible.
    fn version(&self) -> u32 {
        Self::VERSION
    }

    /// Writes the parts into the group `at`.
    ///
    /// # Errors
    /// [`IoError::Write`].
    fn write(&self, at: &Group) -> Result<(), IoError>;

    /// Reads the parts from the group `at` and checks that they fit together.
    ///
    /// # Errors
    /// Any error of reading; [`IoError::Invalid`] for parts that do not fit together.
    fn read(at: &Group) -> Result<Self, IoError>;
}

/// Stores `value` in a new group `name` with the attributes `kind` and `version`.
///
/// # Errors
/// [`IoError::Write`], also when `name` exists.
pub fn save<T: Persist>(parent: &Group, name: &str, value: &T) -> Result<(), IoError> {
    let group = create_group(parent, name)?;
    write_text_attribute(&group, "kind", T::KIND)?;
    write_integer_attribute(&group, "version", &[i64::from(value.version())])?;
    value.write(&group)
}

/// Reads what [`save`] stored.
///
/// # Errors
/// [`IoError::Mismatch`] for another kind, [`IoError::Version`] for another version, and the errors of [`Persist::read`].
pub fn load<T: Persist>(parent: &Group, name: &str) -> Result<T, IoError> {
    let group = open_group(parent, name)?;
    let kind = read_text_attribute(&group, "kind")?;
    if kind != T::KIND {
        return Err(mismatch(parent, name, format!("kind {}", T::KIND), format!("kind {kind}")));
    }
    let known = i64::from(T::OLDEST)..=i64::from(T::VERSION);
    if !matches!(read_integer_attribute(&group, "version")?[..], [found] if known.contains(&found)) {
        check_version(&group, "version", T::VERSION)?;
    }
    T::read(&group)
}

/// Compares the version attribute `name` of `group` with the known version.
pub(crate) fn check_version(group: &Group, name: &str, known: u32) -> Result<(), IoError> {
    match read_integer_attribute(group, name)?[..] {
        [found] if found == i64::from(known) => Ok(()),
        [found] => Err(IoError::Version { file: group.filename(), object: group.name(), found, known }),
        ref other => Err(mismatch(group, name, "one version", format!("{other:?}"))),
    }
}

/// Makes an empty group without a time stamp, so that equal content gives equal files.
///
/// # Errors
/// [`IoError::Write`], also when `name` exists.
pub fn create_group(parent: &Group, name: &str) -> Result<Group, IoError> {
    parent.create_group_builder().obj_track_times(false).create(name).map_err(|e| write_error(parent, name, e))
}

/// Opens the group `name`.
///
/// # Errors
/// [`IoError::Missing`], [`IoError::Mismatch`] if it is no group, [`IoError::Damaged`].
pub fn open_group(parent: &Group, name: &str) -> Result<Group, IoError> {
    if !parent.link_exists(name) {
        // A damaged list of links is not a missing group.
        parent.member_names().map_err(|e| damaged(parent, "", e))?;
        return Err(missing(parent, name));
    }
    if parent.loc_type_by_name(name).map_err(|e| damaged(parent, name, e))? != LocationType::Group {
        return Err(mismatch(parent, name, "a group", "another object"));
    }
    parent.group(name).map_err(|e| damaged(parent, name, e))
}

/// Copies the object `name` of `from`, with its content, to `to`, which may belong to another file, under the same
/// name: with the same bytes and checksums.
///
/// # Errors
/// [`IoError::Missing`]; [`IoError::Write`], also when `to` has such an object or the disk is full;
/// [`IoError::Damaged`].
pub fn copy(from: &Group, name: &str, to: &Group) -> Result<(), IoError> {
    if !from.link_exists(name) {
        return Err(missing(from, name));
    }
    let bytes = room::size(from, name).map_err(|e| damaged(from, name, e))?;
    room::check(to, bytes).map_err(|e| write_error(to, name, system_reason(&e)))?;
    raw::copy(from, name, to).map_err(|e| write_error(to, name, e))
}
