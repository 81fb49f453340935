//! What a paper has printed, read from a data file: numbers with the place where they stand.

use super::LedgerError;
use crate::table::{Align, Table};
use serde::Deserialize;

/// A paper, as its data file tells it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Its name in commands.
    pub name: String,
    /// Its key in `refs.bib`.
    pub key: String,
    /// Its title.
    pub title: String,
    /// Who wrote it.
    pub authors: String,
    /// On what it was measured.
    pub machine: String,
    /// Its tables, and what its text says that is held against ours.
    pub tables: Vec<PublishedTable>,
}

/// A table, or a statement of the text in the form of one.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedTable {
    /// Its name in commands.
    pub id: String,
    /// Where it stands. The texts that we have are without pages, so sections and slides are named.
    pub place: String,
    /// As printed.
    pub caption: String,
    /// Headings with units; ours are shorter.
    pub columns: Vec<String>,
    /// Rows, as printed.
    pub rows: Vec<Vec<Printed>>,
}

/// A cell as printed.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Printed {
    /// A number.
    Number(f64),
    /// Anything else; minutes and seconds as `8:20`.
    Text(String),
}

impl Printed {
    /// The number, or the seconds of minutes and seconds.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Text(text) => {
                let (minutes, seconds) = text.split_once(':')?;
                Some(minutes.parse::<f64>().ok()? * 60.0 + seconds.parse::<f64>().ok()?)
            }
        }
    }
}

impl std::fmt::Display for Printed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

impl Published {
    /// Reads a data file.
    pub fn read(json: &str) -> Result<Self, LedgerError> {
        let published: Self = serde_json::from_str(json).map_err(|error| LedgerError::Data(error.to_string()))?;
        for table in &published.tables {
            if let Some(row) = table.rows.iter().find(|row| row.len() != table.columns.len()) {
                let what = format!(
                    "{}, {}: a row of {} cells under {} headings",
                    published.name,
                    table.id,
                    row.len(),
                    table.columns.len()
                );
                return Err(LedgerError::Data(what));
            }
        }
        Ok(published)
    }

    /// The table of this name.
    pub fn table(&self, id: &str) -> Result<&PublishedTable, LedgerError> {
        let found = self.tables.iter().find(|table| table.id == id);
        found.ok_or_else(|| LedgerError::Data(format!("{} has no table {id}", self.name)))
    }
}

impl PublishedTable {
    /// A column of numbers; cells that are none are left out.
    pub fn column(&self, heading: &str) -> Result<Vec<f64>, LedgerError> {
        let at = self.place_of(heading)?;
        Ok(self.rows.iter().filter_map(|row| row[at].number()).collect())
    }

    /// A number by the first cell of its row and the heading of its column.
    pub fn number(&self, row: &str, heading: &str) -> Result<f64, LedgerError> {
        let at = self.place_of(heading)?;
        let is_row = |cells: &&Vec<Printed>| cells[0].to_string() == row;
        let found = self.rows.iter().find(is_row).and_then(|cells| cells[at].number());
        found.ok_or_else(|| LedgerError::Data(format!("{}: no number of {row} under {heading}", self.id)))
    }

    /// A quotient of two columns in each row.
    pub fn quotients(&self, above: &str, below: &str) -> Result<Vec<f64>, LedgerError> {
        let (above, below) = (self.column(above)?, self.column(below)?);
        Ok(above.iter().zip(below).map(|(above, below)| above / below).collect())
    }

    fn place_of(&self, heading: &str) -> Result<usize, LedgerError> {
        let found = self.columns.iter().position(|column| column == heading);
        found.ok_or_else(|| LedgerError::Data(format!("{}: no column {heading}", self.id)))
    }

    /// To be set.
    pub fn to_table(&self) -> Table {
        let is_number = |at: usize| !self.rows.is_empty() && self.rows.iter().all(|row| row[at].number().is_some());
        let align = |at: usize| if is_number(at) { Align::Number } else { Align::Text };
        Table {
            caption: format!("Published ({}): {}", self.place, self.caption),
            columns: self.columns.iter().enumerate().map(|(at, heading)| (heading.clone(), align(at))).collect(),
            rows: self.rows.iter().map(|row| row.iter().map(Printed::to_string).collect()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minutes_and_seconds_are_numbers() {
        let number = |text: &str| Printed::Text(text.into()).number();
        assert_eq!((number("8:20"), number("92:52"), number("log6 n")), (Some(500.0), Some(5572.0), None));
    }

    #[test]
    fn rows_are_as_long_as_their_headings() {
        let json = |row: &str| {
            format!(
                r#"{{"name": "a", "key": "b", "title": "", "authors": "", "machine": "", "tables":
                   [{{"id": "t", "place": "p", "caption": "", "columns": ["x", "y"], "rows": [{row}]}}]}}"#
            )
        };
        let good = Published::read(&json(r#"["m", 2.5]"#)).unwrap();
        let table = good.table("t").unwrap();
        assert_eq!((table.number("m", "y").unwrap(), table.column("y").unwrap()), (2.5, vec![2.5]));
        assert!(table.number("n", "y").is_err() && table.number("m", "z").is_err() && table.column("z").is_err());
        assert!(good.table("u").is_err());
        let error = Published::read(&json(r#"["m"]"#)).unwrap_err().to_string();
        assert!(error.contains("a row of 1 cells under 2 headings"), "{error}");
    }
}
