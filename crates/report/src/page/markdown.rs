//! A document as Markdown.

use super::html::escaped;
use super::{Block, Table};

/// Writes the blocks below a title.
pub(super) fn write(title: &str, blocks: &[Block]) -> String {
    format!("# {}\n{}", plain(title), written(blocks))
}

fn written(blocks: &[Block]) -> String {
    let one = |block: &Block| match block {
        Block::Text(words) => format!("\n{}\n", plain(words)),
        Block::Table(table) => written_table(table),
        Block::Plot(caption, _) => format!("\n*{} (the plot is in report.html)*\n", plain(caption)),
        Block::Fold(title, inside) => {
            let (title, inside) = (escaped(title), written(inside));
            format!("\n<details><summary>{title}</summary>\n{inside}\n</details>\n")
        }
    };
    blocks.iter().map(one).collect()
}

fn written_table(table: &Table) -> String {
    let caption = match plain(&table.caption) {
        none if none.is_empty() => none,
        some => format!("\n**{some}**\n"),
    };
    let line = |cells: &Vec<String>| {
        let cells: Vec<String> = cells.iter().map(|cell| plain(cell)).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let side = |column| if table.is_numeric(column) { "---:|" } else { "---|" };
    let rule: String = (0..table.head.len()).map(side).collect();
    let rows: String = table.rows.iter().map(line).collect();
    format!("{caption}\n{}|{rule}\n{rows}", line(&table.head))
}

/// The text with every character escaped that Markdown would interpret.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars() {
        match c {
            '\n' => plain.push(' '),
            '|' | '*' | '_' | '`' | '<' | '&' | '\\' | '[' => plain.extend(['\\', c]),
            _ => plain.push(c),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::super::{fold, text};
    use super::*;

    #[test]
    fn tables_keep_their_columns_and_folds_their_titles_whatever_is_in_them() {
        let rows = vec![vec!["x|y".into(), "7<i>\n".into()]];
        let table = Table { caption: String::new(), head: vec!["a".into(), "b".into()], rows };
        let blocks = fold("<T>", vec![text("a_b"), Block::Table(table)]);
        assert_eq!(
            write("R", blocks.as_slice()),
            "# R\n\n<details><summary>&lt;T&gt;</summary>\n\na\\_b\n\n\
             | a | b |\n|---|---:|\n| x\\|y | 7\\<i>  |\n\n</details>\n"
        );
    }
}
