//! Connections: their maximum number, and their timeouts.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
#[cfg(feature = "live")]
use std::thread;
use std::time::{Duration, Instant};

/// The maximum number of connections. It suffices for a few browsers, and is low enough for `ulimit
/// -n 64` if each connection takes a socket and a file.
const MAX_CONNECTIONS: usize = 24;
/// The time after which writing to a blocked connection fails.
const STALL_TIME: Duration = Duration::from_secs(30);
/// When all slots are taken, a connection that was idle for this long is closed for a new one.
const IDLE_TIME: Duration = Duration::from_secs(1);
/// The maximum time and number of bytes to read and discard at the end. Closing a connection with
/// unread bytes would discard the answer.
const SHUTDOWN_TIME: Duration = Duration::from_secs(1);
const MAX_DISCARDED_BYTES: u64 = 64 * 1024;

/// The open connections.
#[derive(Debug, Default)]
pub struct Slots(Mutex<Vec<Arc<Slot>>>);

/// A connection, and the time of its last activity.
#[derive(Debug)]
struct Slot {
    stream: TcpStream,
    active: Mutex<Instant>,
}

impl Slot {
    fn idle(&self) -> Duration {
        let active = self.active.lock().unwrap_or_else(PoisonError::into_inner);
        active.elapsed()
    }

    fn touch(&self) {
        *self.active.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }
}

impl Slots {
    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Slot>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns a slot for a new connection. If all slots are taken, the connection that was idle
    /// for longest is closed. Fails if none is idle for [`IDLE_TIME`].
    fn slot(&self, stream: TcpStream) -> Result<Arc<Slot>, TcpStream> {
        let mut slots = self.lock();
        if slots.len() >= MAX_CONNECTIONS {
            let idlest = (0..slots.len()).max_by_key(|&at| slots[at].idle());
            let idlest = idlest.filter(|&at| slots[at].idle() >= IDLE_TIME);
            let Some(idlest) = idlest else {
                return Err(stream);
            };
            let _ = slots.remove(idlest).stream.shutdown(Shutdown::Both);
        }
        let active = Mutex::new(Instant::now());
        let slot = Arc::new(Slot { stream, active });
        slots.push(Arc::clone(&slot));
        Ok(slot)
    }
}

/// An accepted connection. Writing fails if the other side reads nothing for too long.
#[derive(Debug)]
pub struct Connection {
    slot: Arc<Slot>,
    slots: Arc<Slots>,
}

impl Connection {
    /// Accepts a connection; returns the stream if there is no slot.
    pub fn accept(stream: TcpStream, slots: &Arc<Slots>) -> Result<Self, TcpStream> {
        let grace_period = Some(STALL_TIME);
        let prepared = stream
            .set_nodelay(true)
            .and_then(|()| stream.set_write_timeout(grace_period));
        if prepared.is_err() {
            return Err(stream);
        }
        let slots = Arc::clone(slots);
        let slot = slots.slot(stream)?;
        Ok(Self { slot, slots })
    }

    /// Reads the next bytes; fails with [`ErrorKind::TimedOut`] if nothing arrives before `until`.
    pub fn read_until(&mut self, piece: &mut [u8], until: Instant) -> io::Result<usize> {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.slot.stream.set_read_timeout(Some(left))?;
        (&self.slot.stream).read(piece)
    }

    /// Sends all bytes.
    ///
    /// # Errors
    /// If the connection is closed, or the other side reads nothing for too long.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        (&self.slot.stream).write_all(bytes)?;
        self.slot.touch();
        Ok(())
    }

    /// Forwards all data between this connection and another one, until either ends.
    ///
    /// # Errors
    /// If no thread can be started.
    #[cfg(feature = "live")]
    pub fn connect(&mut self, other: &TcpStream) -> io::Result<()> {
        self.slot.stream.set_read_timeout(None)?;
        thread::scope(|scope| {
            let there = thread::Builder::new().spawn_scoped(scope, || {
                pass_on(&self.slot.stream, other, &self.slot);
            })?;
            pass_on(other, &self.slot.stream, &self.slot);
            let _ = there.join();
            Ok(())
        })
    }

    /// Shuts down writing, and waits until the other side has read the answer.
    pub fn shut_down(&mut self) -> io::Result<()> {
        self.slot.stream.shutdown(Shutdown::Write)?;
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

impl Drop for Connection {
    fn drop(&mut self) {
        let mut slots = self.slots.lock();
        slots.retain(|slot| !Arc::ptr_eq(slot, &self.slot));
    }
}

#[cfg(feature = "live")]
/// Copies until the end, then closes both connections.
fn pass_on(mut from: &TcpStream, mut to: &TcpStream, slot: &Slot) {
    let mut piece = [0; 16 * 1024];
    while let Ok(bytes @ 1..) = from.read(&mut piece) {
        if to.write_all(&piece[..bytes]).is_err() {
            break;
        }
        slot.touch();
    }
    for stream in [from, to] {
        let _ = stream.shutdown(Shutdown::Both);
    }
}
