//! Functions of FMI 3 that the component does not support: in the header, hence here, and refused.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{DependencyKind, Float64, IntervalQualifier, ValueReference};
use crate::ffi::guard::unsupported;
use crate::ffi::status::Interface;

const CLOCKS: &str = "this component has no clocks";
const DEPENDENCIES: &str =
    "providesPerElementDependencies is false: the dependencies are those of modelDescription.xml";

unsupported! { Interface::Fmi3;
    fn fmi3GetNumberOfVariableDependencies(ValueReference, *mut usize) because DEPENDENCIES;
    fn fmi3GetVariableDependencies(ValueReference, *mut usize, *mut ValueReference, *mut usize, *mut DependencyKind, usize) because DEPENDENCIES;

    fn fmi3GetIntervalDecimal(*const ValueReference, usize, *mut Float64, *mut IntervalQualifier) because CLOCKS;
    fn fmi3GetIntervalFraction(*const ValueReference, usize, *mut u64, *mut u64, *mut IntervalQualifier) because CLOCKS;
    fn fmi3GetShiftDecimal(*const ValueReference, usize, *mut Float64) because CLOCKS;
    fn fmi3GetShiftFraction(*const ValueReference, usize, *mut u64, *mut u64) because CLOCKS;
    fn fmi3SetIntervalDecimal(*const ValueReference, usize, *const Float64) because CLOCKS;
    fn fmi3SetIntervalFraction(*const ValueReference, usize, *const u64, *const u64) because CLOCKS;
    fn fmi3SetShiftDecimal(*const ValueReference, usize, *const Float64) because CLOCKS;
    fn fmi3SetShiftFraction(*const ValueReference, usize, *const u64, *const u64) because CLOCKS;
    fn fmi3ActivateModelPartition(ValueReference, Float64) because CLOCKS;
}
