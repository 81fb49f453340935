//! Real models for tests: from the folder named by `MT_DATA`, and said plainly where there is none.

use std::path::PathBuf;

/// The files of these names in `folder` of `MT_DATA`. Prints what is missing; without `MT_DATA` all of it is.
pub fn real_files(folder: &str, names: &[&str]) -> Vec<PathBuf> {
    let Some(root) = std::env::var_os("MT_DATA") else {
        println!("MT_DATA not set: skipped {} files of {folder}", names.len());
        return Vec::new();
    };
    let at = PathBuf::from(root).join(folder);
    let (found, missing): (Vec<_>, Vec<_>) = names.iter().map(|name| at.join(name)).partition(|path| path.is_file());
    for path in missing {
        println!("{} is not there: skipped", path.display());
    }
    found
}
