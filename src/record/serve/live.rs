//! The same messages as in a recording, streamed to a viewer on this machine.

use std::io::Write;
use std::net::{SocketAddr, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use foxglove::websocket::{Capability, ChannelView, Client, ServerListener};
use foxglove::{
    ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, WebSocketServer,
    WebSocketServerHandle,
};

use super::listener::{Listener, Opened, Origin, hidden_host};
use crate::record::info::RecordingKind;
use crate::record::topics::Topic;

/// Messages that may wait for a slow viewer; the oldest are dropped, so that nobody waits for it.
const BACKLOG: usize = 16 * 1024;
/// How often viewers are told the time: they must not drop messages to hear it.
const CLOCK_PERIOD: Duration = Duration::from_millis(10);
/// How long the last messages may take to their viewers.
const FAREWELL: Duration = Duration::from_millis(300);

/// A stream that viewers can join at any time.
///
/// The server of the foxglove crate lets in every page and any number of connections, so it listens
/// where no page can find it, and viewers come to it through a [`Listener`].
///
/// Every message is complete in itself, so whoever comes late is given the last one of each topic
/// and sees the whole picture.
pub struct Stream {
    server: WebSocketServerHandle,
    listener: Opened,
    /// Server and channels only borrow it: without it nobody hears of the channels.
    _context: Arc<Context>,
    memory: Arc<Memory>,
    told_time: Option<Instant>,
}

impl Stream {
    /// Listens on a port of 127.0.0.1; 0 takes any that is free. Pages of the viewers are let in,
    /// and those of `origins`.
    ///
    /// # Errors
    /// When the port is taken or forbidden.
    pub fn open(port: u16, origins: &[Origin]) -> Result<Self, FoxgloveError> {
        // First, because a port that is taken is the likeliest fault.
        let mut listener = Listener::bind(port)?;
        origins.iter().for_each(|origin| listener.allow(origin));
        let host = hidden_host()?;
        let context = Context::new();
        let memory = Arc::new(Memory::new(&context)?);
        let server = WebSocketServer::new()
            .name("xcscr")
            .bind(host.to_string(), 0)
            .capabilities([Capability::Time])
            .message_backlog_size(BACKLOG)
            .listener(Arc::clone(&memory) as Arc<dyn ServerListener>)
            .context(&context)
            .start_blocking()?;
        let inner = SocketAddr::from((host, server.port()));
        let listener = listener.open(move |head, connection| {
            let mut stream = TcpStream::connect(inner)?;
            stream.write_all(&head.received)?;
            connection.connect(&stream)
        })?;
        Ok(Self {
            server,
            listener,
            _context: context,
            memory,
            told_time: None,
        })
    }

    /// Where viewers find it, such as `ws://127.0.0.1:8765`.
    pub fn url(&self) -> String {
        format!("ws://127.0.0.1:{}", self.listener.port())
    }

    /// Did anyone connect who has not gone?
    pub fn has_viewers(&self) -> bool {
        self.server.client_count() > 0
    }

    /// Does anyone listen to a topic?
    pub fn is_watched(&self) -> bool {
        self.memory.subscriptions.load(Ordering::Relaxed) > 0
    }

    /// Sends a message; never waits for a viewer. `time_ns` is simulation time in nanoseconds.
    pub fn send(&mut self, topic: Topic, time_ns: u64, data: &[u8]) {
        if self.told_time.is_none_or(|at| at.elapsed() >= CLOCK_PERIOD) {
            self.server.broadcast_time(time_ns);
            self.told_time = Some(Instant::now());
        }
        self.memory.send(topic, time_ns, data);
    }
}

impl Drop for Stream {
    /// The server ends with the program, and what is still in its queues is lost.
    fn drop(&mut self) {
        if self.is_watched() {
            thread::sleep(FAREWELL);
        }
    }
}

/// A message and its time in nanoseconds.
type Said = Option<(u64, Vec<u8>)>;

/// The channels, and the last message of each for those who come late.
struct Memory {
    channels: Vec<Arc<RawChannel>>,
    /// By [`Topic`].
    last: Mutex<Vec<Said>>,
    subscriptions: AtomicUsize,
}

impl Memory {
    fn new(context: &Arc<Context>) -> Result<Self, FoxgloveError> {
        let channels = Topic::ALL.iter().map(|topic| {
            ChannelBuilder::new(topic.name())
                .schema(topic.schema(RecordingKind::Run).clone())
                .message_encoding(topic.message_encoding())
                .context(context)
                .build_raw()
        });
        Ok(Self {
            channels: channels.collect::<Result<_, _>>()?,
            last: Mutex::new(vec![None; Topic::ALL.len()]),
            subscriptions: AtomicUsize::new(0),
        })
    }

    fn last(&self) -> MutexGuard<'_, Vec<Said>> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn send(&self, topic: Topic, time_ns: u64, data: &[u8]) {
        // Locked until it is sent, so that nobody is given it before and after.
        let mut last = self.last();
        let (time, message) = last[topic as usize].get_or_insert_default();
        *time = time_ns;
        message.clear();
        message.extend_from_slice(data);
        let meta = PartialMetadata::with_log_time(time_ns);
        self.channels[topic as usize].log_with_meta(data, meta);
    }
}

impl ServerListener for Memory {
    fn on_subscribe(&self, client: Client, channel: ChannelView) {
        self.subscriptions.fetch_add(1, Ordering::Relaxed);
        let last = self.last();
        let mut known = self.channels.iter().zip(last.iter());
        let found = known.find(|(one, _)| one.topic() == channel.topic());
        if let Some((channel, Some((time_ns, data)))) = found {
            let meta = PartialMetadata::with_log_time(*time_ns);
            channel.log_with_meta_to_sink(data, meta, client.sink_id());
        }
    }

    fn on_unsubscribe(&self, _: Client, _: ChannelView) {
        self.subscriptions.fetch_sub(1, Ordering::Relaxed);
    }
}
