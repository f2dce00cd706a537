//! Streams the messages of a recording to a viewer on this machine.

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

/// The maximum number of messages queued for a slow viewer. The oldest are dropped, so that a slow
/// viewer blocks nothing.
const BACKLOG: usize = 16 * 1024;
/// The interval of clock messages. It is long enough that they do not displace other messages.
const CLOCK_PERIOD: Duration = Duration::from_millis(10);
/// The maximum time to deliver the last messages to viewers.
const DRAIN_TIME: Duration = Duration::from_millis(300);

/// A stream that viewers can join at any time.
///
/// The server of the foxglove crate accepts every page and any number of connections. It therefore
/// listens at an address that no page can find, and viewers connect through a [`Listener`].
///
/// Every message is complete in itself. A new viewer gets the last message of each topic and thus
/// the whole picture.
pub struct Stream {
    server: WebSocketServerHandle,
    listener: Opened,
    /// Server and channels only borrow the context. Without it, the channels are not announced.
    _context: Arc<Context>,
    broadcast: Arc<Broadcast>,
    clock_sent: Option<Instant>,
}

impl Stream {
    /// Listens on a port of 127.0.0.1; 0 selects a free one. Pages of the viewers and of `origins`
    /// are allowed.
    ///
    /// # Errors
    /// If the port is taken or forbidden.
    pub fn open(port: u16, origins: &[Origin]) -> Result<Self, FoxgloveError> {
        // Bind first, because a port that is taken is the most likely error.
        let mut listener = Listener::bind(port)?;
        origins.iter().for_each(|origin| listener.allow(origin));
        let host = hidden_host()?;
        let context = Context::new();
        let broadcast = Arc::new(Broadcast::new(&context)?);
        let server = WebSocketServer::new()
            .name("xcscr")
            .bind(host.to_string(), 0)
            .capabilities([Capability::Time])
            .message_backlog_size(BACKLOG)
            .listener(Arc::clone(&broadcast) as Arc<dyn ServerListener>)
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
            broadcast,
            clock_sent: None,
        })
    }

    /// Returns the address for viewers, such as `ws://127.0.0.1:8765`.
    pub fn url(&self) -> String {
        format!("ws://127.0.0.1:{}", self.listener.port())
    }

    /// Returns true if a viewer is connected.
    pub fn has_viewers(&self) -> bool {
        self.server.client_count() > 0
    }

    /// Returns true if a viewer is subscribed to a topic.
    pub fn is_watched(&self) -> bool {
        self.broadcast.subscriptions.load(Ordering::Relaxed) > 0
    }

    /// Sends a message without waiting for viewers. `time_ns` is simulation time in nanoseconds.
    pub fn send(&mut self, topic: Topic, time_ns: u64, data: &[u8]) {
        if self
            .clock_sent
            .is_none_or(|at| at.elapsed() >= CLOCK_PERIOD)
        {
            self.server.broadcast_time(time_ns);
            self.clock_sent = Some(Instant::now());
        }
        self.broadcast.send(topic, time_ns, data);
    }
}

impl Drop for Stream {
    /// Gives the queued messages time: the server ends with the program, and its queues are lost.
    fn drop(&mut self) {
        if self.is_watched() {
            thread::sleep(DRAIN_TIME);
        }
    }
}

/// A message and its time in nanoseconds.
type LastMessage = Option<(u64, Vec<u8>)>;

/// The channels, and the last message of each for viewers that join later.
struct Broadcast {
    channels: Vec<Arc<RawChannel>>,
    /// The last messages by [`Topic`].
    last: Mutex<Vec<LastMessage>>,
    subscriptions: AtomicUsize,
}

impl Broadcast {
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

    fn last(&self) -> MutexGuard<'_, Vec<LastMessage>> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn send(&self, topic: Topic, time_ns: u64, data: &[u8]) {
        // Locked until the message is sent, so that a new subscriber does not get it twice.
        let mut last = self.last();
        let (time, message) = last[topic as usize].get_or_insert_default();
        *time = time_ns;
        message.clear();
        message.extend_from_slice(data);
        let meta = PartialMetadata::with_log_time(time_ns);
        self.channels[topic as usize].log_with_meta(data, meta);
    }
}

impl ServerListener for Broadcast {
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
