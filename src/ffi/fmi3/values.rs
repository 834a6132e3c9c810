//! Functions of FMI 3 that get and set variables.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{Binary, Boolean, Clock, Float64, Text, ValueReference};
use crate::cosim::VariableType;
use crate::ffi::guard::exports;
use crate::ffi::pointers::{input, output, same_length};
use crate::ffi::status::{Interface, Phase, Phases};

const READABLE: Phases = Phases::of(&[
    Phase::Instantiated,
    Phase::Initialization,
    Phase::Step,
    Phase::Event,
    Phase::ContinuousTime,
    Phase::IntermediateUpdate,
    Phase::Terminated,
]);
const SETTABLE: Phases = Phases::of(&[
    Phase::Instantiated,
    Phase::Configuration,
    Phase::Initialization,
    Phase::Step,
    Phase::Event,
    Phase::ContinuousTime,
]);

exports! { Interface::Fmi3;
    #[often]
    fn fmi3GetFloat64(|instance| references: *const ValueReference, count: usize, values: *mut Float64, value_count: usize) in READABLE => {
        same_length(("nValues", value_count), ("nValueReferences", count))?;
        instance.get_reals(input(references, count, "valueReferences")?, &mut output(values, count, "values")?)
    };
    fn fmi3GetBoolean(|instance| references: *const ValueReference, count: usize, values: *mut Boolean, value_count: usize) in READABLE => {
        same_length(("nValues", value_count), ("nValueReferences", count))?;
        instance.get_booleans(input(references, count, "valueReferences")?, &mut output(values, count, "values")?)
    };
    #[often]
    fn fmi3SetFloat64(|instance| references: *const ValueReference, count: usize, values: *const Float64, value_count: usize) in SETTABLE => {
        same_length(("nValues", value_count), ("nValueReferences", count))?;
        instance.set_reals(input(references, count, "valueReferences")?, input(values, count, "values")?)
    };
    fn fmi3SetBoolean(|instance| references: *const ValueReference, count: usize, _values: *const Boolean, _value_count: usize) in SETTABLE =>
        instance.set_none(input(references, count, "valueReferences")?, VariableType::Boolean);
}

/// Getters and setters of the types that no variable has.
macro_rules! other_types {
    ($( $get:ident, $set:ident : $type:ty, $name:literal; )*) => {
        exports! { Interface::Fmi3; $(
            fn $get(|instance| references: *const ValueReference, count: usize, _values: *mut $type, _value_count: usize) in READABLE =>
                instance.no_variable_of_type(input(references, count, "valueReferences")?, $name);
            fn $set(|instance| references: *const ValueReference, count: usize, _values: *const $type, _value_count: usize) in SETTABLE =>
                instance.no_variable_of_type(input(references, count, "valueReferences")?, $name);
        )* }
    };
}

other_types! {
    fmi3GetFloat32, fmi3SetFloat32: f32, "a Float32";
    fmi3GetInt8, fmi3SetInt8: i8, "an Int8";
    fmi3GetUInt8, fmi3SetUInt8: u8, "a UInt8";
    fmi3GetInt16, fmi3SetInt16: i16, "an Int16";
    fmi3GetUInt16, fmi3SetUInt16: u16, "a UInt16";
    fmi3GetInt32, fmi3SetInt32: i32, "an Int32";
    fmi3GetUInt32, fmi3SetUInt32: u32, "a UInt32";
    fmi3GetInt64, fmi3SetInt64: i64, "an Int64";
    fmi3GetUInt64, fmi3SetUInt64: u64, "a UInt64";
    fmi3GetString, fmi3SetString: Text, "a String";
}

exports! { Interface::Fmi3;
    fn fmi3GetBinary(|instance| references: *const ValueReference, count: usize, _sizes: *mut usize, _values: *mut Binary, _value_count: usize) in READABLE =>
        instance.no_variable_of_type(input(references, count, "valueReferences")?, "a Binary");
    fn fmi3SetBinary(|instance| references: *const ValueReference, count: usize, _sizes: *const usize, _values: *const Binary, _value_count: usize) in SETTABLE =>
        instance.no_variable_of_type(input(references, count, "valueReferences")?, "a Binary");
    fn fmi3GetClock(|instance| references: *const ValueReference, count: usize, _values: *mut Clock) in READABLE =>
        instance.no_variable_of_type(input(references, count, "valueReferences")?, "a clock");
    fn fmi3SetClock(|instance| references: *const ValueReference, count: usize, _values: *const Clock) in SETTABLE =>
        instance.no_variable_of_type(input(references, count, "valueReferences")?, "a clock");
}
