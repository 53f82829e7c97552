//! Sequences of key-frame files: by a pattern with a number in it, or by a list.

use std::path::{Path, PathBuf};

use crate::files::{Files, names_in};
use crate::{Error, Result};

/// The most digits a pattern may ask for: those of the greatest number.
const MAX_WIDTH: usize = 20;

/// A file name with a place for a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pattern {
    before: String,
    after: String,
    width: usize,
}

impl Pattern {
    /// `%d`, `%4d`, `%04d` (both of four digits or more) or a run of `#` (as many digits as there are, or more). `None` for a name without
    /// any; `Err` says why a name with one is no pattern.
    pub(crate) fn parse(name: &str) -> Result<Option<Self>, String> {
        let mut found: Option<Self> = None;
        let mut at = 0;
        while let Some(byte) = name.as_bytes().get(at) {
            let rest = &name[at..];
            let (length, width) = match byte {
                b'#' => {
                    let run = rest.bytes().take_while(|&byte| byte == b'#').count();
                    (run, run)
                }
                b'%' => {
                    let digits = rest[1..].bytes().take_while(u8::is_ascii_digit).count();
                    if rest.as_bytes().get(1 + digits) != Some(&b'd') {
                        at += 1;
                        continue;
                    }
                    (digits + 2, rest[1..=digits].parse().unwrap_or(if digits == 0 { 0 } else { usize::MAX }))
                }
                _ => {
                    // Whole characters, so that every slice begins at one.
                    at += rest.chars().next().map_or(1, char::len_utf8);
                    continue;
                }
            };
            if found.is_some() {
                return Err(format!("\"{name}\" has two places for a number; a sequence has one"));
            }
            if width > MAX_WIDTH {
                return Err(format!("\"{name}\" asks for {width} digits; at most {MAX_WIDTH} are possible"));
            }
            found = Some(Self { before: name[..at].to_owned(), after: name[at + length..].to_owned(), width });
            at += length;
        }
        Ok(found)
    }

    /// The file's name for a number.
    fn name(&self, number: u64) -> String {
        format!("{}{number:0width$}{}", self.before, self.after, width = self.width)
    }

    /// The number in a file's name, if it is written as [`Pattern::name`] would.
    fn number(&self, name: &str) -> Option<u64> {
        let number = self.digits(name)?.parse().ok()?;
        (self.name(number) == name).then_some(number)
    }

    fn digits<'a>(&self, name: &'a str) -> Option<&'a str> {
        let digits = name.strip_prefix(&self.before)?.strip_suffix(self.after.as_str())?;
        (!digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())).then_some(digits)
    }

    /// What the pattern calls the whole, without number and ending.
    fn title(&self) -> String {
        let title = self.before.trim_end_matches(['.', '_', '-', ' ']);
        if title.is_empty() { "sequence".to_owned() } else { title.to_owned() }
    }
}

/// The files of a sequence, in order; one or more.
#[derive(Clone, Debug)]
pub(crate) struct Sequence {
    names: Names,
    /// Where the names are looked for.
    folder: PathBuf,
    /// Whether a person named the files, rather than a scene file: then they are taken as they are.
    trusted: bool,
}

#[derive(Clone, Debug)]
enum Names {
    Numbered { pattern: Pattern, first: u64, last: u64 },
    Listed(Vec<String>),
}

/// Which numbers of a pattern count; what is `None` comes from the folder.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Range {
    pub(crate) first: Option<u64>,
    pub(crate) last: Option<u64>,
}

impl Sequence {
    /// The files in `folder` that match a pattern. Numbers that the folder leaves out count all the same: they are missed when they are read.
    /// `Err` holds the reason in words.
    pub(crate) fn numbered(pattern: Pattern, folder: &Path, range: Range, trusted: bool) -> Result<Self, String> {
        let shown = folder.join(format!("{}{}{}", pattern.before, Place(pattern.width), pattern.after));
        let listed = if let Range { first: Some(first), last: Some(last) } = range {
            Some((first, last))
        } else {
            let listed_folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            let mut listed: Option<(u64, u64)> = None;
            let mut near: Option<String> = None;
            for name in names_in(listed_folder).filter_map(|name| name.into_string().ok()) {
                if let Some(number) = pattern.number(&name) {
                    listed = Some(listed.map_or((number, number), |(first, last)| (first.min(number), last.max(number))));
                } else if pattern.digits(&name).is_some() && near.as_ref().is_none_or(|near| name < *near) {
                    near = Some(name);
                }
            }
            if let (None, Some(near)) = (listed, &near) {
                let width = pattern.digits(near).map_or(0, str::len);
                return Err(format!("no file matches {}; there is {near}: write %0{width}d for its number", shown.display()));
            }
            listed
        };
        let (first, last) = listed.ok_or_else(|| {
            format!(
                "no file matches {}; the names must be the same but for a number of {} digits or more",
                shown.display(),
                pattern.width.max(1)
            )
        })?;
        let (first, last) = (range.first.unwrap_or(first), range.last.unwrap_or(last));
        if first > last {
            return Err(format!("{} begins at {first} and ends at {last}; first must not be above last", shown.display()));
        }
        if last - first >= u64::from(u32::MAX) {
            return Err(format!("{} goes from {first} to {last}; at most {} key-frames are possible", shown.display(), u32::MAX));
        }
        Ok(Self { names: Names::Numbered { pattern, first, last }, folder: folder.to_owned(), trusted })
    }

    /// Files by name. A list that is empty is no sequence.
    pub(crate) fn listed(names: Vec<String>, folder: &Path) -> Option<Self> {
        (!names.is_empty() && u32::try_from(names.len()).is_ok()).then(|| Self {
            names: Names::Listed(names),
            folder: folder.to_owned(),
            trusted: false,
        })
    }

    /// Number of key-frames, 1 or more.
    pub(crate) fn key_count(&self) -> u32 {
        match &self.names {
            // Both constructors see to it that the number fits.
            Names::Numbered { first, last, .. } => u32::try_from(last - first).unwrap_or(u32::MAX - 1) + 1,
            Names::Listed(names) => u32::try_from(names.len()).unwrap_or(u32::MAX),
        }
    }

    /// The name of the whole.
    pub(crate) fn title(&self) -> String {
        match &self.names {
            Names::Numbered { pattern, .. } => pattern.title(),
            Names::Listed(names) => crate::load::stem(Path::new(names.first().map_or("sequence", String::as_str))),
        }
    }

    /// The file of a key-frame as messages show it.
    pub(crate) fn shown(&self, key: u32) -> String {
        let name = self.name(key).unwrap_or_default();
        if self.trusted { self.folder.join(name).to_string_lossy().into_owned() } else { name }
    }

    /// The name of a key-frame's file; `None` beyond the last.
    fn name(&self, key: u32) -> Option<String> {
        match &self.names {
            Names::Numbered { pattern, first, .. } => (key < self.key_count()).then(|| pattern.name(first + u64::from(key))),
            Names::Listed(names) => names.get(key as usize).cloned(),
        }
    }

    /// Where a key-frame's file lies, if it may be opened.
    pub(crate) fn path(&self, files: &Files, key: u32) -> Result<PathBuf> {
        let name = self.name(key).ok_or(Error::NoKeyFrame { key, count: self.key_count() })?;
        let path = self.folder.join(&name);
        let found = if self.trusted {
            if path.exists() { Ok(path.clone()) } else { Err(Error::NotFound { path: path.clone(), suggestion: None }) }
        } else {
            files.find(&self.folder, &name)
        };
        found.map_err(|error| match (error, &self.names) {
            (Error::NotFound { .. }, Names::Numbered { first, last, .. }) => Error::MissingKeyFrame { path, first: *first, last: *last },
            (error, _) => error,
        })
    }
}

/// The place of a number as a pattern writes it.
struct Place(usize);

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0 == 0 { formatter.write_str("%d") } else { write!(formatter, "%0{}d", self.0) }
    }
}

/// The pattern in a path that a person gave, and its folder. A file of exactly that name goes before any pattern.
pub(crate) fn pattern_of(path: &Path) -> Result<Option<(Pattern, PathBuf)>> {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Ok(None) };
    if path.symlink_metadata().is_ok() {
        return Ok(None);
    }
    let pattern = Pattern::parse(name).map_err(|message| Error::Sequence { message })?;
    Ok(pattern.map(|pattern| (pattern, crate::load::folder_of(path))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(name: &str) -> Pattern {
        let none = Pattern { before: "none".to_owned(), after: String::new(), width: 0 };
        Pattern::parse(name).ok().flatten().unwrap_or(none)
    }

    #[test]
    fn every_spelling_of_a_number() {
        for (name, at_7, at_12345) in [
            ("a.%04d.obj", "a.0007.obj", "a.12345.obj"),
            ("a.%4d.obj", "a.0007.obj", "a.12345.obj"),
            ("a.####.obj", "a.0007.obj", "a.12345.obj"),
            ("a%d.obj", "a7.obj", "a12345.obj"),
            ("é#ü.ply", "é7ü.ply", "é12345ü.ply"),
            ("100%_%02d", "100%_07", "100%_12345"),
        ] {
            let pattern = parsed(name);
            assert_eq!((pattern.name(7).as_str(), pattern.name(12_345).as_str()), (at_7, at_12345));
            assert_eq!((pattern.number(at_7), pattern.number(at_12345)), (Some(7), Some(12_345)));
        }
    }

    #[test]
    fn names_that_the_pattern_would_not_write_do_not_match() {
        let pattern = parsed("a.%03d.obj");
        for name in ["a.7.obj", "a.0007.obj", "a.-01.obj", "a.007.ply", "a..obj", "b.007.obj", "a.99999999999999999999999.obj"] {
            assert_eq!(pattern.number(name), None, "{name}");
        }
    }

    #[test]
    fn what_is_no_pattern() {
        assert_eq!(Pattern::parse("a.obj"), Ok(None));
        assert_eq!(Pattern::parse("50%.obj"), Ok(None));
        assert!(Pattern::parse("a##b#.obj").is_err());
        assert!(Pattern::parse("a%d.%d.obj").is_err());
        assert!(Pattern::parse("a%99d.obj").is_err());
        assert!(Pattern::parse("a%99999999999999999999999d.obj").is_err());
    }
}
