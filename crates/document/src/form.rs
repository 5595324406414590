//! The description of a key of a scene, as plain data: the reader uses names and ranges, the schema and the reference
//! use all of it.

/// A key of a table.
pub(super) struct Key {
    pub(super) name: &'static str,
    /// The values that it takes.
    pub(super) form: Form,
    /// What holds if the key is missing.
    pub(super) default: Fallback,
    /// Unit of its numbers; empty if they have none, or the key has no numbers.
    pub(super) unit: &'static str,
    /// Its meaning, one sentence.
    pub(super) what: &'static str,
}

/// A table: fixed keys, or names that the user chooses.
pub(super) struct Table {
    /// Its full name in a scene.
    pub(super) name: &'static str,
    /// Its purpose, one sentence.
    pub(super) what: &'static str,
    pub(super) keys: &'static [Key],
    /// The values of names that the user chooses, and the meaning of such a name.
    pub(super) names: Option<(Form, &'static str)>,
}

/// The values that a key takes.
pub(super) enum Form {
    /// A number, or the text of an expression of parameters.
    Number(Range),
    /// A whole number, or the text of an expression of parameters.
    Whole(Whole),
    /// A text in quotes.
    Text,
    /// True or false.
    Flag,
    /// The word true without quotes.
    True,
    /// A number in this range, or the text of an expression of the place, parameters and random input.
    Expression(Range),
    /// One of these words in quotes.
    Words(&'static [&'static str]),
    /// A list of two [`Form::Number`], x and y.
    Point,
    /// A list of values of one form, with their number; None for any number.
    List(&'static Form, Option<usize>),
    /// A table.
    Table(&'static Table),
    /// One of several forms; beside words no text is an expression.
    OneOf(&'static [Form]),
    /// The key is known, but no value of it can be solved; the reader says why.
    Refused,
}

/// What holds if a key is missing.
pub(super) enum Fallback {
    /// Nothing: the key is required.
    Required,
    /// This value as TOML text.
    Value(fn() -> String),
    /// As this text says.
    Said(&'static str),
}

/// Numbers between two bounds.
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Whether each bound belongs to it.
    pub(super) closed: [bool; 2],
    /// The numbers in words, for messages.
    pub(super) wanted: &'static str,
}

impl Range {
    /// Numbers between two bounds, without the bounds.
    pub(super) const fn open(low: f64, high: f64, wanted: &'static str) -> Self {
        Self { low, high, closed: [false; 2], wanted }
    }

    pub(super) fn contains(&self, v: f64) -> bool {
        let [low, high] = self.closed;
        (v > self.low || low && v == self.low) && (v < self.high || high && v == self.high)
    }
}

/// The smallest and the largest whole number.
#[derive(Clone, Copy)]
pub(super) struct Whole(pub(super) usize, pub(super) usize);

/// The words of choices.
pub(super) const fn words<T: Copy, const N: usize>(choices: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut k = 0;
    while k < N {
        words[k] = choices[k].0;
        k += 1;
    }
    words
}

/// The word of a choice as TOML text.
pub(super) fn quoted<T: PartialEq>(choices: &[(&'static str, T)], choice: T) -> String {
    let word = choices.iter().find(|(_, other)| *other == choice).map_or("", |(word, _)| word);
    format!("{word:?}")
}

/// An entry of [`Form::Point`].
static COORDINATE: Form = Form::Number(super::keys::FINITE);

impl Table {
    /// The names of its keys.
    pub(super) fn known(&self) -> impl Iterator<Item = &'static str> + Clone {
        self.keys.iter().map(|key| key.name)
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.keys.iter().any(|k| k.name == key)
    }

    /// This table and those below it, each once, in the order of the keys.
    pub(super) fn all(&'static self) -> Vec<&'static Table> {
        let mut all = Vec::new();
        self.add(&mut all);
        all
    }

    fn add(&'static self, all: &mut Vec<&'static Table>) {
        if !all.iter().any(|other| std::ptr::eq(*other, self)) {
            all.push(self);
            let names = self.names.iter().map(|(form, _)| form);
            self.keys.iter().map(|key| &key.form).chain(names).for_each(|form| form.add(all));
        }
    }
}

impl Form {
    fn add(&'static self, all: &mut Vec<&'static Table>) {
        match self {
            Self::Table(table) => table.add(all),
            Self::List(of, _) => of.add(all),
            Self::OneOf(forms) => forms.iter().for_each(|form| form.add(all)),
            _ => {}
        }
    }

    /// The forms of which a value has one.
    pub(super) fn alternatives(&self) -> std::slice::Iter<'_, Form> {
        match self {
            Self::OneOf(forms) => forms.iter(),
            form => std::slice::from_ref(form).iter(),
        }
    }

    /// The form of the entries of a list.
    pub(super) fn of_entries(&self) -> Option<&Form> {
        match self {
            Self::List(of, _) => Some(of),
            Self::Point => Some(&COORDINATE),
            _ => None,
        }
    }

    /// Whether a value of one of these forms may be the text of an expression of parameters.
    pub(super) fn take_expressions<'a>(mut forms: impl Iterator<Item = &'a Form> + Clone) -> bool {
        let is_text = |form: &Form| matches!(form, Self::Text | Self::Words(_) | Self::Expression(_));
        !forms.clone().any(is_text) && forms.any(|form| matches!(form, Self::Number(_) | Self::Whole(_)))
    }
}
