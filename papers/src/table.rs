//! A table as plain data, and its text as Markdown and CSV; `html` sets it in a page.

/// How the cells of a column are set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// Text, from the left.
    #[default]
    Text,
    /// Numbers, to the right, in figures of one width.
    Number,
}

/// A table as text; whoever sets it escapes everything in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Written above; may be empty.
    pub caption: String,
    /// Heading and alignment of each column.
    pub columns: Vec<(String, Align)>,
    /// Cells, row by row; a short row ends in empty cells, and cells beyond the columns are dropped.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table under headings that stand between bars: `"model | #triangles"`. A column is of numbers where its
    /// heading begins with `#`, which is taken off.
    pub fn new(caption: &str, headings: &str) -> Self {
        let column = |heading: &str| match heading.strip_prefix('#') {
            Some(heading) => (heading.to_owned(), Align::Number),
            None => (heading.to_owned(), Align::Text),
        };
        Self { caption: caption.to_owned(), columns: headings.split(" | ").map(column).collect(), rows: Vec::new() }
    }

    /// Appends a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl ToString>) -> &mut Self {
        self.rows.push(cells.into_iter().map(|cell| cell.to_string()).collect());
        self
    }

    fn cells<'a>(&'a self, row: &'a [String]) -> impl Iterator<Item = &'a str> {
        (0..self.columns.len()).map(|i| row.get(i).map_or("", String::as_str))
    }

    /// The table in Markdown, its caption above it. Bars and line ends in cells are escaped.
    pub fn markdown(&self) -> String {
        let escape = |text: &str| text.replace('|', "\\|").replace(['\n', '\r'], " ");
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        let mut text = if self.caption.is_empty() { String::new() } else { format!("{}\n\n", self.caption) };
        text += &line(self.columns.iter().map(|(heading, _)| escape(heading)).collect());
        let rule = |align: Align| if align == Align::Number { " ---: |" } else { " --- |" };
        text += &format!("|{}\n", self.columns.iter().map(|(_, align)| rule(*align)).collect::<String>());
        for row in &self.rows {
            text += &line(self.cells(row).map(escape).collect());
        }
        text
    }

    /// The table as CSV (RFC 4180), headings first, without the caption.
    pub fn csv(&self) -> String {
        let quote = |text: &str| {
            if text.contains(['"', ',', '\n', '\r']) {
                format!("\"{}\"", text.replace('"', "\"\""))
            } else {
                text.to_owned()
            }
        };
        let mut text = self.columns.iter().map(|(heading, _)| quote(heading)).collect::<Vec<_>>().join(",") + "\n";
        for row in &self.rows {
            text += &(self.cells(row).map(quote).collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cannot_break_out_of_their_table() {
        let mut table = Table::new("what | is", "name | #count");
        table.row(["a|b\nc", "1"]).row(["\"q\", r"]);
        assert_eq!(
            table.markdown(),
            "what | is\n\n| name | count |\n| --- | ---: |\n| a\\|b c | 1 |\n| \"q\", r |  |\n"
        );
        assert_eq!(table.csv(), "name,count\n\"a|b\nc\",1\n\"\"\"q\"\", r\",\n");
    }
}
