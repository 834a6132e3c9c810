//! Requests that the studio must not answer.

use crate::*;

#[test]
fn only_the_own_page_is_answered() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    let (host, token) = (studio.host(), format!("/{}/", studio.token));
    let page = studio.ask("GET", &token, &[&host], b"");
    assert_eq!(page.status, 200);
    assert!(page.text().contains("<title>stickslip studio</title>"));
    for rule in ["default-src 'none'", "nosniff", "no-referrer", "no-store"] {
        assert!(page.head.contains(rule), "{rule}: {}", page.head);
    }
    for path in [
        "/",
        "/api/state",
        "/0123456789abcdef0123456789abcdef/",
        "/favicon.ico",
    ] {
        let refused = studio.ask("GET", path, &[&host], b"");
        assert_eq!(refused.status, 403, "{path}");
        assert!(!refused.text().contains(&studio.token));
    }
    for wrong in ["Host: evil.example", "Host: 127.0.0.1:1", "Host: [::1]"] {
        assert_eq!(
            studio.ask("GET", &token, &[wrong], b"").status,
            403,
            "{wrong}"
        );
    }
    for wrong in [
        "Origin: null",
        "Origin: http://evil.example",
        "Origin: http://127.0.0.1:1",
    ] {
        let path = format!("{token}api/diagnosis");
        let refused = studio.ask("POST", &path, &[&host, wrong], br#"{"do": "start"}"#);
        assert_eq!(refused.status, 403, "{wrong}");
    }
    let own = format!("Origin: http://127.0.0.1:{}", studio.port);
    assert_eq!(
        studio
            .ask("GET", &format!("{token}api/state"), &[&host, &own], b"")
            .status,
        200
    );
    assert_eq!(studio.get("api/diagnosis").json()["phase"], "idle");
}

#[test]
fn nothing_outside_its_folder_is_served_or_written() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    for path in [
        "files/..%2f..%2fmodel.toml",
        "files/../../case/model.toml",
        "files/studio.json",
        "files/%2e%2e/model.toml",
        "files/..%2fby-hand/model.toml",
        "report/..%2f..",
        "api/records/..%2fmodel.toml",
        "api/records/%2fetc%2fpasswd",
        "../../etc/passwd",
    ] {
        let status = studio.get(path).status;
        assert!([404, 422, 403].contains(&status), "{path}: {status}");
    }
    let text = fs::read(case_directory().join("run-a.csv")).unwrap();
    let put = studio.own("PUT", "api/records/..%2f..%2fescaped.csv", &text);
    assert_eq!(put.status, 200, "{}", put.text());
    assert!(!place.path().join("escaped.csv").exists());
    assert!(
        place
            .path()
            .join("case/studio/dropped/_.._escaped.csv")
            .is_file()
    );
    for name in ["x.exe", "run-a.csv", ".csv"] {
        let refused = studio.own("PUT", &format!("api/records/{name}"), &text);
        assert_eq!(refused.status, 422, "{name}: {}", refused.text());
    }
}

#[test]
fn what_is_too_large_is_refused_before_it_comes() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    let head = format!(
        "PUT /{}/api/records/big.csv HTTP/1.1\r\n{}\r\nContent-Length: {}\r\n\r\n",
        studio.token,
        studio.host(),
        workbench::studio::MOST_UPLOAD + 1
    );
    let refused = studio.send(head.as_bytes()).unwrap();
    assert_eq!(refused.status, 413);
    assert!(
        refused.text().contains("up to 256 MiB"),
        "{}",
        refused.text()
    );
    // What is no record has a limit of its own.
    let long = vec![b' '; workbench::studio::MOST_CHOICES + 1];
    assert_eq!(studio.own("POST", "api/state", &long).status, 413);
    assert_eq!(studio.get("api/diagnosis").status, 200);
}

#[test]
fn ten_thousand_malformed_requests_are_survived() {
    let place = tempfile::tempdir().unwrap();
    let studio = Studio::on_case(place.path());
    let token = &studio.token;
    let host = studio.host();
    // A generator of Lehmer's kind; its numbers are the same every time.
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state * 48_271 % 0x7fff_ffff;
        state as usize % below
    };
    let paths = [
        "",
        "api/state",
        "api/diagnosis",
        "api/simulate",
        "api/believe",
        "api/records/run-a.csv",
        "files/repeat.py",
        "x/y/z",
    ];
    let bodies = [
        "",
        "{",
        "[]",
        "null",
        "{\"do\":\"stop\"}",
        "{\"do\":7}",
        "{\"settings\":[1,2]}",
        "{\"uses\":[{}]}",
        "\u{0}\u{1}",
        "{\"model\":\"believed\",\"settings\":{\"disc.inertia\":-1},\"drive\":{\"by\":\"record\",\"record\":\"run-a.csv\"}}",
        "{\"model\":\"believed\",\"drive\":{\"by\":\"held\",\"speed_rpm\":1e300,\"normal_force\":-5,\"duration\":1e300,\"step\":0}}",
        "{\"model\":\"../x\",\"drive\":{\"by\":\"rest\",\"record\":\"..\",\"step\":-1}}",
    ];
    let methods = [
        "GET",
        "POST",
        "PUT",
        "DELETE",
        "OPTIONS",
        "TRACE",
        "P\u{f6}ST",
        "get",
    ];
    for number in 0..10_000 {
        let mut stream = studio.connect();
        let (path, body) = (paths[random(paths.len())], bodies[random(bodies.len())]);
        // A record that is taken away would be no malformed request.
        let method = methods[random(methods.len())];
        let request = match number % 5 {
            0 => (0..random(200)).map(|_| random(256) as u8).collect(),
            1 => format!("GET /{token}/ HTTP/9.{}\r\n{host}\r\n\r\n", random(99)).into_bytes(),
            2 => format!("POST /{token}/{path} HTTP/1.1\r\n{host}\r\nContent-Length: 99999\r\n\r\n{body}").into_bytes(),
            3 => format!("POST /{token}/{path} HTTP/1.1\r\n{host}\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n{body}\r\n").into_bytes(),
            _ => format!("{method} /{token}/{path}%ff%00 HTTP/1.1\r\n{host}\r\nContent-Length: {}\r\n\r\n{body}", body.len()).into_bytes(),
        };
        let _ = stream.write_all(&request);
        let _ = stream.shutdown(Shutdown::Write);
        if number % 10 == 9 {
            let _ = stream.read(&mut [0; 64]);
        }
    }
    // Well formed and wrong: each is answered, and told what is wrong.
    for body in bodies {
        for path in &paths[1..5] {
            let answer = studio.own("POST", path, body.as_bytes());
            assert!(
                [200, 404, 409, 422].contains(&answer.status),
                "{path} {body}: {} {}",
                answer.status,
                answer.text()
            );
        }
    }
    let state = studio.get("api/state").json();
    assert_eq!(state["records"].as_array().unwrap().len(), 3);
    assert_eq!(state["records"][0]["problem"], Value::Null, "{state}");
}
