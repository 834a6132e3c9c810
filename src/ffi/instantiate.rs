//! From the arguments of an instantiation to a live instance, or a reason why not.

use super::guard::panicked;
use super::instance::{INSTANCES, Instance};
use super::log::{Callback, Log};
use super::resource;
use super::status::Status;
use crate::cosim::{CoSimulationModel, MODEL_FILE, open};
use std::ffi::{CStr, CString, c_void};
use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::ptr;

/// Largest `model.toml` that is read [bytes].
const MODEL_FILE_LIMIT: u64 = 1 << 20;

/// What both standards pass to an instantiation.
pub(super) struct Request<'a> {
    pub(super) function: &'static str,
    pub(super) instance_name: Option<&'a CStr>,
    pub(super) token: Option<&'a CStr>,
    pub(super) resources: Option<&'a CStr>,
    pub(super) logging_on: bool,
    pub(super) environment: *mut c_void,
    pub(super) callback: Callback,
}

/// A handle to a new instance, finished by `configure`; NULL with a line in the log where there can
/// be none.
pub(super) fn instantiate(
    request: &Request<'_>,
    configure: impl FnOnce(&mut Instance) -> Result<(), String>,
) -> *mut c_void {
    let log = || {
        let name = CString::from(request.instance_name.unwrap_or_default());
        Log::new(
            request.callback,
            request.environment,
            name,
            request.logging_on,
        )
    };
    let made = catch_unwind(AssertUnwindSafe(|| {
        let mut instance = Instance::new(model(request)?, log());
        configure(&mut instance)?;
        INSTANCES
            .insert(instance)
            .ok_or_else(|| "there are too many live instances".to_owned())
    }));
    let reason = match made {
        Ok(Ok(handle)) => return handle,
        Ok(Err(reason)) => reason,
        Err(payload) => panicked(payload).message,
    };
    log().force(Status::Error, &format!("{}: {reason}", request.function));
    ptr::null_mut()
}

fn model(request: &Request<'_>) -> Result<Box<dyn CoSimulationModel>, String> {
    let name = request
        .instance_name
        .ok_or("argument 'instanceName' is NULL; it needs at least one character")?;
    if name.to_bytes().trim_ascii().is_empty() {
        return Err("argument 'instanceName' is empty; it needs at least one character".into());
    }
    let token = request
        .token
        .ok_or("the instantiation token (GUID) is NULL; expected that of modelDescription.xml")?;
    let location = request.resources.ok_or_else(|| {
        format!("the resource location is NULL; the component reads {MODEL_FILE} from there")
    })?;
    let folder = resource::folder(location.to_bytes()).map_err(|error| error.to_string())?;
    let file = folder.join(MODEL_FILE);
    let text = read(&file)?;
    let model = open(&text, &file.to_string_lossy()).map_err(|error| error.to_string())?;
    let expected = model.token().to_string();
    if token.to_bytes() != expected.as_bytes() {
        return Err(format!(
            "the token {} does not match {expected}, the token of this library with {}: XML, library and \
             {MODEL_FILE} must come from one run of build-fmu",
            token.to_string_lossy(),
            file.display(),
        ));
    }
    Ok(model)
}

fn read(file: &Path) -> Result<String, String> {
    let fail = |error: std::io::Error| {
        format!(
            "cannot read {}: {error}; it is a text file among the resources of the unpacked FMU",
            file.display()
        )
    };
    let mut text = String::new();
    File::open(file)
        .map_err(fail)?
        .take(MODEL_FILE_LIMIT + 1)
        .read_to_string(&mut text)
        .map_err(fail)?;
    if text.len() as u64 > MODEL_FILE_LIMIT {
        return Err(format!(
            "{} is larger than {MODEL_FILE_LIMIT} bytes",
            file.display()
        ));
    }
    Ok(text)
}
