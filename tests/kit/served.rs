//! A client of the server of `replay`.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use super::desk::Desk;

/// A timeout that is longer than any response takes, even on a busy machine.
pub const LONG: Duration = Duration::from_secs(60);

/// A server that is killed when the test ends, if it is still running.
pub struct Served {
    pub child: Child,
    pub lines: Vec<String>,
    pub port: u16,
    /// The common prefix of all addresses: a slash and a random word.
    pub base: String,
}

impl Served {
    /// Serves these recordings, with these options.
    pub fn new(desk: &Desk, line: &str) -> Self {
        Self::of(desk.command(&format!("replay {line}")))
    }

    /// Starts the server with a command.
    pub fn of(mut command: Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut reader = BufReader::new(child.stdout.take().unwrap());
        let mut lines = Vec::new();
        while !lines
            .last()
            .is_some_and(|line: &String| line.starts_with("Serving on"))
        {
            let mut line = String::new();
            assert!(reader.read_line(&mut line).unwrap() > 0, "{lines:?}");
            lines.push(line);
        }
        let layout = lines.iter().find(|line| line.contains("  layout "));
        let mut parts = layout.unwrap().split('/');
        let port = parts.nth(2).unwrap().strip_prefix("127.0.0.1:").unwrap();
        let port = port.parse().unwrap();
        let base = format!("/{}", parts.next().unwrap());
        Self {
            child,
            lines,
            port,
            base,
        }
    }

    /// Opens a connection with a read timeout.
    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        stream
    }

    /// Sends bytes and returns the whole response until the connection is closed.
    pub fn say(&self, bytes: &[u8]) -> Vec<u8> {
        let mut stream = self.connect();
        // The server may respond and close the connection before all bytes are sent.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        answer
    }

    /// Returns the whole response to a request for a path below the base, which may be empty.
    pub fn ask_or_nothing(&self, path: &str) -> Vec<u8> {
        let (base, port) = (&self.base, self.port);
        self.say(format!("GET {base}{path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").as_bytes())
    }

    /// Returns the status of the response to these bytes.
    pub fn status(&self, bytes: &[u8]) -> String {
        let answer = String::from_utf8_lossy(&self.say(bytes)).into_owned();
        answer.split(' ').nth(1).unwrap_or(&answer).to_owned()
    }

    /// Sends a request for a path below the base. Returns the head and the body of the response.
    pub fn ask(&self, method: &str, path: &str, headers: &str) -> (String, Vec<u8>) {
        let (base, port) = (&self.base, self.port);
        let host = format!("Host: 127.0.0.1:{port}");
        let request = format!("{method} {base}{path} HTTP/1.1\r\n{host}\r\n{headers}\r\n");
        let answer = self.say(request.as_bytes());
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n");
        let end = end.unwrap_or_else(|| panic!("{request}: {answer:?}"));
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        (head, answer[end + 4..].to_vec())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
