//! A window's Gram matrix with the nuisances integrated out: the start of the window and random
//! disturbance torques.

use crate::gram::Gram;
use crate::load_error::LoadError;
use crate::window::STARTS;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Random disturbances of the friction and of the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disturbance {
    /// Standard deviation relative to the friction torque.
    pub relative: f64,
    /// Standard deviation of an additional torque on the disc.
    pub disc: f64,
    /// Standard deviation of an additional torque on the gearbox output.
    pub motor: f64,
    /// Correlation time.
    pub correlation_time: f64,
}

impl Disturbance {
    /// No disturbance at all.
    pub const NONE: Self = Self {
        relative: 0.0,
        disc: 0.0,
        motor: 0.0,
        correlation_time: 0.5,
    };
}

/// Quadratic form of the free numbers that is left of one window.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// Curvature with respect to the free numbers.
    pub curvature: DMatrix<f64>,
    /// Descent direction: derivative of −½ × the form.
    pub gradient: DVector<f64>,
    /// Sum of squared whitened residuals that the nuisances cannot explain.
    pub square: f64,
    /// What of it the best error of the load cell does not explain either.
    pub left: f64,
    /// ln det of the nuisances' contribution to the covariance, less what the load cell's errors explain.
    pub log_determinant: f64,
    /// Number of residuals.
    pub residuals: usize,
    nuisance: Cholesky<f64, Dyn>,
    right: DVector<f64>,
    cross: DMatrix<f64>,
    active: Vec<usize>,
    scales: Vec<f64>,
    starts: usize,
    /// First column of the disc's torques, and behind their last.
    disc: (usize, usize),
}

/// Integrates the nuisances of a window out.
///
/// `offset` is the window's start minus its anchor, `deviations` how well the anchor is known, and `load_deviation` that of the
/// normal force relative to it, whose error stays in the form that comes second.
/// `None` if the matrices are not positive, which only non-finite numbers bring about.
pub fn reduce(
    gram: &Gram,
    offset: &[f64; STARTS],
    deviations: &[f64; STARTS],
    disturbance: &Disturbance,
    load_deviation: f64,
) -> Option<(Reduced, LoadError)> {
    let starts = gram.starts;
    let mut active: Vec<usize> = (0..starts).collect();
    let disc_scales: Vec<f64> = gram
        .places
        .iter()
        .map(|place| (disturbance.relative * place.friction).hypot(disturbance.disc))
        .collect();
    // A disturbance is estimated in units of its standard deviation, correlated from piece to piece.
    let mut scales = vec![1.0; starts];
    let mut first_of_block = vec![starts];
    for (j, &scale) in disc_scales.iter().enumerate() {
        if scale > 0.0 {
            active.push(gram.disc() + j);
            scales.push(scale);
        }
    }
    first_of_block.push(active.len());
    if let Some(motor) = gram.motor().filter(|_| disturbance.motor > 0.0) {
        for j in 0..gram.pieces {
            active.push(motor + j);
            scales.push(disturbance.motor);
        }
    }
    first_of_block.push(active.len());
    let n = active.len();
    let mut precision = DMatrix::zeros(n, n);
    let mut log_prior = 0.0;
    for j in 0..starts {
        let p = 1.0 / (deviations[j] * deviations[j]);
        precision[(j, j)] = p;
        log_prior += p.ln();
    }
    let rho = (-gram.divided.length / disturbance.correlation_time).exp();
    for block in first_of_block.windows(2) {
        let (from, to) = (block[0], block[1]);
        for j in from..to {
            // Inverse covariance of a first-order autoregression of unit variance, cut where pieces
            // are not neighbours.
            let joined = j > from && active[j] == active[j - 1] + 1;
            if joined {
                let f = 1.0 / (1.0 - rho * rho);
                precision[(j, j)] += f;
                precision[(j - 1, j - 1)] += f * rho * rho;
                precision[(j, j - 1)] -= f * rho;
                precision[(j - 1, j)] -= f * rho;
                log_prior += f.ln();
            } else {
                precision[(j, j)] += 1.0;
            }
        }
    }
    let g = &gram.products;
    let residual = gram.residual();
    let (first, free) = (gram.free(), residual - gram.free());
    let mut matrix = precision;
    let mut right = DVector::zeros(n);
    let mut cross = DMatrix::zeros(n, free);
    for (a, (&i, &si)) in active.iter().zip(&scales).enumerate() {
        for (b, (&j, &sj)) in active.iter().zip(&scales).enumerate() {
            matrix[(a, b)] += g[(i, j)] * si * sj;
        }
        right[a] = g[(i, residual)] * si;
        for p in 0..free {
            cross[(a, p)] = g[(i, first + p)] * si;
        }
    }
    let mut square = g[(residual, residual)];
    for j in 0..starts {
        let p = 1.0 / (deviations[j] * deviations[j]);
        square += offset[j] * offset[j] * p;
        right[j] -= offset[j] * p;
    }
    let nuisance = Cholesky::new(matrix)?;
    let log_determinant = 2.0
        * nuisance
            .l_dirty()
            .diagonal()
            .iter()
            .map(|d| d.ln())
            .sum::<f64>()
        - log_prior;
    let solved_right = nuisance.solve(&right);
    let solved_cross = nuisance.solve(&cross);
    let curvature = g.view((first, first), (free, free)) - cross.transpose() * &solved_cross;
    let gradient =
        g.view((first, residual), (free, 1)).column(0) - cross.transpose() * &solved_right;
    square -= right.dot(&solved_right);
    let load = load_direction(gram, load_deviation);
    let loaded = g * &load;
    let on_nuisance = DVector::from_fn(n, |a, _| loaded[active[a]] * scales[a]);
    let solved = nuisance.solve(&on_nuisance);
    let load_error = LoadError {
        curvature: load.dot(&loaded) - on_nuisance.dot(&solved),
        gradient: loaded[residual] - right.dot(&solved),
        cross: loaded.rows(first, free) - cross.transpose() * &solved,
    };
    let reduced = Reduced {
        curvature,
        gradient,
        square: square.max(0.0),
        left: square.max(0.0),
        log_determinant,
        residuals: gram.residuals,
        nuisance,
        right,
        cross,
        active,
        scales,
        starts,
        disc: (gram.disc(), gram.disc() + gram.pieces),
    };
    reduced.square.is_finite().then_some((reduced, load_error))
}

/// Torques on the disc that a load larger by this share of it makes.
pub(crate) fn load_direction(gram: &Gram, share: f64) -> DVector<f64> {
    let mut direction = DVector::zeros(gram.products.ncols());
    for (piece, place) in gram.places.iter().enumerate() {
        direction[gram.disc() + piece] = -share * place.friction * place.speed.signum();
    }
    direction
}

impl Reduced {
    /// Best change of the window's start when the free numbers change by `step`.
    pub fn start_change(&self, step: &DVector<f64>) -> [f64; STARTS] {
        let solution = self.nuisance.solve(&(&self.right - &self.cross * step));
        std::array::from_fn(|j| if j < self.starts { solution[j] } else { 0.0 })
    }

    /// The same form in other numbers, from which `map` makes the present ones.
    #[must_use]
    pub fn mapped(&self, map: &DMatrix<f64>) -> Self {
        Self {
            curvature: map.transpose() * &self.curvature * map,
            gradient: map.transpose() * &self.gradient,
            cross: &self.cross * map,
            ..self.clone()
        }
    }

    /// Best torque on the disc in each piece when the free numbers change by `step`; none where it is not free.
    #[must_use]
    pub fn torques(&self, step: &DVector<f64>) -> Vec<f64> {
        let solution = self.nuisance.solve(&(&self.right - &self.cross * step));
        let (first, behind) = self.disc;
        let mut torques = vec![0.0; behind - first];
        for a in self.starts..self.active.len() {
            if let Some(torque) = self.active[a]
                .checked_sub(first)
                .and_then(|piece| torques.get_mut(piece))
            {
                *torque = solution[a] * self.scales[a];
            }
        }
        torques
    }

    /// Best estimate of the disturbance torques, in standard deviations, with their standard
    /// deviations, as (column of the Gram matrix, estimate, deviation).
    pub fn disturbances(&self) -> Vec<(usize, f64, f64)> {
        let solution = self.nuisance.solve(&self.right);
        let covariance = self.nuisance.inverse();
        (self.starts..self.active.len())
            .map(|a| {
                (
                    self.active[a],
                    solution[a],
                    covariance[(a, a)].max(0.0).sqrt(),
                )
            })
            .collect()
    }
}
