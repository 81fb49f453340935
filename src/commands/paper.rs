//! `mtess paper`: tables and figures of papers, what they say beside what comes out here.

use super::{CommandError, print_text};
use crate::files;
use crate::memory;
use crate::progress::Progress;
use clap::Args;
use papers::ledger::{
    self, Bare, Entry, Item, LedgerError, PAPERS, Paper as Reproduced, Shelf, Size, Verdict, Workshop,
};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The folder of models, by the variable of the environment that names it.
const DATA: &str = "MT_DATA";

#[derive(Args)]
pub struct Paper {
    /// The paper: fan-hierarchy, truly-selective, generalized, multi-tessellation or strips; without any, what there is is listed
    paper: Option<String>,
    /// A table or figure of it, as in table-2 or fig10; without any, all of them
    #[arg(requires = "paper")]
    item: Option<String>,
    /// Make the whole ledger: LEDGER.md, and tables and pictures in the folder `ledger` beside it
    #[arg(long, conflicts_with = "paper")]
    all: bool,
    /// Where to write; if not set, the folder `paper`, and for a ledger of real models the folder `papers`
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Small generated models, as tests use them, whatever MT_DATA names
    #[arg(long)]
    small: bool,
}

impl Paper {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        let wrong = |error: LedgerError| CommandError::Other(error.to_string());
        let items = match &self.paper {
            _ if self.all => ledger::all(),
            None => {
                print_text(&listing().map_err(wrong)?);
                return Ok(ExitCode::SUCCESS);
            }
            Some(name) => chosen(name, self.item.as_deref()).map_err(wrong)?,
        };
        // A ledger of generated models is not to take the place of one of real ones by a slip of the hand.
        let default = if self.all && self.of_files() { "papers" } else { "paper" };
        let folder = self.output.clone().unwrap_or_else(|| default.into());
        let new_folder = files::make_folder(&folder)?;
        files::check_writable(&folder)?;
        // Minutes of work are not to end at a place that cannot be written.
        if self.all {
            files::make_folder(&folder.join("ledger"))?;
            files::check_place(&folder.join("LEDGER.md"))?;
        }
        let made = self.make(&items);
        if made.is_err() {
            files::remove_empty_folder(&folder.join("ledger"));
        }
        if made.is_err() && new_folder {
            files::remove_empty_folder(&folder);
        }
        let entries = made?;
        self.write(&entries, &folder)?;
        Ok(ExitCode::SUCCESS)
    }

    /// Whether models of files are looked for.
    fn of_files(&self) -> bool {
        !self.small && data().is_some()
    }

    fn make(&self, items: &[(&'static Reproduced, &'static Item)]) -> Result<Vec<Entry>, CommandError> {
        let mut shelf = shelf(self.small)?;
        let size = if self.small { Size::Small } else { Size::Full };
        let mut progress = Progress::new("reproducing", 1000);
        let mut watch = |_: &str, share: f32| progress.at((share * 1000.0) as u64);
        let mut workshop = Workshop::new(size, &mut *shelf, &mut watch);
        ledger::entries(items, &mut workshop).map_err(|error| match error {
            LedgerError::Cancelled => CommandError::Interrupted,
            error => CommandError::Other(error.to_string()),
        })
    }

    fn write(&self, entries: &[Entry], folder: &Path) -> Result<(), CommandError> {
        let beside = if self.all { folder.join("ledger") } else { folder.to_owned() };
        files::make_folder(&beside)?;
        for entry in entries {
            let stem = format!("{}-{}", entry.paper, entry.id);
            for (i, table) in entry.measured.iter().enumerate() {
                let number = if entry.measured.len() > 1 { format!("-{}", i + 1) } else { String::new() };
                files::write_bytes(&beside.join(format!("{stem}{number}.csv")), table.csv().as_bytes())?;
            }
            for figure in &entry.figures {
                files::write_bytes(&beside.join(&figure.name), &figure.bytes)?;
            }
        }
        // The text comes last: where it is, everything it tells of is.
        let (name, text) = if self.all {
            let text = ledger::ledger(entries, &told(self.of_files()))
                .map_err(|error| CommandError::Other(error.to_string()))?;
            ("LEDGER.md".to_owned(), text)
        } else {
            (file_of(entries), entries.iter().map(ledger::markdown).collect())
        };
        files::write_bytes(&folder.join(&name), text.as_bytes())?;
        print_text(&summary(entries, &folder.join(name)));
        Ok(())
    }
}

/// One sentence on models and threads, for whoever reads times.
fn told(of_files: bool) -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let models = if of_files {
        "on models of files, and generated ones where a line says so"
    } else {
        "on generated models alone"
    };
    let (version, machine) = (env!("CARGO_PKG_VERSION"), std::env::consts::ARCH);
    format!("This one was made by version {version} {models}, on {machine} with {cores} threads at hand.")
}

fn data() -> Option<PathBuf> {
    std::env::var_os(DATA).filter(|name| !name.is_empty()).map(PathBuf::from)
}

/// Files of models in a folder.
struct Folder(PathBuf);

impl Shelf for Folder {
    fn bytes(&mut self, file: &str) -> Result<Option<Vec<u8>>, LedgerError> {
        let path = self.0.join(file);
        if !path.exists() {
            eprintln!("{}: no such file; something generated stands in for it", path.display());
            return Ok(None);
        }
        let wrong = |error: &dyn std::fmt::Display| LedgerError::Model(file.to_owned(), error.to_string());
        let length = files::length(&path).map_err(|error| wrong(&error))?;
        memory::allow("making models of it", memory::of_loading_mesh(length)).map_err(|error| wrong(&error))?;
        files::read(&path).map(Some).map_err(|error| wrong(&error))
    }
}

fn shelf(small: bool) -> Result<Box<dyn Shelf>, CommandError> {
    if small {
        return Ok(Box::new(Bare));
    }
    let Some(folder) = data() else {
        eprintln!("MT_DATA names no folder of models: generated ones stand in for them");
        return Ok(Box::new(Bare));
    };
    files::check_folder(&folder)
        .map_err(|error| CommandError::Other(format!("{DATA} names no folder of models: {error}")))?;
    Ok(Box::new(Folder(folder)))
}

fn chosen(paper: &str, item: Option<&str>) -> Result<Vec<(&'static Reproduced, &'static Item)>, LedgerError> {
    let paper = ledger::paper(paper)?;
    Ok(match item {
        Some(name) => vec![(paper, ledger::item(paper, name)?)],
        None => paper.items.iter().map(|item| (paper, item)).collect(),
    })
}

/// Papers and what is reproduced of them.
fn listing() -> Result<String, LedgerError> {
    let mut lines = Vec::new();
    for paper in &PAPERS {
        let published = paper.published()?;
        lines.push(format!("{}: {} ({})", published.name, published.title, published.authors));
        lines.extend(paper.items.iter().map(|item| format!("    {:14} {}", item.id, item.title)));
    }
    lines.push("`mtess paper NAME ITEM` makes one of them, `mtess paper --all` the ledger".into());
    Ok(lines.join("\n"))
}

/// What the text of these entries is called.
fn file_of(entries: &[Entry]) -> String {
    match entries {
        [entry] => format!("{}-{}.md", entry.paper, entry.id),
        _ => format!("{}.md", entries.first().map_or("paper", |entry| &entry.paper)),
    }
}

/// A line an entry, with what does not hold.
fn summary(entries: &[Entry], at: &Path) -> String {
    let mut lines = Vec::new();
    for entry in entries {
        let count = |verdict| entry.count(verdict, false) + entry.count(verdict, true);
        lines.push(format!(
            "{} {}: {} claims hold, {} differ, {} stay open; {:.1} s",
            entry.paper,
            entry.id,
            count(Verdict::Holds),
            count(Verdict::Differs),
            count(Verdict::Open),
            entry.seconds
        ));
        let differing = entry.claims.iter().filter(|claim| claim.verdict == Verdict::Differs);
        lines.extend(differing.map(|claim| format!("    differs: {}; {}", claim.says, claim.finds)));
    }
    lines.push(format!("read {}", at.display()));
    lines.join("\n")
}
