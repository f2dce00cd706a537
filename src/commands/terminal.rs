//! The way to the terminal: what files hold is printed, and never obeyed.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};

/// What cannot stand as it is in the path of an address.
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

/// Columns of a terminal.
const COLUMNS: usize = 80;

/// Tells the user something, on a line of stderr. A closed stderr is no reason to fail.
pub fn say(line: &str) {
    let mut there = io::stderr();
    let _ = writeln!(there, "{}", fitted(&escaped(line), &there));
}

/// Prints a line of words on stdout, as a terminal or a file is to have it.
pub fn write_words(out: &mut impl Write, line: &str) -> io::Result<()> {
    writeln!(out, "{}", fitted(line, &io::stdout()))
}

/// The text as it is printed there: a terminal gets lines of at most 80 columns, broken between words;
/// a file or a pipe gets them whole, so that they can be searched.
pub fn fitted<'a>(text: &'a str, there: &impl IsTerminal) -> Cow<'a, str> {
    match there.is_terminal() {
        true => Cow::Owned(broken(text)),
        false => Cow::Borrowed(text),
    }
}

/// The text with each line that is too long broken between words; what goes on is indented. What
/// stands between backticks is one word, so that it can be copied.
fn broken(text: &str) -> String {
    let lines: Vec<String> = text.split('\n').map(broken_line).collect();
    lines.join("\n")
}

fn broken_line(line: &str) -> String {
    if line.chars().count() <= COLUMNS {
        return line.to_owned();
    }
    let margin = line.len() - line.trim_start().len();
    let mut text = line[..margin].to_owned();
    let mut length = margin;
    for word in words(line[margin..].trim_end()) {
        let size = word.chars().count();
        if length > margin && length + 1 + size > COLUMNS {
            write!(text, "\n{:width$}", "", width = margin + 2).expect("a string has room");
            length = margin + 2;
        } else if length > margin {
            text.push(' ');
            length += 1;
        }
        text.push_str(&word);
        length += size;
    }
    text
}

/// The words of a line; those between two backticks are one.
fn words(line: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut is_open = false;
    for word in line.split(' ') {
        match words.last_mut().filter(|_| is_open) {
            Some(before) => *before = format!("{before} {word}"),
            None => words.push(word.to_owned()),
        }
        is_open ^= word.matches('`').count() % 2 == 1;
    }
    words
}

/// Does the terminal on stdout show links (OSC 8)? Those that are known to; `FORCE_HYPERLINK=1`
/// says so of any, `FORCE_HYPERLINK=0` of none.
pub fn shows_links() -> bool {
    let set = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    if let Some(forced) = set("FORCE_HYPERLINK") {
        return forced != "0";
    }
    const PROGRAMS: [&str; 6] = [
        "iTerm.app",
        "WezTerm",
        "vscode",
        "ghostty",
        "Hyper",
        "Tabby",
    ];
    const TERMS: [&str; 5] = [
        "xterm-kitty",
        "xterm-ghostty",
        "alacritty",
        "foot",
        "wezterm",
    ];
    const SIGNS: [&str; 4] = [
        "KITTY_WINDOW_ID",
        "WT_SESSION",
        "KONSOLE_VERSION",
        "DOMTERM",
    ];
    let is_one_of = |name, of: &[&str]| set(name).is_some_and(|it| of.contains(&it.as_str()));
    let vte = set("VTE_VERSION").and_then(|version| version.parse::<u32>().ok());
    io::stdout().is_terminal()
        && (is_one_of("TERM_PROGRAM", &PROGRAMS)
            || is_one_of("TERM", &TERMS)
            || vte.is_some_and(|version| version >= 5000)
            || SIGNS.iter().any(|name| set(name).is_some()))
}

/// Are colours wanted there? See no-color.org.
pub fn shows_colours(there: &impl IsTerminal) -> bool {
    let forbidden = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    there.is_terminal() && !forbidden
}

/// Prints a maze with its policy, and what the letters mean, on stdout: in colour where that is wanted.
pub fn print_maze(drawn: &str) -> io::Result<()> {
    let (mut out, drawn) = (io::stdout(), escaped(drawn));
    match shows_colours(&out) {
        true => writeln!(out, "{}", painted(&drawn)),
        false => writeln!(out, "{drawn}"),
    }
}

/// A drawn maze in colours: walls grey, arrows green, the goal magenta, what is not clear yellow.
fn painted(drawn: &str) -> String {
    let paint = |letter: char| {
        let colour = match letter {
            '█' => 90,
            '←'..='↓' | '↖'..='↙' => 32,
            'G' => 35,
            '+' | '?' => 33,
            _ => return letter.to_string(),
        };
        format!("\u{1b}[{colour}m{letter}\u{1b}[0m")
    };
    drawn.chars().map(paint).collect()
}

/// Prints an address after a name, on a line of stdout: as a link behind short words (OSC 8) where the terminal shows links, so
/// that 80 columns hold. The address is one of our own making, whose letters are ASCII and command nothing.
pub fn write_link(name: &str, address: &str, out: &mut impl Write) -> io::Result<()> {
    if !shows_links() {
        return writeln!(out, "  {name}{address}");
    }
    write!(out, "  {name}")?;
    out.flush()?;
    let address = escaped(address);
    // What goes through `out` would be escaped.
    write!(
        io::stdout(),
        "\u{1b}]8;;{address}\u{1b}\\click here to open it\u{1b}]8;;\u{1b}\\"
    )?;
    writeln!(out)
}

/// Returns the address of a file on this machine (`file://...`).
pub fn file_link(path: &Path) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let encoded = whole.to_string_lossy();
    let encoded = utf8_percent_encode(&encoded, IN_PATHS);
    format!("file://{encoded}")
}

/// Text on its way to the terminal, in which whatever commands a terminal is shown as `\u001b`.
/// That is also how JSON spells it: a document means the same as before.
pub struct Escaping<W: Write> {
    inner: W,
    /// The beginning of a letter whose other bytes are still to come.
    pending: Vec<u8>,
}

impl<W: Write> Escaping<W> {
    /// Text on its way to `inner`.
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

/// The text with all that commands a terminal as it is spelt in JSON; the ends of lines and
/// tabulators stay.
pub fn escaped(text: &str) -> Cow<'_, str> {
    if !text.contains(is_command) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for letter in text.chars() {
        match is_command(letter) {
            true => write!(shown, "\\u{:04x}", u32::from(letter)).expect("a string has room"),
            false => shown.push(letter),
        }
    }
    Cow::Owned(shown)
}

/// Does a terminal do something else with it than show it? Control characters do, of which there
/// are some above ASCII, and those that turn the direction of writing, so that one text looks like
/// another.
fn is_command(letter: char) -> bool {
    let turns = matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (letter.is_control() && letter != '\n' && letter != '\t')
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every letter that could be written, byte by byte.
    fn written(text: &str) -> String {
        let mut out = Escaping::new(Vec::new());
        for byte in text.bytes() {
            out.write_all(&[byte]).unwrap();
        }
        String::from_utf8(out.inner).unwrap()
    }

    #[test]
    fn no_character_of_unicode_commands_the_terminal_and_none_is_lost() {
        for letter in '\0'..=char::MAX {
            let (text, shown) = (letter.to_string(), written(&letter.to_string()));
            let is_layout = letter == '\n' || letter == '\t';
            assert!(is_layout || !shown.contains(char::is_control), "{letter:?}");
            // In a JSON document it stands for the same.
            if letter > '\u{1f}' && letter != '"' && letter != '\\' {
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
