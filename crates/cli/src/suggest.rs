//! "Did you mean".

/// The name that is nearest to `wanted`, if it is near enough to be a slip.
pub fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = wanted.to_lowercase();
    names
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&wanted, &name.to_lowercase()), name))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

/// The end of a message about an unknown name: the nearest one, or all there are.
pub fn hint<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str> + Clone) -> String {
    match nearest(wanted, names.clone()) {
        Some(name) => format!("did you mean \"{name}\"?"),
        None => {
            let all: Vec<&str> = names.into_iter().collect();
            if all.is_empty() { "there is none".to_owned() } else { format!("there are {}", all.join(", ")) }
        }
    }
}

/// The same for a file that is not there: the nearest name in its folder.
pub fn file_hint(path: &std::path::Path) -> String {
    let parent = path.parent().unwrap_or(std::path::Path::new(""));
    let folder = if parent.as_os_str().is_empty() { std::path::Path::new(".") } else { parent };
    let wanted = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let Ok(entries) = std::fs::read_dir(folder) else {
        return format!("; there is no folder {}", folder.display());
    };
    let names: Vec<String> =
        entries.filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned())).take(10_000).collect();
    match nearest(&wanted, names.iter().map(String::as_str)) {
        Some(name) => format!("; did you mean {}?", parent.join(name).display()),
        None => String::new(),
    }
}
