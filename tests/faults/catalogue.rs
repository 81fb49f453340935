//! What a planted fault is, and the table of those that are caught.

use mt_core::check::Breach;
use multi_tessellation::verify::{Counterexample, Finding};
use std::fmt::Display;
use std::sync::Mutex;

/// Who caught a fault: a law, or a reader that refuses.
#[derive(Debug)]
pub struct Caught {
    by: String,
    told: String,
}

/// `Err` where something is wrong.
pub type Verdict = Result<(), Caught>;

impl From<Breach> for Caught {
    fn from(breach: Breach) -> Self {
        Self { by: breach.law.to_string(), told: breach.to_string() }
    }
}

impl<const N: usize> From<Box<Counterexample<N>>> for Caught {
    fn from(found: Box<Counterexample<N>>) -> Self {
        Self { by: found.breach.law.to_string(), told: format!("{}; {}", found.breach, found.sizes()) }
    }
}

impl From<Box<Finding>> for Caught {
    fn from(found: Box<Finding>) -> Self {
        Self { by: found.breach.law.to_string(), told: format!("{}; {}", found.breach, found.sizes) }
    }
}

impl Caught {
    /// Refused by a reader, with its reason.
    pub fn refused(error: impl Display) -> Self {
        Self { by: "refused by the reader".into(), told: error.to_string() }
    }

    /// Caught by a comparison that is no law of models.
    pub fn by(by: &str, told: impl Display) -> Self {
        Self { by: by.into(), told: told.to_string() }
    }
}

/// A fault that can be planted or left out.
pub struct Fault<'a> {
    what: &'static str,
    judge: Box<dyn Fn(bool) -> Verdict + 'a>,
}

/// A fault, and how what has it is judged; told whether it is planted.
pub fn fault<'a>(what: &'static str, judge: impl Fn(bool) -> Verdict + 'a) -> Fault<'a> {
    Fault { what, judge: Box::new(judge) }
}

/// Sees each fault caught and what is right passed, and compares with the table of this layer.
pub fn hunt(layer: &str, faults: &[Fault]) {
    let mut rows = String::new();
    for Fault { what, judge } in faults {
        if let Err(caught) = judge(false) {
            panic!("{layer}: {what}: without the fault, {} says: {}", caught.by, caught.told);
        }
        let caught = judge(true).expect_err(&format!("{layer}: {what}: nobody saw it"));
        println!("{layer}: {what}: {}", caught.told);
        rows += &format!("| {what} | {} |\n", caught.by);
    }
    compare(layer, &rows);
}

const HEAD: &str = "\
# Planted faults

Each of these is planted by a test, and seen by the law or the reader beside it; the same without the fault passes. Written
by `MT_BLESS=1 cargo test -p mt-tests --test faults`, and compared with each run of the tests. What a law says and how
small the counterexample becomes is printed with `-- --nocapture`. Faults for single checkers (`tests/faults/checkers.rs`)
and those of one call (`tests/one_call.rs`) come on top.
";

const TABLE: &str = "\n| what is wrong | caught by |\n|---|---|\n";

/// The table of a layer in the document is this one; with `MT_BLESS` it becomes that.
fn compare(layer: &str, rows: &str) {
    static DOCUMENT: Mutex<()> = Mutex::new(());
    let _alone = DOCUMENT.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/faults.md");
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let mut sections: Vec<(String, String)> = text
        .split("\n## ")
        .skip(1)
        .filter_map(|section| section.split_once('\n'))
        .map(|(title, body)| (title.to_owned(), body.trim_end().to_owned() + "\n"))
        .collect();
    let body = format!("{TABLE}{rows}");
    if std::env::var_os("MT_BLESS").is_none() {
        let known = sections.iter().find(|section| section.0 == layer).map(|section| section.1.as_str());
        assert_eq!(known, Some(body.as_str()), "docs/faults.md is stale: run this test with MT_BLESS=1");
        return;
    }
    sections.retain(|section| section.0 != layer);
    sections.push((layer.to_owned(), body));
    sections.sort();
    let written = sections.iter().map(|(title, body)| format!("\n## {title}\n{body}"));
    std::fs::write(path, HEAD.to_owned() + &written.collect::<String>()).expect("the document can be written");
}
