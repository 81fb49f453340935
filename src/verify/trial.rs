//! Trials: how cases are drawn and judged, and what is said of one that fails.

use super::keep;
use super::specimen::Drawn;
use super::{Summary, Topology};
use mt_core::check::{Breach, Law};
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, FileFailurePersistence, TestCaseError, TestError, TestRunner};
use std::cell::Cell;
use std::fmt;
use std::panic::Location;
use std::path::PathBuf;
use std::sync::Once;

/// How much a trial does.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Number of cases; `PROPTEST_CASES` in the environment comes before it.
    pub cases: u32,
    /// Random fronts of each model.
    pub fronts: u32,
    /// What the modifications may do to the topology of meshes.
    pub topology: Topology,
    /// Where a finding is written; by default `counterexamples` in the folder of build results. See [`Finding::files`].
    pub folder: Option<PathBuf>,
    /// Whether seeds that failed are kept in a file beside the test, and come first the next time.
    pub keep_seeds: bool,
}

impl Default for Trial {
    fn default() -> Self {
        Self { cases: 48, fronts: 6, topology: Topology::Kept, folder: None, keep_seeds: true }
    }
}

/// What a trial without a finding did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// How often each law was checked, and held.
    pub checks: Summary,
    /// Cases that were judged.
    pub judged: u32,
    /// Cases that the subject does not take, and the reason of the last.
    pub refused: (u32, String),
    /// Of those judged: cases whose modifications merge vertices, so that hierarchies were judged too.
    pub merging: u32,
}

impl Tally {
    pub(super) fn add(&mut self, checks: &Summary) {
        checks.iter().for_each(|(&law, count)| *self.checks.entry(law).or_default() += count);
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cases, {} of them as hierarchies too, {} refused", self.judged, self.merging, self.refused.0)?;
        self.checks.iter().try_for_each(|(law, count)| write!(f, "\n  {law}: checked {count} times"))
    }
}

/// A law that is broken by what somebody wrote, with the smallest example and where it was written.
#[derive(Clone)]
pub struct Finding {
    /// What is judged: the name that it gives itself, or its type.
    pub subject: String,
    /// The law, and what is wrong in the smallest case.
    pub breach: Breach,
    /// The case as it was drawn: mesh, seed.
    pub drawn: String,
    /// How large it was, and how large it is now, in words.
    pub sizes: String,
    /// Cells of the input that is left.
    pub cells: usize,
    /// The mesh at which the law is broken, as OBJ.
    pub obj: String,
    /// The whole story: mesh, history, front.
    pub log: String,
    /// A test to paste.
    pub test: String,
    /// Where `obj`, `log` and `test` were written; empty where that was not possible.
    pub files: Vec<PathBuf>,
}

impl Finding {
    /// Writes the files, into the folder of a trial.
    pub(super) fn written(mut self, folder: Option<&PathBuf>) -> Self {
        self.files = keep::write(&self, folder);
        self
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.breach)?;
        writeln!(f, "  subject     {}", self.subject)?;
        writeln!(f, "  case        {}", self.drawn)?;
        writeln!(f, "  made small  {}", self.sizes)?;
        for file in &self.files {
            writeln!(f, "  written     {}", file.display())?;
        }
        if self.files.is_empty() {
            write!(f, "{}", self.log)?;
        }
        write!(f, "To see it again:\n{}", self.test)
    }
}

/// As it is displayed, since that is what `unwrap` shows.
impl fmt::Debug for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl std::error::Error for Finding {}

/// A breach of a law that is no model's: of what is asked of the subject itself.
pub(super) fn breach(law: Law, what: String) -> Breach {
    Breach { law, what, node: None }
}

/// Judges drawn cases until one fails; gives the smallest that proptest comes to. Seeds that failed are kept in a file
/// beside the caller's, and come first the next time.
///
/// # Panics
/// Where proptest gives up for a reason of its own.
pub(super) fn first_failure<V: Drawn, S: Strategy<Value = V>>(
    trial: &Trial,
    caller: &'static Location<'static>,
    strategy: &S,
    judge: &dyn Fn(&V) -> Result<(), Breach>,
) -> Option<V> {
    let asked_for = std::env::var_os("PROPTEST_CASES").is_some();
    let usual = Config::default();
    let persistence = match trial.keep_seeds {
        true => FileFailurePersistence::WithSource("proptest-regressions"),
        false => FileFailurePersistence::Off,
    };
    let config = Config {
        cases: if asked_for { usual.cases } else { trial.cases },
        source_file: Some(caller.file()),
        failure_persistence: Some(Box::new(persistence)),
        max_shrink_time: 15_000,
        ..usual
    };
    let judge = |case: V| judge(&case).map_err(|breach| TestCaseError::fail(breach.to_string()));
    match TestRunner::new(config).run(strategy, judge) {
        Ok(()) => None,
        Err(TestError::Fail(_, case)) => Some(case),
        Err(TestError::Abort(reason)) => panic!("the trial was given up: {reason}"),
    }
}

/// A trial that judged nothing has shown nothing.
///
/// # Panics
/// Then.
pub(super) fn insist(subject: &str, tally: &Tally) {
    let (refused, why) = &tally.refused;
    assert!(tally.judged > 0, "{subject} takes none of the {refused} cases drawn, so nothing was judged: {why}");
}

/// What a piece of somebody's code comes to; a panic is a breach of the law of conduct, and is not shown besides.
pub(super) fn guarded<T>(what: &str, run: impl FnOnce() -> T) -> Result<T, Breach> {
    static HUSH: Once = Once::new();
    thread_local!(static GUARDED: Cell<bool> = const { Cell::new(false) });
    // Making a case small repeats a panic a hundred times; those of other threads are shown as ever.
    HUSH.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !GUARDED.get() {
                usual(info);
            }
        }));
    });
    let before = GUARDED.replace(true);
    let ran = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run));
    GUARDED.set(before);
    ran.map_err(|panic| {
        let told = panic.downcast_ref::<String>().map(String::as_str);
        let told = told.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without a word");
        breach(Law::Conduct, format!("{what} panics: {told}"))
    })
}
