//! A call as data: what is called on whom with which arguments, legal or not.

use stickslip::cosim::VariableTable;

use crate::standard::{State, Version};

/// Number of instances that a sequence of calls plays with.
pub const SLOTS: usize = 8;
/// Number of places for handles of saved states, and for serialised ones.
pub const STATE_PLACES: usize = 6;

/// One call of a sequence. Sequences make sense in any selection and order, so they can be shortened.
#[derive(Debug, Clone)]
pub struct Call {
    /// The instance.
    pub slot: usize,
    /// The handle that is passed for it.
    pub aim: Aim,
    /// What is called.
    pub action: Action,
}

/// Which handle is passed as the instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    /// The instance's own.
    Own,
    /// NULL.
    Null,
    /// That of the instance freed last.
    Freed,
    /// That of a saved state.
    SavedState,
    /// Any number.
    Forged(usize),
    /// The instance's own, to a function of the other version.
    OtherVersion,
}

/// Which handle is passed as a saved state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateAim {
    /// The one kept in this place, NULL if none was.
    Place(usize),
    /// That of the state freed last.
    Freed,
    /// That of an instance.
    Instance,
    /// Any number.
    Forged(usize),
}

/// Types of values, as far as the standards share them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Real, Float64.
    Real,
    /// Boolean.
    Boolean,
    /// Integer, Int32.
    Integer,
    /// String.
    Text,
}

/// What is wrong with array arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrays {
    /// Nothing.
    Sound,
    /// The value references are NULL.
    NoReferences,
    /// The values are NULL.
    NoValues,
    /// An address that no value of the type can have.
    Misaligned,
    /// A count that no memory has.
    HugeCount,
    /// FMI 3: another number of values than of references.
    OtherCount,
}

/// Array arguments: value references, with what is wrong with them and with the values that go with them.
#[derive(Debug, Clone)]
pub struct Array {
    /// The value references.
    pub references: Vec<u32>,
    /// What is wrong.
    pub wrong: Arrays,
}

/// What is wrong with the arguments of an instantiation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instantiation {
    /// Nothing.
    Sound,
    /// No instance name.
    NoName,
    /// A name of blanks.
    BlankName,
    /// No token.
    NoToken,
    /// The token of another component.
    ForeignToken,
    /// No resource location.
    NoResources,
    /// A scheme that cannot be read.
    Scheme,
    /// A relative path.
    Relative,
    /// A folder that is not there.
    Nowhere,
    /// FMI 2: no callbacks. FMI 3: intermediate variables, which the component does not provide.
    Interface,
}

/// Arguments of `fmi2SetupExperiment` and `fmi3EnterInitializationMode`.
#[derive(Debug, Clone, Copy)]
pub struct SetUp {
    /// Tolerance, where defined.
    pub tolerance: Option<f64>,
    /// Start time [s].
    pub start: f64,
    /// Stop time [s], where defined.
    pub stop: Option<f64>,
}

/// What is called.
#[derive(Debug, Clone)]
#[allow(missing_docs, reason = "named as in the standards")]
pub enum Action {
    Instantiate {
        component: usize,
        instantiation: Instantiation,
        event_mode: bool,
        early_return: bool,
        logging: bool,
        logger: bool,
    },
    Free,
    Debug {
        on: bool,
        categories: Vec<&'static str>,
        with_null: bool,
    },
    SetUp(SetUp),
    EnterInitialization(SetUp),
    ExitInitialization,
    EnterConfiguration,
    ExitConfiguration,
    EnterEvent,
    Evaluate,
    Update {
        null: bool,
    },
    EnterStep,
    Terminate,
    Reset,
    Get {
        kind: Kind,
        array: Array,
    },
    Set {
        kind: Kind,
        array: Array,
        values: Vec<f64>,
    },
    InputDerivatives {
        array: Array,
        orders: Vec<i32>,
        values: Vec<f64>,
    },
    OutputDerivatives {
        array: Array,
        orders: Vec<i32>,
    },
    Directional {
        unknowns: Array,
        knowns: Vec<u32>,
        seed: Vec<f64>,
    },
    Step {
        offset: f64,
        size: f64,
        null: bool,
    },
    Cancel,
    /// Without a kind of value: `fmi2GetStatus` itself.
    GetStatus {
        kind: Option<Kind>,
        asked: i32,
        null: bool,
    },
    /// With `fresh` the place is set to NULL before, so that a new state is made.
    SaveState {
        into: StateAim,
        fresh: bool,
        null: bool,
    },
    RestoreState(StateAim),
    FreeState {
        aim: StateAim,
        null: bool,
    },
    StateSize {
        aim: StateAim,
        null: bool,
    },
    Serialize {
        aim: StateAim,
        into: usize,
        short: bool,
        null: bool,
    },
    Deserialize {
        from: usize,
        into: usize,
        flipped: Option<(usize, u8)>,
        cut: usize,
        null: bool,
    },
    /// A function that the component does not support.
    Unsupported(bool),
    /// Not one call but three: saves, serialises and compares every bit of the state with the native model's.
    Compare,
}

/// What the generator may know of an instance to make most calls legal.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Version through which it was made.
    pub version: Version,
    /// Its state by the standard; `None` where there is no instance.
    pub state: Option<State>,
    /// Its variables.
    pub table: &'a VariableTable,
}
