//! Calls about saved states, and the comparison of whole states with the native model's.

use std::ptr;

use stickslip::ffi::Status;

use super::{Answer, CallSequence, Instance, LiveState};
use crate::call::{Action, StateAim};
use crate::expectation::Verdict;
use crate::library::{Both, Handle};

fn done_if(done: bool, otherwise: Status) -> Verdict {
    if done { Ok(Vec::new()) } else { Err(otherwise) }
}

impl CallSequence<'_> {
    fn state_handle(&self, aim: StateAim) -> Handle {
        match aim {
            StateAim::Place(place) => self.places[place],
            StateAim::Freed => self.freed_state,
            StateAim::Instance => {
                let first = self.instances.iter().flatten().next();
                first.map_or(ptr::null_mut(), |instance| instance.handle)
            }
            StateAim::Forged(bits) => ptr::without_provenance_mut(bits),
        }
    }

    /// Calls about saved states; `None` for others.
    pub(super) fn on_saved_states(
        &mut self,
        instance: &mut Instance,
        action: &Action,
    ) -> Option<Result<(), String>> {
        let states = self.library.of(instance.expected.version);
        let own = instance.handle;
        Some(match *action {
            Action::SaveState { into, fresh, null } => {
                let before = if fresh {
                    ptr::null_mut()
                } else {
                    self.state_handle(into)
                };
                let known = before.is_null() || self.live.contains_key(&before.addr());
                let verdict = done_if(known && !null, Status::Error);
                let (status, after) = states.save(own, before, null);
                if verdict.is_ok() {
                    let owner = self
                        .live
                        .get(&before.addr())
                        .map_or(instance.number, |old| old.owner);
                    let saved = instance.expected.save();
                    self.live.insert(after.addr(), LiveState { saved, owner });
                    if let StateAim::Place(place) = into {
                        self.places[place] = after;
                    }
                }
                self.compare(instance, verdict, 0, &Answer::status(status))
            }
            Action::RestoreState(aim) => {
                let handle = self.state_handle(aim);
                let saved = self.live.get(&handle.addr()).map(|state| &state.saved);
                let verdict = instance.expected.restore(saved);
                let status = states.restore(own, handle);
                self.compare(instance, verdict, 0, &Answer::status(status))
            }
            Action::FreeState { aim, null } => {
                let handle = self.state_handle(aim);
                let ignored = null || handle.is_null();
                let live = !ignored && self.live.remove(&handle.addr()).is_some();
                let verdict = done_if(live || ignored, Status::Warning);
                let (status, after) = states.forget(own, handle, null);
                if live {
                    self.freed_state = handle;
                    if let StateAim::Place(place) = aim {
                        self.places[place] = after;
                    }
                    if !after.is_null() {
                        return Some(Err("a freed state's handle was not set to NULL".into()));
                    }
                }
                self.compare(instance, verdict, 0, &Answer::status(status))
            }
            Action::StateSize { aim, null } => {
                let handle = self.state_handle(aim);
                let live = self.live.contains_key(&handle.addr());
                let verdict = done_if(live && !null, Status::Error);
                let (status, _) = states.size(own, handle, null);
                self.compare(instance, verdict, 0, &Answer::status(status))
            }
            Action::Serialize {
                aim,
                into,
                short,
                null,
            } => {
                let handle = self.state_handle(aim);
                let saved = self
                    .live
                    .get(&handle.addr())
                    .map(|state| state.saved.clone());
                let size = saved
                    .as_ref()
                    .map_or(64, |saved| saved.native.len() + 72 + 8);
                let fits = saved.is_some() && !short && !null;
                let verdict = done_if(fits, Status::Error);
                let (status, bytes) = states.bytes(own, handle, size - usize::from(short), null);
                if let (true, Some(saved)) = (fits, saved) {
                    self.bytes[into] = Some((bytes, saved));
                }
                self.compare(instance, verdict, 0, &Answer::status(status))
            }
            Action::Deserialize {
                from,
                into,
                flipped,
                cut,
                null,
            } => {
                let (mut bytes, saved) = match &self.bytes[from] {
                    Some((bytes, saved)) => (bytes.clone(), Some(saved.clone())),
                    None => (b"nothing of the kind".to_vec(), None),
                };
                if let Some((place, bit)) = flipped {
                    let place = place % bytes.len();
                    bytes[place] ^= 1 << bit;
                }
                bytes.truncate(bytes.len() - cut.min(bytes.len()));
                let fits = flipped.is_none() && cut == 0 && !null;
                let saved =
                    saved.filter(|saved| fits && saved.component == instance.expected.component);
                let verdict = done_if(saved.is_some(), Status::Error);
                let (status, handle) = states.state_of(own, &bytes, null);
                if let Some(saved) = saved {
                    self.live.insert(
                        handle.addr(),
                        LiveState {
                            saved,
                            owner: instance.number,
                        },
                    );
                    self.places[into] = handle;
                }
                self.compare(instance, verdict, 0, &Answer::status(status))
            }
            Action::Compare => self.compare_states(instance, states),
            _ => return None,
        })
    }

    /// Saves, serialises and frees a state, and compares it bit by bit with the native model's.
    fn compare_states(&mut self, instance: &mut Instance, states: &Both) -> Result<(), String> {
        let own = instance.handle;
        let mut done = |status| self.compare(instance, Ok(Vec::new()), 0, &Answer::status(status));
        let (status, handle) = states.save(own, ptr::null_mut(), false);
        done(status)?;
        let (status, size) = states.size(own, handle, false);
        done(status)?;
        let (status, bytes) = states.bytes(own, handle, size, false);
        done(status)?;
        let (status, _) = states.forget(own, handle, false);
        done(status)?;
        let expected = instance.expected.save();
        let native = bytes.get(72..bytes.len().saturating_sub(8));
        let time = bytes.get(47..55);
        if native != Some(&expected.native[..])
            || time != Some(&expected.time.to_bits().to_le_bytes()[..])
        {
            return Err("the state differs from the native model's".into());
        }
        Ok(())
    }
}
