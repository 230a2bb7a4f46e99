//! A document as one self-contained HTML page.

use super::{Block, Table};

/// Opens the folds for a printer: those of older browsers ignore the style sheet's rule.
const OPEN_TO_PRINT: &str = "onbeforeprint=()=>{for(const d of \
     document.querySelectorAll('details'))d.open=true}";

/// Writes the page.
pub(super) fn write(title: &str, blocks: &[Block]) -> String {
    let (title, style) = (escaped(title), include_str!("style.css"));
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{style}</style>\n<script>{OPEN_TO_PRINT}</script>\n\
         <main>\n<h1>{title}</h1>\n{}</main>\n",
        written(blocks)
    )
}

fn written(blocks: &[Block]) -> String {
    let one = |block: &Block| match block {
        Block::Text(words) => format!("<p>{}</p>\n", escaped(words)),
        Block::Table(table) => written_table(table),
        Block::Plot(caption, plot) => {
            let (caption, svg) = (escaped(caption), plot.svg());
            format!("<figure><figcaption>{caption}</figcaption>\n{svg}</figure>\n")
        }
        Block::Fold(title, inside) => {
            let (title, inside) = (escaped(title), written(inside));
            format!("<details><summary>{title}</summary>\n{inside}</details>\n")
        }
    };
    blocks.iter().map(one).collect()
}

fn written_table(table: &Table) -> String {
    let line = |cells: &Vec<String>, tag: &str| {
        let cell = |(column, text): (usize, &String)| {
            let class = match (table.is_numeric(column), text.chars().count() > 40) {
                (true, _) => " class=\"number\"",
                (false, true) => " class=\"words\"",
                (false, false) => "",
            };
            format!("<{tag}{class}>{}</{tag}>", escaped(text))
        };
        let cells: String = cells.iter().enumerate().map(cell).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let caption = match escaped(&table.caption) {
        none if none.is_empty() => none,
        some => format!("<caption>{some}</caption>\n"),
    };
    let head = line(&table.head, "th");
    let rows: String = table.rows.iter().map(|row| line(row, "td")).collect();
    format!(
        "<div class=\"wide\"><table>\n{caption}<thead>\n{head}</thead>\n<tbody>\n{rows}</tbody>\n\
         </table></div>\n"
    )
}

/// The text with every character escaped that could begin or end markup.
pub(super) fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;").replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use super::super::{fold, text};
    use super::*;

    #[test]
    fn text_cannot_become_markup() {
        let bold = || "a<b>&\"'".to_string();
        let table = Table { caption: bold(), head: vec![bold()], rows: vec![vec![bold()]] };
        let page =
            write(&bold(), &[fold(&bold(), vec![text(&bold()), Block::Table(table)]).unwrap()]);
        // Two titles, a fold, a paragraph, a caption, a head and a cell.
        assert_eq!(page.matches("a&lt;b&gt;&amp;&quot;&#39;").count(), 7);
        assert!(!page.contains("a<b"));
    }
}
