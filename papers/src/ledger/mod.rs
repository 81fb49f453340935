//! The ledger: tables and figures of the papers that are implemented here, what they say beside what comes out.
//!
//! ```text
//! published/*.json ─▶ Published ─┐
//! Shelf (files, or none) ─▶ Workshop ─▶ Item::run ─▶ Entry { tables, claims, figures } ─▶ Markdown, CSV, pictures
//! ```
//!
//! A paper is a data file and a list of items, an item is a function that fills an entry. What a paper says is a claim, and
//! measuring decides whether it holds; a claim that does not hold comes with a reason. Counts come before times, and times
//! are told as ratios of one run.

mod entry;
mod pages;
mod paint;
mod published;
mod raster;
mod roles;
mod workshop;

pub use entry::{Claim, Entry, Figure, Verdict};
pub use pages::{ledger, markdown};
pub(crate) use paint::{Brush, close_up, share};
pub use published::{Printed, Published, PublishedTable};
pub use raster::{Coding, Raster};
pub(crate) use roles::{BUNNY, COW, HORSE, edge_collapse, fuji};
pub use workshop::{Bare, Grid, Role, Sequenced, Shelf, Size, Subject, Workshop};

use mt_core::analysis::AnalysisError;
use mt_core::hierarchy::HierarchyError;
use std::time::Instant;

/// A paper that is reproduced.
pub struct Paper {
    /// What it has printed, as JSON: see [`Published`].
    pub data: &'static str,
    /// What is reproduced of it, in its order.
    pub items: &'static [Item],
}

/// A table or figure, and how it is reproduced.
pub struct Item {
    /// Its name in commands: `table-2`, `figure-10`.
    pub id: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// Fills its entry.
    pub run: fn(&mut Workshop<'_>, &Published, &mut Entry) -> Result<(), LedgerError>,
}

/// The papers, in the order of the ledger.
pub static PAPERS: [Paper; 5] = [
    crate::fan_hierarchy::PAPER,
    crate::truly_selective::PAPER,
    crate::generalized::PAPER,
    crate::multi_tessellation::PAPER,
    crate::strips::PAPER,
];

/// Why an entry could not be made.
#[derive(Debug, thiserror::Error)]
pub enum LedgerError {
    /// A data file is wrong, which is a fault of the program.
    #[error("{0}")]
    Data(String),
    /// No paper has the name.
    #[error("there is no paper `{name}`; there are {names}")]
    Paper {
        /// What was asked for.
        name: String,
        /// What there is.
        names: String,
    },
    /// The paper has no such table or figure.
    #[error("{paper} has no `{name}`; there are {names}")]
    Item {
        /// The paper.
        paper: String,
        /// What was asked for.
        name: String,
        /// What there is.
        names: String,
    },
    /// A model cannot be read.
    #[error("{0}: {1}")]
    Model(String, String),
    /// An operator could not take a model.
    #[error("{0}: {1}")]
    Analysis(String, AnalysisError),
    /// A sequence has no vertex hierarchy, or a scheme does not take it.
    #[error("{0}: {1}")]
    Hierarchy(String, HierarchyError),
    /// A picture could not be drawn.
    #[error("the picture {0} cannot be drawn: {1}")]
    Picture(String, render::RenderError),
    /// Somebody asked to stop.
    #[error("interrupted; nothing was written")]
    Cancelled,
}

impl Paper {
    /// What it has printed.
    pub fn published(&self) -> Result<Published, LedgerError> {
        Published::read(self.data)
    }

    /// Makes the entry of one of its items.
    pub fn entry(&self, item: &Item, workshop: &mut Workshop<'_>) -> Result<Entry, LedgerError> {
        let published = self.published()?;
        workshop.go_on(&format!("{} {}", published.name, item.id))?;
        let mut entry = Entry {
            paper: published.name.clone(),
            id: item.id.to_owned(),
            title: item.title.to_owned(),
            published: published.table(item.id).ok().map(PublishedTable::to_table),
            ..Entry::default()
        };
        let begun = Instant::now();
        (item.run)(workshop, &published, &mut entry)?;
        entry.seconds = begun.elapsed().as_secs_f64();
        Ok(entry)
    }
}

/// The paper of this name.
pub fn paper(name: &str) -> Result<&'static Paper, LedgerError> {
    let mut names = Vec::new();
    for paper in &PAPERS {
        let published = paper.published()?;
        if plain(&published.name) == plain(name) || published.key == name {
            return Ok(paper);
        }
        names.push(published.name);
    }
    Err(LedgerError::Paper { name: name.to_owned(), names: names.join(", ") })
}

/// The item of a paper by its name, however that is written: `table-2`, `Table 2`, `fig. 10`.
pub fn item(paper: &'static Paper, name: &str) -> Result<&'static Item, LedgerError> {
    let wanted = plain(name);
    let found = paper.items.iter().find(|item| plain(item.id) == wanted);
    found.ok_or_else(|| LedgerError::Item {
        paper: paper.published().map_or_else(|error| error.to_string(), |published| published.name),
        name: name.to_owned(),
        names: paper.items.iter().map(|item| item.id).collect::<Vec<_>>().join(", "),
    })
}

/// Letters and digits alone, `figure` for `fig`.
fn plain(name: &str) -> String {
    let text: String = name.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    match text.strip_prefix("fig").map(|rest| rest.strip_prefix("ure").unwrap_or(rest)) {
        Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => format!("figure{rest}"),
        _ => text,
    }
}

/// Makes entries, one after the other. What is made of the models of a paper is forgotten when the next one begins.
pub fn entries(
    items: &[(&'static Paper, &'static Item)],
    workshop: &mut Workshop<'_>,
) -> Result<Vec<Entry>, LedgerError> {
    let mut entries: Vec<Entry> = Vec::with_capacity(items.len());
    for (i, (paper, item)) in items.iter().enumerate() {
        if i > 0 && !std::ptr::eq(items[i - 1].0, *paper) {
            workshop.clear();
        }
        workshop.at(i as f32 / items.len() as f32);
        entries.push(paper.entry(item, workshop)?);
    }
    Ok(entries)
}

/// All items of all papers.
pub fn all() -> Vec<(&'static Paper, &'static Item)> {
    PAPERS.iter().flat_map(|paper| paper.items.iter().map(move |item| (paper, item))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn papers_and_items_are_found_however_they_are_written() {
        let fans = paper("fan-hierarchy").unwrap();
        for name in ["table-2", "Table 2", "TABLE2"] {
            assert_eq!(item(fans, name).unwrap().id, "table-2");
        }
        for name in ["figure-10", "Fig. 10", "fig10", "Figure 10"] {
            assert_eq!(item(fans, name).unwrap().id, "figure-10");
        }
        let error = item(fans, "table-9").map(|item| item.id).unwrap_err().to_string();
        assert!(error.contains("table-9") && error.contains("table-3"), "{error}");
        let error = paper("fans").map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("truly-selective"), "{error}");
    }

    #[test]
    fn every_data_file_is_read_and_every_printed_table_has_an_item() {
        for paper in &PAPERS {
            let published = paper.published().unwrap();
            for table in &published.tables {
                assert!(item(paper, &table.id).is_ok(), "{} {}", published.name, table.id);
            }
        }
    }
}
