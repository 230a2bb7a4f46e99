//! A report as one self-contained HTML page.

use std::fmt::Write;

use super::pages::{Block, Section, Table};

const STYLE: &str = "
:root { color-scheme: light dark; --edge: #8884; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 68rem; margin: 2rem auto; padding: 0 1rem; }
h1, h2 { line-height: 1.2; font-weight: 600; }
h2 { margin-top: 2.5rem; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: .4rem 0; }
th, td { padding: .25rem .7rem; border-bottom: 1px solid var(--edge); text-align: left; }
.number { text-align: right; white-space: nowrap; }
th { font-weight: 600; vertical-align: bottom; }
tr:hover td { background: #8881; }
.wide { overflow-x: auto; margin: 1rem 0; }
figure { margin: 1rem 0; }
figcaption { font-weight: 600; }
svg { max-width: 100%; height: auto; }
svg text { fill: currentColor; }
";

/// Writes the page.
pub(super) fn write(title: &str, sections: &[Section]) -> String {
    let title = escaped(title);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{title}</title>\n<style>{STYLE}</style>\n<h1>{title}</h1>\n"
    );
    for section in sections {
        let _ = writeln!(page, "<h2>{}</h2>", escaped(&section.title));
        for block in &section.blocks {
            match block {
                Block::Text(words) => {
                    let _ = writeln!(page, "<p>{}</p>", escaped(words));
                }
                Block::Table(table) => write_table(&mut page, table),
                Block::Figure { caption, svg } => {
                    let caption = escaped(caption);
                    let _ = writeln!(
                        page,
                        "<figure><figcaption>{caption}</figcaption>\n{svg}\n</figure>"
                    );
                }
            }
        }
    }
    page
}

fn write_table(page: &mut String, table: &Table) {
    page.push_str("<div class=\"wide\"><table>\n");
    if !table.caption.is_empty() {
        let _ = writeln!(page, "<caption>{}</caption>", escaped(&table.caption));
    }
    let line = |cells: &[String], tag: &str| {
        let cell = |(column, text): (usize, &String)| {
            let class = if table.is_numeric(column) { " class=\"number\"" } else { "" };
            format!("<{tag}{class}>{}</{tag}>", escaped(text))
        };
        let cells: String = cells.iter().enumerate().map(cell).collect();
        format!("<tr>{cells}</tr>\n")
    };
    page.push_str(&line(&table.head, "th"));
    for row in &table.rows {
        page.push_str(&line(row, "td"));
    }
    page.push_str("</table></div>\n");
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_become_markup() {
        let blocks = vec![
            Block::Text("a < b & c".into()),
            Block::Table(Table::new("<c>", &["<h>"], vec![vec!["<td>".into()]])),
        ];
        let page = write("<t>", &[Section { title: "<s>".into(), blocks }]);
        for markup in ["<t>", "<s>", "<c>", "<h>", "<td><td>", "a < b"] {
            assert!(!page.contains(markup), "{markup}");
        }
        assert!(page.contains("a &lt; b &amp; c"));
    }
}
