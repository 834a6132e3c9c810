//! A studio that runs for a test, and what it answers.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::library;

/// Longest that a diagnosis of the small case may take here, unoptimised and beside other tests.
const PATIENCE: Duration = Duration::from_secs(300);

pub fn case_directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/unbalance")
}

/// A studio that runs, and ends with its test.
pub struct Studio {
    pub child: Child,
    pub port: u16,
    pub token: String,
}

impl Drop for Studio {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What was answered.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub fn json(&self) -> Value {
        assert_eq!(self.status, 200, "{}", self.text());
        serde_json::from_slice(&self.body).unwrap()
    }

    /// A column of an answer with curves.
    pub fn column(&self, name: &str) -> Vec<f64> {
        assert_eq!(self.status, 200, "{}", self.text());
        let length = u32::from_le_bytes(self.body[..4].try_into().unwrap()) as usize;
        let header: Value = serde_json::from_slice(&self.body[4..4 + length]).unwrap();
        let rows = header["rows"].as_u64().unwrap() as usize;
        let names = header["columns"].as_array().unwrap();
        let place = names.iter().position(|own| own == name).unwrap();
        let first = 4 + length + 8 * rows * place;
        let numbers = self.body[first..first + 8 * rows].chunks_exact(8);
        numbers
            .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
            .collect()
    }
}

impl Studio {
    pub fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_stickslip"))
            .arg("studio")
            .args(arguments)
            .args(["--no-browser"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut address = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut address)
            .unwrap();
        let rest = address.trim().strip_prefix("http://127.0.0.1:").unwrap();
        let (port, token) = rest.split_once('/').unwrap();
        Self {
            child,
            port: port.parse().unwrap(),
            token: token.trim_matches('/').to_owned(),
        }
    }

    /// On a copy of the small case, with the library that was built beside the test.
    pub fn on_case(place: &Path) -> Self {
        let case = place.join("case");
        fs::create_dir_all(&case).unwrap();
        for entry in fs::read_dir(case_directory()).unwrap() {
            let path = entry.unwrap().path();
            fs::copy(&path, case.join(path.file_name().unwrap())).unwrap();
        }
        let library = library("stickslip");
        Self::start(&[case.to_str().unwrap(), "--library", &library])
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        stream
    }

    /// Sends bytes as they are, and hears the answer.
    pub fn send(&self, request: &[u8]) -> Option<Answer> {
        let mut stream = self.connect();
        stream.write_all(request).ok()?;
        let mut all = Vec::new();
        let _ = stream.read_to_end(&mut all);
        let end = all.windows(4).position(|four| four == b"\r\n\r\n")?;
        let head = String::from_utf8_lossy(&all[..end]).into_owned();
        let status = head.split(' ').nth(1)?.parse().ok()?;
        Some(Answer {
            status,
            head,
            body: all[end + 4..].to_vec(),
        })
    }

    pub fn host(&self) -> String {
        format!("Host: 127.0.0.1:{}", self.port)
    }

    pub fn ask(&self, method: &str, path: &str, headers: &[&str], body: &[u8]) -> Answer {
        let mut request = format!(
            "{method} {path} HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n",
            body.len()
        );
        for header in headers {
            request += &format!("{header}\r\n");
        }
        let mut request = (request + "\r\n").into_bytes();
        request.extend(body);
        self.send(&request).unwrap()
    }

    pub fn own(&self, method: &str, path: &str, body: &[u8]) -> Answer {
        let path = format!("/{}/{path}", self.token);
        self.ask(method, &path, &[&self.host()], body)
    }

    pub fn get(&self, path: &str) -> Answer {
        self.own("GET", path, b"")
    }

    pub fn post(&self, path: &str, value: &Value) -> Answer {
        self.own("POST", path, value.to_string().as_bytes())
    }

    /// Waits until the diagnosis is in one of these phases.
    pub fn wait(&self, phases: &[&str]) -> Value {
        let begun = Instant::now();
        loop {
            let progress = self.get("api/diagnosis").json();
            let phase = progress["phase"].as_str().unwrap();
            if phases.contains(&phase) {
                return progress;
            }
            assert!(begun.elapsed() < PATIENCE, "{progress}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}
