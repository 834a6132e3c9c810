//! Where the algebraic loops of Eqs 6-1 and 6-2 fold.

use super::RigJet;
use super::jet::PinJet;
use crate::series::{Scalar, TERMS, first_vertical_tangent};

/// Margin 1 + (∂T/∂a)/J below which the algebraic loop may be about to fold.
const FOLD_MARGIN: f64 = 0.5;

/// Local times at which the loops of D2 and D1 fold, as far as they do soon.
pub(super) fn folds<S: Scalar>(jet: &RigJet<S>) -> [Option<f64>; 2] {
    if let Some((_, plain)) = jet.motion() {
        return folds(plain);
    }
    let fold = |pin: &PinJet<S>| {
        if pin.slip.margin >= FOLD_MARGIN {
            return None;
        }
        let mut plain = [0.0; TERMS];
        for (p, c) in plain.iter_mut().zip(&pin.slip.acceleration[..=jet.order]) {
            *p = c.value();
        }
        first_vertical_tangent(&plain[..=jet.order])
    };
    [fold(&jet.disc), jet.disc1.as_deref().and_then(fold)]
}
