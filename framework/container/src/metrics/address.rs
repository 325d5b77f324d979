//! Where figures are served.

use std::net::{Ipv4Addr, SocketAddr};

/// An address to listen at: `127.0.0.1:9464`, `[::1]:9464`, or a port alone, which means this machine
/// only.
///
/// # Errors
/// What is wanted instead.
pub fn parse_address(text: &str) -> Result<SocketAddr, String> {
    let port = text.strip_prefix(':').unwrap_or(text);
    if let Ok(port) = port.parse::<u16>() {
        return Ok((Ipv4Addr::LOCALHOST, port).into());
    }
    let address = text.replace("localhost", "127.0.0.1");
    address.parse().map_err(|_not_an_address| {
        "an address with a port is wanted, as in 127.0.0.1:9464, or a port".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses() {
        for (text, expected) in [
            ("9464", Some("127.0.0.1:9464")),
            (":9464", Some("127.0.0.1:9464")),
            ("localhost:80", Some("127.0.0.1:80")),
            ("0.0.0.0:9464", Some("0.0.0.0:9464")),
            ("[::1]:9464", Some("[::1]:9464")),
            ("127.0.0.1", None),
            ("70000", None),
            ("robot:9464", None),
            ("", None),
        ] {
            let found = parse_address(text).ok().map(|address| address.to_string());
            assert_eq!(found.as_deref(), expected, "{text}");
        }
    }
}
