//! What the effects by equation add, order by order, and where they change branch.

use super::{EquationEffect, EquationEffects, Port, SiUnits};
use crate::expression::{COORDINATES, Coordinate, Dimension, ExpressionJet, Program, Site};
use crate::series::{Scalar, Series, TERMS, convolution};
use std::ops::Range;

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
    /// Of each active effect, its program, its values, and where its kinks stand among those of all.
    fn programs(
        &self,
    ) -> impl Iterator<Item = (&EquationEffect<S>, &'static Program, Range<usize>)> {
        let mut first = 0;
        self.active().map(move |effect| {
            let program = effect.definition.program();
            let sites = first..first + program.sites().len();
            first = sites.end;
            (effect, program, sites)
        })
    }

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
        for ((effect, program, sites), jet) in self.programs().zip(&mut work.jets) {
            if effect.definition.port() == port {
                let own = &branches[sites];
                sum += program.expand_order(k, &coordinates, effect.values(), own, jet);
            }
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
        let disc = usize::from(port.is_on_disc1());
        work.unvaried[disc][k] = load;
        let mut product: &Series<S> = &work.unvaried[disc];
        let jets = work.jets.iter_mut().zip(&mut work.products);
        for ((effect, program, sites), (jet, varied)) in self.programs().zip(jets) {
            if effect.definition.port() == port {
                let own = &branches[sites];
                program.expand_order(k, &coordinates, effect.values(), own, jet);
                varied[k] = convolution(&product[..=k], &jet.value()[..=k]);
                product = varied;
            }
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
        for ((effect, program, sites), jet) in self.programs().zip(&mut work.jets) {
            if effect.definition.port() == port {
                let own = &mut branches[sites];
                program.branches(&coordinates, effect.values(), own, jet);
            }
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
        for ((_, program, sites), jet) in self.programs().zip(&work.jets) {
            for (site, place) in sites.enumerate() {
                let branch = branches[place];
                for upwards in [false, true] {
                    if program.has_end(site, upwards, branch) {
                        watch(place, upwards, &|k| {
                            program.watched(site, upwards, branch, jet, k)
                        });
                    }
                }
            }
        }
    }

    /// The branch on which the kink at `place` goes on, where the present values lie on `found`.
    pub(in crate::plant) fn next_branch(
        &self,
        place: usize,
        upwards: bool,
        branch: i32,
        found: i32,
    ) -> i32 {
        let own = self.programs().find(|(_, _, sites)| sites.contains(&place));
        own.map_or(branch, |(_, program, sites)| {
            program.next_branch(place - sites.start, upwards, branch, found)
        })
    }

    /// For every kink, whether it can be left both ways, and the dimension of what decides it.
    pub(in crate::plant) fn kinks(&self) -> impl Iterator<Item = (bool, Dimension)> {
        self.programs().flat_map(|(_, program, _)| {
            let sites = program.sites().iter().map(Site::has_pieces);
            sites.zip(program.watched_dimensions())
        })
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
