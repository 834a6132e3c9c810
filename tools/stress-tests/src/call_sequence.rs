//! Carries out calls on the library and compares each with its expectation: status, values, messages.

mod saved_states;

use std::collections::HashMap;
use std::ffi::{CString, c_int};
use std::ptr;

use anyhow::Result;
use stickslip::ffi::Status;

use crate::call::{Action, Aim, Call, Instantiation, SLOTS, STATE_PLACES, View};
use crate::component::Component;
use crate::expectation::{Expectation, Saved};
use crate::library::{Birth, Handle, Library};
use crate::log::Inbox;
use crate::standard::{State, Version, state_after};

/// An instance in the library with what it should be.
pub(crate) struct Instance {
    pub(crate) handle: Handle,
    pub(crate) inbox: Box<Inbox>,
    pub(crate) expected: Expectation,
    /// Communication point [s] from which the next step goes.
    pub(crate) point: f64,
    /// Tells instances of one slot apart.
    number: u64,
}

/// A saved state as it should be, and the instance with which it ends.
struct LiveState {
    saved: Saved,
    owner: u64,
}

/// What the library did: its status, and the values that it returned.
pub(crate) struct Answer {
    pub(crate) status: c_int,
    pub(crate) values: Vec<u64>,
}

impl Answer {
    pub(crate) fn status(status: c_int) -> Self {
        Self {
            status,
            values: Vec::new(),
        }
    }
}

/// All instances and saved states of one sequence of calls.
pub struct CallSequence<'a> {
    library: &'a Library,
    components: &'a [Component; 2],
    main: Version,
    instances: [Option<Instance>; SLOTS],
    freed_instance: Handle,
    places: [Handle; STATE_PLACES],
    freed_state: Handle,
    live: HashMap<usize, LiveState>,
    bytes: [Option<(Vec<u8>, Saved)>; STATE_PLACES],
    born: u64,
    /// Number of library calls so far.
    pub calls: u64,
    /// How many of them were refused, as they should be.
    pub refused: u64,
}

impl<'a> CallSequence<'a> {
    /// An empty field; most instances will be of the version `main`.
    #[must_use]
    pub fn new(library: &'a Library, components: &'a [Component; 2], main: Version) -> Self {
        Self {
            library,
            components,
            main,
            instances: [const { None }; SLOTS],
            freed_instance: ptr::null_mut(),
            places: [ptr::null_mut(); STATE_PLACES],
            freed_state: ptr::null_mut(),
            live: HashMap::new(),
            bytes: [const { None }; STATE_PLACES],
            born: 0,
            calls: 0,
            refused: 0,
        }
    }

    /// The version of a slot's instances: the main one, but for the last quarter of the slots.
    fn version(&self, slot: usize) -> Version {
        if slot >= SLOTS - SLOTS / 4 {
            self.main.other()
        } else {
            self.main
        }
    }

    /// What the generator may know of a slot.
    #[must_use]
    pub fn view(&self, slot: usize) -> View<'_> {
        let expected = self.instances[slot]
            .as_ref()
            .map(|instance| &instance.expected);
        View {
            version: self.version(slot),
            state: expected.map(|expected| expected.state),
            table: &self.components[expected.map_or(0, |expected| expected.component)].table,
        }
    }

    /// Carries out one call.
    ///
    /// # Errors
    /// What the library did otherwise than it should.
    pub fn carry_out(&mut self, call: &Call) -> Result<(), String> {
        match (&call.action, call.aim) {
            (Action::Instantiate { .. }, _) => self.instantiate(call),
            (Action::Free, aim) => {
                self.free(call.slot, aim);
                Ok(())
            }
            (_, Aim::Own | Aim::OtherVersion) => {
                let Some(mut instance) = self.instances[call.slot].take() else {
                    return self.on_no_instance(ptr::null_mut(), &call.action);
                };
                let result = if call.aim == Aim::Own {
                    self.on_instance(&mut instance, &call.action)
                } else {
                    self.through_other_version(&mut instance)
                };
                self.instances[call.slot] = Some(instance);
                result
            }
            (action, aim) => {
                let handle = self.wrong_handle(aim);
                self.on_no_instance(handle, action)
            }
        }
    }

    fn wrong_handle(&self, aim: Aim) -> Handle {
        match aim {
            Aim::Freed => self.freed_instance,
            Aim::SavedState => self.places[0],
            Aim::Forged(bits) if !self.is_a_handle(bits) => ptr::without_provenance_mut(bits),
            _ => ptr::null_mut(),
        }
    }

    fn is_a_handle(&self, bits: usize) -> bool {
        self.live.contains_key(&bits)
            || (self.instances.iter().flatten()).any(|instance| instance.handle.addr() == bits)
    }

    fn on_no_instance(&mut self, handle: Handle, action: &Action) -> Result<(), String> {
        self.calls += 1;
        self.refused += 1;
        let (two, three) = (&self.library.fmi2, &self.library.fmi3);
        let both = self.library.of(self.main);
        let mut flags = [0_u8; 3];
        let [event, terminate, early] = &mut flags;
        let (mut time, mut state) = (0.0, ptr::null_mut());
        // SAFETY: the handle is no instance, which the library must notice; the places are valid.
        let status = unsafe {
            match (self.main, action) {
                (_, Action::SaveState { .. }) => (both.get_state)(handle, &mut state),
                (Version::Two, Action::Step { .. }) => (two.step)(handle, 0.0, 0.1, 1),
                (Version::Two, Action::Get { .. }) => (two.get_real)(handle, &1, 1, &mut time),
                (Version::Three, Action::Step { .. }) => {
                    (three.step)(handle, 0.0, 0.1, 1, event, terminate, early, &mut time)
                }
                (Version::Three, Action::Get { .. }) => {
                    (three.get_real)(handle, &1, 1, &mut time, 1)
                }
                _ => (both.reset)(handle),
            }
        };
        if status == Status::Error as c_int {
            Ok(())
        } else {
            Err(format!(
                "the handle {handle:p} is no instance, but the status is {status}"
            ))
        }
    }

    fn through_other_version(&mut self, instance: &mut Instance) -> Result<(), String> {
        let other = self.library.of(instance.expected.version.other());
        // SAFETY: a live handle, though of the other version.
        let status = unsafe { (other.terminate)(instance.handle) };
        self.compare(instance, Err(Status::Error), 0, &Answer::status(status))
    }

    fn instantiate(&mut self, call: &Call) -> Result<(), String> {
        let Action::Instantiate {
            component,
            instantiation,
            event_mode,
            early_return,
            logging,
            logger,
        } = call.action
        else {
            return Ok(());
        };
        if self.instances[call.slot].is_some() {
            return Ok(());
        }
        self.calls += 1;
        let version = self.version(call.slot);
        let mut inbox = Box::<Inbox>::default();
        let here = &self.components[component];
        let token = if instantiation == Instantiation::ForeignToken {
            self.components[1 - component].token.clone()
        } else {
            here.token.clone()
        };
        let location = match instantiation {
            Instantiation::Scheme => CString::new("http://example.com/resources"),
            Instantiation::Relative => CString::new("resources"),
            Instantiation::Nowhere => CString::new("/nowhere/at all/resources"),
            _ => Ok(here.resources(version).unwrap_or_default()),
        }
        .unwrap_or_default();
        let name = if instantiation == Instantiation::BlankName {
            c" \t"
        } else {
            c"rig %s #1#"
        };
        let or_null = |text: &std::ffi::CStr, missing: Instantiation| {
            if instantiation == missing {
                ptr::null()
            } else {
                text.as_ptr()
            }
        };
        let birth = Birth {
            name: or_null(name, Instantiation::NoName),
            token: or_null(&token, Instantiation::NoToken),
            resources: or_null(&location, Instantiation::NoResources),
            event_mode,
            early_return,
            logging,
            logger,
            environment: inbox.environment(),
            wrong_interface: instantiation == Instantiation::Interface,
        };
        // SAFETY: strings are valid or NULL, and the inbox is kept with the instance.
        let handle = unsafe { self.library.instantiate(version, &birth) };
        let messages = inbox.take();
        let silent = instantiation == Instantiation::Sound
            || !logger
            || instantiation == Instantiation::Interface && version == Version::Two;
        if messages.len() != usize::from(!silent) {
            return Err(format!(
                "{} messages from an instantiation with {instantiation:?}: {messages:?}",
                messages.len()
            ));
        }
        if handle.is_null() != (instantiation != Instantiation::Sound) {
            return Err(format!(
                "an instantiation with {instantiation:?} gave {handle:p}: {messages:?}"
            ));
        }
        if handle.is_null() {
            self.refused += 1;
            return Ok(());
        }
        let native = here.native().map_err(|error| error.to_string())?;
        let two = version == Version::Two;
        let expected = Expectation {
            version,
            component,
            state: State::Instantiated,
            time: native.identity().default_experiment.start_time,
            native,
            stop: None,
            last_step: Status::Ok,
            event_mode: event_mode && !two,
            early_return: early_return && !two,
            logger,
            logging,
            categories: None,
        };
        self.born += 1;
        self.instances[call.slot] = Some(Instance {
            handle,
            inbox,
            point: expected.time,
            expected,
            number: self.born,
        });
        Ok(())
    }

    fn free(&mut self, slot: usize, aim: Aim) {
        self.calls += 1;
        let version = self.version(slot);
        let handle = match (aim, self.instances[slot].take()) {
            (Aim::Own, Some(instance)) => {
                self.live.retain(|_, state| state.owner != instance.number);
                self.freed_instance = instance.handle;
                instance.handle
            }
            (aim, kept) => {
                self.instances[slot] = kept;
                self.wrong_handle(aim)
            }
        };
        // SAFETY: a live handle, or what the library must recognise as none.
        unsafe { (self.library.of(version).free)(handle) }
    }

    /// Ends all instances of the sequence.
    pub fn finish(&mut self) {
        for slot in 0..SLOTS {
            if self.instances[slot].is_some() {
                self.free(slot, Aim::Own);
            }
        }
    }

    /// Compares answer and messages with the verdict, and moves the expectation on where it is an error.
    fn compare(
        &mut self,
        instance: &mut Instance,
        verdict: Result<Vec<u64>, Status>,
        events: usize,
        answer: &Answer,
    ) -> Result<(), String> {
        self.calls += 1;
        let expected = verdict.as_ref().err().copied().unwrap_or(Status::Ok);
        if answer.status != expected as c_int {
            let messages = instance.inbox.take();
            return Err(format!(
                "status {} instead of {expected:?}: {messages:?}",
                answer.status
            ));
        }
        if let Ok(values) = &verdict
            && *values != answer.values
        {
            let shown = |bits: &[u64]| bits.iter().map(|b| f64::from_bits(*b)).collect::<Vec<_>>();
            return Err(format!(
                "values {:?} instead of {:?}",
                shown(&answer.values),
                shown(values)
            ));
        }
        let category = match expected {
            Status::Ok => None,
            Status::Warning => Some("logStatusWarning"),
            Status::Discard => Some("logStatusDiscard"),
            Status::Error => Some("logStatusError"),
        };
        let due = usize::from(category.is_some_and(|category| instance.expected.hears(category)));
        let events = if instance.expected.hears("logEvents") {
            events
        } else {
            0
        };
        let messages = instance.inbox.take();
        let sound = messages.len() == due + events
            && messages.iter().all(|message| {
                message.status == expected as c_int
                    && message.category == category.unwrap_or("logEvents")
                    && !message.text.is_empty()
            });
        if !sound {
            return Err(format!(
                "status {expected:?} as it should, but the log has {messages:?}"
            ));
        }
        self.refused += u64::from(expected != Status::Ok);
        instance.expected.state =
            state_after(instance.expected.version, instance.expected.state, expected);
        Ok(())
    }

    fn on_instance(&mut self, instance: &mut Instance, action: &Action) -> Result<(), String> {
        if let Some(result) = self.on_saved_states(instance, action) {
            return result;
        }
        instance.point = instance.expected.time;
        let (verdict, events) = instance.judge(action);
        let answer = crate::invoke::invoke(self.library, instance, action);
        self.compare(instance, verdict, events, &answer)
    }
}
