//! The page's server: on 127.0.0.1, behind the [`Guard`].

use std::net::Ipv4Addr;
use std::sync::Arc;

use anyhow::Context;
use axum::Router;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, Path, Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post, put};
use serde::de::DeserializeOwned;
use serde_json::json;
use tokio::net::TcpListener;
use tokio::sync::Notify;

use super::diagnosis::Wish;
use super::error::StudioError;
use super::export::{MODEL, SCRIPT};
use super::guard::{Guard, MOST_CHOICES, MOST_UPLOAD};
use super::session::Session;
use super::simulate::Order;
use crate::diagnose::case::STACK;
use crate::diagnose::report;
use crate::outcome::Outcome;

/// What the page's own files are.
const PAGE: [(&str, &str, &str); 12] = [
    (
        "",
        "text/html; charset=utf-8",
        include_str!("page/index.html"),
    ),
    (
        "studio.css",
        "text/css; charset=utf-8",
        include_str!("page/studio.css"),
    ),
    (
        "studio.js",
        "text/javascript; charset=utf-8",
        include_str!("page/studio.js"),
    ),
    (
        "records.js",
        "text/javascript; charset=utf-8",
        include_str!("page/records.js"),
    ),
    (
        "rig.js",
        "text/javascript; charset=utf-8",
        include_str!("page/rig.js"),
    ),
    (
        "where.js",
        "text/javascript; charset=utf-8",
        include_str!("page/where.js"),
    ),
    (
        "what.js",
        "text/javascript; charset=utf-8",
        include_str!("page/what.js"),
    ),
    (
        "take.js",
        "text/javascript; charset=utf-8",
        include_str!("page/take.js"),
    ),
    (
        "charts.js",
        "text/javascript; charset=utf-8",
        include_str!("page/charts.js"),
    ),
    (
        "server.js",
        "text/javascript; charset=utf-8",
        include_str!("page/server.js"),
    ),
    (
        "uplot.js",
        "text/javascript; charset=utf-8",
        include_str!("page/uplot.js"),
    ),
    (
        "uplot.css",
        "text/css; charset=utf-8",
        include_str!("page/uplot.css"),
    ),
];

/// What the page may load and do; the report has scripts and styles of its own inside it, and no right to anything else.
const OF_PAGE: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; \
                       frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const OF_REPORT: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; sandbox \
                         allow-scripts; frame-ancestors 'self'";

#[derive(Debug)]
struct Shared {
    session: Arc<Session>,
    guard: Guard,
}

type Studio = State<Arc<Shared>>;
type Answer = Result<Response, StudioError>;

/// Serves the page until Ctrl-C; `ready` hears the address.
///
/// # Errors
/// The port is taken, or the system refuses a socket.
pub fn serve(
    mut session: Session,
    port: u16,
    ready: impl FnOnce(&str) -> anyhow::Result<()>,
) -> anyhow::Result<Outcome> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .thread_stack_size(STACK)
        .build()?;
    let end = Arc::new(Notify::new());
    let ended = Arc::clone(&end);
    ctrlc::set_handler(move || ended.notify_one()).context("cannot wait for Ctrl-C")?;
    let outcome = runtime.block_on(async {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
            .await
            .with_context(|| format!("port {port} of 127.0.0.1"))?;
        let guard = Guard::new(listener.local_addr()?.port())?;
        session.folder.tell(&guard.place());
        let address = guard.address();
        let shared = Arc::new(Shared {
            session: Arc::new(session),
            guard,
        });
        let routes = routes(Arc::clone(&shared));
        ready(&address)?;
        tokio::select! {
            served = async { axum::serve(listener, routes).await } => served?,
            () = end.notified() => {}
        }
        Ok::<_, anyhow::Error>(if shared.session.is_busy() {
            eprintln!("the diagnosis was cut off; a studio on the same folder goes on behind what is finished");
            Outcome::Interrupted
        } else {
            Outcome::Done
        })
    })?;
    // Work that still runs has nobody to answer any more.
    runtime.shutdown_background();
    Ok(outcome)
}

fn routes(shared: Arc<Shared>) -> Router {
    let records = put(drop_file).layer(DefaultBodyLimit::max(MOST_UPLOAD));
    Router::new()
        .route("/{token}/", get(page))
        .route("/{token}/{file}", get(page_file))
        .route("/{token}/api/state", get(state).post(choose))
        .route("/{token}/api/diagnosis", get(progress).post(wish))
        .route("/{token}/api/simulate", post(simulate))
        .route("/{token}/api/believe", post(believe))
        .route(
            "/{token}/api/records/{name}",
            records.get(curves).delete(forget),
        )
        .route("/{token}/report/", get(own_report))
        .route("/{token}/report/{hand}", get(hand_report))
        .route("/{token}/files/{name}", get(own_file))
        .route("/{token}/files/{hand}/{name}", get(hand_file))
        .fallback(unknown)
        .layer(DefaultBodyLimit::max(MOST_CHOICES))
        .layer(middleware::from_fn_with_state(Arc::clone(&shared), guarded))
        .with_state(shared)
}

/// Lets through what the guard lets through, and says in each answer what a browser must not do with it.
async fn guarded(State(shared): Studio, request: Request, next: Next) -> Response {
    let checked = shared.guard.check(request.uri().path(), request.headers());
    let mut response = match checked {
        Ok(()) => next.run(request).await,
        Err(refusal) => StudioError::from(refusal).into_response(),
    };
    if response.status() == StatusCode::PAYLOAD_TOO_LARGE {
        let refusal = StudioError::from(super::guard::Refusal::TooLarge);
        response = refusal.into_response();
    }
    let headers = response.headers_mut();
    let rules: [(HeaderName, &str); 4] = [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
    ];
    for (name, value) in rules {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers
        .entry(header::CONTENT_SECURITY_POLICY)
        .or_insert(HeaderValue::from_static(OF_PAGE));
    response
}

/// Work that takes more than an instant, off the server's thread.
async fn work(
    shared: Arc<Shared>,
    work: impl FnOnce(&Arc<Session>) -> Answer + Send + 'static,
) -> Answer {
    let done = tokio::task::spawn_blocking(move || work(&shared.session)).await;
    done.map_err(|_| {
        StudioError::Input("stickslip has a defect here, please report it".to_owned())
    })?
}

fn parsed<T: DeserializeOwned>(body: &Bytes) -> Result<T, StudioError> {
    serde_json::from_slice(body).map_err(StudioError::of)
}

fn typed(kind: &'static str, content: impl IntoResponse) -> Response {
    ([(header::CONTENT_TYPE, kind)], content).into_response()
}

fn json_answer(value: &serde_json::Value) -> Response {
    typed("application/json", value.to_string())
}

fn done() -> Answer {
    Ok(json_answer(&json!({})))
}

async fn unknown(request: Request) -> StudioError {
    StudioError::Unknown(request.method().to_string())
}

fn page_of(name: &str) -> Answer {
    let found = PAGE.iter().find(|(own, _, _)| *own == name);
    let (_, kind, content) = found.ok_or_else(|| StudioError::Unknown(name.to_owned()))?;
    Ok(typed(kind, *content))
}

async fn page() -> Answer {
    page_of("")
}

async fn page_file(Path((_, name)): Path<(String, String)>) -> Answer {
    page_of(&name)
}

async fn state(State(shared): Studio) -> Answer {
    work(shared, |session| Ok(json_answer(&session.told()))).await
}

async fn choose(State(shared): Studio, body: Bytes) -> Answer {
    work(shared, move |session| {
        session.choose(parsed(&body)?)?;
        done()
    })
    .await
}

async fn progress(State(shared): Studio) -> Answer {
    Ok(json_answer(&shared.session.progress()))
}

async fn wish(State(shared): Studio, body: Bytes) -> Answer {
    work(shared, move |session| {
        session.wish(parsed::<Wish>(&body)?)?;
        Ok(json_answer(&session.progress()))
    })
    .await
}

async fn simulate(State(shared): Studio, body: Bytes) -> Answer {
    work(shared, move |session| {
        let order: Order = parsed(&body)?;
        Ok(typed("application/octet-stream", session.simulate(&order)?))
    })
    .await
}

/// A model with numbers set by hand, or none for the case's own.
async fn believe(State(shared): Studio, body: Bytes) -> Answer {
    work(shared, move |session| {
        match parsed::<Option<(String, std::collections::BTreeMap<String, f64>)>>(&body)? {
            Some((model, settings)) => session.believe(&model, &settings)?,
            None => session.believe_case()?,
        }
        done()
    })
    .await
}

async fn curves(State(shared): Studio, Path((_, name)): Path<(String, String)>) -> Answer {
    work(shared, move |session| {
        Ok(typed("application/octet-stream", session.curves(&name)?))
    })
    .await
}

async fn drop_file(
    State(shared): Studio,
    Path((_, name)): Path<(String, String)>,
    body: Bytes,
) -> Answer {
    work(shared, move |session| {
        session.drop_file(&name, &body)?;
        done()
    })
    .await
}

async fn forget(State(shared): Studio, Path((_, name)): Path<(String, String)>) -> Answer {
    work(shared, move |session| {
        session.forget(&name)?;
        done()
    })
    .await
}

async fn own_report(State(shared): Studio) -> Answer {
    work(shared, |session| report_of(session, None)).await
}

async fn hand_report(State(shared): Studio, Path((_, hand)): Path<(String, String)>) -> Answer {
    work(shared, move |session| report_of(session, Some(&hand))).await
}

fn report_of(session: &Session, hand: Option<&str>) -> Answer {
    let path = session.folder.result(hand, report::FILE)?;
    let text = std::fs::read(path).map_err(StudioError::of)?;
    let rules = [(header::CONTENT_SECURITY_POLICY, OF_REPORT)];
    Ok((rules, typed("text/html; charset=utf-8", text)).into_response())
}

async fn own_file(State(shared): Studio, Path((_, name)): Path<(String, String)>) -> Answer {
    work(shared, move |session| match name.as_str() {
        SCRIPT => Ok(attached(SCRIPT, session.script()?)),
        MODEL => Ok(attached(MODEL, session.model_file()?)),
        "shell.txt" => Ok(attached("shell.txt", session.shell()?)),
        _ => file_of(session, None, &name),
    })
    .await
}

async fn hand_file(
    State(shared): Studio,
    Path((_, hand, name)): Path<(String, String, String)>,
) -> Answer {
    work(shared, move |session| file_of(session, Some(&hand), &name)).await
}

fn file_of(session: &Session, hand: Option<&str>, name: &str) -> Answer {
    let path = session.folder.result(hand, name)?;
    Ok(attached(
        name,
        std::fs::read(path).map_err(StudioError::of)?,
    ))
}

/// A file to be kept, not shown.
fn attached(name: &str, content: impl IntoResponse) -> Response {
    let mut response = typed("application/octet-stream", content);
    // Names are those of results, which need no escapes.
    if let Ok(value) = HeaderValue::from_str(&format!("attachment; filename=\"{name}\"")) {
        response
            .headers_mut()
            .insert(header::CONTENT_DISPOSITION, value);
    }
    response
}
