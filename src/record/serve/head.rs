//! What a request says: its head, held to bounds, and the page that it comes from.

use std::time::{Duration, Instant};

use super::connection::Connection;

/// Bytes of a head: method, address and headers.
const MOST_HEAD: usize = 8 * 1024;
/// Headers of a request.
const MOST_HEADERS: usize = 64;
/// How long a head may take.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// The origin of a web page: scheme, host and port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin(pub(super) String);

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
    /// The machine that is asked, in small letters.
    pub host: Option<String>,
}

impl Head {
    /// Reads a head, or the status that says why there is none.
    pub fn read(connection: &mut Connection) -> Result<Self, u16> {
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
            let read = connection.read_until(&mut piece[..room], until);
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
