//! A server's access control and limits for requests on this machine.
//!
//! Any web page in a browser can send requests to this machine, and any program can open
//! connections. Every request is therefore limited in size and time. It is rejected unless its host
//! is this machine; otherwise a page could have its own name resolve to this machine. If a browser
//! sends an origin, the origin must be allowed.

use std::io::{self, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

pub use super::connection::Connection;
use super::connection::Slots;
pub use super::head::{Head, Origin};

/// The origins of the viewers.
pub const VIEWERS: [&str; 2] = [
    "https://app.foxglove.dev",
    "https://lichtblick-suite.github.io",
];
/// The origin of desktop viewers, whose pages are files.
const DESKTOP: &str = "file://";

/// The delay after connections could not be accepted, for example because no descriptor was free.
const RETRY_DELAY: Duration = Duration::from_millis(100);

/// A listener on the loopback interface that accepts only allowed requests within the limits.
#[derive(Debug)]
pub struct Listener {
    listener: TcpListener,
    port: u16,
    origins: Vec<String>,
}

impl Listener {
    /// Listens on a port of 127.0.0.1; 0 selects a free one. Pages of the [viewers](VIEWERS) are
    /// allowed.
    ///
    /// # Errors
    /// If the port is taken or forbidden.
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

    /// Returns the port of the listener.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Allows the pages of one more origin, such as `https://viewer.example`.
    pub fn allow(&mut self, origin: &Origin) {
        self.origins.push(origin.0.clone());
    }

    /// Accepts connections on separate threads, until the [`Opened`] listener is dropped. `host`
    /// answers requests whose head was accepted; all others are rejected.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn open<H>(self, host: H) -> io::Result<Opened>
    where
        H: Fn(&Head, &mut Connection) -> io::Result<()> + Send + Sync + 'static,
    {
        let closing = Arc::new(AtomicBool::new(false));
        let (port, stop) = (self.port, Arc::clone(&closing));
        let thread = thread::Builder::new().spawn(move || self.accept(&Arc::new(host), &stop))?;
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
        let slots = Slots::default();
        let listener = Arc::new(self);
        while !closing.load(Ordering::Relaxed) {
            let Ok((stream, _)) = listener.listener.accept() else {
                thread::sleep(RETRY_DELAY);
                continue;
            };
            let mut connection = match Connection::accept(stream, &slots) {
                Ok(connection) => connection,
                Err(mut stream) => {
                    // The response fits into the buffer of any connection, so this does not block.
                    let _ = stream.write_all(&refusal(503));
                    continue;
                }
            };
            let (listener, host) = (Arc::clone(&listener), Arc::clone(host));
            // If no thread can be started, the connection is dropped.
            let _ = thread::Builder::new().spawn(move || {
                // Errors of a broken connection are ignored.
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
            // A connection that sent too little must not keep its slot any longer.
            Err(408) => return connection.send(&refusal(408)),
            Err(status) => connection.send(&refusal(status))?,
        }
        connection.shut_down()
    }

    /// Returns the head if the request is allowed. The error is an HTTP status.
    fn check(&self, head: Head) -> Result<Head, u16> {
        let names = ["127.0.0.1", "localhost"];
        let is_ours = |host: &String| {
            // Browsers leave out the port of the protocol.
            let named = names.iter().find_map(|name| host.strip_prefix(name));
            named.is_some_and(|port| match port.strip_prefix(':') {
                Some(port) => port == self.port.to_string(),
                None => port.is_empty() && self.port == 80,
            })
        };
        match &head.host {
            None => return Err(400),
            Some(host) if !is_ours(host) => return Err(421),
            Some(_) => {}
        }
        match &head.origin {
            Some(origin) if !self.origins.contains(origin) => Err(403),
            _ => Ok(head),
        }
    }
}

/// A running listener that accepts connections until it is dropped.
#[derive(Debug)]
pub struct Opened {
    port: u16,
    closing: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Opened {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Relaxed);
        // `accept` blocks until there is a connection, so open one.
        let _ = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port));
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Returns a response with an error status and no body.
fn refusal(status: u16) -> Vec<u8> {
    let head = status_line(status);
    format!("{head}Content-Length: 0\r\nConnection: close\r\n\r\n").into_bytes()
}

/// Returns the first line of a response.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn status(port: u16, host: &str) -> Option<u16> {
        let listener = Listener {
            port,
            ..Listener::bind(0).unwrap()
        };
        let head = Head {
            method: "GET".to_owned(),
            target: "/".to_owned(),
            origin: None,
            range: None,
            received: Vec::new(),
            host: Some(host.to_owned()),
        };
        listener.check(head).err()
    }

    #[test]
    fn a_host_without_a_port_is_this_machine_only_on_the_port_of_the_protocol() {
        for host in ["127.0.0.1", "localhost", "localhost:80"] {
            assert_eq!(status(80, host), None, "{host}");
        }
        for (port, host) in [
            (8000, "127.0.0.1"),
            (80, "localhost:8000"),
            (80, "localhost.evil.example"),
            (80, "evil.example"),
        ] {
            assert_eq!(status(port, host), Some(421), "{host}");
        }
        assert_eq!(status(8000, "localhost:8000"), None);
    }
}
