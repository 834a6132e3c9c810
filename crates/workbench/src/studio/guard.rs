//! Who may ask: only the page of this studio, on this machine.
//!
//! A page of another site can make a browser send requests to 127.0.0.1, and a name that is resolved anew can make it read the
//! answers. So every request needs the token of the address, the studio's own Host, and, where the browser states an Origin,
//! the studio's own.

use axum::http::{HeaderMap, StatusCode, header};
use thiserror::Error;

/// Most bytes of a file that is dropped onto the page: 256 MiB.
pub const MOST_UPLOAD: usize = 256 << 20;
/// Most bytes of anything else that the page sends: 1 MiB.
pub const MOST_CHOICES: usize = 1 << 20;
/// Random bytes of the token.
const TOKEN_BYTES: usize = 16;

/// Why a request is refused.
#[derive(Debug, Error, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// The address lacks the token.
    #[error(
        "403: this is not the address that `stickslip studio` printed; its token is missing or of an earlier start"
    )]
    Token,
    /// The request is for another host.
    #[error("403: the studio answers to 127.0.0.1 and localhost at its own port alone")]
    Host,
    /// A page of another site asks.
    #[error("403: the studio answers to its own page alone")]
    Origin,
    /// The body is too large.
    #[error("413: the file is too large; the studio takes up to {} MiB, and larger records are thinned out anyway", MOST_UPLOAD >> 20)]
    TooLarge,
}

impl Refusal {
    /// Status of the answer.
    pub fn status(self) -> StatusCode {
        match self {
            Self::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
            Self::Token | Self::Host | Self::Origin => StatusCode::FORBIDDEN,
        }
    }
}

/// What requests are held against.
#[derive(Debug, Clone)]
pub struct Guard {
    token: String,
    port: u16,
}

impl Guard {
    /// With a new token.
    ///
    /// # Errors
    /// The operating system gives no random bytes.
    pub fn new(port: u16) -> Result<Self, getrandom::Error> {
        let mut random = [0; TOKEN_BYTES];
        getrandom::fill(&mut random)?;
        Ok(Self {
            token: random.iter().map(|byte| format!("{byte:02x}")).collect(),
            port,
        })
    }

    /// The page's address.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// The address without its token.
    pub fn place(&self) -> String {
        format!("http://127.0.0.1:{}", self.port)
    }

    /// Whether the request may be answered.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn check(&self, path: &str, headers: &HeaderMap) -> Result<(), Refusal> {
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let one = |name| {
            let mut all = headers.get_all(name).iter();
            let first = all.next();
            // A second one would be another's to read.
            first.filter(|_| all.next().is_none())
        };
        let host = one(header::HOST).and_then(|value| value.to_str().ok());
        if !host.is_some_and(|host| hosts.iter().any(|own| own == host)) {
            return Err(Refusal::Host);
        }
        if headers.contains_key(header::ORIGIN) {
            let origin = one(header::ORIGIN).and_then(|value| value.to_str().ok());
            let is_own = |origin: &str| {
                let host = origin.strip_prefix("http://");
                host.is_some_and(|host| hosts.iter().any(|own| own == host))
            };
            if !origin.is_some_and(is_own) {
                return Err(Refusal::Origin);
            }
        }
        let given = path
            .strip_prefix('/')
            .and_then(|path| path.split('/').next());
        if !given.is_some_and(|given| is_same(given.as_bytes(), self.token.as_bytes())) {
            return Err(Refusal::Token);
        }
        let length = one(header::CONTENT_LENGTH).and_then(|value| value.to_str().ok());
        let length = length.and_then(|length| length.parse::<u64>().ok());
        if length.is_some_and(|length| length > MOST_UPLOAD as u64) {
            return Err(Refusal::TooLarge);
        }
        Ok(())
    }
}

/// Whether both are the same, in a time that does not tell where they differ.
fn is_same(one: &[u8], other: &[u8]) -> bool {
    let differences = one.iter().zip(other).fold(0, |all, (a, b)| all | (a ^ b));
    one.len() == other.len() && differences == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(path: &str, headers: &[(&str, &str)]) -> Option<Refusal> {
        let guard = Guard {
            token: "secret".to_owned(),
            port: 4000,
        };
        let mut all = HeaderMap::new();
        for (name, value) in headers {
            let name: header::HeaderName = name.parse().unwrap();
            all.append(name, value.parse().unwrap());
        }
        guard.check(path, &all).err()
    }

    #[test]
    fn only_the_own_page_may_ask() {
        let own = ("host", "127.0.0.1:4000");
        assert_eq!(refused("/secret/", &[own]), None);
        assert_eq!(
            refused("/secret/api/state", &[("host", "localhost:4000")]),
            None
        );
        assert_eq!(
            refused("/secret/", &[own, ("origin", "http://127.0.0.1:4000")]),
            None
        );
        for path in [
            "/",
            "",
            "/secre/",
            "/secrets/",
            "//secret/",
            "/api/state?secret",
        ] {
            assert_eq!(refused(path, &[own]), Some(Refusal::Token), "{path}");
        }
        for host in [
            "127.0.0.1",
            "127.0.0.1:80",
            "evil.example:4000",
            "127.0.0.1:4000.evil.example",
        ] {
            assert_eq!(
                refused("/secret/", &[("host", host)]),
                Some(Refusal::Host),
                "{host}"
            );
        }
        assert_eq!(refused("/secret/", &[]), Some(Refusal::Host));
        assert_eq!(refused("/secret/", &[own, own]), Some(Refusal::Host));
        for origin in [
            "null",
            "http://evil.example",
            "https://127.0.0.1:4000",
            "http://127.0.0.1:4001",
        ] {
            let found = refused("/secret/", &[own, ("origin", origin)]);
            assert_eq!(found, Some(Refusal::Origin), "{origin}");
        }
        let large = ("content-length", "268435457");
        assert_eq!(refused("/secret/", &[own, large]), Some(Refusal::TooLarge));
    }

    #[test]
    fn tokens_differ() {
        let (one, other) = (Guard::new(1).unwrap(), Guard::new(1).unwrap());
        assert_ne!(one.address(), other.address());
    }
}
