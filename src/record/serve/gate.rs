//! Who may talk to a server on this machine, how much, and for how long.
//!
//! Any page that a browser shows can send requests to this machine, and any program can open
//! connections. So every request is held to bounds before it is looked at, and refused unless it
//! names this machine as its host (or a page could have its own name resolve to this machine) and,
//! where a browser sends it for a page, comes from one that was allowed.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// The sites of the viewers.
pub const VIEWERS: [&str; 2] = [
    "https://app.foxglove.dev",
    "https://lichtblick-suite.github.io",
];
/// What viewers on the desktop, whose pages are files, say they are.
const DESKTOP: &str = "file://";

/// Connections at a time: what a few browsers open, and few enough for `ulimit -n 64` when each
/// takes a socket and a file.
const MOST_GUESTS: usize = 24;
/// Bytes of a head: method, address and headers.
const MOST_HEAD: usize = 8 * 1024;
/// Headers of a request.
const MOST_HEADERS: usize = 64;
/// How long a head may take.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// How long a guest may take nothing of what is sent.
const STALL_TIME: Duration = Duration::from_secs(30);
/// A guest that did nothing for so long gives way to a new one when all places are taken.
const IDLE_TIME: Duration = Duration::from_secs(1);
/// How long, and how much, is read and thrown away at the end: closing a connection with unread
/// bytes would take the answer back.
const FAREWELL_TIME: Duration = Duration::from_secs(1);
const MOST_FAREWELL: u64 = 64 * 1024;
/// How long to wait after connections could not be accepted, such as for want of descriptors.
const RECOVERY: Duration = Duration::from_millis(100);

/// A listener on the loopback interface that lets in only requests within its bounds.
#[derive(Debug)]
pub struct Gate {
    listener: TcpListener,
    port: u16,
    origins: Vec<String>,
}

impl Gate {
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

    /// Lets guests in on threads of their own, until the [`Opened`] gate is dropped. `host` answers
    /// a request whose head was accepted; all others are refused before.
    ///
    /// # Errors
    /// When no thread can be started.
    pub fn open<H>(self, host: H) -> io::Result<Opened>
    where
        H: Fn(&Head, &mut Guest) -> io::Result<()> + Send + Sync + 'static,
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
        H: Fn(&Head, &mut Guest) -> io::Result<()> + Send + Sync + 'static,
    {
        let room = Arc::new(Room::default());
        let gate = Arc::new(self);
        while !closing.load(Ordering::Relaxed) {
            let Ok((stream, _)) = gate.listener.accept() else {
                thread::sleep(RECOVERY);
                continue;
            };
            let Some(mut guest) = Guest::enter(stream, &room) else {
                continue;
            };
            let (gate, host) = (Arc::clone(&gate), Arc::clone(host));
            // When no thread can be started, the guest is dropped, and with it the connection.
            let _ = thread::Builder::new().spawn(move || {
                // A guest that breaks off is nobody's fault.
                let _ = gate.receive(&mut guest, &*host);
            });
        }
    }

    fn receive<H>(&self, guest: &mut Guest, host: &H) -> io::Result<()>
    where
        H: Fn(&Head, &mut Guest) -> io::Result<()>,
    {
        match Head::read(guest).and_then(|head| self.check(head)) {
            Ok(head) => host(&head, guest)?,
            Err(status) => guest.say(&refusal(status))?,
        }
        guest.take_leave()
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

/// A gate that lets guests in until it is dropped.
#[derive(Debug)]
pub struct Opened {
    port: u16,
    closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

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

/// The origin of a web page: scheme, host and port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin(String);

/// A text that is no origin.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("must be scheme and host, without a path, such as https://viewer.example")]
pub struct NoOrigin;

impl std::str::FromStr for Origin {
    type Err = NoOrigin;

    fn from_str(text: &str) -> Result<Self, NoOrigin> {
        let text = text.strip_suffix('/').unwrap_or(text).to_ascii_lowercase();
        let host = ["http://", "https://"]
            .iter()
            .find_map(|scheme| text.strip_prefix(scheme))
            .ok_or(NoOrigin)?;
        let is_part = |c: char| c.is_ascii_alphanumeric() || "-._:[]".contains(c);
        match !host.is_empty() && host.chars().all(is_part) {
            true => Ok(Self(text)),
            false => Err(NoOrigin),
        }
    }
}

/// What matters of the head of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Head {
    /// Such as `GET`.
    pub method: String,
    /// The address, from its path on.
    pub target: String,
    /// The page that asks, if a browser says so.
    pub origin: Option<String>,
    /// The bytes that are wanted.
    pub range: Option<String>,
    /// What was received: the head, and perhaps more.
    pub received: Vec<u8>,
    host: Option<String>,
}

impl Head {
    /// Reads a head, or the status that says why there is none.
    fn read(guest: &mut Guest) -> Result<Self, u16> {
        let until = Instant::now() + HEAD_TIME;
        let mut received = Vec::new();
        let mut piece = [0; 1024];
        loop {
            if let Some(head) = Self::parse(&received)? {
                return Ok(head);
            }
            if received.len() >= MOST_HEAD {
                return Err(431);
            }
            let room = piece.len().min(MOST_HEAD - received.len());
            let read = guest.read_until(&mut piece[..room], until);
            match read.map_err(|_| 408_u16)? {
                0 => return Err(400),
                bytes => received.extend_from_slice(&piece[..bytes]),
            }
        }
    }

    /// The head in these bytes; `None` while it is incomplete.
    fn parse(received: &[u8]) -> Result<Option<Self>, u16> {
        let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        let parsed = request.parse(received).map_err(|fault| match fault {
            httparse::Error::TooManyHeaders => 431_u16,
            _ => 400,
        })?;
        if parsed.is_partial() {
            return Ok(None);
        }
        let own = |name: &str| -> Result<Option<String>, u16> {
            let mut values = request
                .headers
                .iter()
                .filter(|one| one.name.eq_ignore_ascii_case(name));
            let value = values
                .next()
                .map(|one| String::from_utf8(one.value.to_vec()));
            match (value, values.next()) {
                (_, Some(_)) | (Some(Err(_)), _) => Err(400),
                (value, None) => Ok(value.and_then(Result::ok)),
            }
        };
        let has_body = own("content-length")?.is_some_and(|length| length != "0")
            || own("transfer-encoding")?.is_some();
        if has_body {
            return Err(413);
        }
        Ok(Some(Self {
            method: request.method.unwrap_or_default().to_owned(),
            target: request.path.unwrap_or_default().to_owned(),
            host: own("host")?.map(|host| host.to_ascii_lowercase()),
            origin: own("origin")?,
            range: own("range")?,
            received: received.to_vec(),
        }))
    }
}

/// Who is connected.
#[derive(Debug, Default)]
struct Room(Mutex<Vec<Arc<Seat>>>);

/// A connection, and when something last went over it.
#[derive(Debug)]
struct Seat {
    stream: TcpStream,
    active: Mutex<Instant>,
}

impl Seat {
    fn idle(&self) -> Duration {
        let active = self.active.lock().unwrap_or_else(PoisonError::into_inner);
        active.elapsed()
    }

    fn touch(&self) {
        *self.active.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }
}

impl Room {
    fn seats(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Seat>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A seat for a new connection. When all are taken, whoever has been idle for longest gives
    /// way, so that silent connections keep nobody out; `None` when nobody is idle.
    fn seat(&self, stream: TcpStream) -> Result<Arc<Seat>, TcpStream> {
        let mut seats = self.seats();
        if seats.len() >= MOST_GUESTS {
            let idlest = (0..seats.len()).max_by_key(|&at| seats[at].idle());
            let idlest = idlest.filter(|&at| seats[at].idle() >= IDLE_TIME);
            let Some(idlest) = idlest else {
                return Err(stream);
            };
            let _ = seats.remove(idlest).stream.shutdown(Shutdown::Both);
        }
        let active = Mutex::new(Instant::now());
        let seat = Arc::new(Seat { stream, active });
        seats.push(Arc::clone(&seat));
        Ok(seat)
    }
}

/// A connection that was let in. Writing to it fails when nothing is taken for too long.
#[derive(Debug)]
pub struct Guest {
    seat: Arc<Seat>,
    room: Arc<Room>,
}

impl Guest {
    fn enter(stream: TcpStream, room: &Arc<Room>) -> Option<Self> {
        stream.set_nodelay(true).ok()?;
        stream.set_write_timeout(Some(STALL_TIME)).ok()?;
        match room.seat(stream) {
            Ok(seat) => Some(Self {
                seat,
                room: Arc::clone(room),
            }),
            Err(mut stream) => {
                // Fits into the buffer of any connection, so it waits for nobody.
                let _ = stream.write_all(&refusal(503));
                None
            }
        }
    }

    /// Reads what comes next; fails with [`ErrorKind::TimedOut`] when nothing does until then.
    fn read_until(&mut self, piece: &mut [u8], until: Instant) -> io::Result<usize> {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.seat.stream.set_read_timeout(Some(left))?;
        (&self.seat.stream).read(piece)
    }

    /// Sends all of it.
    ///
    /// # Errors
    /// When the guest has gone, or takes nothing for too long.
    pub fn say(&mut self, bytes: &[u8]) -> io::Result<()> {
        (&self.seat.stream).write_all(bytes)?;
        self.seat.touch();
        Ok(())
    }

    /// Passes everything on between the guest and another connection, until either has enough.
    ///
    /// # Errors
    /// When no thread can be started.
    pub fn connect(&mut self, other: &TcpStream) -> io::Result<()> {
        self.seat.stream.set_read_timeout(None)?;
        thread::scope(|scope| {
            let there = thread::Builder::new().spawn_scoped(scope, || {
                pass_on(&self.seat.stream, other, &self.seat);
            })?;
            pass_on(other, &self.seat.stream, &self.seat);
            let _ = there.join();
            Ok(())
        })
    }

    /// Says that nothing more comes, and waits a moment until the guest has understood.
    fn take_leave(&mut self) -> io::Result<()> {
        self.seat.stream.shutdown(Shutdown::Write)?;
        let until = Instant::now() + FAREWELL_TIME;
        let mut piece = [0; 4096];
        let mut read = 0;
        while read < MOST_FAREWELL {
            match self.read_until(&mut piece, until)? {
                0 => break,
                bytes => read += bytes as u64,
            }
        }
        Ok(())
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        let mut seats = self.room.seats();
        seats.retain(|seat| !Arc::ptr_eq(seat, &self.seat));
    }
}

/// Copies until the end, then ends both connections.
fn pass_on(mut from: &TcpStream, mut to: &TcpStream, seat: &Seat) {
    let mut piece = [0; 16 * 1024];
    while let Ok(bytes @ 1..) = from.read(&mut piece) {
        if to.write_all(&piece[..bytes]).is_err() {
            break;
        }
        seat.touch();
    }
    for stream in [from, to] {
        let _ = stream.shutdown(Shutdown::Both);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_has_a_scheme_and_a_host_and_no_path() {
        let read = |text: &str| text.parse::<Origin>().map(|origin| origin.0);
        assert_eq!(
            read("https://Viewer.example/"),
            Ok("https://viewer.example".to_owned())
        );
        assert_eq!(
            read("http://[::1]:8080"),
            Ok("http://[::1]:8080".to_owned())
        );
        for text in [
            "*",
            "",
            "null",
            "viewer.example",
            "https://",
            "https://a/b",
            "https://a\r\nb",
        ] {
            assert_eq!(read(text), Err(NoOrigin), "{text}");
        }
    }
}
