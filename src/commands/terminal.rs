//! Safe output to the terminal: control characters from files are escaped.

use std::borrow::Cow;
use std::fmt::{Display, Write as _};
use std::io::{self, IsTerminal, Write};
use std::path::Path;

use percent_encoding::{AsciiSet, CONTROLS, percent_encode};
use textwrap::core::Word;
use textwrap::{Options, WordSeparator, WordSplitter};

use super::results::{Results, Unwritten};

/// The characters that must be percent-encoded in the path of an address.
const IN_PATHS: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'`')
    .add(b'{')
    .add(b'}');

/// Width of a terminal, in columns.
const COLUMNS: usize = 80;

/// Prints a line to stderr. Errors of stderr are ignored.
pub fn say(line: &str) {
    let mut there = io::stderr();
    let _ = writeln!(there, "{}", fitted(&escaped(line), &there));
}

/// Prints a line of text to stdout, wrapped for a terminal.
pub fn write_words(out: &mut Results, line: &str) -> Result<(), Unwritten> {
    writeln!(out, "{}", fitted(line, &io::stdout()))
}

/// Prints a line of a report: a label and a value.
pub fn write_row(out: &mut Results, label: &str, value: impl Display) -> Result<(), Unwritten> {
    writeln!(out, "  {label:<20} {value}")
}

/// Wraps text for a terminal to lines of at most 80 columns, between words. For a file or a pipe,
/// the text is unchanged, so that it can be searched.
pub fn fitted<'a>(text: &'a str, there: &impl IsTerminal) -> Cow<'a, str> {
    if there.is_terminal() {
        Cow::Owned(broken(text))
    } else {
        Cow::Borrowed(text)
    }
}

/// Wraps each line that is too long between words. Continuation lines are indented. Text between
/// backticks is one word, so that it can be copied.
fn broken(text: &str) -> String {
    let lines: Vec<String> = text.split('\n').map(broken_line).collect();
    lines.join("\n")
}

fn broken_line(line: &str) -> String {
    if line.chars().count() <= COLUMNS {
        return line.to_owned();
    }
    let text = line.trim_start();
    let margin = " ".repeat(line.len() - text.len() + 2);
    let options = Options::new(COLUMNS)
        .initial_indent(&margin[2..])
        .subsequent_indent(&margin)
        .break_words(false)
        .word_separator(WordSeparator::Custom(words))
        .word_splitter(WordSplitter::NoHyphenation);
    textwrap::fill(text, options)
}

/// Splits a line into words. Text between backticks is one word.
fn words(line: &str) -> Box<dyn Iterator<Item = Word<'_>> + '_> {
    let mut is_open = false;
    let ends = move |letter| {
        is_open ^= letter == '`';
        letter == ' ' && !is_open
    };
    Box::new(line.split_inclusive(ends).map(Word::from))
}

/// Returns true if the terminal on stdout shows links (OSC 8). `FORCE_HYPERLINK=1` enables links,
/// `FORCE_HYPERLINK=0` disables them.
pub fn shows_links() -> bool {
    supports_hyperlinks::on(supports_hyperlinks::Stream::Stdout)
}

/// Returns true if colours are enabled there; see no-color.org.
pub fn shows_colours(there: &impl IsTerminal) -> bool {
    let forbidden = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    there.is_terminal() && !forbidden
}

/// Prints a maze with its policy and legend to stdout, in colour if enabled.
pub fn print_maze(drawn: &str) -> Result<(), Unwritten> {
    let (mut out, drawn) = (io::stdout(), escaped(drawn));
    let written = if shows_colours(&out) {
        writeln!(out, "{}", painted(&drawn))
    } else {
        writeln!(out, "{drawn}")
    };
    written.map_err(Unwritten)
}

/// Colours a drawn maze: walls grey, arrows green, the goal magenta, ambiguous cells yellow.
fn painted(drawn: &str) -> String {
    let paint = |character: char| {
        let colour = match character {
            '█' => 90,
            '←'..='↓' | '↖'..='↙' => 32,
            'G' => 35,
            '+' | '?' => 33,
            _ => return character.to_string(),
        };
        format!("\u{1b}[{colour}m{character}\u{1b}[0m")
    };
    drawn.chars().map(paint).collect()
}

/// Prints a name and an address to stdout. If the terminal shows links (OSC 8), the address is a
/// link behind a short text, so that the line fits 80 columns. The address comes from this program:
/// its characters are printable ASCII.
pub fn write_link(name: &str, address: &str, out: &mut Results) -> Result<(), Unwritten> {
    if !shows_links() {
        return writeln!(out, "  {name}{address}");
    }
    write!(out, "  {name}")?;
    out.flush()?;
    let address = escaped(address);
    // Output through `out` would be escaped.
    write!(
        io::stdout(),
        "\u{1b}]8;;{address}\u{1b}\\click here to open it\u{1b}]8;;\u{1b}\\"
    )
    .map_err(Unwritten)?;
    writeln!(out)
}

/// Returns the address of a file on this machine (`file://...`).
pub fn file_link(path: &Path) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let encoded = percent_encode(whole.as_os_str().as_encoded_bytes(), IN_PATHS);
    format!("file://{encoded}")
}

/// A writer that escapes control characters for a terminal as `\u001b`. This is also the escape of
/// JSON, so the meaning of a document does not change.
pub struct Escaping<W: Write> {
    inner: W,
    /// The first bytes of an incomplete character.
    pending: Vec<u8>,
}

impl<W: Write> Escaping<W> {
    /// Creates a writer to `inner`.
    pub fn new(inner: W) -> Self {
        let pending = Vec::new();
        Self { inner, pending }
    }
}

impl<W: Write> Write for Escaping<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.pending.extend_from_slice(bytes);
        let whole = match std::str::from_utf8(&self.pending) {
            Err(fault) if fault.error_len().is_none() => fault.valid_up_to(),
            _ => self.pending.len(),
        };
        let whole: Vec<u8> = self.pending.drain(..whole).collect();
        let text = String::from_utf8_lossy(&whole);
        self.inner.write_all(escaped(&text).as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Escapes all characters that control a terminal as in JSON, except line breaks and tabs.
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(is_command) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        if is_command(character) {
            write!(shown, "\\u{:04x}", u32::from(character)).expect("a string has room")
        } else {
            shown.push(character)
        }
    }
    Cow::Owned(shown)
}

/// Returns true if a terminal does not simply display the character. This includes control
/// characters, also those above ASCII, and characters that change the writing direction, which can
/// make one text look like another.
fn is_command(character: char) -> bool {
    let turns = matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (character.is_control() && character != '\n' && character != '\t')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a text byte by byte, and returns the output.
    fn written(text: &str) -> String {
        let mut out = Escaping::new(Vec::new());
        for byte in text.bytes() {
            out.write_all(&[byte]).unwrap();
        }
        String::from_utf8(out.inner).unwrap()
    }

    #[test]
    fn no_character_of_unicode_commands_the_terminal_and_none_is_lost() {
        for character in '\0'..=char::MAX {
            let (text, shown) = (character.to_string(), written(&character.to_string()));
            let is_layout = character == '\n' || character == '\t';
            assert!(
                is_layout || !shown.contains(char::is_control),
                "{character:?}"
            );
            // In a JSON document the escape has the same meaning.
            if character > '\u{1f}' && character != '"' && character != '\\' {
                let read: String = serde_json::from_str(&format!("\"{shown}\"")).unwrap();
                assert_eq!(read, text);
            }
        }
    }

    #[test]
    fn a_line_for_a_terminal_is_broken_between_words_and_a_command_stays_whole() {
        let said = "error: run exists: choose another folder with `--out`, or replace the run in it \
                    with `xcscr train world.json --force`";
        assert_eq!(
            broken(said),
            "error: run exists: choose another folder with `--out`, or replace the run in it\n  \
             with `xcscr train world.json --force`"
        );
        let listed = format!("error: wrong\n  one of: {}", "a-name, ".repeat(20));
        let broken = broken(&listed);
        let widths = broken.lines().map(|line| line.chars().count());
        assert!(
            broken.lines().count() == 4 && widths.max() <= Some(COLUMNS),
            "{broken}"
        );
        assert_eq!(
            broken.split_whitespace().collect::<Vec<_>>(),
            listed.split_whitespace().collect::<Vec<_>>()
        );
        // Control: no word is broken, however long it is.
        let long = format!("{} and `a {}`", "path/".repeat(30), "b ".repeat(60));
        assert_eq!(super::broken(&long).lines().count(), 3);
        assert_eq!(super::broken("short"), "short");
    }

    #[test]
    fn a_painted_maze_has_the_same_letters() {
        let drawn = "██→ + ██\n██? ↘ G \n";
        let painted = painted(drawn);
        assert_eq!(painted.matches("\u{1b}[90m█\u{1b}[0m").count(), 6);
        assert!(painted.contains("\u{1b}[32m↘\u{1b}[0m \u{1b}[35mG"));
        let mut plain = painted;
        for colour in ["90", "32", "33", "35", "0"] {
            plain = plain.replace(&format!("\u{1b}[{colour}m"), "");
        }
        assert_eq!(plain, drawn);
    }

    #[test]
    fn letters_of_several_bytes_survive_any_cut() {
        let text = "Übergröße → 迷路 🤖\n";
        assert_eq!(written(text), text);
        assert_eq!(
            written("a\u{1b}[31mb\u{9b}2J\r"),
            "a\\u001b[31mb\\u009b2J\\u000d"
        );
    }
}
