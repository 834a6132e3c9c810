//! Every function of the two standards' headers: a library must export them all, used or not.

use object::Object;

use crate::platform::FmiVersion;

/// Names of all functions that the header of the standard declares.
pub fn required(version: FmiVersion) -> &'static [&'static str] {
    match version {
        FmiVersion::Fmi2 => &FMI2,
        FmiVersion::Fmi3 => &FMI3,
    }
}

/// Names of the functions that an FMU with these interfaces (`CoSimulation` …) must export; a foreign library
/// may leave out those of other interfaces.
pub fn required_by(version: FmiVersion, interfaces: &[&str]) -> Vec<&'static str> {
    let belongs = |name: &str| {
        let home = OF_ONE_INTERFACE
            .iter()
            .find(|(_, names)| names.contains(&&name[4..]));
        home.is_none_or(|(interface, _)| interfaces.contains(interface))
    };
    required(version)
        .iter()
        .copied()
        .filter(|name| belongs(name))
        .collect()
}

/// Those of `names` that a library of any platform does not export.
pub fn missing_from(file: &object::File<'_>, names: Vec<&'static str>) -> Vec<&'static str> {
    let exported: Vec<String> = file
        .exports()
        .unwrap_or_default()
        .iter()
        .map(|export| {
            String::from_utf8_lossy(export.name())
                .trim_start_matches('_')
                .to_owned()
        })
        .collect();
    names
        .into_iter()
        .filter(|name| !exported.iter().any(|export| export == name))
        .collect()
}

/// Functions, without their prefix, that only one interface calls.
const OF_ONE_INTERFACE: [(&str, &[&str]); 3] = [
    (
        "ModelExchange",
        &[
            "InstantiateModelExchange",
            "NewDiscreteStates",
            "EnterContinuousTimeMode",
            "CompletedIntegratorStep",
            "SetTime",
            "SetContinuousStates",
            "GetDerivatives",
            "GetContinuousStateDerivatives",
            "GetEventIndicators",
            "GetContinuousStates",
            "GetNominalsOfContinuousStates",
            "GetNumberOfEventIndicators",
            "GetNumberOfContinuousStates",
        ],
    ),
    (
        "CoSimulation",
        &[
            "InstantiateCoSimulation",
            "DoStep",
            "CancelStep",
            "SetRealInputDerivatives",
            "GetRealOutputDerivatives",
            "GetOutputDerivatives",
            "GetStatus",
            "GetRealStatus",
            "GetIntegerStatus",
            "GetBooleanStatus",
            "GetStringStatus",
            "EnterStepMode",
        ],
    ),
    (
        "ScheduledExecution",
        &["InstantiateScheduledExecution", "ActivateModelPartition"],
    ),
];

/// `fmi2Functions.h`, in alphabetical order.
const FMI2: [&str; 44] = [
    "fmi2CancelStep",
    "fmi2CompletedIntegratorStep",
    "fmi2DeSerializeFMUstate",
    "fmi2DoStep",
    "fmi2EnterContinuousTimeMode",
    "fmi2EnterEventMode",
    "fmi2EnterInitializationMode",
    "fmi2ExitInitializationMode",
    "fmi2FreeFMUstate",
    "fmi2FreeInstance",
    "fmi2GetBooleanStatus",
    "fmi2GetBoolean",
    "fmi2GetContinuousStates",
    "fmi2GetDerivatives",
    "fmi2GetDirectionalDerivative",
    "fmi2GetEventIndicators",
    "fmi2GetFMUstate",
    "fmi2GetIntegerStatus",
    "fmi2GetInteger",
    "fmi2GetNominalsOfContinuousStates",
    "fmi2GetRealOutputDerivatives",
    "fmi2GetRealStatus",
    "fmi2GetReal",
    "fmi2GetStatus",
    "fmi2GetStringStatus",
    "fmi2GetString",
    "fmi2GetTypesPlatform",
    "fmi2GetVersion",
    "fmi2Instantiate",
    "fmi2NewDiscreteStates",
    "fmi2Reset",
    "fmi2SerializeFMUstate",
    "fmi2SerializedFMUstateSize",
    "fmi2SetBoolean",
    "fmi2SetContinuousStates",
    "fmi2SetDebugLogging",
    "fmi2SetFMUstate",
    "fmi2SetInteger",
    "fmi2SetRealInputDerivatives",
    "fmi2SetReal",
    "fmi2SetString",
    "fmi2SetTime",
    "fmi2SetupExperiment",
    "fmi2Terminate",
];

/// `fmi3Functions.h`, in alphabetical order.
const FMI3: [&str; 75] = [
    "fmi3ActivateModelPartition",
    "fmi3CompletedIntegratorStep",
    "fmi3DeserializeFMUState",
    "fmi3DoStep",
    "fmi3EnterConfigurationMode",
    "fmi3EnterContinuousTimeMode",
    "fmi3EnterEventMode",
    "fmi3EnterInitializationMode",
    "fmi3EnterStepMode",
    "fmi3EvaluateDiscreteStates",
    "fmi3ExitConfigurationMode",
    "fmi3ExitInitializationMode",
    "fmi3FreeFMUState",
    "fmi3FreeInstance",
    "fmi3GetAdjointDerivative",
    "fmi3GetBinary",
    "fmi3GetBoolean",
    "fmi3GetClock",
    "fmi3GetContinuousStateDerivatives",
    "fmi3GetContinuousStates",
    "fmi3GetDirectionalDerivative",
    "fmi3GetEventIndicators",
    "fmi3GetFMUState",
    "fmi3GetFloat32",
    "fmi3GetFloat64",
    "fmi3GetInt16",
    "fmi3GetInt32",
    "fmi3GetInt64",
    "fmi3GetInt8",
    "fmi3GetIntervalDecimal",
    "fmi3GetIntervalFraction",
    "fmi3GetNominalsOfContinuousStates",
    "fmi3GetNumberOfContinuousStates",
    "fmi3GetNumberOfEventIndicators",
    "fmi3GetNumberOfVariableDependencies",
    "fmi3GetOutputDerivatives",
    "fmi3GetShiftDecimal",
    "fmi3GetShiftFraction",
    "fmi3GetString",
    "fmi3GetUInt16",
    "fmi3GetUInt32",
    "fmi3GetUInt64",
    "fmi3GetUInt8",
    "fmi3GetVariableDependencies",
    "fmi3GetVersion",
    "fmi3InstantiateCoSimulation",
    "fmi3InstantiateModelExchange",
    "fmi3InstantiateScheduledExecution",
    "fmi3Reset",
    "fmi3SerializeFMUState",
    "fmi3SerializedFMUStateSize",
    "fmi3SetBinary",
    "fmi3SetBoolean",
    "fmi3SetClock",
    "fmi3SetContinuousStates",
    "fmi3SetDebugLogging",
    "fmi3SetFMUState",
    "fmi3SetFloat32",
    "fmi3SetFloat64",
    "fmi3SetInt16",
    "fmi3SetInt32",
    "fmi3SetInt64",
    "fmi3SetInt8",
    "fmi3SetIntervalDecimal",
    "fmi3SetIntervalFraction",
    "fmi3SetShiftDecimal",
    "fmi3SetShiftFraction",
    "fmi3SetString",
    "fmi3SetTime",
    "fmi3SetUInt16",
    "fmi3SetUInt32",
    "fmi3SetUInt64",
    "fmi3SetUInt8",
    "fmi3Terminate",
    "fmi3UpdateDiscreteStates",
];
