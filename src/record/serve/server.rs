//! Serving recordings to a viewer in the browser, on this machine only.

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

/// How often the server looks whether it shall stop.
const PATIENCE: Duration = Duration::from_millis(100);
/// Bytes that are sent at once.
const PIECE: usize = 64 * 1024;
/// What every answer says: that nobody shall keep it, because the next run has the same names,
/// and that pages get it only by asking as themselves, never as a picture or a script.
const HEADERS: &str = "Accept-Ranges: bytes\r\n\
    Cache-Control: no-store\r\n\
    Connection: close\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\n\
    Vary: Origin\r\n\
    X-Content-Type-Options: nosniff\r\n";
/// What a page that is allowed is told besides.
const TO_PAGES: &str = "Access-Control-Allow-Methods: GET, HEAD, OPTIONS\r\n\
    Access-Control-Allow-Headers: *\r\n\
    Access-Control-Allow-Private-Network: true\r\n\
    Access-Control-Expose-Headers: Accept-Ranges, Content-Length, Content-Range\r\n";

/// What lies behind an address.
#[derive(Debug, Clone)]
pub enum Content {
    /// A file.
    File(PathBuf),
    /// A text, as JSON.
    Text(String),
}

/// An HTTP server on the loopback interface that gives out what it was told to, and nothing else,
/// to whoever knows the address: each begins with a word that nobody can guess. Pages in a browser
/// are given it only if they are those of the viewers, or of origins that were allowed.
///
/// ```no_run
/// use xcscr::record::server::{Content, Server, foxglove_link};
///
/// let mut server = Server::bind(0)?;
/// let url = server.add("ep-0001.mcap", Content::File("ep-0001.mcap".into()));
/// println!("{}", foxglove_link(&[url]));
/// server.run(|| false)?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Server {
    listener: Listener,
    /// The word that nobody can guess.
    secret: String,
    contents: Contents,
}

impl Server {
    /// Listens on a port of 127.0.0.1; 0 takes any that is free.
    ///
    /// # Errors
    /// When the port is taken or forbidden, or the system has no random numbers.
    pub fn bind(port: u16) -> io::Result<Self> {
        Ok(Self {
            listener: Listener::bind(port)?,
            secret: format!("{:016x}{:016x}", getrandom::u64()?, getrandom::u64()?),
            contents: Contents::default(),
        })
    }

    /// Where it listens, such as `http://127.0.0.1:8080`.
    pub fn origin(&self) -> String {
        format!("http://127.0.0.1:{}", self.listener.port())
    }

    /// Allows the pages of one more origin to read what is given out.
    pub fn allow(&mut self, origin: &Origin) {
        self.listener.allow(origin);
    }

    /// Gives something out from now on; returns its address, which ends in `name`.
    pub fn add(&mut self, name: &str, content: Content) -> String {
        let contents = &mut self.contents.0;
        let path = format!("/{}/{}/{}", self.secret, contents.len(), escaped(name));
        contents.push((path.clone(), content));
        format!("{}{path}", self.origin())
    }

    /// Answers requests until `stopped` says so.
    ///
    /// # Errors
    /// When there is no thread to answer them.
    pub fn run(self, stopped: impl Fn() -> bool) -> io::Result<()> {
        let contents = Arc::new(self.contents);
        let _open = self
            .listener
            .open(move |head, connection| contents.answer(head, connection))?;
        while !stopped() {
            thread::sleep(PATIENCE);
        }
        Ok(())
    }
}

/// A link that opens recordings in Foxglove.
pub fn foxglove_link(urls: &[String]) -> String {
    format!("https://app.foxglove.dev/~/view?{}", query(urls))
}

/// A link that opens recordings in Lichtblick, with a layout.
pub fn lichtblick_link(urls: &[String], layout: &str) -> String {
    let (query, layout) = (query(urls), escaped(layout));
    format!("https://lichtblick-suite.github.io/lichtblick/?{query}&layoutUrl={layout}")
}

fn query(urls: &[String]) -> String {
    let urls = urls.iter().map(|url| format!("&ds.url={}", escaped(url)));
    format!("ds=remote-file{}", urls.collect::<String>())
}

/// All but the unreserved characters of RFC 3986.
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~');

/// A text as part of an address.
fn escaped(text: &str) -> PercentEncode<'_> {
    utf8_percent_encode(text, RESERVED)
}

/// Paths with what lies behind them.
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
            // The file may have gone since the server was started.
            ("GET" | "HEAD", Some(content)) => Answer::part(content, head.range.as_deref())
                .unwrap_or_else(|cause| Answer::failure(&cause)),
            ("GET" | "HEAD", None) => Answer::empty(404),
            _ => Answer::empty(405),
        };
        answer.send(head, connection)
    }
}

/// An answer: its status, its own headers, and its body.
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

    /// What became of content that cannot be read.
    fn failure(cause: &io::Error) -> Self {
        Self::empty(match cause.kind() {
            io::ErrorKind::NotFound => 404,
            io::ErrorKind::PermissionDenied => 403,
            _ => 500,
        })
    }

    /// The wanted bytes of some content.
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
        connection.say(format!("{text}\r\n").as_bytes())?;
        if head.method == "HEAD" {
            return Ok(());
        }
        let mut piece = vec![0; PIECE];
        loop {
            match self.body.read(&mut piece)? {
                0 => return Ok(()),
                bytes => connection.say(&piece[..bytes])?,
            }
        }
    }
}

trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

/// The content, its size and its media type.
fn open(content: &Content) -> io::Result<(Box<dyn ReadSeek>, u64, &'static str)> {
    match content {
        Content::File(path) => {
            // It was no link when it was offered; what a link leads to was never offered.
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
