//! The results of a study as plain data, the source of its JSON object, HDF5 file, CSV tables and printed text.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use steklov_bem_operators::Mesh;
use steklov_document::Source;
use steklov_io::{
    File, Group, IoError, Label, create_atomically, create_group, save, save_integers, save_number, save_points,
    save_text, save_texts, save_vector, write_integer_attribute, write_text_attribute,
};
use steklov_problem::Scene;

use crate::kind::Draw;
use crate::table::Table;
use crate::{StudyError, show};

/// The results of a study.
pub struct Report<'a> {
    /// The file's description of its content.
    pub(crate) content: &'static str,
    /// The meaning of the stored settings.
    pub(crate) overrides: &'static str,
    /// The scene as it was run.
    pub(crate) scene: &'a Scene,
    /// The texts from which it was read.
    pub(crate) source: &'a Source,
    /// Whether nobody stopped it and everything was solved.
    pub complete: bool,
    /// Whether the user stopped it.
    pub(crate) interrupted: bool,
    /// The further parts of the JSON object and the HDF5 file.
    pub(crate) parts: Vec<Part>,
    /// Names and contents of the CSV tables.
    pub tables: Vec<(&'static str, String)>,
    /// The text printed between the title and the note of an interruption.
    pub(crate) body: String,
}

/// A part of a report: its name, its value in the JSON object, its content in the HDF5 file.
pub(crate) struct Part {
    name: String,
    told: Option<Value>,
    kept: Option<Stored>,
}

/// The content of a part in a file.
enum Stored {
    Text(String, &'static str),
    Texts(Vec<String>, &'static str, &'static str),
    Number(f64, &'static str, &'static str),
    Vector(Vec<f64>, Label<'static>),
    Counts(Vec<usize>, Label<'static>),
    Points(Vec<[f64; 2]>, Label<'static>),
    /// The columns, in the group where the part is.
    Columns(Table),
    Group(Vec<Part>),
    Mesh(Mesh),
}

/// A value of the JSON object only.
pub(crate) fn told(name: &str, value: impl Into<Value>) -> Part {
    Part::new(name, Some(value.into()), None)
}

/// A text with its meaning.
pub(crate) fn text(name: &str, text: &str, meaning: &'static str) -> Part {
    Part::new(name, Some(text.into()), Some(Stored::Text(text.to_owned(), meaning)))
}

/// A number with unit and meaning.
pub(crate) fn number(name: &str, value: f64, unit: &'static str, meaning: &'static str) -> Part {
    Part::new(name, Some(value.into()), Some(Stored::Number(value, unit, meaning)))
}

/// Texts of the file only, with their meaning and the subject of each.
pub(crate) fn texts(name: &str, texts: Vec<String>, meaning: &'static str, axis: &'static str) -> Part {
    Part::new(name, None, Some(Stored::Texts(texts, meaning, axis)))
}

/// Numbers in one dataset.
pub(crate) fn vector(name: &str, values: &[f64], label: Label<'static>) -> Part {
    Part::new(name, Some(json!(values)), Some(Stored::Vector(values.to_vec(), label)))
}

/// Counts of the file only.
pub(crate) fn counts(name: &str, values: Vec<usize>, label: Label<'static>) -> Part {
    Part::new(name, None, Some(Stored::Counts(values, label)))
}

/// Points of the file only.
pub(crate) fn points(name: &str, values: Vec<[f64; 2]>, label: Label<'static>) -> Part {
    Part::new(name, None, Some(Stored::Points(values, label)))
}

/// A mesh of the file.
pub(crate) fn mesh(name: &str, mesh: &Mesh) -> Part {
    Part::new(name, None, Some(Stored::Mesh(mesh.clone())))
}

/// A table: its rows in the JSON object, its columns in a group of that name.
pub(crate) fn rows(name: &str, table: Table) -> Part {
    Part::new(name, Some(table.json()), Some(Stored::Group(vec![columns(name, table)])))
}

/// A table whose columns are beside the other parts of the group.
pub(crate) fn columns(name: &str, table: Table) -> Part {
    Part::new(name, Some(table.json()), Some(Stored::Columns(table)))
}

/// An object and a group.
pub(crate) fn part(name: &str, parts: Vec<Part>) -> Part {
    Part::new(name, Some(object(&parts)), Some(Stored::Group(parts)))
}

/// A list of objects, and groups with three digits as names.
pub(crate) fn list(name: &str, items: Vec<Vec<Part>>) -> Part {
    let value = items.iter().map(|parts| object(parts)).collect();
    let groups = items.into_iter().enumerate().map(|(k, parts)| part(&format!("{k:03}"), parts));
    Part::new(name, Some(value), Some(Stored::Group(groups.collect())))
}

/// Tables of one kind with their names, each a list of `points` and the columns of a group; `meaning` describes the
/// names.
pub(crate) fn named<'n>(
    name: &str,
    names: impl Iterator<Item = &'n str>,
    meaning: &'static str,
    table: impl Fn(usize) -> Table,
) -> Part {
    let item = |(k, name)| vec![text("name", name, meaning), columns("points", table(k))];
    list(name, names.enumerate().map(item).collect())
}

/// The failures, each with its reason.
pub(crate) fn failures<'f>(all: impl Iterator<Item = &'f (String, String)>) -> Part {
    told("failures", all.map(|(at, why)| json!({ "at": at, "message": why })).collect::<Value>())
}

impl Part {
    fn new(name: &str, told: Option<Value>, kept: Option<Stored>) -> Self {
        Self { name: name.to_owned(), told, kept }
    }

    /// The part in the JSON object only.
    pub(crate) fn only_told(self) -> Self {
        Self { kept: None, ..self }
    }

    /// The part in the file only.
    pub(crate) fn only_kept(self) -> Self {
        Self { told: None, ..self }
    }
}

fn object(parts: &[Part]) -> Value {
    let told = parts.iter().filter_map(|part| Some((part.name.clone(), part.told.clone()?)));
    Value::Object(told.collect::<Map<_, _>>())
}

fn keep(at: &Group, parts: &[Part]) -> Result<(), IoError> {
    for Part { name, kept, .. } in parts {
        match kept {
            None => {}
            Some(Stored::Text(text, meaning)) => save_text(at, name, text, meaning)?,
            Some(Stored::Texts(texts, meaning, axis)) => save_texts(at, name, texts, meaning, axis)?,
            Some(Stored::Number(value, unit, meaning)) => save_number(at, name, *value, unit, meaning)?,
            Some(Stored::Vector(values, label)) => save_vector(at, name, values, label)?,
            Some(Stored::Counts(values, label)) => save_integers(at, name, values, label)?,
            Some(Stored::Points(values, label)) => save_points(at, name, values, label)?,
            Some(Stored::Columns(table)) => table.save(at)?,
            Some(Stored::Group(parts)) => keep(&create_group(at, name)?, parts)?,
            Some(Stored::Mesh(mesh)) => save(at, name, mesh)?,
        }
    }
    Ok(())
}

impl Report<'_> {
    /// The JSON object; unknown numbers are null.
    pub fn json(&self) -> Value {
        let mut all = object(&self.parts);
        all["title"] = json!(self.scene.title);
        all["settings"] = json!(show::settings(self.source));
        (all["complete"], all["interrupted"]) = (self.complete.into(), self.interrupted.into());
        all
    }

    /// Writes the study into a new file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, file: &File) -> Result<(), IoError> {
        write_text_attribute(file, "program", concat!("steklov ", env!("CARGO_PKG_VERSION")))?;
        write_text_attribute(file, "content", self.content)?;
        write_integer_attribute(file, "threads", &[rayon::current_num_threads() as i64])?;
        save_text(file, "scene", &self.source.text, "text of the scene file")?;
        save_texts(file, "overrides", &show::settings(self.source), self.overrides, "override")?;
        let meaning = "the JSON object of study --json, without its list of files";
        save_text(file, "summary", &self.json().to_string(), meaning)?;
        keep(file, &self.parts)
    }

    /// Writes the HDF5 file `name.h5`, the tables and the pictures into a folder, over older ones, and returns the files.
    ///
    /// # Errors
    /// When one of them cannot be written: [`StudyError::Io`], [`StudyError::Write`], [`StudyError::Picture`].
    pub fn store(&self, folder: &Path, name: &str, pictures: Draw<'_>) -> Result<Vec<PathBuf>, StudyError> {
        let failed = |source| StudyError::Write { folder: folder.to_owned(), source };
        std::fs::create_dir_all(folder).map_err(failed)?;
        let mut files = vec![folder.join(format!("{name}.h5"))];
        create_atomically(&files[0], true, |file| self.write(file))?;
        for (table, content) in &self.tables {
            let path = folder.join(table);
            steklov_picture::replace(folder, &path, content.as_bytes()).map_err(failed)?;
            files.push(path);
        }
        files.extend(pictures(folder)?);
        Ok(files)
    }

    /// The printed text.
    pub fn text(&self) -> String {
        let stopped = if self.interrupted { "interrupted: what was finished is here\n" } else { "" };
        format!("{}\n{}{stopped}", self.scene.title, self.body)
    }
}
