//! Writes what fuzzers start from: `cargo run -p mt-tests --example seeds -- FOLDER`.

use mt_tests::chew;
use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).unwrap_or_else(|| "fuzz/seeds".into()));
    for (i, (target, bytes)) in chew::seeds().into_iter().enumerate() {
        std::fs::create_dir_all(folder.join(target))?;
        std::fs::write(folder.join(target).join(i.to_string()), bytes)?;
    }
    Ok(())
}
