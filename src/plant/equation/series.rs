//! What the effects by equation add, order by order, and where they change branch.

use super::{EquationEffects, Port, SiUnits};
use crate::expression::{COORDINATES, Coordinate, ExpressionJet, Site};
use crate::series::{Scalar, Series, TERMS, convolution};

/// Series of a rig's effects by equation.
#[derive(Clone, Debug)]
pub(in crate::plant) struct EquationJet<S> {
    /// One for each active effect.
    jets: Vec<ExpressionJet<S>>,
    /// Normal forces on D2 and D1 [the rig's unit of force], ≥ 0.
    pub loads: [Series<S>; 2],
    /// Loads of D2 and D1 before any factor, and under the factors of one effect after the other.
    unvaried: [Series<S>; 2],
    products: Vec<Series<S>>,
}

impl<S: Scalar> EquationJet<S> {
    /// Empty series.
    pub fn new(effects: &EquationEffects<S>) -> Self {
        let zero = [S::ZERO; TERMS];
        Self {
            jets: effects
                .active()
                .map(|effect| effect.definition.program().new_jet())
                .collect(),
            loads: [zero; 2],
            unvaried: [zero; 2],
            products: vec![zero; effects.active().count()],
        }
    }
}

impl<S: Scalar> EquationEffects<S> {
    /// Coefficient `k` of the sum of all that acts at `port`.
    pub(in crate::plant) fn sum(
        &self,
        port: Port,
        k: usize,
        mut coordinates: [S; COORDINATES],
        branches: &[i32],
        work: &mut EquationJet<S>,
    ) -> S {
        self.in_si(&mut coordinates, port);
        let mut sum = S::ZERO;
        let mut first = 0;
        for (effect, jet) in self.active().zip(&mut work.jets) {
            let program = effect.definition.program();
            let last = first + program.sites().len();
            if effect.definition.port() == port {
                let own = &branches[first..last];
                sum += program.expand_order(k, &coordinates, effect.values(), own, jet);
            }
            first = last;
        }
        if self.units == SiUnits::SI {
            sum
        } else {
            sum * (1.0 / self.units.of_port(port))
        }
    }

    /// Coefficient `k` of the load whose coefficient was `load` before the factors of all that acts at `port`.
    pub(in crate::plant) fn varied_load(
        &self,
        port: Port,
        k: usize,
        load: S,
        mut coordinates: [S; COORDINATES],
        branches: &[i32],
        work: &mut EquationJet<S>,
    ) -> S {
        self.in_si(&mut coordinates, port);
        let disc = usize::from(port.is_outer());
        work.unvaried[disc][k] = load;
        let mut product: &Series<S> = &work.unvaried[disc];
        let mut first = 0;
        let jets = work.jets.iter_mut().zip(&mut work.products);
        for (effect, (jet, varied)) in self.active().zip(jets) {
            let program = effect.definition.program();
            let last = first + program.sites().len();
            if effect.definition.port() == port {
                let own = &branches[first..last];
                program.expand_order(k, &coordinates, effect.values(), own, jet);
                varied[k] = convolution(&product[..=k], &jet.value()[..=k]);
                product = varied;
            }
            first = last;
        }
        product[k]
    }

    /// Puts the branches of all that acts at `port` where these coordinates are.
    pub(in crate::plant) fn find_branches(
        &self,
        port: Port,
        mut coordinates: [S; COORDINATES],
        branches: &mut [i32],
        work: &mut EquationJet<S>,
    ) {
        self.in_si(&mut coordinates, port);
        let mut first = 0;
        for (effect, jet) in self.active().zip(&mut work.jets) {
            let program = effect.definition.program();
            let last = first + program.sites().len();
            if effect.definition.port() == port {
                let own = &mut branches[first..last];
                program.branches(&coordinates, effect.values(), own, jet);
            }
            first = last;
        }
    }

    /// Calls `watch` for every end of every branch: with its place, whether it lies upwards, and the coefficients of what must
    /// stay positive.
    pub(in crate::plant) fn watch_branches(
        &self,
        branches: &[i32],
        work: &EquationJet<S>,
        mut watch: impl FnMut(usize, bool, &dyn Fn(usize) -> S),
    ) {
        let mut place = 0;
        for (effect, jet) in self.active().zip(&work.jets) {
            let program = effect.definition.program();
            for site in 0..program.sites().len() {
                let branch = branches[place];
                for upwards in [false, true] {
                    if program.has_end(site, upwards, branch) {
                        watch(place, upwards, &|k| {
                            program.watched(site, upwards, branch, jet, k)
                        });
                    }
                }
                place += 1;
            }
        }
    }

    /// Moves the site at `place` to its next branch.
    pub(in crate::plant) fn leave_branch(&self, place: usize, upwards: bool, branches: &mut [i32]) {
        let mut first = 0;
        for effect in self.active() {
            let program = effect.definition.program();
            let count = program.sites().len();
            if place < first + count {
                branches[place] = program.next_branch(place - first, upwards, branches[place]);
                return;
            }
            first += count;
        }
    }

    /// For every site, whether it can be left both ways.
    pub(in crate::plant) fn sites(&self) -> Vec<bool> {
        let programs = self.active().map(|effect| effect.definition.program());
        programs
            .flat_map(|program| program.sites().iter().map(Site::has_pieces))
            .collect()
    }
}

/// Coordinates with these coefficients, the others zero.
pub(in crate::plant) fn coordinates<S: Scalar, const N: usize>(
    known: [(Coordinate, S); N],
) -> [S; COORDINATES] {
    let mut all = [S::ZERO; COORDINATES];
    for (coordinate, value) in known {
        all[coordinate as usize] = value;
    }
    all
}
