//! Random calls: legal, illegal and hostile ones.

use stickslip::cosim::{Causality, Variable, VariableType};

use crate::call::{
    Action, Aim, Array, Arrays, Call, Instantiation, Kind, STATE_PLACES, SetUp, StateAim, View,
};
use crate::random::Random;
use crate::standard::{State, Version};

const HOSTILE: [f64; 16] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    -1.0,
    1e300,
    -1e300,
    1e-300,
    f64::MIN_POSITIVE,
    5e-324,
    f64::MAX,
    1e-9,
    1e9,
    -1e-9,
    0.1,
];

const CATEGORIES: [&str; 7] = [
    "logEvents",
    "logStatusWarning",
    "logStatusDiscard",
    "logStatusError",
    "logAll",
    "nonsense %s%n #1#",
    "",
];

/// The next call of a sequence: about four in five are legal where they arrive.
#[must_use]
pub fn generate(random: &mut Random, slot: usize, view: View<'_>) -> Call {
    let aim = match random.index(160) {
        0 => Aim::Null,
        1 => Aim::Freed,
        2 => Aim::SavedState,
        3 => Aim::Forged(random.bits() as usize >> random.index(64)),
        4 => Aim::OtherVersion,
        _ => Aim::Own,
    };
    let action = match view.state {
        None if !random.once_in(30) => instantiation(random),
        Some(state) if !random.once_in(12) => useful(random, state, view),
        _ => any(random, view),
    };
    Call { slot, aim, action }
}

fn instantiation(random: &mut Random) -> Action {
    use Instantiation as B;
    let wrong = [
        B::NoName,
        B::BlankName,
        B::NoToken,
        B::ForeignToken,
        B::NoResources,
        B::Scheme,
        B::Relative,
        B::Nowhere,
        B::Interface,
    ];
    Action::Instantiate {
        component: random.index(2),
        instantiation: if random.once_in(4) {
            random.pick(&wrong)
        } else {
            B::Sound
        },
        event_mode: random.once_in(2),
        early_return: random.once_in(2),
        logging: random.once_in(2),
        logger: !random.once_in(8),
    }
}

fn useful(random: &mut Random, state: State, view: View<'_>) -> Action {
    let three = view.version == Version::Three;
    match state {
        State::Instantiated => match random.index(8) {
            0 | 1 => set(random, view),
            2 if three => Action::EnterConfiguration,
            3 if !three => Action::SetUp(set_up(random)),
            4 => states(random),
            _ => Action::EnterInitialization(set_up(random)),
        },
        State::Configuration => Action::ExitConfiguration,
        State::Initialization => match random.index(8) {
            0..3 => set(random, view),
            3 => get(random, view),
            4 => directional(random, view),
            5 => states(random),
            _ => Action::ExitInitialization,
        },
        State::Step => match random.index(32) {
            0..8 => Action::Step {
                offset: 0.0,
                size: random.pick(&[1e-4, 1e-3, 1e-3, 0.01, 0.01, 0.05, 0.3]),
                null: false,
            },
            8..14 => get(random, view),
            14..20 => set(random, view),
            20..22 => states(random),
            22 => directional(random, view),
            23 => output_derivatives(random, view),
            24 if !three => input_derivatives(random, view),
            24 => Action::EnterEvent,
            25 => Action::Compare,
            26 if random.once_in(12) => Action::Terminate,
            27 if random.once_in(24) => Action::Reset,
            28 if random.once_in(24) => Action::Free,
            29 => debug(random),
            30 if !three => get_status(random),
            _ => step(random),
        },
        State::Event => match random.index(6) {
            0 => set(random, view),
            1 => Action::Evaluate,
            2 => Action::Update { null: false },
            3 => get(random, view),
            _ => Action::EnterStep,
        },
        State::Terminated | State::Error => match random.index(8) {
            0 => get(random, view),
            1 => Action::Compare,
            2 => Action::Free,
            3 | 4 => states(random),
            _ => Action::Reset,
        },
    }
}

fn any(random: &mut Random, view: View<'_>) -> Action {
    match random.index(27) {
        0 => instantiation(random),
        1 => Action::Free,
        2 => debug(random),
        3 => Action::SetUp(set_up(random)),
        4 => Action::EnterInitialization(set_up(random)),
        5 => Action::ExitInitialization,
        6 => Action::EnterConfiguration,
        7 => Action::ExitConfiguration,
        8 => Action::EnterEvent,
        9 => Action::Evaluate,
        10 => Action::Update {
            null: random.once_in(2),
        },
        11 => Action::EnterStep,
        12 => Action::Terminate,
        13 => Action::Reset,
        14 => get(random, view),
        15 => set(random, view),
        16 => input_derivatives(random, view),
        17 => output_derivatives(random, view),
        18 => directional(random, view),
        19 | 20 => step(random),
        21 => Action::Cancel,
        22 => get_status(random),
        23 | 24 => states(random),
        25 => Action::Unsupported(random.once_in(2)),
        _ => Action::Compare,
    }
}

fn set_up(random: &mut Random) -> SetUp {
    let start = hostile_once_in(random, 16, |random| {
        random.pick(&[0.0, 0.0, 0.0, 100.0, -3.5])
    });
    SetUp {
        tolerance: match random.index(8) {
            0 => Some(random.pick(&HOSTILE)),
            1 => Some(1e-6),
            _ => None,
        },
        start,
        stop: match random.index(6) {
            0 => Some(start + 1.0),
            1 => Some(random.pick(&HOSTILE)),
            _ => None,
        },
    }
}

fn step(random: &mut Random) -> Action {
    let hostile = [
        0.0,
        -1e-3,
        f64::NAN,
        f64::INFINITY,
        1e-300,
        1e-15,
        5e-10,
        2.0,
    ];
    Action::Step {
        offset: match random.index(6) {
            0 => random.pick(&[1e-16, -4e-10, 1e-6, -0.01, f64::NAN, 1e300]),
            _ => 0.0,
        },
        size: if random.once_in(2) {
            random.pick(&hostile)
        } else {
            1e-3 * random.uniform()
        },
        null: random.once_in(20),
    }
}

fn references(random: &mut Random, view: View<'_>) -> Vec<u32> {
    let count = view.table.variables().len();
    let most = random.pick(&[1, 1, 2, 3, 8]);
    (0..random.index(most + 1))
        .map(|_| match random.index(60) {
            0 => random.bits() as u32,
            1 => count as u32,
            _ => random.index(count) as u32,
        })
        .collect()
}

/// Mostly variables of the wanted sort, now and then any.
fn chosen(random: &mut Random, view: View<'_>, wanted: impl Fn(&Variable) -> bool) -> Vec<u32> {
    if random.once_in(20) {
        return references(random, view);
    }
    let fitting: Vec<u32> = (view.table.variables().iter())
        .filter(|variable| wanted(variable))
        .map(|variable| variable.value_reference)
        .collect();
    (0..1 + random.index(3))
        .map(|_| random.pick(&fitting))
        .collect()
}

fn is_real(variable: &Variable) -> bool {
    variable.variable_type == VariableType::Real
}

fn kind(random: &mut Random) -> Kind {
    random.pick(&[Kind::Boolean, Kind::Integer, Kind::Text])
}

fn array(random: &mut Random, references: Vec<u32>) -> Array {
    let wrong = match random.index(150) {
        0 => Arrays::NoReferences,
        1 => Arrays::NoValues,
        2 => Arrays::Misaligned,
        3 => Arrays::HugeCount,
        4 => Arrays::OtherCount,
        _ => Arrays::Sound,
    };
    Array { references, wrong }
}

fn get(random: &mut Random, view: View<'_>) -> Action {
    let (kind, references) = match random.index(12) {
        0 => (kind(random), references(random, view)),
        1 | 2 => (
            Kind::Boolean,
            chosen(random, view, |variable| !is_real(variable)),
        ),
        _ => (Kind::Real, chosen(random, view, is_real)),
    };
    Action::Get {
        kind,
        array: array(random, references),
    }
}

fn value(random: &mut Random, variable: Option<&Variable>) -> f64 {
    if random.once_in(60) {
        return random.pick(&HOSTILE);
    }
    match variable {
        Some(input) if input.causality == Causality::Input && input.name == "u" => {
            12.0 * random.uniform() - 6.0
        }
        Some(input) if input.causality == Causality::Input => 90.0 * random.uniform() - 10.0,
        Some(other) => match other.start {
            Some(start) if start != 0.0 => start * (0.5 + 1.5 * random.uniform()),
            _ => 2.0 * random.uniform() - 1.0,
        },
        None => 1.0,
    }
}

fn set(random: &mut Random, view: View<'_>) -> Action {
    let in_use = matches!(view.state, Some(State::Step | State::Event));
    let inputs_only = !random.once_in(4);
    let references = chosen(random, view, |variable| {
        if in_use {
            variable.settable_between_steps()
                && (!inputs_only || variable.causality == Causality::Input)
        } else {
            variable.settable_before_start()
        }
    });
    let values = references
        .iter()
        .map(|reference| value(random, view.table.get(*reference)))
        .collect();
    Action::Set {
        kind: if random.once_in(20) {
            kind(random)
        } else {
            Kind::Real
        },
        array: array(random, references),
        values,
    }
}

fn orders(random: &mut Random, count: usize, highest: i32) -> Vec<i32> {
    (0..count)
        .map(|_| match random.index(24) {
            0 => random.bits() as i32,
            1 => 0,
            2 => highest + 1,
            _ => 1 + random.index(highest as usize) as i32,
        })
        .collect()
}

fn input_derivatives(random: &mut Random, view: View<'_>) -> Action {
    let references = chosen(random, view, |v| v.causality == Causality::Input);
    Action::InputDerivatives {
        orders: orders(random, references.len(), 3),
        values: (references.iter())
            .map(|_| hostile_once_in(random, 12, |random| 4.0 * random.uniform() - 2.0))
            .collect(),
        array: array(random, references),
    }
}

fn output_derivatives(random: &mut Random, view: View<'_>) -> Action {
    let references = chosen(random, view, |v| v.causality == Causality::Output);
    Action::OutputDerivatives {
        orders: orders(random, references.len(), 2),
        array: array(random, references),
    }
}

fn directional(random: &mut Random, view: View<'_>) -> Action {
    let knowns = chosen(random, view, |variable| {
        variable.settable_between_steps() && variable.causality != Causality::Output
    });
    let unknowns = chosen(random, view, |variable| {
        is_real(variable) && variable.causality == Causality::Output
    });
    Action::Directional {
        seed: (knowns.iter())
            .map(|_| hostile_once_in(random, 10, |_| 1.0))
            .collect(),
        knowns,
        unknowns: array(random, unknowns),
    }
}

/// A hostile value once in `many` times, and otherwise a usual one.
fn hostile_once_in(random: &mut Random, many: usize, usual: fn(&mut Random) -> f64) -> f64 {
    if random.once_in(many) {
        random.pick(&HOSTILE)
    } else {
        usual(random)
    }
}

fn debug(random: &mut Random) -> Action {
    Action::Debug {
        on: random.once_in(2),
        categories: (0..random.index(4))
            .map(|_| random.pick(&CATEGORIES))
            .collect(),
        with_null: random.once_in(20),
    }
}

fn get_status(random: &mut Random) -> Action {
    Action::GetStatus {
        kind: random.pick(&[
            None,
            Some(Kind::Real),
            Some(Kind::Boolean),
            Some(Kind::Integer),
            Some(Kind::Text),
        ]),
        asked: random.pick(&[0, 0, 1, 2, 2, 3, 3, 4, -1, i32::MAX]),
        null: random.once_in(12),
    }
}

fn state_aim(random: &mut Random) -> StateAim {
    match random.index(40) {
        0 => StateAim::Freed,
        1 => StateAim::Instance,
        2 => StateAim::Forged(random.bits() as usize >> random.index(64)),
        _ => StateAim::Place(random.index(STATE_PLACES)),
    }
}

fn states(random: &mut Random) -> Action {
    let null = random.once_in(60);
    let aim = state_aim(random);
    match random.index(12) {
        0..4 => Action::SaveState {
            into: aim,
            fresh: random.once_in(2),
            null,
        },
        4..6 => Action::RestoreState(aim),
        6 => Action::FreeState { aim, null },
        7 => Action::StateSize { aim, null },
        8..10 => Action::Serialize {
            aim,
            into: random.index(STATE_PLACES),
            short: random.once_in(12),
            null,
        },
        _ => Action::Deserialize {
            from: random.index(STATE_PLACES),
            into: random.index(STATE_PLACES),
            flipped: (random.once_in(4)).then(|| (random.bits() as usize, random.index(8) as u8)),
            cut: if random.once_in(8) {
                1 + random.index(60)
            } else {
                0
            },
            null,
        },
    }
}
