//! One page of HTML that needs no other file: headings, paragraphs, tables, and pictures within the text.

pub use crate::table::{Align, Table};

/// A picture among others.
#[derive(Clone, Copy, Debug)]
pub struct Shot<'a> {
    /// The bytes of a PNG file, which are part of the page.
    pub png: &'a [u8],
    /// What it shows.
    pub caption: &'a str,
    /// What makes it; may be empty.
    pub command: &'a str,
}

/// A page on its way: each call adds a block at the end.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    body: String,
}

impl Page {
    /// An empty page; the title is also its first heading.
    pub fn new(title: &str) -> Self {
        Self { title: title.into(), body: format!("<h1>{}</h1>\n", escape(title)) }
    }

    /// A heading below the title, level 2 (section) to 4.
    pub fn heading(&mut self, level: u8, text: &str) -> &mut Self {
        let level = level.clamp(2, 4);
        self.raw(&format!("<h{level}>{}</h{level}>", escape(text)))
    }

    /// A paragraph of plain text.
    pub fn paragraph(&mut self, text: &str) -> &mut Self {
        self.raw(&format!("<p>{}</p>", escape(text)))
    }

    /// A block of text set as it stands, in figures of one width.
    pub fn verbatim(&mut self, text: &str) -> &mut Self {
        self.raw(&format!("<pre>{}</pre>", escape(text)))
    }

    /// A list of plain texts.
    pub fn list<S: AsRef<str>>(&mut self, items: impl IntoIterator<Item = S>) -> &mut Self {
        let items: String = items.into_iter().map(|item| format!("<li>{}</li>\n", escape(item.as_ref()))).collect();
        self.raw(&format!("<ul>\n{items}</ul>"))
    }

    /// A table; a wide one scrolls on its own.
    pub fn table(&mut self, table: &Table) -> &mut Self {
        let cell = |tag: &str, text: &str, align: Align| {
            let class = if align == Align::Number { " class=\"number\"" } else { "" };
            format!("<{tag}{class}>{}</{tag}>", escape(text))
        };
        let head: String = table.columns.iter().map(|(text, align)| cell("th", text, *align)).collect();
        let row = |cells: &Vec<String>| {
            let text = |i: usize| cells.get(i).map_or("", String::as_str);
            let cells: String =
                table.columns.iter().enumerate().map(|(i, (_, align))| cell("td", text(i), *align)).collect();
            format!("<tr>{cells}</tr>\n")
        };
        let rows: String = table.rows.iter().map(row).collect();
        let caption = if table.caption.is_empty() {
            String::new()
        } else {
            format!("<caption>{}</caption>\n", escape(&table.caption))
        };
        self.raw(&format!(
            "<div class=\"wide\"><table>\n{caption}<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>"
        ))
    }

    /// A figure with an `<svg>` element, which is trusted and goes in as it is.
    pub fn figure_svg(&mut self, svg: &str, caption: &str) -> &mut Self {
        self.raw(&figure(svg, caption))
    }

    /// A figure with the bytes of a PNG file; `caption` is also what is read out in its place.
    pub fn figure_png(&mut self, png: &[u8], caption: &str) -> &mut Self {
        self.raw(&figure(&image(png, caption), caption))
    }

    /// Figures side by side where there is room; each fills the window when it is clicked, and says what makes it.
    pub fn gallery<'a>(&mut self, shots: impl IntoIterator<Item = Shot<'a>>) -> &mut Self {
        let shown = |shot: Shot<'_>| {
            let image = image(shot.png, shot.caption);
            let picture = format!("<details class=\"shot\"><summary>{image}</summary></details>");
            let command = if shot.command.is_empty() {
                String::new()
            } else {
                format!("<details><summary>the command</summary><pre>{}</pre></details>", escape(shot.command))
            };
            format!("<figure>{picture}<figcaption>{}{command}</figcaption></figure>\n", escape(shot.caption))
        };
        let figures: String = shots.into_iter().map(shown).collect();
        self.raw(&format!("<div class=\"gallery\">\n{figures}</div>"))
    }

    /// A block of HTML, which is trusted and goes in as it is.
    pub fn raw(&mut self, html: &str) -> &mut Self {
        self.body.push_str(html);
        self.body.push('\n');
        self
    }

    /// The whole page.
    pub fn finish(&self) -> String {
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
            escape(&self.title),
            self.body
        )
    }
}

/// The text with the five characters that mean something in HTML replaced; safe in elements and quoted attributes.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            other => escaped.push(other),
        }
    }
    escaped
}

fn figure(picture: &str, caption: &str) -> String {
    let caption =
        if caption.is_empty() { String::new() } else { format!("<figcaption>{}</figcaption>", escape(caption)) };
    format!("<figure>{picture}{caption}</figure>")
}

fn image(png: &[u8], description: &str) -> String {
    format!("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escape(description), base64(png))
}

/// Base64 with padding (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let six = (bits >> (18 - 6 * digit)) & 63;
            text.push(if digit <= chunk.len() { char::from(DIGITS[six as usize]) } else { '=' });
        }
    }
    text
}

const STYLE: &str = "\
:root { color-scheme: light dark; --text: #1d1f21; --page: #fdfdfb; --line: #d4d4ce; --quiet: #63655f; --shade: #f3f3ee; }
@media (prefers-color-scheme: dark) {
  :root { --text: #dcdcd6; --page: #17181a; --line: #3b3d40; --quiet: #9a9c96; --shade: #202225; }
}
body { margin: 0; background: var(--page); color: var(--text); font: 17px/1.55 system-ui, sans-serif; }
main { max-width: 76rem; margin: 0 auto; padding: 2.5rem 1.25rem 5rem; }
h1, h2, h3, h4 { line-height: 1.2; font-weight: 650; text-wrap: balance; }
h1 { font-size: 2rem; margin: 0 0 1.5rem; }
h2 { font-size: 1.4rem; margin: 3rem 0 0.75rem; }
h3 { font-size: 1.12rem; margin: 2rem 0 0.5rem; }
h4 { font-size: 1rem; margin: 1.5rem 0 0.25rem; }
p, ul { max-width: 42rem; margin: 0.75rem 0; }
pre { overflow-x: auto; padding: 0.75rem 1rem; background: var(--shade); font: 0.85rem/1.45 ui-monospace, monospace; }
.wide { overflow-x: auto; margin: 1.25rem 0; }
table { border-collapse: collapse; font-size: 0.88rem; line-height: 1.35; }
caption { text-align: left; color: var(--quiet); padding-bottom: 0.4rem; }
th, td { padding: 0.32rem 0.8rem; text-align: left; vertical-align: baseline; border-bottom: 1px solid var(--line); }
th { font-weight: 600; vertical-align: bottom; border-bottom: 2px solid var(--line); }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
td { white-space: nowrap; }
figure { margin: 1.5rem 0; }
figure img { max-width: 100%; height: auto; }
figcaption { color: var(--quiet); font-size: 0.88rem; max-width: 42rem; margin-top: 0.4rem; }
.gallery { display: grid; grid-template-columns: repeat(auto-fit, minmax(16rem, 1fr)); gap: 1rem; margin: 1.5rem 0; }
.gallery figure { margin: 0; }
.shot summary { list-style: none; cursor: zoom-in; }
.shot[open] img { position: fixed; inset: 0; width: 100%; height: 100%; object-fit: contain; background: var(--page); z-index: 1; cursor: zoom-out; }
details { font-size: 0.85rem; }
details pre { white-space: pre-wrap; }
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_five_characters_are_escaped() {
        assert_eq!(
            escape("<a href=\"x\">'&amp;'</a> é"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;amp;&#39;&lt;/a&gt; é"
        );
    }

    #[test]
    fn nothing_that_is_text_becomes_a_tag() {
        let evil = "</title><script>\"'";
        let mut page = Page::new(evil);
        let table = Table {
            caption: evil.into(),
            columns: vec![(evil.into(), Align::Number)],
            rows: vec![vec![evil.into(), "beyond".into()], vec![]],
        };
        page.heading(2, evil).paragraph(evil).verbatim(evil).list([evil]).table(&table);
        let shot = Shot { png: b"png", caption: evil, command: evil };
        page.figure_png(b"png", evil).figure_svg("<svg/>", evil).gallery([shot]);
        let html = page.finish();
        assert!(!html.contains("<script") && html.matches("</title>").count() == 1);
        assert!(!html.contains("beyond") && html.contains("<td class=\"number\"></td>"));
        // The tags, as opened, are all ours.
        let escaped = "&lt;/title&gt;&lt;script&gt;&quot;&#39;";
        assert!(html.contains(&format!("<img alt=\"{escaped}\" src=")));
        assert_eq!(html.matches(escaped).count(), 15);
    }

    #[test]
    fn the_page_stands_alone() {
        let html = Page::new("Study").heading(9, "deep").finish();
        assert!(html.starts_with("<!DOCTYPE html>") && html.contains("<h4>deep</h4>"));
        assert!(!html.contains("http"), "a page that fetches nothing");
    }

    #[test]
    fn base64_of_the_standard() {
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(texts, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
        assert_eq!(base64(&[0xfb, 0xff, 0xbf]), "+/+/");
    }
}
