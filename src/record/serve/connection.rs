//! Connections: how many there are at a time, and how long each may be silent.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
#[cfg(feature = "live")]
use std::thread;
use std::time::{Duration, Instant};

/// Connections at a time: what a few browsers open, and few enough for `ulimit -n 64` when each
/// takes a socket and a file.
const MOST_GUESTS: usize = 24;
/// How long a connection may take nothing of what is sent.
const STALL_TIME: Duration = Duration::from_secs(30);
/// A connection that did nothing for so long gives way to a new one when all places are taken.
const IDLE_TIME: Duration = Duration::from_secs(1);
/// How long, and how much, is read and thrown away at the end: closing a connection with unread
/// bytes would take the answer back.
const FAREWELL_TIME: Duration = Duration::from_secs(1);
const MOST_FAREWELL: u64 = 64 * 1024;

/// Who is connected.
#[derive(Debug, Default)]
pub struct Room(Mutex<Vec<Arc<Slot>>>);

/// A connection, and when something last went over it.
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

impl Room {
    fn seats(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Slot>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A seat for a new connection. When all are taken, whoever has been idle for longest gives
    /// way, so that silent connections keep nobody out; `None` when nobody is idle.
    fn slot(&self, stream: TcpStream) -> Result<Arc<Slot>, TcpStream> {
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
        let slot = Arc::new(Slot { stream, active });
        seats.push(Arc::clone(&slot));
        Ok(slot)
    }
}

/// A connection that was let in. Writing to it fails when nothing is taken for too long.
#[derive(Debug)]
pub struct Connection {
    slot: Arc<Slot>,
    room: Arc<Room>,
}

impl Connection {
    /// Lets a connection in; gives it back when there is no place.
    pub fn enter(stream: TcpStream, room: &Arc<Room>) -> Result<Self, TcpStream> {
        let grace_period = Some(STALL_TIME);
        let prepared = stream
            .set_nodelay(true)
            .and_then(|()| stream.set_write_timeout(grace_period));
        if prepared.is_err() {
            return Err(stream);
        }
        let room = Arc::clone(room);
        let slot = room.slot(stream)?;
        Ok(Self { slot, room })
    }

    /// Reads what comes next; fails with [`ErrorKind::TimedOut`] when nothing does until then.
    pub fn read_until(&mut self, piece: &mut [u8], until: Instant) -> io::Result<usize> {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        self.slot.stream.set_read_timeout(Some(left))?;
        (&self.slot.stream).read(piece)
    }

    /// Sends all of it.
    ///
    /// # Errors
    /// When the connection has gone, or takes nothing for too long.
    pub fn say(&mut self, bytes: &[u8]) -> io::Result<()> {
        (&self.slot.stream).write_all(bytes)?;
        self.slot.touch();
        Ok(())
    }

    /// Passes everything on between the connection and another connection, until either has enough.
    ///
    /// # Errors
    /// When no thread can be started.
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

    /// Says that nothing more comes, and waits a moment until the connection has understood.
    pub fn take_leave(&mut self) -> io::Result<()> {
        self.slot.stream.shutdown(Shutdown::Write)?;
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

impl Drop for Connection {
    fn drop(&mut self) {
        let mut seats = self.room.seats();
        seats.retain(|slot| !Arc::ptr_eq(slot, &self.slot));
    }
}

#[cfg(feature = "live")]
/// Copies until the end, then ends both connections.
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
