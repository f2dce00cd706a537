//! Serves recordings to a viewer in the browser, on this machine only.

use std::fmt::Write as _;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, PercentEncode, utf8_percent_encode};

use super::byte_range::Wanted;
pub use super::listener::Origin;
use super::listener::{Connection, Head, Listener, status_line};
use crate::disk;

/// The interval at which the server checks whether to stop.
const POLL_INTERVAL: Duration = Duration::from_millis(100);
/// The size of the pieces that are sent, in bytes.
const PIECE: usize = 64 * 1024;
/// The headers of every response. Responses must not be cached, because the next run uses the same
/// names. Pages get them only by requests with their own origin, never as a picture or a script.
const HEADERS: &str = "Accept-Ranges: bytes\r\n\
    Cache-Control: no-store\r\n\
    Connection: close\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\n\
    Vary: Origin\r\n\
    X-Content-Type-Options: nosniff\r\n";
/// The additional headers of a response to an allowed page.
const TO_PAGES: &str = "Access-Control-Allow-Methods: GET, HEAD, OPTIONS\r\n\
    Access-Control-Allow-Headers: *\r\n\
    Access-Control-Allow-Private-Network: true\r\n\
    Access-Control-Expose-Headers: Accept-Ranges, Content-Length, Content-Range\r\n";

/// The content behind an address.
#[derive(Debug, Clone)]
pub enum Content {
    /// A file.
    File(PathBuf),
    /// A text, as JSON.
    Text(String),
}

/// An HTTP server on the loopback interface that serves the added contents and nothing else. Each
/// address begins with a secret that cannot be guessed. Of web pages, only those of the viewers and
/// of allowed origins can read the contents.
///
/// ```no_run
/// use xcscr::replay::server::{Content, Server, viewer_links};
///
/// let mut server = Server::bind(0)?;
/// let url = server.add("ep-0001.mcap", Content::File("ep-0001.mcap".into()));
/// let layout = server.add("layout.json", Content::Text("{}".to_owned()));
/// for (viewer, link) in viewer_links(&[url], &layout) {
///     println!("{viewer}: {link}");
/// }
/// server.run(|| false)?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Server {
    listener: Listener,
    /// The part of each address that cannot be guessed.
    secret: String,
    contents: Contents,
}

impl Server {
    /// Listens on a port of 127.0.0.1; 0 selects a free one.
    ///
    /// # Errors
    /// If the port is taken or forbidden, or the system has no random numbers.
    pub fn bind(port: u16) -> io::Result<Self> {
        Ok(Self {
            listener: Listener::bind(port)?,
            secret: format!("{:016x}{:016x}", getrandom::u64()?, getrandom::u64()?),
            contents: Contents::default(),
        })
    }

    /// Returns the server's own origin, such as `http://127.0.0.1:8080`.
    pub fn origin(&self) -> String {
        format!("http://127.0.0.1:{}", self.listener.port())
    }

    /// Allows the pages of another origin to read the contents.
    pub fn allow(&mut self, origin: &Origin) {
        self.listener.allow(origin);
    }

    /// Serves a content from now on. Returns its address, which ends with `name`.
    pub fn add(&mut self, name: &str, content: Content) -> String {
        let contents = &mut self.contents.0;
        let path = format!("/{}/{}/{}", self.secret, contents.len(), escaped(name));
        contents.push((path.clone(), content));
        format!("{}{path}", self.origin())
    }

    /// Answers requests until `stopped` returns true.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn run(self, stopped: impl Fn() -> bool) -> io::Result<()> {
        let contents = Arc::new(self.contents);
        let _open = self
            .listener
            .open(move |head, connection| contents.answer(head, connection))?;
        while !stopped() {
            thread::sleep(POLL_INTERVAL);
        }
        Ok(())
    }
}

/// Returns the links that open recordings in Lichtblick, with a layout, and in Foxglove, each after
/// the viewer's name.
pub fn viewer_links(urls: &[String], layout: &str) -> [(&'static str, String); 2] {
    let (query, layout) = (query(urls), escaped(layout));
    let lichtblick =
        format!("https://lichtblick-suite.github.io/lichtblick/?{query}&layoutUrl={layout}");
    let foxglove = format!("https://app.foxglove.dev/~/view?{query}");
    [("Lichtblick", lichtblick), ("Foxglove", foxglove)]
}

fn query(urls: &[String]) -> String {
    let urls = urls.iter().map(|url| format!("&ds.url={}", escaped(url)));
    format!("ds=remote-file{}", urls.collect::<String>())
}

/// All characters but the unreserved ones of RFC 3986.
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~');

/// Escapes a text for use in an address.
fn escaped(text: &str) -> PercentEncode<'_> {
    utf8_percent_encode(text, RESERVED)
}

/// Paths and their contents.
#[derive(Debug, Default)]
struct Contents(Vec<(String, Content)>);

impl Contents {
    fn at(&self, target: &str) -> Option<&Content> {
        let path = target.split(['?', '#']).next()?;
        let found = self.0.iter().find(|(known, _)| known == path);
        found.map(|(_, content)| content)
    }

    fn answer(&self, head: &Head, connection: &mut Connection) -> io::Result<()> {
        let answer = match (head.method.as_str(), self.at(&head.target)) {
            ("OPTIONS", _) => Answer::empty(204),
            // The file may have been deleted since the server was started.
            ("GET" | "HEAD", Some(content)) => Answer::part(content, head.range.as_deref())
                .unwrap_or_else(|cause| Answer::failure(&cause)),
            ("GET" | "HEAD", None) => Answer::empty(404),
            _ => Answer::empty(405),
        };
        answer.send(head, connection)
    }
}

/// A response: its status, its own headers, and its body.
struct Answer {
    status: u16,
    headers: String,
    body: io::Take<Box<dyn ReadSeek>>,
}

impl Answer {
    fn empty(status: u16) -> Self {
        let nothing: Box<dyn ReadSeek> = Box::new(io::empty());
        Self {
            status,
            headers: String::new(),
            body: nothing.take(0),
        }
    }

    /// Creates the response for a content that cannot be read.
    fn failure(cause: &io::Error) -> Self {
        Self::empty(match cause.kind() {
            io::ErrorKind::NotFound => 404,
            io::ErrorKind::PermissionDenied => 403,
            _ => 500,
        })
    }

    /// Creates the response with the requested bytes of a content.
    fn part(content: &Content, range: Option<&str>) -> io::Result<Self> {
        let (mut reader, size, kind) = open(content)?;
        let (status, range, bytes) = match Wanted::of(range, size) {
            Wanted::All => (200, None, 0..size),
            Wanted::Part(bytes) => {
                let (first, last) = (bytes.start, bytes.end - 1);
                (206, Some(format!("{first}-{last}")), bytes)
            }
            Wanted::Nothing => (416, Some("*".to_owned()), 0..0),
        };
        let mut headers = format!("Content-Type: {kind}\r\n");
        if let Some(range) = range {
            let _ = write!(headers, "Content-Range: bytes {range}/{size}\r\n");
        }
        reader.seek(SeekFrom::Start(bytes.start))?;
        Ok(Self {
            status,
            headers,
            body: reader.take(bytes.end - bytes.start),
        })
    }

    fn send(mut self, head: &Head, connection: &mut Connection) -> io::Result<()> {
        let mut text = status_line(self.status) + HEADERS + &self.headers;
        if let Some(origin) = &head.origin {
            let _ = write!(text, "Access-Control-Allow-Origin: {origin}\r\n{TO_PAGES}");
        }
        if self.status != 204 {
            let _ = write!(text, "Content-Length: {}\r\n", self.body.limit());
        }
        connection.send(format!("{text}\r\n").as_bytes())?;
        if head.method == "HEAD" {
            return Ok(());
        }
        let mut piece = vec![0; PIECE];
        loop {
            match self.body.read(&mut piece)? {
                0 => return Ok(()),
                bytes => connection.send(&piece[..bytes])?,
            }
        }
    }
}

trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

/// Opens a content. Returns a reader, the size and the media type.
fn open(content: &Content) -> io::Result<(Box<dyn ReadSeek>, u64, &'static str)> {
    match content {
        Content::File(path) => {
            // The path was not a link when it was added; a link target must not be served.
            disk::require_plain(path)?;
            let file = disk::open(path)?;
            let size = file.metadata()?.len();
            Ok((Box::new(file), size, "application/octet-stream"))
        }
        Content::Text(text) => {
            let size = text.len() as u64;
            Ok((
                Box::new(Cursor::new(text.clone())),
                size,
                "application/json",
            ))
        }
    }
}
