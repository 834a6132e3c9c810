//! Functions of FMI 2 for model exchange: in the header, hence here, and refused.
#![allow(non_snake_case, reason = "the standard names its functions so")]

use super::types::{Boolean, EventInfo, Real};
use crate::ffi::guard::unsupported;
use crate::ffi::status::Interface;

const REASON: &str = "model exchange is not supported; this component is for co-simulation";

unsupported! { Interface::Fmi2;
    fn fmi2EnterEventMode() because REASON;
    fn fmi2NewDiscreteStates(*mut EventInfo) because REASON;
    fn fmi2EnterContinuousTimeMode() because REASON;
    fn fmi2CompletedIntegratorStep(Boolean, *mut Boolean, *mut Boolean) because REASON;
    fn fmi2SetTime(Real) because REASON;
    fn fmi2SetContinuousStates(*const Real, usize) because REASON;
    fn fmi2GetDerivatives(*mut Real, usize) because REASON;
    fn fmi2GetEventIndicators(*mut Real, usize) because REASON;
    fn fmi2GetContinuousStates(*mut Real, usize) because REASON;
    fn fmi2GetNominalsOfContinuousStates(*mut Real, usize) because REASON;
}
