//! Who may talk to a server on this machine, how much, and for how long.
//!
//! Any page that a browser shows can send requests to this machine, and any program can open
//! connections. So every request is held to bounds before it is looked at, and refused unless it
//! names this machine as its host (or a page could have its own name resolve to this machine) and,
//! where a browser sends it for a page, comes from one that was allowed.

use std::io::{self, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

pub use super::connection::Connection;
use super::connection::Room;
pub use super::head::{Head, Origin};

/// The sites of the viewers.
pub const VIEWERS: [&str; 2] = [
    "https://app.foxglove.dev",
    "https://lichtblick-suite.github.io",
];
/// What viewers on the desktop, whose pages are files, say they are.
const DESKTOP: &str = "file://";

/// How long to wait after connections could not be accepted, such as for want of descriptors.
const RECOVERY: Duration = Duration::from_millis(100);

/// A listener on the loopback interface that lets in only requests within its bounds.
#[derive(Debug)]
pub struct Listener {
    listener: TcpListener,
    port: u16,
    origins: Vec<String>,
}

impl Listener {
    /// Listens on a port of 127.0.0.1; 0 takes any that is free. Pages of the [viewers](VIEWERS)
    /// are allowed.
    ///
    /// # Errors
    /// When the port is taken or forbidden.
    pub fn bind(port: u16) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        Ok(Self {
            port: listener.local_addr()?.port(),
            listener,
            origins: [&VIEWERS[..], &[DESKTOP]]
                .concat()
                .iter()
                .map(|one| (*one).to_owned())
                .collect(),
        })
    }

    /// The port on which it listens.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Allows the pages of one more origin, such as `https://viewer.example`.
    pub fn allow(&mut self, origin: &Origin) {
        self.origins.push(origin.0.clone());
    }

    /// Lets connection in on threads of their own, until the [`Opened`] gate is dropped. `host` answers
    /// a request whose head was accepted; all others are refused before.
    ///
    /// # Errors
    /// When no thread can be started.
    pub fn open<H>(self, host: H) -> io::Result<Opened>
    where
        H: Fn(&Head, &mut Connection) -> io::Result<()> + Send + Sync + 'static,
    {
        let closing = Arc::new(AtomicBool::new(false));
        let (port, told) = (self.port, Arc::clone(&closing));
        let thread = thread::Builder::new().spawn(move || self.accept(&Arc::new(host), &told))?;
        Ok(Opened {
            port,
            closing,
            thread: Some(thread),
        })
    }

    fn accept<H>(self, host: &Arc<H>, closing: &AtomicBool)
    where
        H: Fn(&Head, &mut Connection) -> io::Result<()> + Send + Sync + 'static,
    {
        let room = Arc::new(Room::default());
        let listener = Arc::new(self);
        while !closing.load(Ordering::Relaxed) {
            let Ok((stream, _)) = listener.listener.accept() else {
                thread::sleep(RECOVERY);
                continue;
            };
            let mut connection = match Connection::enter(stream, &room) {
                Ok(connection) => connection,
                Err(mut stream) => {
                    // Fits into the buffer of any connection, so it waits for nobody.
                    let _ = stream.write_all(&refusal(503));
                    continue;
                }
            };
            let (listener, host) = (Arc::clone(&listener), Arc::clone(host));
            // When no thread can be started, the connection is dropped, and with it the connection.
            let _ = thread::Builder::new().spawn(move || {
                // A connection that breaks off is nobody's fault.
                let _ = listener.receive(&mut connection, &*host);
            });
        }
    }

    fn receive<H>(&self, connection: &mut Connection, host: &H) -> io::Result<()>
    where
        H: Fn(&Head, &mut Connection) -> io::Result<()>,
    {
        match Head::read(connection).and_then(|head| self.check(head)) {
            Ok(head) => host(&head, connection)?,
            Err(status) => connection.say(&refusal(status))?,
        }
        connection.take_leave()
    }

    /// The head, if it may come in; or else the status that says why not.
    fn check(&self, head: Head) -> Result<Head, u16> {
        let hosts = [
            format!("127.0.0.1:{}", self.port),
            format!("localhost:{}", self.port),
        ];
        match &head.host {
            None => return Err(400),
            Some(host) if !hosts.contains(host) => return Err(421),
            Some(_) => {}
        }
        match &head.origin {
            Some(origin) if !self.origins.contains(origin) => Err(403),
            _ => Ok(head),
        }
    }
}

/// A gate that lets connection in until it is dropped.
#[derive(Debug)]
pub struct Opened {
    port: u16,
    closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

#[cfg(feature = "live")]
impl Opened {
    /// The port on which it listens.
    pub fn port(&self) -> u16 {
        self.port
    }
}

impl Drop for Opened {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
        // It waits for a connection, so it is given one.
        let _ = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port));
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// An answer that says no, and nothing else.
fn refusal(status: u16) -> Vec<u8> {
    let head = status_line(status);
    format!("{head}Content-Length: 0\r\nConnection: close\r\n\r\n").into_bytes()
}

/// The first line of an answer.
pub fn status_line(status: u16) -> String {
    let reason = match status {
        200 => "OK",
        204 => "No Content",
        206 => "Partial Content",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        413 => "Content Too Large",
        416 => "Range Not Satisfiable",
        421 => "Misdirected Request",
        500 => "Internal Server Error",
        431 => "Request Header Fields Too Large",
        _ => "Service Unavailable",
    };
    format!("HTTP/1.1 {status} {reason}\r\n")
}

/// A loopback address of one's own, which no page can guess; where the system has but one
/// (macOS), only the port is.
#[cfg(feature = "live")]
pub fn hidden_host() -> io::Result<Ipv4Addr> {
    let [a, b, c, ..] = getrandom::u64()?.to_le_bytes();
    let own = Ipv4Addr::new(127, a, b, c.clamp(1, 254));
    Ok(match TcpListener::bind((own, 0)) {
        Ok(_) => own,
        Err(_) => Ipv4Addr::LOCALHOST,
    })
}
