//! The head of an HTTP request, with size and time limits, and the origin of a page.

use std::time::{Duration, Instant};

use super::connection::Connection;

/// The maximum size of a head, in bytes: method, address and headers.
const MAX_HEAD_BYTES: usize = 8 * 1024;
/// The maximum number of headers.
const MAX_HEADERS: usize = 64;
/// The maximum time to receive a head. It is short, because silent connections keep others out.
const HEAD_TIME: Duration = Duration::from_secs(1);

/// The origin of a web page: scheme, host and port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin(pub(super) String);

/// A text that is not a valid origin.
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
        if !host.is_empty() && host.chars().all(is_part) {
            Ok(Self(text))
        } else {
            Err(NoOrigin)
        }
    }
}

/// The relevant parts of a request's head.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Head {
    /// The method, such as `GET`.
    pub method: String,
    /// The address, starting with its path.
    pub target: String,
    /// The origin of the requesting page, if a browser sends it.
    pub origin: Option<String>,
    /// The `Range` header.
    pub range: Option<String>,
    /// The received bytes: the head, and perhaps more.
    pub received: Vec<u8>,
    /// The `Host` header, in lower case.
    pub host: Option<String>,
}

impl Head {
    /// Reads a head. The error is an HTTP status.
    pub fn read(connection: &mut Connection) -> Result<Self, u16> {
        let until = Instant::now() + HEAD_TIME;
        let mut received = Vec::new();
        let mut piece = [0; 1024];
        loop {
            if let Some(head) = Self::parse(&received)? {
                return Ok(head);
            }
            if received.len() >= MAX_HEAD_BYTES {
                return Err(431);
            }
            let room = piece.len().min(MAX_HEAD_BYTES - received.len());
            let read = connection.read_until(&mut piece[..room], until);
            match read.map_err(|_| 408_u16)? {
                0 => return Err(400),
                bytes => received.extend_from_slice(&piece[..bytes]),
            }
        }
    }

    /// Parses the head; `None` while it is incomplete.
    fn parse(received: &[u8]) -> Result<Option<Self>, u16> {
        let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
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
