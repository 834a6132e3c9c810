//! What the integrator asks of a hybrid system.

use crate::series::{Scalar, Series};
use std::fmt::Debug;

/// A condition that holds, as a non-negative series, as long as a mode is the right one.
#[derive(Clone, Debug)]
pub struct Guard<K> {
    /// What is watched.
    pub kind: K,
    /// The watched quantity; the mode ends where it becomes negative.
    pub series: Series<f64>,
}

/// Where the branch that a motion follows ends.
#[derive(Clone, Copy, Debug)]
pub enum Fold<S> {
    /// At this local time [s], with the derivatives of the instant.
    At(S),
    /// Not within this time [s], which may be a part of the step asked for.
    Beyond(f64),
}

/// A system that is analytic within each of its modes and changes mode where a guard is lost.
///
/// Everything is pure: modes and states are values that the integrator holds, and they change only
/// at accepted events.
pub trait HybridSystem<S: Scalar> {
    /// Discrete state.
    type Mode: Copy + Debug + Send;
    /// What a guard watches.
    type GuardKind: Copy + Debug + PartialEq + Send;
    /// Continuous state.
    type State: Copy + AsRef<[S]> + AsMut<[S]> + Debug + Send;
    /// Inputs.
    type Inputs: Clone + Debug + Send;
    /// Series over one segment.
    type Jet: Clone + Debug + Send;

    /// Series to work on.
    fn new_jet(&self) -> Self::Jet;

    /// Drops what an expanded jet remembers of its run, so that another run on it is the same as on a new one.
    fn forget(&self, _jet: &mut Self::Jet) {}

    /// Computes the coefficients of orders 0 to `order` from `time` on.
    fn expand(
        &self,
        mode: &Self::Mode,
        time: S,
        state: &Self::State,
        inputs: &Self::Inputs,
        order: usize,
        jet: &mut Self::Jet,
    );

    /// As [`Self::expand`], but for the motion without fast transients, whose series reach further:
    /// only if `state` has none left within `tolerance` (absolute for coordinates, else relative to
    /// 1 + |x|). Whether that is so; if not, `jet` is left without meaning.
    #[allow(clippy::too_many_arguments)]
    fn expand_without_transients(
        &self,
        _mode: &Self::Mode,
        _time: S,
        _state: &Self::State,
        _inputs: &Self::Inputs,
        _order: usize,
        _tolerance: f64,
        _jet: &mut Self::Jet,
    ) -> bool {
        false
    }

    /// The state's series in an expanded jet.
    fn states<'a>(&self, jet: &'a Self::Jet) -> &'a [Series<S>];

    /// What the derivatives of component `index` of the state have beside its series at local time `tau` [s].
    fn beside_series(&self, _jet: &Self::Jet, _index: usize, _tau: f64) -> Option<S> {
        None
    }

    /// The longest segment [s] at which the derivatives in an expanded jet hold; the states' values are the
    /// integrator's business.
    fn reach(&self, _jet: &Self::Jet) -> f64 {
        f64::INFINITY
    }

    /// The guards of an expanded jet.
    fn guards<'a>(&self, jet: &'a Self::Jet) -> &'a [Guard<Self::GuardKind>];

    /// The quantity that `guard` watches, with its derivatives, at local time `tau` of the segment in
    /// `jet`, where the time is `time` and the state `state`; its value may differ by rounding from that
    /// of the guard's series. `spare` may be overwritten. Only numbers with derivatives are asked.
    #[allow(clippy::too_many_arguments)]
    fn guard_at(
        &self,
        mode: &Self::Mode,
        guard: Self::GuardKind,
        jet: &Self::Jet,
        tau: f64,
        time: S,
        state: &Self::State,
        inputs: &Self::Inputs,
        spare: &mut Self::Jet,
    ) -> S;

    /// Whether component `index` of the state is an angle-like coordinate whose size says nothing
    /// about the accuracy wanted: its tolerance is absolute.
    fn is_coordinate(&self, index: usize) -> bool;

    /// The mode with its memory brought up to local time `tau` of the segment in `jet`.
    fn carry(&self, mode: &Self::Mode, jet: &Self::Jet, tau: f64) -> Self::Mode;

    /// The mode in which the system starts from `state`.
    fn initial_mode(
        &self,
        time: S,
        state: &mut Self::State,
        inputs: &Self::Inputs,
        jet: &mut Self::Jet,
    ) -> Self::Mode;

    /// The mode after `guard` was lost at `time`; may correct the state on the switching surface.
    fn switch(
        &self,
        mode: &Self::Mode,
        guard: Self::GuardKind,
        time: S,
        state: &mut Self::State,
        inputs: &Self::Inputs,
        jet: &mut Self::Jet,
    ) -> Self::Mode;

    /// Whether a branch of the right-hand side ends (a fold, a singular point of the motion) within `step` [s] of the segment just
    /// expanded.
    fn fold(&self, _mode: &Self::Mode, _jet: &Self::Jet, step: f64) -> Fold<S> {
        Fold::Beyond(step)
    }

    /// The mode beyond the fold that [`Self::fold`] found in `jet`; corrects derivatives of the state there, since their series do not
    /// converge at a singular point.
    fn leave_fold(
        &self,
        mode: &Self::Mode,
        _state: &mut Self::State,
        _jet: &Self::Jet,
    ) -> Self::Mode {
        *mode
    }

    /// One line that names the mode, for messages.
    fn describe(&self, mode: &Self::Mode) -> String;
}
