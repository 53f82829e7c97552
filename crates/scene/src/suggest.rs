//! "Did you mean": the nearest of some names.

/// The name with the fewest edits away from `wanted`, if that is near enough to be a slip. Of equal ones the first.
pub(crate) fn closest<'a>(wanted: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (wanted.chars().count() / 3).clamp(1, 3);
    names
        .map(|name| (distance(wanted, name), name))
        .filter(|&(edits, _)| edits <= limit)
        .min_by_key(|&(edits, _)| edits)
        .map(|(_, name)| name)
}

/// Edits (Levenshtein 1966) between two names, case ignored. Names of more than 64 characters are never near.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.to_lowercase().chars().collect(), b.to_lowercase().chars().collect());
    if a.len() > 64 || b.len() > 64 {
        return usize::MAX;
    }
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, &from) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::closest;

    #[test]
    fn a_slip_is_near_and_another_word_is_not() {
        let names = ["diffuse", "specular", "shininess"];
        assert_eq!(closest("difuse", names.into_iter()), Some("diffuse"));
        assert_eq!(closest("Specular", names.into_iter()), Some("specular"));
        assert_eq!(closest("weight", names.into_iter()), None);
        assert_eq!(closest("", names.into_iter()), None);
    }
}
