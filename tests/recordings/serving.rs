//! `replay` under attack: by pages that a browser shows, and by clients that are broken,
//! slow or many.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;

use crate::kit::desk::Desk;
use crate::kit::program::wait_until;
use crate::kit::served::Served;

const SAMPLE: &str = "recordings/sample-maze4.mcap";
const FILE: &str = "/1/sample-maze4.mcap";
const FOXGLOVE: &str = "https://app.foxglove.dev";
const EVIL: &str = "https://evil.example";

fn sample() -> Vec<u8> {
    fs::read(SAMPLE).unwrap()
}

fn serve(line: &str) -> Served {
    Served::new(&Desk::new(), line)
}

#[track_caller]
fn assert_serves(server: &Served, when: &str) {
    let (head, body) = server.ask("GET", FILE, "");
    assert!(
        head.starts_with("HTTP/1.1 200") && body == sample(),
        "{when}: {head}"
    );
}

#[test]
fn only_pages_of_the_viewers_and_of_allowed_origins_are_answered() {
    let server = serve(&format!("{SAMPLE} --allow-origin http://localhost:8080"));
    let origin = |origin: &str| format!("Origin: {origin}\r\n");
    for good in [
        FOXGLOVE,
        "https://lichtblick-suite.github.io",
        "http://localhost:8080",
    ] {
        let (head, body) = server.ask("GET", FILE, &origin(good));
        assert!(
            head.starts_with("HTTP/1.1 200") && body == sample(),
            "{good}: {head}"
        );
        let told = format!("Access-Control-Allow-Origin: {good}\r\n");
        assert!(
            head.contains(&told) && head.contains("Vary: Origin"),
            "{head}"
        );
        let preflight = origin(good) + "Access-Control-Request-Headers: range\r\n";
        let (head, _) = server.ask("OPTIONS", FILE, &preflight);
        assert!(
            head.starts_with("HTTP/1.1 204") && head.contains(&told),
            "{head}"
        );
        assert!(head.contains("Access-Control-Allow-Headers: *"), "{head}");
        assert!(
            head.contains("Access-Control-Allow-Private-Network: true"),
            "{head}"
        );
    }
    let near = [
        "https://app.foxglove.dev.evil.example",
        "http://app.foxglove.dev",
    ];
    for bad in [EVIL, "null", "http://localhost:8081", near[0], near[1]] {
        for method in ["GET", "HEAD", "OPTIONS"] {
            let (head, body) = server.ask(method, FILE, &origin(bad));
            assert!(
                head.starts_with("HTTP/1.1 403") && body.is_empty(),
                "{bad}: {head}"
            );
            assert!(!head.contains("Access-Control"), "{bad}: {head}");
        }
    }
    let (head, _) = server.ask("GET", FILE, "");
    assert!(!head.contains("Access-Control"), "{head}");
    assert!(
        head.contains("Cross-Origin-Resource-Policy: same-origin"),
        "{head}"
    );
}

#[test]
fn a_name_that_was_made_to_resolve_to_this_machine_is_refused() {
    let server = serve(SAMPLE);
    let (port, base) = (server.port, &server.base);
    let status =
        |hosts: &str| server.status(format!("GET {base}{FILE} HTTP/1.1\r\n{hosts}\r\n").as_bytes());
    for host in ["127.0.0.1", "localhost", "LocalHost"] {
        assert_eq!(status(&format!("Host: {host}:{port}\r\n")), "200", "{host}");
    }
    for host in [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        format!("127.0.0.1.evil.example:{port}"),
        "127.0.0.1".to_owned(),
        format!("127.0.0.1:{}", port ^ 1),
    ] {
        assert_eq!(status(&format!("Host: {host}\r\n")), "421", "{host}");
    }
    assert_eq!(status(""), "400");
    let own = format!("Host: 127.0.0.1:{port}\r\n");
    assert_eq!(status(&format!("{own}Host: evil.example\r\n")), "400");
}

#[test]
fn addresses_cannot_be_guessed() {
    let (one, two) = (serve(SAMPLE), serve(SAMPLE));
    assert_ne!(one.base, two.base);
    for server in [&one, &two] {
        let secret = &server.base[1..];
        assert!(secret.len() == 32 && secret.bytes().all(|b| b.is_ascii_hexdigit()));
    }
    for path in [
        FILE,
        "/",
        "/0/foxglove-layout.json",
        &format!("{}{FILE}", one.base),
    ] {
        let request = format!(
            "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n",
            two.port
        );
        assert_eq!(two.status(request.as_bytes()), "404", "{path}");
    }
}

#[cfg(unix)]
#[test]
fn a_recording_that_becomes_a_link_while_it_is_served_gives_away_nothing() {
    let desk = Desk::new();
    let (recording, link) = (desk.path("sample-maze4.mcap"), desk.path("link.mcap"));
    desk.write("sample-maze4.mcap", sample());
    desk.write("secret", "secret");
    std::os::unix::fs::symlink(&recording, &link).unwrap();
    // A link that the user offers is followed once.
    for offered in ["sample-maze4.mcap", "link.mcap"] {
        let server = Served::new(&desk, &format!("@{offered}"));
        let address = format!("/1/{offered}");
        assert_eq!(server.ask("GET", &address, "").1, sample(), "{address}");
        fs::remove_file(&recording).unwrap();
        std::os::unix::fs::symlink(desk.path("secret"), &recording).unwrap();
        let (head, body) = server.ask("GET", &address, "");
        let is_refused = head.starts_with("HTTP/1.1 500") && body.is_empty();
        assert!(is_refused, "{address}: {head}");
        fs::remove_file(&recording).unwrap();
        desk.write("sample-maze4.mcap", sample());
    }
}

#[cfg(feature = "long")]
#[test]
fn requests_beyond_the_bounds_are_refused_and_the_next_one_is_served() {
    let server = serve(SAMPLE);
    let start = format!(
        "GET {}{FILE} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n",
        server.base, server.port
    );
    let with = |rest: &str| [start.as_bytes(), rest.as_bytes(), b"\r\n"].concat();
    let long = "x".repeat(4 << 20);
    let lines = "X-Line: 1\r\n".repeat(200);
    for (request, wanted) in [
        (with("Content-Length: 9223372036854775807\r\n"), "413"),
        (with("Content-Length: 18446744073709551616\r\n"), "413"),
        (with("Content-Length: -1\r\n"), "413"),
        (with("Transfer-Encoding: chunked\r\n"), "413"),
        (with("Content-Length: 0\r\n"), "200"),
        (with(&format!("X-Long: {long}\r\n")), "431"),
        (with(&lines), "431"),
        (long.clone().into_bytes(), "431"),
        (format!("GET /{long} HTTP/1.1\r\n").into_bytes(), "431"),
        (
            b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03 hello TLS".to_vec(),
            "400",
        ),
        (vec![0; 100_000], "400"),
    ] {
        let shown = String::from_utf8_lossy(&request[..request.len().min(200)]).into_owned();
        assert_eq!(server.status(&request), wanted, "{shown}");
        assert_serves(&server, &shown);
    }
}

/// More connections than the server holds, and than it has descriptors for.
#[cfg(unix)]
#[cfg(feature = "long")]
#[test]
fn many_silent_or_slow_clients_keep_nobody_out_even_with_64_descriptors() {
    let limited = Desk::new().limited("-n 64", &format!("replay {SAMPLE}"));
    let mut server = Served::of(limited);
    let (base, port) = (&server.base, server.port);
    let silent: Vec<TcpStream> = (0..100).map(|_| server.connect()).collect();
    served_within_a_while(&server, "silent clients");
    // Each asks for the file again and again, and reads nothing.
    let request = format!("GET {base}{FILE} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    let slow: Vec<TcpStream> = (0..100).map(|_| server.connect()).collect();
    for mut stream in &slow {
        let _ = stream.write_all(&request.as_bytes()[..20]);
    }
    served_within_a_while(&server, "half a head");
    for mut stream in &slow {
        let _ = stream.write_all(request.as_bytes());
    }
    served_within_a_while(&server, "answers that nobody reads");
    drop((silent, slow));
    served_within_a_while(&server, "all have gone");
    assert!(server.child.try_wait().unwrap().is_none());
}

/// A slot of a client that sends no request is free after a second.
fn served_within_a_while(server: &Served, when: &str) {
    wait_until(when, || server.ask_or_nothing(FILE).ends_with(&sample()));
}

#[cfg(feature = "long")]
#[test]
fn a_client_that_reads_slowly_gets_everything_while_others_are_served() {
    let desk = Desk::new();
    desk.write("large.mcap", sample());
    let server = Served::new(&desk, "@large.mcap");
    // More than any buffer between the two holds.
    let mut options = fs::OpenOptions::new();
    let grown = options.write(true).open(desk.path("large.mcap")).unwrap();
    grown.set_len(64 << 20).unwrap();
    let mut slow = server.connect();
    let (base, port) = (&server.base, server.port);
    let request = format!("GET {base}/1/large.mcap HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    slow.write_all(request.as_bytes()).unwrap();
    let mut first = [0; 1000];
    slow.read_exact(&mut first).unwrap();
    for _ in 0..5 {
        let (_, body) = server.ask("GET", "/1/large.mcap", "Range: bytes=0-7\r\n");
        assert_eq!(body, b"\x89MCAP0\r\n");
    }
    let mut rest = Vec::new();
    slow.read_to_end(&mut rest).unwrap();
    assert!(first.len() + rest.len() > 64 << 20);
}
