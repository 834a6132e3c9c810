//! The importer's logger, of either standard, which may be absent.

use super::status::{Interface, Status};
use crate::cosim::LOG_CATEGORIES;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::fmt;

/// `fmi2CallbackLogger`.
pub type Fmi2Logger =
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// `fmi3LogMessageCallback`.
pub type Fmi3Logger = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

/// Whom to tell.
#[derive(Clone, Copy)]
pub(super) enum Callback {
    Fmi2(Option<Fmi2Logger>),
    Fmi3(Option<Fmi3Logger>),
}

/// Kinds of messages; each has a name in [`LOG_CATEGORIES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Category {
    Events,
    Warning,
    Discard,
    Error,
}

impl Category {
    fn of(status: Status) -> Self {
        match status {
            Status::Ok => Self::Events,
            Status::Warning => Self::Warning,
            Status::Discard => Self::Discard,
            Status::Error => Self::Error,
        }
    }

    fn name(self) -> &'static CStr {
        match self {
            Self::Events => c"logEvents",
            Self::Warning => c"logStatusWarning",
            Self::Discard => c"logStatusDiscard",
            Self::Error => c"logStatusError",
        }
    }
}

/// The category that stands for all others.
const ALL: &[u8] = b"logAll";

/// A channel to the importer's log.
pub(super) struct Log {
    callback: Callback,
    environment: *mut c_void,
    instance_name: CString,
    /// Whether debug logging is on at all.
    on: bool,
    /// Categories that were asked for by name; `None` for all.
    chosen: Option<Vec<Category>>,
}

// SAFETY: the environment pointer is only handed back, and both standards let an importer move an
// instance between threads as long as calls do not overlap.
unsafe impl Send for Log {}

impl Log {
    pub(super) fn new(
        callback: Callback,
        environment: *mut c_void,
        instance_name: CString,
        on: bool,
    ) -> Self {
        Self {
            callback,
            environment,
            instance_name,
            on,
            chosen: None,
        }
    }

    /// Follows `fmi2SetDebugLogging` and `fmi3SetDebugLogging`; returns the names it does not know, which choose warnings.
    pub(super) fn configure(&mut self, on: bool, categories: &[&CStr]) -> Vec<String> {
        let known = [
            Category::Events,
            Category::Warning,
            Category::Discard,
            Category::Error,
        ];
        let mut unknown = Vec::new();
        let mut chosen = Vec::new();
        let mut all = categories.is_empty();
        for name in categories {
            if name.to_bytes() == ALL {
                all = true;
            } else if let Some(category) = known.into_iter().find(|c| c.name() == *name) {
                chosen.push(category);
            } else {
                unknown.push(name.to_string_lossy().into_owned());
            }
        }
        if !unknown.is_empty() {
            // Else an importer that only asks for names there are not would not hear of it.
            chosen.push(Category::Warning);
        }
        self.on = on;
        self.chosen = if all { None } else { Some(chosen) };
        unknown
    }

    /// Whether messages of the category go out.
    ///
    /// FMI 3 forbids every message while logging is off. FMI 2 has its switch for debug messages
    /// only: why a call was refused is always said.
    fn wants(&self, category: Category) -> bool {
        let always = matches!(self.callback, Callback::Fmi2(_)) && category != Category::Events;
        always
            || self.on
                && self
                    .chosen
                    .as_ref()
                    .is_none_or(|chosen| chosen.contains(&category))
    }

    /// Sends one message, if its category is wanted.
    pub(super) fn write(&self, status: Status, message: &str) {
        if self.wants(Category::of(status)) {
            self.force(status, message);
        }
    }

    /// Sends one message about an event, formatted only if it is wanted.
    pub(super) fn inform(&self, event: &dyn fmt::Display) {
        if self.wants(Category::Events) {
            self.force(Status::Ok, &event.to_string());
        }
    }

    /// Sends one message whatever the settings: the reason why there will be no instance.
    pub(super) fn force(&self, status: Status, message: &str) {
        let category = Category::of(status).name();
        // '#' starts a reference to a variable in both standards; '%' a conversion in FMI 2, whose
        // logger is variadic. Doubled, they stand for themselves.
        let escaped = message.replace('#', "##").replace('\0', " ");
        match self.callback {
            Callback::Fmi2(Some(logger)) => {
                let text = CString::new(escaped.replace('%', "%%")).unwrap_or_default();
                // SAFETY: the importer gave this function for this purpose; the strings live
                // until it returns, and the message has no conversion that would need an argument.
                unsafe {
                    logger(
                        self.environment,
                        self.instance_name.as_ptr(),
                        status as c_int,
                        category.as_ptr(),
                        text.as_ptr(),
                    );
                }
            }
            Callback::Fmi3(Some(logger)) => {
                let text = CString::new(escaped).unwrap_or_default();
                // SAFETY: as above.
                unsafe {
                    logger(
                        self.environment,
                        status as c_int,
                        category.as_ptr(),
                        text.as_ptr(),
                    );
                }
            }
            Callback::Fmi2(None) | Callback::Fmi3(None) => {}
        }
    }

    /// The interface whose logger this is.
    pub(super) fn interface(&self) -> Interface {
        match self.callback {
            Callback::Fmi2(_) => Interface::Fmi2,
            Callback::Fmi3(_) => Interface::Fmi3,
        }
    }
}

/// The names of the log categories, for messages.
pub(super) fn category_names() -> String {
    LOG_CATEGORIES.map(|category| category.name).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_uses_only_categories_that_the_xml_lists() {
        for category in [
            Category::Events,
            Category::Warning,
            Category::Discard,
            Category::Error,
        ] {
            let name = category.name().to_str().unwrap();
            assert!(
                LOG_CATEGORIES.iter().any(|listed| listed.name == name),
                "{name}"
            );
        }
        assert!(
            LOG_CATEGORIES
                .iter()
                .any(|listed| listed.name.as_bytes() == ALL)
        );
    }
}
