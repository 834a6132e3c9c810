//! `stickslip studio`: the diagnosis as a local page, with eyes and hands.
//!
//! `server` answers the page and nobody else, which `guard` sees to. A `session` holds what was chosen, keeps it in the
//! studio's `folder`, and hands the work to the functions behind the other commands: `seen` and `records` read,
//! `simulate` runs, `diagnosis` names, `export` hands out.

mod binary;
mod choices;
mod diagnosis;
mod error;
mod export;
mod folder;
mod guard;
mod models;
mod records;
mod seen;
mod server;
mod session;
mod simulate;

use std::io::{IsTerminal, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::Context;
use clap::Args;

use crate::outcome::Outcome;

pub use guard::{MOST_CHOICES, MOST_UPLOAD};

/// Folder of a studio inside its case, or in the working directory where there is no case.
const FOLDER: &str = "studio";

/// Arguments of `studio`.
#[derive(Debug, Args)]
pub struct StudioArguments {
    /// Directory of a case, as `diagnose` takes it, where records may still be missing; without it records are dropped onto the page.
    pub case: Option<PathBuf>,
    /// Directory for what is chosen and found; without it the folder studio in the case, or here where there is no case.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Port of the page; without it one that is free.
    #[arg(long, default_value_t = 0)]
    pub port: u16,
    /// The library to pack into the FMUs; without it the one beside this program.
    #[arg(long, value_name = "FILE")]
    pub library: Option<PathBuf>,
    /// Print the address alone; do not open it in the browser.
    #[arg(long)]
    pub no_browser: bool,
}

/// Serves the page until Ctrl-C.
///
/// # Errors
/// The case cannot be read, the folder is open in another studio, or the port is taken.
pub fn command(arguments: &StudioArguments) -> anyhow::Result<Outcome> {
    let out = arguments.out.clone().unwrap_or_else(|| {
        arguments
            .case
            .as_deref()
            .unwrap_or(Path::new(""))
            .join(FOLDER)
    });
    let base = models::base(arguments.case.as_deref())?;
    let folder = folder::Folder::open(&out)?;
    let session = session::Session::open(base, folder, arguments.library.clone())?;
    server::serve(session, arguments.port, |address| {
        let mut screen = std::io::stdout();
        writeln!(screen, "{address}")?;
        screen.flush()?;
        eprintln!(
            "The page is for this machine and this user alone; what is chosen and found is kept in {}. Ctrl-C ends the studio.",
            out.display()
        );
        if !arguments.no_browser && screen.is_terminal() && !browse(address) {
            eprintln!("Open the address in a browser.");
        }
        Ok(())
    })
    .context("the studio's page")
}

/// Opens the address in the user's browser; whether that could be asked for.
fn browse(address: &str) -> bool {
    let (program, arguments): (&str, &[&str]) = if cfg!(windows) {
        ("cmd", &["/C", "start", ""])
    } else if cfg!(target_os = "macos") {
        ("open", &[])
    } else {
        ("xdg-open", &[])
    };
    Command::new(program)
        .args(arguments)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .is_ok()
}
