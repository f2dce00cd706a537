//! Connections: their maximum number, and their timeouts.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The maximum number of connections. It suffices for a few browsers, and is low enough for `ulimit
/// -n 64` if each connection takes a socket and a file.
const MAX_CONNECTIONS: usize = 24;
/// The time in which the other side must read the bytes of one call of [`Connection::send`].
const STALL_TIME: Duration = Duration::from_secs(10);
/// The maximum time and number of bytes to read and discard at the end. Closing a connection with
/// unread bytes would discard the answer.
const SHUTDOWN_TIME: Duration = Duration::from_secs(1);
const MAX_DISCARDED_BYTES: u64 = 64 * 1024;

/// The slots for connections. Each open connection holds a clone.
#[derive(Debug, Clone, Default)]
pub struct Slots(Arc<()>);

/// An accepted connection. Writing fails if the other side reads nothing for too long.
#[derive(Debug)]
pub struct Connection {
    stream: TcpStream,
    _slot: Slots,
}

impl Connection {
    /// Accepts a connection; returns the stream if there is no slot.
    pub fn accept(stream: TcpStream, slots: &Slots) -> Result<Self, TcpStream> {
        let is_full = Arc::strong_count(&slots.0) > MAX_CONNECTIONS;
        let prepared = stream.set_nodelay(true);
        if is_full || prepared.is_err() {
            Err(stream)
        } else {
            Ok(Self {
                stream,
                _slot: slots.clone(),
            })
        }
    }

    /// Reads the next bytes; fails with [`ErrorKind::TimedOut`] if nothing arrives before `until`.
    pub fn read_until(&mut self, piece: &mut [u8], until: Instant) -> io::Result<usize> {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(piece)
    }

    /// Sends all bytes.
    ///
    /// # Errors
    /// If the connection is closed, or the other side reads nothing for too long.
    pub fn send(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        let until = Instant::now() + STALL_TIME;
        while !bytes.is_empty() {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ErrorKind::TimedOut.into());
            }
            self.stream.set_write_timeout(Some(left))?;
            match self.stream.write(bytes) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(written) => bytes = &bytes[written..],
                Err(cause) if cause.kind() == ErrorKind::Interrupted => {}
                Err(cause) => return Err(cause),
            }
        }
        Ok(())
    }

    /// Shuts down writing, and waits until the other side has read the answer.
    pub fn shut_down(&mut self) -> io::Result<()> {
        self.stream.shutdown(Shutdown::Write)?;
        let until = Instant::now() + SHUTDOWN_TIME;
        let mut piece = [0; 4096];
        let mut read = 0;
        while read < MAX_DISCARDED_BYTES {
            match self.read_until(&mut piece, until)? {
                0 => break,
                bytes => read += bytes as u64,
            }
        }
        Ok(())
    }
}
