//! A report as Markdown.

use std::fmt::Write;

use super::pages::{Block, Section, Table};

/// Writes the sections below a title.
pub(super) fn write(title: &str, sections: &[Section]) -> String {
    let mut text = format!("# {title}\n");
    for section in sections {
        let _ = write!(text, "\n## {}\n", section.title);
        for block in &section.blocks {
            match block {
                Block::Text(words) => {
                    let _ = write!(text, "\n{}\n", plain(words));
                }
                Block::Table(table) => write_table(&mut text, table),
                Block::Figure { caption, .. } => {
                    let _ = write!(text, "\n*{} (the plot is in report.html)*\n", plain(caption));
                }
            }
        }
    }
    text
}

fn write_table(text: &mut String, table: &Table) {
    if !table.caption.is_empty() {
        let _ = write!(text, "\n**{}**\n", plain(&table.caption));
    }
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| plain(cell)).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let side = |column| if table.is_numeric(column) { "---:|" } else { "---|" };
    let rule: String = (0..table.head.len()).map(side).collect();
    let _ = write!(text, "\n{}|{rule}\n", line(&table.head));
    for row in &table.rows {
        text.push_str(&line(row));
    }
}

/// The text with every character escaped that Markdown would interpret.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars() {
        match c {
            '\n' => plain.push(' '),
            '|' | '*' | '_' | '`' | '<' | '\\' | '[' => plain.extend(['\\', c]),
            _ => plain.push(c),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_keep_their_columns_whatever_is_in_them() {
        let table = Table::new("", &["a", "b"], vec![vec!["x|y".into(), "7<i>\n".into()]]);
        let section = Section { title: "T".into(), blocks: vec![Block::Table(table)] };
        let text = write("R", &[section]);
        assert!(text.starts_with("# R\n\n## T\n"));
        assert!(text.contains("| a | b |\n|---|---:|\n| x\\|y | 7\\<i>  |\n"), "{text}");
    }
}
