//! Which frames, and the names of their files.

use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Frames by number, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    pub first: u64,
    /// `None` goes on to the end.
    pub last: Option<u64>,
    /// 1 or more.
    pub step: u32,
}

/// Beyond it, times of frames are no longer told apart.
const MAX_FRAME: u64 = 1_000_000_000;

impl FromStr for FrameRange {
    type Err = String;

    /// `0..99`, `0..99:2`, `10..`, `7`.
    fn from_str(text: &str) -> Result<FrameRange, String> {
        let wrong = || "write the frames as 0..99, 0..99:2, 10.. or 7".to_owned();
        let number = |text: &str| text.trim().parse().ok().filter(|number| *number <= MAX_FRAME).ok_or_else(wrong);
        let (ends, step) = text.split_once(':').map_or((text, None), |(ends, step)| (ends, Some(step)));
        let step = match step {
            Some(step) => step.trim().parse().ok().filter(|step| *step > 0).ok_or("the step after : is a number from 1 on")?,
            None => 1,
        };
        let (first, last) = match ends.split_once("..") {
            None => number(ends).map(|frame| (frame, Some(frame)))?,
            Some((first, "")) => (number(first)?, None),
            Some((first, last)) => (number(first)?, Some(number(last)?)),
        };
        match last {
            Some(last) if last < first => Err(format!("the frames end before they begin; write {last}..{first}")),
            _ => Ok(FrameRange { first, last, step }),
        }
    }
}

/// A file name with a place for the number of the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    typed: PathBuf,
    folder: PathBuf,
    before: String,
    /// The number's least width; `None` where the name has no number.
    width: Option<usize>,
    after: String,
}

/// What keeps a name from being a pattern.
const TWO_NUMBERS: &str = "there are two places for the number of the frame; leave one, and write a percent sign as %% and a brace as {{";

/// Wider numbers than any there are.
const MAX_WIDTH: usize = 64;

impl Pattern {
    /// Finds `%04d` (or `%d`), `####` or `{frame:04}` (or `{frame}`) in the last part of a path. `%%` stands for a percent sign, `{{` and
    /// `}}` for braces.
    pub fn new(path: &Path) -> Result<Pattern, String> {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        let mut pattern = Pattern { typed: path.to_owned(), folder, before: String::new(), width: None, after: String::new() };
        let mut rest = name.as_str();
        while let Some(c) = rest.chars().next() {
            if let Some((width, length)) = number(rest) {
                if pattern.width.is_some() {
                    return Err(TWO_NUMBERS.to_owned());
                }
                if width > MAX_WIDTH {
                    return Err(format!("a number of {width} digits is too long; use %04d"));
                }
                pattern.width = Some(width);
                rest = &rest[length..];
                continue;
            }
            let doubled = ["%%", "{{", "}}"].iter().any(|pair| rest.starts_with(pair));
            let text = if pattern.width.is_some() { &mut pattern.after } else { &mut pattern.before };
            text.push(c);
            rest = &rest[c.len_utf8() * (1 + usize::from(doubled))..];
        }
        Ok(pattern)
    }

    /// Whether each frame has a file of its own.
    pub const fn has_number(&self) -> bool {
        self.width.is_some()
    }

    /// The file of a frame.
    pub fn path(&self, frame: u64) -> PathBuf {
        let number = self.width.map(|width| format!("{frame:0width$}")).unwrap_or_default();
        self.folder.join(format!("{}{number}{}", self.before, self.after))
    }

    /// The name without the number and what sets it apart: `elephant` of `elephant.%04d.obj`, without the ending.
    pub fn stem(&self) -> String {
        match self.width {
            Some(_) => self.before.trim_end_matches(['.', '_', '-', ' ']).to_owned(),
            None => self.before.clone(),
        }
    }
}

impl std::fmt::Display for Pattern {
    /// As it was typed.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.typed.display().fmt(f)
    }
}

/// The width of the number that a text begins with a place for, and the length of that place.
fn number(text: &str) -> Option<(usize, usize)> {
    let hashes = text.len() - text.trim_start_matches('#').len();
    if hashes > 0 {
        return Some((hashes, hashes));
    }
    if let Some(rest) = text.strip_prefix('%') {
        let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        return rest[digits..].starts_with('d').then(|| (rest[..digits].parse().unwrap_or(0), digits + 2));
    }
    let rest = text.strip_prefix("{frame")?;
    let (inside, _) = rest.split_once('}')?;
    let width = match inside.strip_prefix(':') {
        Some(digits) => digits.parse().ok()?,
        None => inside.is_empty().then_some(0)?,
    };
    Some((width, "{frame".len() + inside.len() + 1))
}

#[cfg(test)]
mod tests {
    use super::{FrameRange, Pattern};
    use std::path::Path;

    #[test]
    fn ranges() {
        let range = |text: &str| text.parse::<FrameRange>().ok().map(|range| (range.first, range.last, range.step));
        assert_eq!(range("0..99"), Some((0, Some(99), 1)));
        assert_eq!(range("5..5"), Some((5, Some(5), 1)));
        assert_eq!(range("10..20:3"), Some((10, Some(20), 3)));
        assert_eq!(range("10.."), Some((10, None, 1)));
        assert_eq!(range("10..:5"), Some((10, None, 5)));
        assert_eq!(range(" 7 "), Some((7, Some(7), 1)));
        for wrong in
            ["", "..", "..5", "a..b", "1-5", "-1..5", "1..5:0", "1..5:", "1..5:-1", "5..1", "1...5", "1..2..3", "1..99999999999999999999"]
        {
            assert_eq!(range(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn names() {
        let path = |text: &str, frame| {
            Pattern::new(Path::new(text)).map(|pattern| (pattern.path(frame).display().to_string(), pattern.has_number()))
        };
        for (text, frame, expected) in [
            ("a.%04d.png", 7, "a.0007.png"),
            ("a.####.png", 7, "a.0007.png"),
            ("a{frame:04}.png", 7, "a0007.png"),
            ("{frame}.png", 7, "7.png"),
            ("%d.png", 12, "12.png"),
            ("#.png", 12_345, "12345.png"),
            ("f%3d.exr", 12_345, "f12345.exr"),
            ("o##/%%d{{%02d}}.png", 7, "o##/%d{07}.png"),
            ("/x/y_%08d", 0, "/x/y_00000000"),
        ] {
            assert_eq!(path(text, frame), Ok((expected.to_owned(), true)), "{text}");
        }
        for text in ["a.png", "%s.png", "100%.png", "{n}.png", "{frame:x}.png", "{frame.png", "##/a.png", "%%04d.png"] {
            assert_eq!(path(text, 7), Ok((text.replace("%%", "%"), false)), "{text}");
        }
        for text in ["%d%d.png", "#-#.png", "##{frame}.png", "%999d.png", "%99999999999999999999999d.png#"] {
            assert!(path(text, 7).is_err(), "{text}");
        }
    }

    #[test]
    fn stems() {
        let stem = |text: &str| Pattern::new(Path::new(text)).map(|pattern| pattern.stem());
        assert_eq!(stem("x/elephant.%04d"), Ok("elephant".to_owned()));
        assert_eq!(stem("bunny_####"), Ok("bunny".to_owned()));
        assert_eq!(stem("teapot"), Ok("teapot".to_owned()));
    }
}
