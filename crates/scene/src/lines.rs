//! Lines of OBJ and MTL files: LF, CRLF and CR endings, `\` at the end continues, comments are cut, any bytes.

use std::borrow::Cow;

/// The cap for one line, continuations included.
pub(crate) const MAX_LINE_BYTES: usize = 1 << 20;

/// A line with more than [`MAX_LINE_BYTES`]; holds its number.
pub(crate) struct LineTooLong(pub(crate) u64);

/// Iterates over lines with their numbers (of the first, where lines are continued), without comments and outer blanks.
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: u64,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), at: 0, number: 0 }
    }

    /// One physical line without its ending.
    fn physical(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        self.number += 1;
        let end = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(rest.len());
        let ending = match &rest[end..] {
            [b'\r', b'\n', ..] => 2,
            [] => 0,
            _ => 1,
        };
        self.at += end + ending;
        Some(&rest[..end])
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Result<(u64, Cow<'a, [u8]>), LineTooLong>;

    fn next(&mut self) -> Option<Self::Item> {
        let first = self.physical()?;
        let number = self.number;
        let mut line = Cow::Borrowed(first);
        // A continuation inside a comment continues the comment; blanks after the backslash are tolerated.
        while let Some(kept) = line.trim_ascii_end().strip_suffix(b"\\") {
            let kept = kept.len();
            let Some(next) = self.physical() else {
                line.to_mut().truncate(kept);
                break;
            };
            let joined = line.to_mut();
            joined.truncate(kept);
            joined.push(b' ');
            joined.extend_from_slice(next);
            if joined.len() > MAX_LINE_BYTES {
                return Some(Err(LineTooLong(number)));
            }
        }
        if line.len() > MAX_LINE_BYTES {
            return Some(Err(LineTooLong(number)));
        }
        Some(Ok((number, without_comment(line))))
    }
}

/// A comment begins with `#` at the start or after a blank, so that names may hold the character.
fn without_comment(line: Cow<'_, [u8]>) -> Cow<'_, [u8]> {
    let comment = line.iter().enumerate().position(|(at, &byte)| byte == b'#' && (at == 0 || line[at - 1].is_ascii_whitespace()));
    let end = comment.unwrap_or(line.len());
    match line {
        Cow::Borrowed(line) => Cow::Borrowed(line[..end].trim_ascii()),
        Cow::Owned(line) => Cow::Owned(line[..end].trim_ascii().to_vec()),
    }
}

/// Cuts the first word off.
pub(crate) fn word(line: &[u8]) -> (&[u8], &[u8]) {
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii_start())
}

/// The words of a line.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A word as text for a message: bytes that are no UTF-8 replaced, at most 40 characters.
pub(crate) fn shown(word: &[u8]) -> String {
    let word = &word[..word.len().min(160)];
    let text = String::from_utf8_lossy(word);
    let short: String = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(40).collect();
    if short.len() < text.len() { short + "..." } else { short }
}

/// A number as OBJ and MTL files write it. Values beyond single precision become infinite; what Microsoft's C library prints for numbers
/// that are none (`-1.#IND`) is NaN.
pub(crate) fn number(word: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| text.contains(".#").then_some(f32::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> Vec<(u64, String)> {
        Lines::new(text).map_while(Result::ok).map(|(number, line)| (number, String::from_utf8_lossy(&line).into_owned())).collect()
    }

    #[test]
    fn every_ending_continuation_and_comment() {
        let text = b"\xef\xbb\xbfa\r\nb\rc\\\n d \\ \r\ne # no\n\n#x\nlast\\";
        let expected = [(1, "a"), (2, "b"), (3, "c  d  e"), (6, ""), (7, ""), (8, "last")];
        assert_eq!(lines(text), expected.map(|(number, line)| (number, line.to_owned())));
    }

    #[test]
    fn a_long_line_is_refused_with_its_number() {
        let mut text = b"a\n".to_vec();
        text.extend(std::iter::repeat_n(b"1 \\\n".as_slice(), MAX_LINE_BYTES).flatten());
        assert!(matches!(Lines::new(&text).nth(1), Some(Err(LineTooLong(2)))));
    }

    #[test]
    fn numbers_beyond_range_and_microsoft_nan() {
        assert_eq!(number(b"1e400"), Some(f32::INFINITY));
        assert!(number(b"-1.#IND").is_some_and(f32::is_nan));
        assert_eq!(number(b"1,5"), None);
    }
}
