//! Renders blocks as one self-contained HTML page, without network access or other files.

use std::fmt::Write;

use super::blocks::{Block, Picture, Table};

/// Colours for light and dark mode, and the layout.
const STYLE: &str = include_str!("page.css");
/// Sorts a table by the column whose heading was clicked.
const SCRIPT: &str = include_str!("page.js");

/// Makes the browser refuse to load anything.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// The colours of figures, and the CSS variables that replace them so that figures follow dark
/// mode.
const COLOURS: [(&str, &str); 5] = [
    ("#ffffff", "var(--paper)"),
    ("#1d2430", "var(--ink)"),
    ("#d9dee6", "var(--faint)"),
    ("#5a5a5a", "var(--grey)"),
    ("#0072b2", "var(--blue)"),
];

/// Renders blocks as a page.
pub fn html(title: &str, blocks: &[Block]) -> String {
    let title = escaped(title);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <h1>{title}</h1>\n"
    );
    for block in blocks {
        let _ = match block {
            Block::Heading(text) => writeln!(page, "<h2>{}</h2>", escaped(text)),
            Block::Subheading(text) => writeln!(page, "<h3>{}</h3>", escaped(text)),
            Block::Text(text) => writeln!(page, "<p>{}</p>", marked(text)),
            Block::Table(rows) => writeln!(page, "{}", table(rows)),
            Block::Picture(picture) => writeln!(page, "{}", figure(picture)),
        };
    }
    let _ = write!(
        page,
        "</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n"
    );
    page
}

fn table(table: &Table) -> String {
    let numbers = table.numbers();
    let cells = |tag: &str, row: &[String]| {
        let cell = |(column, text): (usize, &String)| {
            let class = if numbers[column] {
                " class=\"number\""
            } else {
                ""
            };
            match tag {
                "th" => format!(
                    "<th scope=\"col\"{class}><button type=\"button\">{}</button></th>",
                    escaped(text.trim())
                ),
                _ => format!("<td{class}>{}</td>", escaped(text)),
            }
        };
        let cells: String = row.iter().enumerate().map(cell).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let body: String = table.rows.iter().map(|row| cells("td", row)).collect();
    format!(
        "<div class=\"wide\"><table>\n<thead>{}</thead>\n<tbody>\n{body}</tbody>\n</table></div>",
        cells("th", &table.header).trim_end()
    )
}

fn figure(picture: &Picture) -> String {
    // In HTML, SVG needs no namespace. Without it, the page contains no address at all.
    let bare = picture
        .svg
        .replace(" xmlns=\"http://www.w3.org/2000/svg\"", "");
    let themed = COLOURS.iter().fold(bare, |svg, (colour, name)| {
        svg.replace(&format!("\"{colour}\""), &format!("\"{name}\""))
    });
    let caption = escaped(picture.caption);
    let labelled = format!("<svg role=\"img\" aria-label=\"{caption}\" ");
    let svg = themed.replacen("<svg ", &labelled, 1);
    format!("<figure><div class=\"wide\">{svg}</div><figcaption>{caption}</figcaption></figure>")
}

/// Converts text with `code` and **strong** parts to HTML.
fn marked(text: &str) -> String {
    let escaped = escaped(text);
    let code = between(&escaped, "`", "code");
    between(&code, "**", "strong")
}

/// Wraps every second part between two marks in an element.
fn between(text: &str, mark: &str, element: &str) -> String {
    let parts = text.split(mark).enumerate();
    let part = |(at, part): (usize, &str)| match at % 2 {
        0 => part.to_owned(),
        _ => format!("<{element}>{part}</{element}>"),
    };
    parts.map(part).collect()
}

/// Escapes text for HTML, SVG and their attributes.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_become_elements_of_the_page() {
        let evil = "<img src=x onerror=alert(1)>";
        let mut rows = Table::new([evil]);
        rows.rows.push(vec![evil.to_owned()]);
        let blocks = [
            Block::Heading(evil.to_owned()),
            Block::Text(evil.to_owned()),
            Block::Table(rows),
        ];
        let page = html(evil, &blocks);
        assert!(!page.contains("<img"), "{page}");
        assert_eq!(page.matches("&lt;img src=x").count(), 6);
    }

    #[test]
    fn figures_take_their_colours_from_the_page() {
        let picture = Picture {
            name: "f",
            caption: "A figure",
            svg: "<svg width=\"1\" xmlns=\"http://www.w3.org/2000/svg\"><rect fill=\"#ffffff\" \
                  stroke=\"#1d2430\"/></svg>"
                .to_owned(),
        };
        assert_eq!(
            figure(&picture),
            "<figure><div class=\"wide\"><svg role=\"img\" aria-label=\"A figure\" width=\"1\">\
             <rect fill=\"var(--paper)\" stroke=\"var(--ink)\"/></svg></div>\
             <figcaption>A figure</figcaption></figure>"
        );
    }

    #[test]
    fn marks_become_elements() {
        assert_eq!(
            marked("`a < b` and **c**"),
            "<code>a &lt; b</code> and <strong>c</strong>"
        );
    }
}
