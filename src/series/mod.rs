//! Truncated power series: the arithmetic on which the integrator stands.
//!
//! Within one mode of a hybrid system the solution is analytic, so it is carried as a polynomial in
//! local time whose coefficients come from recurrences, one order after the other.

mod dual;
mod power_series;
mod root;
mod scalar;
mod vertical_tangent;

pub use dual::Dual;
pub use power_series::{
    RECIPROCAL, Series, TERMS, convolution, cosine_sine, evaluate, evaluate_derivative,
    exponential, lower_bound, shifted,
};
pub use root::first_loss_of_sign;
pub use scalar::Scalar;
pub use vertical_tangent::{TangentWeights, VerticalTangent};
