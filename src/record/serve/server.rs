//! Serving recordings to a viewer in the browser, on this machine only.

use std::error::Error;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use tiny_http::{Header, Method, Request, Response, StatusCode};

use super::byte_range::Wanted;

/// How often the server looks whether it shall stop.
const PATIENCE: Duration = Duration::from_millis(100);
/// What every answer says: who may read it (every page, or no viewer could), and that nobody
/// shall keep it, because the next run has the same names.
const HEADERS: [(&str, &str); 8] = [
    ("Accept-Ranges", "bytes"),
    ("Access-Control-Allow-Origin", "*"),
    ("Access-Control-Allow-Methods", "GET, HEAD, OPTIONS"),
    ("Access-Control-Allow-Headers", "*"),
    ("Access-Control-Allow-Private-Network", "true"),
    (
        "Access-Control-Expose-Headers",
        "Accept-Ranges, Content-Length, Content-Range",
    ),
    ("Cache-Control", "no-store"),
    ("X-Content-Type-Options", "nosniff"),
];

/// What lies behind an address.
#[derive(Debug, Clone)]
pub enum Content {
    /// A file.
    File(PathBuf),
    /// A text, as JSON.
    Text(String),
}

/// An HTTP server on the loopback interface that gives out what it was told to, and nothing else.
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
    http: tiny_http::Server,
    address: SocketAddr,
    /// Paths with what lies behind them.
    contents: Vec<(String, Content)>,
}

impl Server {
    /// Listens on a port of 127.0.0.1; 0 takes any that is free.
    ///
    /// # Errors
    /// When the port is taken or forbidden.
    pub fn bind(port: u16) -> io::Result<Self> {
        let wanted = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        let http = tiny_http::Server::http(wanted).map_err(plain)?;
        let address = http.server_addr().to_ip().unwrap_or(wanted);
        Ok(Self {
            http,
            address,
            contents: Vec::new(),
        })
    }

    /// Where it listens, such as `http://127.0.0.1:8080`.
    pub fn origin(&self) -> String {
        format!("http://{}", self.address)
    }

    /// Gives something out from now on; returns its address, which ends in `name`.
    pub fn add(&mut self, name: &str, content: Content) -> String {
        let path = format!("/{}/{}", self.contents.len(), escaped(name));
        let url = format!("{}{path}", self.origin());
        self.contents.push((path, content));
        url
    }

    /// Answers requests until `stopped` says so.
    ///
    /// # Errors
    /// When nothing can be received any more.
    pub fn run(&self, stopped: impl Fn() -> bool) -> io::Result<()> {
        while !stopped() {
            if let Some(request) = self.http.recv_timeout(PATIENCE)? {
                let content = self.content(request.url()).cloned();
                // A client that reads slowly must keep nobody waiting.
                thread::Builder::new().spawn(move || answer(request, content))?;
            }
        }
        Ok(())
    }

    fn content(&self, url: &str) -> Option<&Content> {
        let path = url.split(['?', '#']).next()?;
        let found = self.contents.iter().find(|(known, _)| known == path);
        found.map(|(_, content)| content)
    }
}

/// The library boxes its errors.
fn plain(error: Box<dyn Error + Send + Sync>) -> io::Error {
    match error.downcast::<io::Error>() {
        Ok(error) => *error,
        Err(other) => io::Error::other(other),
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

/// A text as part of an address.
fn escaped(text: &str) -> String {
    let letter = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => {
            char::from(byte).to_string()
        }
        _ => format!("%{byte:02X}"),
    };
    text.bytes().map(letter).collect()
}

/// Answers a request. A client that went away is nobody's fault.
fn answer(request: Request, content: Option<Content>) {
    let response = match (request.method(), content) {
        (Method::Options, _) => Ok(empty(204)),
        (Method::Get | Method::Head, Some(content)) => {
            let range = request
                .headers()
                .iter()
                .find(|one| one.field.equiv("Range"));
            part(&content, range.map(|header| header.value.as_str()))
        }
        (Method::Get | Method::Head, None) => Ok(empty(404)),
        _ => Ok(empty(405)),
    };
    // The file may have gone since the server was started.
    let response = response.unwrap_or_else(|_| empty(404));
    let _ = request.respond(response);
}

type Answer = Response<Box<dyn Read + Send>>;

fn empty(status: u16) -> Answer {
    with_headers(status, Vec::new(), Box::new(io::empty()), 0)
}

/// The wanted bytes of some content.
fn part(content: &Content, range: Option<&str>) -> io::Result<Answer> {
    let (mut reader, size, kind) = open(content)?;
    let mut headers = vec![("Content-Type", kind.to_owned())];
    let (status, bytes) = match Wanted::of(range, size) {
        Wanted::All => (200, 0..size),
        Wanted::Part(bytes) => {
            let (first, last) = (bytes.start, bytes.end - 1);
            headers.push(("Content-Range", format!("bytes {first}-{last}/{size}")));
            (206, bytes)
        }
        Wanted::Nothing => {
            headers.push(("Content-Range", format!("bytes */{size}")));
            return Ok(with_headers(416, headers, Box::new(io::empty()), 0));
        }
    };
    reader.seek(SeekFrom::Start(bytes.start))?;
    let length = bytes.end - bytes.start;
    Ok(with_headers(
        status,
        headers,
        Box::new(reader.take(length)),
        length,
    ))
}

trait ReadSeek: Read + Seek + Send {}

impl<T: Read + Seek + Send> ReadSeek for T {}

/// The content, its size and its media type.
fn open(content: &Content) -> io::Result<(Box<dyn ReadSeek>, u64, &'static str)> {
    match content {
        Content::File(path) => {
            let file = File::open(path)?;
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

fn with_headers(
    status: u16,
    own: Vec<(&str, String)>,
    body: Box<dyn Read + Send>,
    length: u64,
) -> Answer {
    let common = HEADERS
        .into_iter()
        .map(|(name, value)| (name, value.to_owned()));
    let headers = common
        .chain(own)
        .filter_map(|(name, value)| Header::from_bytes(name.as_bytes(), value.as_bytes()).ok());
    let length = usize::try_from(length).ok();
    let response = Response::new(StatusCode(status), headers.collect(), body, length, None);
    // Chunked transfer would leave out the length, by which viewers know the size.
    response.with_chunked_threshold(usize::MAX)
}
