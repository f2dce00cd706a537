//! Headings, paragraphs, tables and pictures, rendered as Markdown or for a terminal.

use std::fmt::Write;

use textwrap::WordSplitter;

/// Width of a terminal, in columns.
const COLUMNS: usize = 80;
/// Least width to which a text column is narrowed to fit the terminal.
const NARROWEST: usize = 20;

/// A part of a page.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// The heading of a section.
    Heading(String),
    /// A heading within a section.
    Subheading(String),
    /// A paragraph.
    Text(String),
    /// A table.
    Table(Table),
    /// A picture. Terminals show its file name and caption.
    Picture(Picture),
}

/// A rendered figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The file name, without extension.
    pub name: &'static str,
    /// The caption.
    pub caption: &'static str,
    /// The figure as an SVG document.
    pub svg: String,
}

/// The name of a column, and the function that formats an item as its cell.
pub type Column<'a, T> = (&'a str, &'a dyn Fn(&T) -> String);

/// A header and rows. The first column and text columns are left-aligned, numbers right-aligned.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The names of the columns.
    pub header: Vec<String>,
    /// The cells. Each row has as many as the header.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates an empty table with these columns.
    pub fn new<T: Into<String>>(header: impl IntoIterator<Item = T>) -> Self {
        Self {
            header: header.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Creates a table with a row for each item.
    pub fn of<T>(items: impl IntoIterator<Item = T>, columns: &[Column<'_, T>]) -> Self {
        let mut table = Self::new(columns.iter().map(|(name, _)| *name));
        let row = |item| columns.iter().map(|(_, cell)| cell(&item)).collect();
        table.rows = items.into_iter().map(row).collect();
        table
    }

    /// Removes the columns accepted by `is_dull` whose cells are the same in every row.
    pub fn without_dull(mut self, is_dull: impl Fn(&str) -> bool) -> Self {
        let same = |column: usize| {
            let mut cells = self.rows.iter().map(|row| &row[column]);
            let first = cells.next();
            cells.all(|cell| Some(cell) == first)
        };
        let kept: Vec<bool> = self
            .header
            .iter()
            .enumerate()
            .map(|(column, name)| !(is_dull(name) && same(column)))
            .collect();
        for row in std::iter::once(&mut self.header).chain(&mut self.rows) {
            let mut keep = kept.iter();
            row.retain(|_| keep.next().is_none_or(|kept| *kept));
        }
        self
    }

    fn widths(&self) -> Vec<usize> {
        let width = |column: usize| {
            let cells = self.rows.iter().map(|row| &row[column]);
            let widest = cells
                .chain([&self.header[column]])
                .map(|cell| cell.chars().count());
            widest.max().unwrap_or(0)
        };
        (0..self.header.len()).map(width).collect()
    }

    /// Returns for each column whether every cell begins with a digit. Such columns are
    /// right-aligned. The first column never is. Reads every cell: call it once per table.
    pub fn numbers(&self) -> Vec<bool> {
        let numeric = |cell: &String| {
            let bare = cell.trim_start_matches(['+', '-', '−', '<', ' ', '–']);
            bare.is_empty() || bare.starts_with(|c: char| c.is_ascii_digit())
        };
        let is_number = |column| column > 0 && self.rows.iter().all(|row| numeric(&row[column]));
        (0..self.header.len()).map(is_number).collect()
    }

    fn markdown(&self) -> String {
        let columns = Columns {
            widths: self.widths(),
            numbers: self.numbers(),
        };
        let rule = |(&width, &is_number): (&usize, &bool)| {
            let dashes = "-".repeat(width.saturating_sub(1));
            if is_number {
                dashes + ":"
            } else {
                ":".to_owned() + &dashes
            }
        };
        let rules = columns.widths.iter().zip(&columns.numbers).map(rule);
        let mut text = format!(
            "| {} |\n| {} |\n",
            columns.line(&self.header, " | "),
            rules.collect::<Vec<_>>().join(" | ")
        );
        for row in &self.rows {
            let _ = writeln!(text, "| {} |", columns.line(row, " | "));
        }
        text
    }

    /// Formats the table for a terminal. A row takes several lines if its words need them. A table
    /// that is still too wide is split into several tables, each with the leading text columns.
    pub fn text(&self) -> String {
        let parts = self.parts();
        let texts: Vec<String> = parts.iter().map(Self::whole_text).collect();
        texts.join("\n")
    }

    /// Splits the table into tables that fit a terminal, where possible. Each begins with the
    /// columns before the first number.
    fn parts(&self) -> Vec<Self> {
        if across(&self.fitted()) <= COLUMNS {
            return vec![self.clone()];
        }
        let columns = self.header.len();
        let keys = self.numbers().iter().take_while(|number| !**number).count();
        let mut widths = self.widths();
        let surplus = across(&widths[..keys]).saturating_sub(COLUMNS / 2);
        if let Some(widest) = (0..keys).max_by_key(|&column| widths[column]) {
            widths[widest] = widths[widest]
                .saturating_sub(surplus)
                .max(NARROWEST.min(widths[widest]));
        }
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for column in keys..columns {
            let fits = |part: &Vec<usize>| {
                let shown = (0..keys).chain(part.iter().copied()).chain([column]);
                across(&shown.map(|column| widths[column]).collect::<Vec<_>>()) <= COLUMNS
            };
            match parts.last_mut().filter(|part| fits(part)) {
                Some(part) => part.push(column),
                None => parts.push(vec![column]),
            }
        }
        let part = |own: &Vec<usize>| {
            let kept = |row: &Vec<String>| -> Vec<String> {
                let shown = (0..keys).chain(own.iter().copied());
                shown.map(|column| row[column].clone()).collect()
            };
            Self {
                header: kept(&self.header),
                rows: self.rows.iter().map(kept).collect(),
            }
        };
        if parts.is_empty() {
            vec![self.clone()]
        } else {
            parts.iter().map(part).collect()
        }
    }

    fn whole_text(&self) -> String {
        let columns = Columns {
            widths: self.fitted(),
            numbers: self.numbers(),
        };
        let rule = "-".repeat(across(&columns.widths));
        let header = columns.line(&self.header, "  ");
        let mut text = format!("{}\n{rule}\n", header.trim_end());
        let rows = self.rows.iter();
        for row in rows.flat_map(|row| broken(row, &columns.widths)) {
            let _ = writeln!(text, "{}", columns.line(&row, "  ").trim_end());
        }
        text
    }

    /// Returns the widths of the columns. The widest text column is narrowed to fit a terminal. If
    /// the table is still too wide, nothing is narrowed.
    fn fitted(&self) -> Vec<usize> {
        let mut widths = self.widths();
        let surplus = across(&widths).saturating_sub(COLUMNS);
        let numbers = self.numbers();
        let words = (0..widths.len()).filter(|&column| !numbers[column]);
        if let Some(widest) = words.max_by_key(|&column| widths[column]) {
            let least = NARROWEST.max(self.header[widest].chars().count());
            let narrowed = widths[widest].saturating_sub(surplus);
            if narrowed >= least {
                widths[widest] = narrowed;
            }
        }
        widths
    }
}

/// How the columns of a table are laid out.
struct Columns {
    widths: Vec<usize>,
    /// Whether a column is right-aligned.
    numbers: Vec<bool>,
}

impl Columns {
    /// Aligns the cells of a row and joins them by `gap`.
    fn line(&self, row: &[String], gap: &str) -> String {
        let cell = |(column, text): (usize, &String)| {
            let width = self.widths[column];
            if self.numbers[column] {
                format!("{text:>width$}")
            } else {
                format!("{text:<width$}")
            }
        };
        let cells: Vec<String> = row.iter().enumerate().map(cell).collect();
        cells.join(gap)
    }
}

/// Returns the total width of columns, with gaps.
fn across(widths: &[usize]) -> usize {
    let with_gaps: usize = widths.iter().map(|width| width + 2).sum();
    with_gaps.saturating_sub(2)
}

/// Wraps the cells of a row to the given widths, and returns the lines. Continuation lines are
/// indented.
fn broken(row: &[String], widths: &[usize]) -> Vec<Vec<String>> {
    let parts = |(cell, &width): (&String, &usize)| {
        if cell.chars().count() > width {
            wrapped(cell, width - 2)
                .replace('\n', "\n  ")
                .lines()
                .map(str::to_owned)
                .collect()
        } else {
            vec![cell.clone()]
        }
    };
    let cells: Vec<Vec<String>> = row.iter().zip(widths).map(parts).collect();
    let lines = cells.iter().map(Vec::len).max().unwrap_or(0);
    let part = |cell: &Vec<String>, line| cell.get(line).cloned().unwrap_or_default();
    (0..lines)
        .map(|line| cells.iter().map(|cell| part(cell, line)).collect())
        .collect()
}

/// Renders blocks as Markdown.
pub fn markdown(blocks: &[Block]) -> String {
    let part = |block: &Block| match block {
        Block::Heading(text) => format!("## {}\n", without_tags(text)),
        Block::Subheading(text) => format!("### {}\n", without_tags(text)),
        Block::Text(text) => format!("{}\n", without_tags(text)),
        Block::Table(table) => without_tags(&table.markdown()),
        Block::Picture(Picture { name, caption, .. }) => format!("![{caption}]({name}.svg)\n"),
    };
    blocks.iter().map(part).collect::<Vec<_>>().join("\n")
}

/// Escapes HTML tags in Markdown. The names of studies and worlds come from files.
pub(crate) fn without_tags(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        let begins = |next: &char| next.is_ascii_alphabetic() || "/!?".contains(*next);
        if character == '<' && characters.peek().is_some_and(begins) {
            safe.push('\\');
        }
        safe.push(character);
    }
    safe
}

/// Renders blocks for a terminal of 80 columns.
pub fn terminal(blocks: &[Block]) -> String {
    let part = |block: &Block| match block {
        Block::Heading(text) => format!("{}\n", text.to_uppercase()),
        Block::Subheading(text) => format!("{text}\n"),
        Block::Text(text) => format!("{}\n", wrapped(text, COLUMNS)),
        Block::Table(table) => table.text(),
        Block::Picture(Picture { name, caption, .. }) => format!("{name}.svg  {caption}\n"),
    };
    blocks.iter().map(part).collect::<Vec<_>>().join("\n")
}

/// Wraps text between words to lines of at most `width` characters.
fn wrapped(text: &str, width: usize) -> String {
    let plain = text.replace("**", "").replace('`', "");
    let words: Vec<&str> = plain.split_whitespace().collect();
    let options = textwrap::Options::new(width)
        .break_words(false)
        .word_splitter(WordSplitter::NoHyphenation);
    textwrap::fill(&words.join(" "), options)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(["world", "arena", "p"]);
        let rows = [["maze4", "grid", "0.5"], ["woods12", "grid", "< 0.0001"]];
        table.rows = rows.map(|row| row.map(str::to_owned).to_vec()).to_vec();
        table
    }

    #[test]
    fn a_table_aligns_words_to_the_left_and_numbers_to_the_right() {
        insta::assert_snapshot!(table().without_dull(|name| name == "arena").markdown(), @r"
        | world   |        p |
        | :------ | -------: |
        | maze4   |      0.5 |
        | woods12 | < 0.0001 |
        ");
        insta::assert_snapshot!(table().text(), @r"
        world    arena         p
        ------------------------
        maze4    grid        0.5
        woods12  grid   < 0.0001
        ");
    }

    #[test]
    fn a_table_for_a_terminal_wraps_its_text_column() {
        let mut table = Table::new(["if", "go", "value"]);
        let words =
            "north wall, east free, south-east free, south wall, west free, north-west wall";
        table.rows = vec![
            vec![words, "east", "577.0"],
            vec!["east free", "west", "1.0"],
        ]
        .into_iter()
        .map(|row| row.into_iter().map(str::to_owned).collect())
        .collect();
        assert!(words.len() <= 80);
        insta::assert_snapshot!(table.text(), @r"
        if                                                                   go    value
        --------------------------------------------------------------------------------
        north wall, east free, south-east free, south wall, west free,       east  577.0
          north-west wall
        east free                                                            west    1.0
        ");
    }

    #[test]
    fn control_a_table_that_cannot_fit_has_one_line_for_each_row() {
        let mut table = Table::new([&"w".repeat(70), "comparison"]);
        let words = "xcscr-plus after maze6 − after nothing";
        table.rows = vec![vec!["maze4".to_owned(), words.to_owned()]];
        let text = table.text();
        assert!(text.contains(words) && text.lines().count() == 3, "{text}");
    }

    #[test]
    fn a_table_of_many_numbers_is_split_and_no_number_is_broken() {
        let names = (0..12).map(|number| format!("number {number}"));
        let mut table = Table::new(["world".to_owned()].into_iter().chain(names));
        let numbers = (0..12).map(|number| format!("{number}00"));
        table.rows = vec![["maze4".to_owned()].into_iter().chain(numbers).collect()];
        let text = table.text();
        assert!(
            text.lines().all(|line| line.chars().count() <= COLUMNS),
            "{text}"
        );
        assert_eq!(text.matches("maze4").count(), 2, "{text}");
        let found: Vec<&str> = text
            .split_whitespace()
            .filter(|word| word.ends_with("00"))
            .collect();
        assert_eq!(found.len(), 12, "{text}");
    }

    #[test]
    fn markdown_has_no_html_elements_and_keeps_numbers_below_a_bound() {
        let text = "<img src=x> </b> <!-- p < 0.0001, a<3 -->";
        let safe = markdown(&[Block::Text(text.to_owned())]);
        assert_eq!(safe, "\\<img src=x> \\</b> \\<!-- p < 0.0001, a<3 -->\n");
    }

    #[test]
    fn long_text_is_wrapped_between_words() {
        assert_eq!(wrapped("one **two** three", 8), "one two\nthree");
    }
}
