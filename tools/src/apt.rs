//! Debian packages, unpacked beside the system: own package lists, no root, nothing installed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::process;

/// Downloads packages of a suite and unpacks them into a folder.
pub fn unpack(packages: &[&str], suite: &str, folder: &Path) -> Result<()> {
    if !process::installed("apt-get") || !process::installed("dpkg") {
        bail!("{} can be had on Debian only: needs apt-get and dpkg", packages.join(", "));
    }
    let state = State::open(suite)?;
    let downloads = folder.join(".downloads");
    fs::create_dir_all(&downloads).with_context(|| format!("{}: cannot be made", downloads.display()))?;
    for package in packages {
        eprintln!("downloading {package} ({suite})");
        if process::run(&mut state.download(package, &downloads)).is_err() {
            // Lists grow stale: the version they name may be gone.
            state.update()?;
            process::run(&mut state.download(package, &downloads))?;
        }
    }
    for entry in fs::read_dir(&downloads).with_context(|| format!("{}: cannot be listed", downloads.display()))? {
        process::run(Command::new("dpkg").arg("-x").arg(entry?.path()).arg(folder))?;
    }
    fs::remove_dir_all(&downloads).with_context(|| format!("{}: cannot be removed", downloads.display()))
}

/// The code name of this Debian, such as `bookworm`.
pub fn codename() -> Result<String> {
    let release = fs::read_to_string("/etc/os-release").context("/etc/os-release: cannot be read")?;
    let field =
        |name: &str| release.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix('=')).map(|v| v.trim_matches('"').to_owned());
    if field("ID").as_deref() != Some("debian") {
        bail!("Debian packages can be had on Debian only; this is {}", field("PRETTY_NAME").unwrap_or_default());
    }
    field("VERSION_CODENAME").context("/etc/os-release: no VERSION_CODENAME")
}

/// apt's lists and settings for one suite, in the cache folder.
struct State {
    folder: PathBuf,
}

impl State {
    fn open(suite: &str) -> Result<State> {
        let folder = process::cache()?.join("apt").join(suite);
        let state = State { folder };
        for name in ["lists/partial", "cache/archives/partial"] {
            fs::create_dir_all(state.folder.join(name)).with_context(|| format!("{}: cannot be made", state.folder.display()))?;
        }
        let uri = mirror().context("no Debian mirror in /etc/apt/sources.list or /etc/apt/sources.list.d")?;
        let keyring = "/usr/share/keyrings/debian-archive-keyring.gpg";
        let list = format!("deb [signed-by={keyring}] {uri} {suite} main\n");
        let path = state.folder.join("sources.list");
        if fs::read_to_string(&path).ok().as_ref() != Some(&list) {
            state.update_from(&path, &list)?;
        }
        Ok(state)
    }

    /// Writes the source list only after the lists were read, so that an interrupted first time is repeated.
    fn update_from(&self, path: &Path, list: &str) -> Result<()> {
        let partial = path.with_extension("partial");
        fs::write(&partial, list).with_context(|| format!("{}: cannot be written", partial.display()))?;
        fs::copy(&partial, self.source()).with_context(|| format!("{}: cannot be written", path.display()))?;
        self.update()?;
        fs::rename(&partial, path).with_context(|| format!("{}: cannot be written", path.display()))
    }

    fn source(&self) -> PathBuf {
        self.folder.join("active.list")
    }

    fn command(&self) -> Command {
        let mut command = Command::new("apt-get");
        for (option, value) in [
            ("Dir::Etc::SourceList", self.source()),
            ("Dir::Etc::SourceParts", PathBuf::from("/dev/null")),
            ("Dir::State::Lists", self.folder.join("lists")),
            ("Dir::Cache", self.folder.join("cache")),
            // As root, apt would drop to a user who cannot write into this folder.
            ("APT::Sandbox::User", PathBuf::from("root")),
            ("Acquire::Retries", PathBuf::from("3")),
            ("Acquire::Languages", PathBuf::from("none")),
        ] {
            command.arg("-o").arg(format!("{option}={}", value.display()));
        }
        command.arg("-q");
        command
    }

    fn update(&self) -> Result<()> {
        eprintln!("reading the package lists");
        process::run(self.command().arg("update"))
    }

    fn download(&self, package: &str, folder: &Path) -> Command {
        let mut command = self.command();
        command.arg("download").arg(package).current_dir(folder);
        command
    }
}

/// The mirror that this machine's own apt uses for Debian itself.
fn mirror() -> Option<String> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir("/etc/apt/sources.list.d").into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.push(PathBuf::from("/etc/apt/sources.list"));
    paths.iter().filter_map(|path| fs::read_to_string(path).ok()).find_map(|text| mirror_in(&text))
}

/// The first address of a source list, in either format, whose last part is `debian`.
fn mirror_in(text: &str) -> Option<String> {
    let lines = text.lines().filter(|line| line.starts_with("URIs:") || line.starts_with("deb "));
    let mut words = lines.flat_map(str::split_whitespace).filter(|word| word.contains("://"));
    words.find(|word| word.trim_end_matches('/').ends_with("/debian")).map(|word| word.trim_end_matches('/').to_owned())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::mirror_in;

    #[test]
    fn mirrors_of_both_formats() {
        assert_eq!(mirror_in("Types: deb\nURIs: http://a.example/debian/\nSuites: x\n").unwrap(), "http://a.example/debian");
        assert_eq!(
            mirror_in("# deb http://no.example/debian x\ndeb [arch=amd64] http://a.example/debian x main\n").unwrap(),
            "http://a.example/debian"
        );
        assert_eq!(mirror_in("deb http://a.example/debian-security x main\n"), None);
    }
}
