//! Physical parameters: one declaration gives the struct, its names, units, ranges and access.

mod entry;
mod list;
mod range;
mod section_file;
pub mod units;

pub(crate) use entry::Entry;
pub use list::Parameter;
pub(crate) use list::{check, parameters, position, set_at, value_at};
pub use range::Range;
pub use section_file::{ModelFileError, Provenance};
pub(crate) use section_file::{SectionReader, number};

use crate::series::Scalar;
use thiserror::Error;

/// What is known of a parameter before it has a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterInfo {
    /// Key inside its section of `model.toml`.
    pub key: &'static str,
    /// Unit in the notation of FMI (`N.m`, `kg.m2`, `1` for none).
    pub unit: &'static str,
    /// Allowed values.
    pub range: Range,
    /// One line for people.
    pub description: &'static str,
    /// Whether it stays as it is while the component runs. The others wear, warm up, are adjusted or are calibrated.
    pub built_in: bool,
}

/// Mark of a parameter that stays as it is while the component runs, for declarations.
pub(crate) const BUILT_IN: bool = true;

/// A value outside what its parameter allows, or a pair of values that contradict each other.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ParameterError {
    /// No parameter has this name.
    #[error("there is no parameter \"{name}\" in this model")]
    Unknown {
        /// The name asked for.
        name: String,
    },
    /// The value is outside the parameter's range.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// Dotted name.
        name: String,
        /// The offending value.
        value: f64,
        /// What would be right.
        range: Range,
    },
    /// Two parameters contradict each other.
    #[error("{section}: {message}")]
    Inconsistent {
        /// Section of `model.toml`.
        section: String,
        /// What contradicts what.
        message: String,
    },
}

/// A group of parameters: a section of `model.toml`.
pub trait Section<S: Scalar> {
    /// Names, units and ranges, in the order of `get` and `set`.
    fn infos(&self) -> &'static [ParameterInfo];
    /// Value number `index`.
    fn get(&self, index: usize) -> S;
    /// Replaces value number `index`; the range is the caller's business.
    fn set(&mut self, index: usize, value: S);
}

/// Declares a section: a struct over [`Scalar`](crate::series::Scalar) with documented fields and
/// its [`Section`](crate::parameter::Section) implementation.
macro_rules! section {
    (
        $(#[$outer:meta])*
        pub struct $name:ident {
            $( $(#[doc = $doc:literal])+ $field:ident : $unit:literal, $range:expr $(, $built_in:expr)?; )*
        }
    ) => {
        $(#[$outer])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name<S> {
            $( $(#[doc = $doc])+ pub $field: S, )*
        }

        impl<S: $crate::series::Scalar> $name<S> {
            /// Names, units and ranges of the fields, in declaration order.
            pub const INFOS: &'static [$crate::parameter::ParameterInfo] = &[
                $( $crate::parameter::ParameterInfo {
                    key: stringify!($field),
                    unit: $unit,
                    range: $range,
                    description: concat!($($doc),+),
                    built_in: [$($built_in,)? false][0],
                }, )*
            ];

            /// The section with the values that `value` gives for each parameter in turn.
            pub fn from_values<E>(
                mut value: impl FnMut(&'static $crate::parameter::ParameterInfo) -> Result<S, E>,
            ) -> Result<Self, E> {
                let mut infos = Self::INFOS.iter();
                $( let $field = match infos.next() {
                    Some(info) => value(info)?,
                    None => unreachable!(),
                }; )*
                Ok(Self { $( $field, )* })
            }

            /// The same values as another kind of number, without derivatives.
            pub fn to_scalar<T: $crate::series::Scalar>(&self) -> $name<T> {
                $name { $( $field: T::constant(self.$field.value()), )* }
            }
        }

        impl<S: $crate::series::Scalar> $crate::parameter::Section<S> for $name<S> {
            fn infos(&self) -> &'static [$crate::parameter::ParameterInfo] {
                Self::INFOS
            }
            fn get(&self, index: usize) -> S {
                [$( self.$field, )*][index]
            }
            fn set(&mut self, index: usize, value: S) {
                *[$( &mut self.$field, )*][index] = value;
            }
        }
    };
}
pub(crate) use section;
