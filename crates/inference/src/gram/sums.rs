//! Sums of products of a window's residuals and derivatives, piece by piece.
//!
//! Within a piece a reading depends on the state at the piece's begin, the torques held in it and the free numbers: a few slots,
//! whose products are summed up. How that state depends on all that was before, the chain, makes of them the products of all
//! columns, once for each piece.

use crate::window::{START_COMPONENTS, STARTS};
use nalgebra::{DMatrix, DVector};
use stickslip::plant::RigState;
use stickslip::series::Dual;

/// What the slots of a dual number are: start components, the torque on the disc, free numbers, the torque on the motor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slots {
    /// Number of start components.
    pub starts: usize,
    /// Number of free numbers.
    pub free: usize,
    /// Whether there is a torque on the motor.
    pub on_motor: bool,
}

impl Slots {
    fn count(&self) -> usize {
        self.starts + 1 + self.free + usize::from(self.on_motor)
    }
}

/// Number of encoders.
pub(super) const ZEROS: usize = 3;

/// Sums of an encoder's rows, from which its zero is told.
#[derive(Clone, Default)]
struct Zero {
    /// Of the slots and the residual, within the present piece.
    within: Vec<f64>,
    /// Of all columns.
    rows: DVector<f64>,
    readings: usize,
}

/// The sums of a window.
pub(super) struct Sums {
    slots: Slots,
    pieces: usize,
    /// Products of all columns; of (i, j) with i ≤ j.
    products: DMatrix<f64>,
    /// The same of the slots and the residual, within the present piece.
    within: DMatrix<f64>,
    row: Vec<f64>,
    /// Derivatives of the start components at the begin of the present piece with respect to all columns but the residual's.
    chain: DMatrix<f64>,
    zeros: [Zero; ZEROS],
    /// Number of residuals.
    pub residuals: usize,
}

impl Sums {
    pub(super) fn new(slots: Slots, pieces: usize) -> Self {
        let torques = pieces * (1 + usize::from(slots.on_motor));
        let columns = slots.starts + torques + slots.free + 1;
        let local = slots.count() + 1;
        Self {
            slots,
            pieces,
            products: DMatrix::zeros(columns, columns),
            within: DMatrix::zeros(local, local),
            row: vec![0.0; local],
            chain: DMatrix::identity(slots.starts, columns - 1),
            zeros: std::array::from_fn(|_| Zero {
                within: vec![0.0; local],
                rows: DVector::zeros(columns),
                readings: 0,
            }),
            residuals: 0,
        }
    }

    /// Adds the reading of a channel whose standard deviation is 1/`weight`, of an encoder whose zero is not known better if `zero` says
    /// which.
    #[inline]
    pub(super) fn add<const N: usize>(
        &mut self,
        value: &Dual<N>,
        reading: f64,
        weight: f64,
        zero: Option<usize>,
    ) {
        let count = self.slots.count();
        for (own, derivative) in self.row.iter_mut().zip(&value.derivative[..count]) {
            *own = derivative * weight;
        }
        self.row[count] = (reading - value.value) * weight;
        for (j, &b) in self.row.iter().enumerate() {
            if b != 0.0 {
                let column = &mut self.within.column_mut(j);
                for (sum, &a) in column.iter_mut().zip(&self.row[..=j]) {
                    *sum += a * b;
                }
            }
        }
        if let Some(zero) = zero.map(|which| &mut self.zeros[which]) {
            for (sum, own) in zero.within.iter_mut().zip(&self.row) {
                *sum += own;
            }
            zero.readings += 1;
        }
        self.residuals += 1;
    }

    /// The column of a slot in `piece` or of the residual behind the slots.
    fn column(&self, slot: usize, piece: usize) -> usize {
        let Slots {
            starts,
            free,
            on_motor,
        } = self.slots;
        let first_free = starts + self.pieces * (1 + usize::from(on_motor));
        match slot {
            _ if slot == starts => starts + piece,
            _ if slot <= starts + free => first_free + slot - starts - 1,
            _ if on_motor && slot == starts + free + 1 => starts + self.pieces + piece,
            _ => first_free + free,
        }
    }

    /// The columns that the state at the begin of `piece` may depend on.
    fn columns_before(&self, piece: usize) -> Vec<usize> {
        let Slots {
            starts,
            free,
            on_motor,
        } = self.slots;
        let motor = starts + self.pieces;
        let on_motor = if on_motor { motor..motor + piece } else { 0..0 };
        let first_free = self.column(starts + 1, 0);
        (0..starts + piece)
            .chain(on_motor)
            .chain(first_free..first_free + free)
            .collect()
    }

    /// Takes the sums within `piece` over into those of all columns.
    pub(super) fn close(&mut self, piece: usize) {
        let starts = self.slots.starts;
        let local = self.within.ncols();
        let before = self.columns_before(piece);
        let within = &self.within;
        let of_slots = |a: usize, b: usize| within[(a.min(b), a.max(b))];
        let own: Vec<usize> = (starts..local)
            .map(|slot| self.column(slot, piece))
            .collect();
        for (b, &j) in before.iter().enumerate() {
            let chained: [f64; STARTS] = std::array::from_fn(|a| {
                if a < starts {
                    (0..starts)
                        .map(|c| of_slots(a, c) * self.chain[(c, j)])
                        .sum()
                } else {
                    0.0
                }
            });
            for &i in &before[..=b] {
                let sum: f64 = (0..starts).map(|a| self.chain[(a, i)] * chained[a]).sum();
                self.products[(i, j)] += sum;
            }
            for (slot, &k) in (starts..local).zip(&own) {
                let sum: f64 = (0..starts)
                    .map(|a| self.chain[(a, j)] * within[(a, slot)])
                    .sum();
                let twice = if j == k { 2.0 } else { 1.0 };
                self.products[(j.min(k), j.max(k))] += twice * sum;
            }
        }
        for (b, &j) in own.iter().enumerate() {
            for (a, &i) in own[..=b].iter().enumerate() {
                self.products[(i.min(j), i.max(j))] += within[(starts + a, starts + b)];
            }
        }
        self.within.fill(0.0);
        for zero in self.zeros.iter_mut().filter(|zero| zero.readings > 0) {
            for &j in &before {
                let chained = (0..starts).map(|a| self.chain[(a, j)] * zero.within[a]);
                zero.rows[j] += chained.sum::<f64>();
            }
            for (sum, &k) in zero.within[starts..].iter().zip(&own) {
                zero.rows[k] += sum;
            }
            zero.within.fill(0.0);
        }
    }

    /// Goes on to the piece after `piece`, at whose end the state is `end`.
    pub(super) fn advance<const N: usize>(&mut self, end: &RigState<Dual<N>>, piece: usize) {
        let Slots { starts, .. } = self.slots;
        let mut next = DMatrix::zeros(starts, self.chain.ncols());
        let before = self.columns_before(piece);
        for (row, component) in START_COMPONENTS.into_iter().take(starts).enumerate() {
            let derivative = &end[component].derivative;
            for &column in &before {
                next[(row, column)] = (0..starts)
                    .map(|slot| derivative[slot] * self.chain[(slot, column)])
                    .sum();
            }
            for (slot, own) in (starts..self.slots.count()).zip(&derivative[starts..]) {
                next[(row, self.column(slot, piece))] += own;
            }
        }
        self.chain = next;
    }

    /// The products of all columns, over all zeros that an encoder may have. Those deviate as much as a reading does: an encoder whose
    /// steps are rounded down and one whose steps are rounded are half a step apart.
    pub(super) fn symmetric(self) -> DMatrix<f64> {
        let mut products = self.products;
        products.fill_lower_triangle_with_upper_triangle();
        for zero in self.zeros.iter().filter(|zero| zero.readings > 0) {
            let share = 1.0 / (1.0 + zero.readings as f64);
            products.ger(-share, &zero.rows, &zero.rows, 1.0);
        }
        products
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use stickslip::series::Scalar;

    const SLOTS: usize = 8;
    const PIECES: usize = 3;
    const READINGS: usize = 4;

    fn drawn(random: &mut Random, count: usize) -> Dual<SLOTS> {
        let mut number = Dual::constant(random.normal());
        for derivative in &mut number.derivative[..count] {
            *derivative = random.normal();
        }
        number
    }

    /// The derivatives of `value` with respect to all columns, by the chain rule alone.
    fn row(sums: &Sums, chain: &DMatrix<f64>, value: &Dual<SLOTS>, piece: usize) -> DVector<f64> {
        let mut row = DVector::zeros(chain.ncols());
        for slot in 0..sums.slots.count() {
            if slot < sums.slots.starts {
                row += chain.row(slot).transpose() * value.derivative[slot];
            } else {
                row[sums.column(slot, piece)] += value.derivative[slot];
            }
        }
        row
    }

    fn sums_agree(on_motor: bool) {
        let slots = Slots {
            starts: 3,
            free: 2,
            on_motor,
        };
        let mut sums = Sums::new(slots, PIECES);
        let mut random = Random::new(7);
        let columns = sums.products.ncols();
        let mut expected = DMatrix::zeros(columns, columns);
        let mut chain = DMatrix::identity(slots.starts, columns - 1);
        let mut of_encoder = Vec::new();
        for piece in 0..PIECES {
            for number in 0..READINGS {
                let (value, reading) = (drawn(&mut random, slots.count()), random.normal());
                let zero = (number % 2 == 0).then_some(1);
                sums.add(&value, reading, 2.0, zero);
                let residual = reading - value.value;
                let full = row(&sums, &chain, &value, piece).push(residual) * 2.0;
                match zero {
                    Some(_) => of_encoder.push(full),
                    None => expected += &full * full.transpose(),
                }
            }
            sums.close(piece);
            let mut end: RigState<Dual<SLOTS>> = [Dual::constant(0.0); stickslip::plant::STATES];
            let mut next = chain.clone();
            for (start, component) in START_COMPONENTS.into_iter().take(slots.starts).enumerate() {
                end[component] = drawn(&mut random, slots.count());
                let own = row(&sums, &chain, &end[component], piece);
                next.set_row(start, &own.transpose());
            }
            sums.advance(&end, piece);
            chain = next;
        }
        // A common error as large as each reading's own doubles the variances and makes half of them common.
        let count = of_encoder.len();
        let covariance = DMatrix::from_fn(count, count, |i, j| if i == j { 2.0 } else { 1.0 });
        let weights = covariance.try_inverse().unwrap_or_default();
        for (i, one) in of_encoder.iter().enumerate() {
            for (j, other) in of_encoder.iter().enumerate() {
                expected += one * other.transpose() * weights[(i, j)];
            }
        }
        let difference = sums.symmetric() - &expected;
        assert!(difference.amax() < 1e-12 * expected.amax());
    }

    #[test]
    fn sums_piece_by_piece_are_those_of_all_rows() {
        sums_agree(false);
        sums_agree(true);
    }
}
