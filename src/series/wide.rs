//! Loops over derivatives on registers as wide as the processor's.
//!
//! A library for x86-64 may count on registers of two numbers only, though nearly all processors since 2013 have some of four (AVX2).
//! The same loops are therefore there twice, and the processor chooses. Each number is computed by the same operations in the same
//! order, so that a run gives the same bits on every processor.

/// Work whose loops the compiler shall vectorise.
pub trait Wide {
    /// Result of the work.
    type Output;

    /// Does the work. It must be `#[inline(always)]`: only code that is inlined is on the wide registers.
    fn run(self) -> Self::Output;
}

/// Does `work` on the widest registers that the processor has.
#[inline]
pub fn on_wide_registers<W: Wide>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the function needs nothing but AVX2, which the processor has.
        return unsafe { with_avx2(work) };
    }
    work.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<W: Wide>(work: W) -> W::Output {
    work.run()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::{Dual, Scalar};

    const SLOTS: usize = 13;

    struct Products<'a>(&'a [Dual<SLOTS>], &'a [Dual<SLOTS>]);

    impl Wide for Products<'_> {
        type Output = Dual<SLOTS>;

        #[inline(always)]
        fn run(self) -> Self::Output {
            let mut sum = Dual::ZERO;
            for (a, b) in self.0.iter().zip(self.1) {
                sum += (*a * *b).exp();
            }
            sum
        }
    }

    #[test]
    fn the_bits_are_those_of_narrow_registers() {
        let numbers = |phase: f64| -> Vec<Dual<SLOTS>> {
            (0..17)
                .map(|j| {
                    let mut number = Dual::constant((phase * f64::from(j)).sin());
                    for (slot, derivative) in number.derivative.iter_mut().enumerate() {
                        *derivative = (phase + slot as f64 / 3.0).cos() / 7.0;
                    }
                    number
                })
                .collect()
        };
        let (a, b) = (numbers(0.7), numbers(1.9));
        let bits = |number: Dual<SLOTS>| number.derivative.map(f64::to_bits);
        let (wide, narrow) = (on_wide_registers(Products(&a, &b)), Products(&a, &b).run());
        assert_eq!(wide.value.to_bits(), narrow.value.to_bits());
        assert_eq!(bits(wide), bits(narrow));
    }
}
