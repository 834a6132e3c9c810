//! How a rig changes its modes.

use super::index::{BRISTLE1, OMEGA, OMEGA1, OMEGA3, RELAXING_TORQUE, THETA, THETA1, THETA3};
use super::{Contact, Coupling, Rig, RigGuard, RigInputs, RigJet, RigMode, RigState};
use crate::expression::SITES;
use crate::friction::{ContactMode, Direction, Law, Regime};
use crate::integrator::{Fold, Guard, HybridSystem};
use crate::series::{Scalar, Series, evaluate, evaluate_derivative};

impl<S: Scalar> Rig<S> {
    pub(super) fn law_of(&self, contact: Contact) -> Option<&Law<S>> {
        match contact {
            Contact::Disc => Some(&self.law),
            Contact::Disc1 => self.disc1.as_ref().map(|disc1| &disc1.law),
            Contact::Motor => None,
        }
    }

    /// Friction torque needed to hold a contact at rest and the torque at which it breaks away.
    fn holding_torques(
        &self,
        contact: Contact,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) -> (f64, f64) {
        let mut trial = *mode;
        trial.set_contact(contact, ContactMode::Stuck);
        self.expand_motion(&trial, time, state, inputs, 0, jet);
        let pin = match contact {
            Contact::Disc => &jet.disc,
            Contact::Disc1 => match &jet.disc1 {
                Some(pin) => pin,
                None => return (0.0, 0.0),
            },
            Contact::Motor => {
                let limit = self.gearbox.ratio * self.motor.coulomb_torque;
                return (jet.motor_torque[0].value(), limit.value());
            }
        };
        (-pin.resisting[0].value(), pin.breakaway[0].value())
    }

    /// Mode of a contact whose slip velocity is zero.
    fn mode_at_rest(
        &self,
        contact: Contact,
        mode: &mut RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) {
        if self.bristle(contact).is_some() {
            // Whether bristles hold shows in their deflection.
            return mode.set_contact(contact, ContactMode::Stuck);
        }
        let (torque, limit) = self.holding_torques(contact, mode, time, state, inputs, jet);
        if torque.abs() <= limit {
            mode.set_contact(contact, ContactMode::Stuck);
        } else {
            self.break_away(contact, Direction::of(torque), mode);
        }
    }

    pub(super) fn break_away(&self, contact: Contact, direction: Direction, mode: &mut RigMode) {
        let has_band = self
            .law_of(contact)
            .is_some_and(|law| law.band().0.value() > 0.0);
        mode.restart_root(contact, Regime::SpeedingUp);
        let next = if has_band {
            ContactMode::Breaking(direction)
        } else {
            ContactMode::Slipping(direction, self.first_regime(contact))
        };
        mode.set_contact(contact, next);
    }

    /// Puts a contact into its first mode of sliding.
    pub(super) fn set_sliding(&self, contact: Contact, direction: Direction, mode: &mut RigMode) {
        mode.restart_root(contact, Regime::SpeedingUp);
        mode.set_contact(
            contact,
            ContactMode::Slipping(direction, self.first_regime(contact)),
        );
    }

    fn first_regime(&self, contact: Contact) -> Regime {
        match self.law_of(contact) {
            Some(Law::Wojewoda(_)) => Regime::SpeedingUp,
            _ => Regime::Free,
        }
    }

    /// Mode after the slip acceleration of a contact has reached zero: the branch on which the
    /// torques can drive it on, or constant speed if neither can. `earlier` tells whether the speed
    /// grew or fell so far, if anything is known of it.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn turn(
        &self,
        contact: Contact,
        earlier: Option<Direction>,
        mode: &mut RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) {
        let ContactMode::Slipping(direction, _) = mode.contact(contact) else {
            return;
        };
        let omega = match contact {
            Contact::Disc => state[OMEGA],
            Contact::Disc1 => state[OMEGA1],
            Contact::Motor => return,
        };
        let law = self.law_of(contact);
        let smooth = law
            .and_then(Law::two_gaussian)
            .is_some_and(|shape| !shape.jumps_at(omega.value() * direction.sign()));
        let free = law.and_then(Law::two_gaussian).is_some();
        let (up, down) = if free {
            (Regime::Free, Regime::Free)
        } else {
            (Regime::SpeedingUp, Regime::SlowingDown)
        };
        let speed_up = |mode: &mut RigMode| {
            mode.set_contact(contact, ContactMode::Slipping(direction, up));
            mode.restart_root(contact, Regime::SpeedingUp);
        };
        let slow_down = |mode: &mut RigMode| {
            mode.set_contact(contact, ContactMode::Slipping(direction, down));
            mode.restart_root(contact, Regime::SlowingDown);
        };
        if smooth {
            return if earlier == Some(Direction::Forward) {
                slow_down(mode)
            } else {
                speed_up(mode)
            };
        }
        let mut trial = *mode;
        trial.set_contact(contact, ContactMode::Slipping(direction, Regime::Holding));
        self.expand_motion(&trial, time, state, inputs, 0, jet);
        let pin = match (contact, &jet.disc1) {
            (Contact::Disc1, Some(pin)) => pin,
            _ => &jet.disc,
        };
        let constant = pin.constant_torque.value();
        let load = pin.load[0].value();
        let reaction = pin.slip.torque[0].value();
        let upper = load * pin.slip.level[0].value() + constant;
        let lower = load * pin.slip.lower_level[0].value() + constant;
        let can_speed_up = reaction > upper;
        let can_slow_down = reaction < lower;
        if pin.slip.branches_meet {
            return match earlier {
                Some(Direction::Forward) => slow_down(mode),
                _ => speed_up(mode),
            };
        }
        match (earlier, can_speed_up, can_slow_down) {
            (Some(Direction::Backward) | None, true, _) => speed_up(mode),
            (Some(Direction::Forward) | None, _, true) => slow_down(mode),
            _ => mode.set_contact(contact, ContactMode::Slipping(direction, Regime::Holding)),
        }
    }
}

/// Position of a contact's velocity in the state.
pub(super) fn velocity_of(contact: Contact) -> usize {
    match contact {
        Contact::Disc => OMEGA,
        Contact::Disc1 => OMEGA1,
        Contact::Motor => OMEGA3,
    }
}

/// Evaluates only the value of a series.
fn value_at<S: Scalar>(series: &Series<S>, order: usize, tau: f64) -> f64 {
    evaluate(&series[..=order], S::constant(tau)).value()
}

impl<S: Scalar> HybridSystem<S> for Rig<S> {
    type Mode = RigMode;
    type GuardKind = RigGuard;
    type State = RigState<S>;
    type Inputs = RigInputs<S>;
    type Jet = RigJet<S>;

    fn new_jet(&self) -> RigJet<S> {
        RigJet::new(self)
    }

    fn forget(&self, jet: &mut RigJet<S>) {
        jet.forget();
    }

    #[inline]
    fn expand(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        jet: &mut RigJet<S>,
    ) {
        self.expand_motion(mode, time, state, inputs, order, jet);
    }

    #[inline]
    fn expand_without_transients(
        &self,
        mode: &RigMode,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        order: usize,
        tolerance: f64,
        jet: &mut RigJet<S>,
    ) -> bool {
        Rig::expand_without_transients(self, mode, time, state, inputs, order, tolerance, jet)
    }

    fn states<'a>(&self, jet: &'a RigJet<S>) -> &'a [Series<S>] {
        // The last components are zero for ever unless the rig has the parts they belong to.
        let used = if self.effects.presliding.is_some() {
            BRISTLE1 + 1
        } else if self.effects.shaft_hysteresis.is_some() {
            RELAXING_TORQUE + 1
        } else if self.disc1.is_some() {
            OMEGA1 + 1
        } else {
            THETA1
        };
        &jet.states[..used]
    }

    fn beside_series(&self, jet: &RigJet<S>, index: usize, tau: f64) -> Option<S> {
        jet.fading.as_ref().map(|fading| fading.at(index, tau))
    }

    fn reach(&self, jet: &RigJet<S>) -> f64 {
        let tangent = jet.tangent.as_ref().filter(|_| jet.follows_tangent);
        tangent.map_or(f64::INFINITY, |tangent| tangent.reach)
    }

    fn guards<'a>(&self, jet: &'a RigJet<S>) -> &'a [Guard<RigGuard>] {
        match jet.motion() {
            Some((_, plain)) => &plain.guards,
            None => &jet.guards,
        }
    }

    fn guard_at(
        &self,
        mode: &RigMode,
        guard: RigGuard,
        jet: &RigJet<S>,
        tau: f64,
        time: S,
        state: &RigState<S>,
        inputs: &RigInputs<S>,
        spare: &mut RigJet<S>,
    ) -> S {
        let sliding = |contact: Contact| match mode.contact(contact) {
            ContactMode::Slipping(direction, _) => direction.sign(),
            ContactMode::Stuck | ContactMode::Breaking(_) => 1.0,
        };
        match guard {
            RigGuard::Rest(contact) => {
                let band = self.law_of(contact).map_or(S::ZERO, |law| law.band().0);
                state[velocity_of(contact)] * sliding(contact) - band
            }
            RigGuard::Turn(contact, earlier) => {
                let place = velocity_of(contact);
                let velocity = &jet.states[place][..=jet.order];
                let mut acceleration = evaluate_derivative(velocity, S::constant(tau));
                if let Some(fading) = &jet.fading {
                    acceleration += fading.rate_at(place, tau);
                }
                acceleration * (sliding(contact) * earlier.sign())
            }
            _ => {
                let mode = self.carry(mode, jet, tau);
                let order = self.order_of_guard(guard);
                self.expand_motion(&mode, time, state, inputs, order, spare);
                self.guard_value(&mode, guard, spare)
            }
        }
    }

    fn is_coordinate(&self, index: usize) -> bool {
        matches!(index, THETA | THETA3 | THETA1)
    }

    fn carry(&self, mode: &RigMode, jet: &RigJet<S>, tau: f64) -> RigMode {
        if let Some((rig, plain)) = jet.motion() {
            return rig.carry(mode, plain, tau);
        }
        let mut mode = *mode;
        mode.folded = [false; 2];
        if self.law.has_branches() && matches!(mode.disc, ContactMode::Slipping(..)) {
            mode.near[0] = kept_sign(
                value_at(&jet.disc.slip.acceleration, jet.order, tau),
                mode.near[0],
            );
        }
        if let (Some(disc1), Some(pin)) = (&self.disc1, &jet.disc1)
            && disc1.law.has_branches()
            && matches!(mode.disc1, ContactMode::Slipping(..))
        {
            mode.near[1] = kept_sign(
                value_at(&pin.slip.acceleration, jet.order, tau),
                mode.near[1],
            );
        }
        mode
    }

    fn initial_mode(
        &self,
        time: S,
        state: &mut RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) -> RigMode {
        let mut mode = RigMode {
            disc: ContactMode::Stuck,
            disc1: ContactMode::Stuck,
            motor: ContactMode::Stuck,
            coupling: match &self.effects.backlash {
                Some(backlash) => {
                    Coupling::at((state[THETA] - state[THETA3]).value(), backlash.gap.value())
                }
                None => Coupling::Ahead,
            },
            near: [0.0; 2],
            folded: [false; 2],
            branches: [0; SITES],
        };
        self.find_branches(&mut mode, time, state, inputs, jet);
        let contacts: &[(Contact, usize)] = &[
            (Contact::Motor, OMEGA3),
            (Contact::Disc, OMEGA),
            (Contact::Disc1, OMEGA1),
        ];
        let used = if self.disc1.is_some() { 3 } else { 2 };
        for &(contact, omega) in &contacts[..used] {
            let velocity = state[omega].value();
            let band = self.law_of(contact).map_or(0.0, |law| law.band().0.value());
            if velocity.abs() > band && !self.is_deflected(contact, state) {
                let regime = self.first_regime(contact);
                mode.set_contact(
                    contact,
                    ContactMode::Slipping(Direction::of(velocity), regime),
                );
            }
        }
        for &(contact, _) in &contacts[..used] {
            match mode.contact(contact) {
                ContactMode::Stuck => {
                    self.mode_at_rest(contact, &mut mode, time, state, inputs, jet);
                }
                ContactMode::Slipping(..)
                    if self.law_of(contact).is_some_and(Law::has_branches) =>
                {
                    self.turn(contact, None, &mut mode, time, state, inputs, jet);
                }
                _ => {}
            }
        }
        mode
    }

    fn switch(
        &self,
        mode: &RigMode,
        guard: RigGuard,
        time: S,
        state: &mut RigState<S>,
        inputs: &RigInputs<S>,
        jet: &mut RigJet<S>,
    ) -> RigMode {
        let mut mode = *mode;
        match guard {
            RigGuard::Rest(contact) => {
                let omega = velocity_of(contact);
                let band = self.law_of(contact).map_or(S::ZERO, |law| law.band().0);
                let ContactMode::Slipping(direction, _) = mode.contact(contact) else {
                    return mode;
                };
                state[omega] = band * direction.sign();
                self.load_bristle(contact, &mode, time, state, inputs, jet);
                self.mode_at_rest(contact, &mut mode, time, state, inputs, jet);
                // A velocity that passes through zero goes on the other way, whatever rounding makes
                // of a torque that is almost zero.
                if mode.contact(contact)
                    == ContactMode::Slipping(direction, self.first_regime(contact))
                {
                    self.break_away(contact, direction.opposite(), &mut mode);
                }
            }
            RigGuard::Breakaway(contact, direction) => match self.bristle(contact) {
                Some(_) => {
                    self.let_go(contact, direction, &mut mode, time, state, inputs, jet);
                }
                None => self.break_away(contact, direction, &mut mode),
            },
            RigGuard::LeaveBand(contact, direction) => {
                if let Some((place, _)) = self.bristle(contact) {
                    state[place] = S::ZERO;
                }
                mode.set_contact(
                    contact,
                    ContactMode::Slipping(direction, self.first_regime(contact)),
                );
            }
            RigGuard::Calm(contact) => mode.set_contact(contact, ContactMode::Stuck),
            RigGuard::Turn(contact, earlier) => {
                self.turn(contact, Some(earlier), &mut mode, time, state, inputs, jet);
            }
            RigGuard::Release(contact, sense) => {
                if let ContactMode::Slipping(direction, _) = mode.contact(contact) {
                    let free = self.law_of(contact).and_then(Law::two_gaussian).is_some();
                    let regime = match (free, sense) {
                        (true, _) => Regime::Free,
                        (false, Direction::Forward) => Regime::SpeedingUp,
                        (false, Direction::Backward) => Regime::SlowingDown,
                    };
                    mode.set_contact(contact, ContactMode::Slipping(direction, regime));
                    let side = match sense {
                        Direction::Forward => Regime::SpeedingUp,
                        Direction::Backward => Regime::SlowingDown,
                    };
                    mode.restart_root(contact, side);
                }
            }
            RigGuard::Play(coupling) => mode.coupling = coupling,
            RigGuard::Branch(place, upwards) => {
                let place = usize::from(place);
                let mut present = mode;
                self.find_branches(&mut present, time, state, inputs, jet);
                mode.branches[place] = self.equations.next_branch(
                    place,
                    upwards,
                    mode.branches[place],
                    present.branches[place],
                );
            }
            // The load's series changes its form; no mode does.
            RigGuard::Load(_) => {}
        }
        mode
    }

    fn fold(&self, mode: &RigMode, jet: &RigJet<S>, step: f64) -> Fold<S> {
        self.fold_within(mode, jet, step)
    }

    fn leave_fold(&self, mode: &RigMode, state: &mut RigState<S>, jet: &RigJet<S>) -> RigMode {
        self.pass_fold(mode, state, jet)
    }

    fn describe(&self, mode: &RigMode) -> String {
        let word = |mode: ContactMode| match mode {
            ContactMode::Stuck => "stuck",
            ContactMode::Breaking(_) => "breaking away",
            ContactMode::Slipping(Direction::Forward, _) => "slipping forward",
            ContactMode::Slipping(Direction::Backward, _) => "slipping backward",
        };
        let mut text = format!("disc D2 {}, motor {}", word(mode.disc), word(mode.motor));
        if self.disc1.is_some() {
            text.push_str(&format!(", disc D1 {}", word(mode.disc1)));
        }
        if self.effects.backlash.is_some() {
            text.push_str(match mode.coupling {
                Coupling::Free => ", coupling free",
                Coupling::Ahead | Coupling::Behind => ", coupling engaged",
            });
        }
        text
    }
}

/// `value`, or a zero with the sign of `earlier` where rounding took the sign away.
fn kept_sign(value: f64, earlier: f64) -> f64 {
    if value == 0.0 {
        libm::copysign(0.0, earlier)
    } else {
        value
    }
}
