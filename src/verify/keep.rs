//! Where findings are written: the one place of this library that writes files, and only when a test has failed.

use super::trial::Finding;
use std::path::{Path, PathBuf};

/// Writes picture, log and test of a finding; gives the files, none where that is not possible.
pub(super) fn write(finding: &Finding, folder: Option<&PathBuf>) -> Vec<PathBuf> {
    let folder = folder.cloned().unwrap_or_else(usual_folder);
    if std::fs::create_dir_all(&folder).is_err() {
        return Vec::new();
    }
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let name: String = finding.subject.rsplit("::").next().unwrap_or("subject").chars().map(plain).collect();
    let stem = format!("{}-{}", name.trim_matches('-'), finding.breach.law);
    let files = [("obj", &finding.obj), ("log", &finding.log), ("rs", &finding.test)];
    let written = files.into_iter().filter_map(|(ending, text)| {
        let path = folder.join(format!("{stem}.{ending}"));
        // Half a file would mislead; a rename is whole.
        let part = folder.join(format!(".{stem}.{ending}.{}", std::process::id()));
        std::fs::write(&part, text).and_then(|()| std::fs::rename(&part, &path)).ok()?;
        Some(path)
    });
    written.collect()
}

/// The folder of build results that the running test lies in, or that of temporary files.
fn usual_folder() -> PathBuf {
    let exe = std::env::current_exe().unwrap_or_default();
    let target = exe.ancestors().find(|folder| folder.join("CACHEDIR.TAG").is_file());
    target.map_or_else(std::env::temp_dir, Path::to_owned).join("counterexamples")
}
