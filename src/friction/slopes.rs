//! How a law's level answers to the motion and to its own parameters, along a motion that is known.
//!
//! These are series of partial derivatives: the level at an instant is a function of slip speed, slip
//! acceleration, disc angle and parameters, and each is varied alone.

use super::contact::Regime;
use super::law::Law;
use super::slip::SlipJet;
use super::two_gaussian::TwoGaussian;
use super::{two_gaussian, wojewoda};
use crate::series::{Series, TERMS, convolution, exponential};

/// Parameters of the law that has most.
pub const MOST_PARAMETERS: usize = 8;

/// Series of the partial derivatives of a law's level, in coordinates in which the contact slides
/// forward.
#[derive(Clone, Debug)]
pub struct LevelSlopes {
    /// By the slip speed [per rad/s], if the level depends on it.
    pub by_speed: Option<Series<f64>>,
    /// By the slip acceleration [per rad/s²], if the level depends on it.
    pub by_rate: Option<Series<f64>>,
    /// By the disc's angle [per rad], if the level depends on it.
    pub by_angle: Option<Series<f64>>,
    /// By those of the law's parameters that were asked for, in the order of its section.
    pub by_parameter: [Series<f64>; MOST_PARAMETERS],
}

/// What is known of a sliding contact.
pub struct KnownSlip<'a> {
    /// How the slip speed changes.
    pub regime: Regime,
    /// Slip speed [rad/s], ≥ 0.
    pub speed: &'a Series<f64>,
    /// Angle of the disc [rad].
    pub angle: &'a Series<f64>,
    /// The law's level.
    pub level: &'a Series<f64>,
    /// All other series of the contact, for laws without an exponential curve of their own.
    pub jet: &'a SlipJet<f64>,
    /// Last order wanted.
    pub order: usize,
}

impl Default for LevelSlopes {
    /// Of a level that depends on nothing.
    fn default() -> Self {
        Self {
            by_speed: None,
            by_rate: None,
            by_angle: None,
            by_parameter: [[0.0; TERMS]; MOST_PARAMETERS],
        }
    }
}

impl LevelSlopes {
    /// Fills the slopes of `law` along `slip`, those by parameters only where they are `wanted`.
    pub fn fill(&mut self, law: &Law<f64>, slip: &KnownSlip<'_>, wanted: &[bool; MOST_PARAMETERS]) {
        (self.by_speed, self.by_rate, self.by_angle) = (None, None, None);
        match law {
            Law::Coulomb(_) | Law::CoulombStiction(_) => {
                self.by_parameter[0] = [0.0; TERMS];
                self.by_parameter[1] = [0.0; TERMS];
                self.by_parameter[0][0] = 1.0;
            }
            Law::Stribeck(_) | Law::Karnopp(_) | Law::Switch(_) => {
                if let Some(curve) = law.exponential_curve() {
                    let mut excess = *slip.level;
                    excess[0] -= curve.mu_c;
                    let shape = Curve {
                        span: curve.span,
                        inverse_omega_s: curve.inverse_omega_s,
                        sense: 1.0,
                    };
                    self.fill_curve(&shape, &excess, slip, wanted);
                }
            }
            Law::Wojewoda(law) => {
                let shape = Curve {
                    span: law.mu_s - law.mu_c,
                    inverse_omega_s: 1.0 / law.omega_s,
                    sense: if slip.regime == Regime::SlowingDown {
                        -1.0
                    } else {
                        1.0
                    },
                };
                let (excess, random) = wojewoda::parts(law, slip.jet.work(), slip.order);
                self.fill_curve(&shape, &excess, slip, wanted);
                if let Some(random) = random {
                    self.fill_random(&shape, law, &random, slip, wanted);
                }
            }
            Law::TwoGaussianTorque(law) => self.fill_gaussians(&law.shape(), slip, wanted),
            Law::TwoGaussianMu(law) => self.fill_gaussians(&law.shape(), slip, wanted),
        }
    }

    /// Slopes of μ_c ± `excess` where the excess is span × exp(−ω/ω_s); μ_c, μ_s and ω_s are the first
    /// three parameters.
    fn fill_curve(
        &mut self,
        curve: &Curve,
        excess: &Series<f64>,
        slip: &KnownSlip<'_>,
        wanted: &[bool; MOST_PARAMETERS],
    ) {
        let Curve {
            span,
            inverse_omega_s,
            sense,
        } = *curve;
        self.by_speed = Some(excess.map(|e| -sense * inverse_omega_s * e));
        if wanted[0] || wanted[1] {
            let unit = if span != 0.0 {
                excess.map(|e| e / span)
            } else {
                unit_exponential(slip.speed, inverse_omega_s, slip.order)
            };
            self.by_parameter[0] = unit.map(|e| -sense * e);
            self.by_parameter[0][0] += 1.0;
            self.by_parameter[1] = unit.map(|e| sense * e);
        }
        if wanted[2] {
            let scale = sense * inverse_omega_s * inverse_omega_s;
            for k in 0..=slip.order {
                let product = convolution(&excess[..=k], &slip.speed[..=k]);
                self.by_parameter[2][k] = scale * product;
            }
        }
        // The band of velocities that counts as zero and the rate of decay in it do not change the level.
        self.by_parameter[3] = [0.0; TERMS];
        self.by_parameter[4] = [0.0; TERMS];
    }

    /// Adds the slopes of the random part of Wojewoda's law.
    fn fill_random(
        &mut self,
        curve: &Curve,
        law: &super::Wojewoda<f64>,
        random: &wojewoda::RandomPart,
        slip: &KnownSlip<'_>,
        wanted: &[bool; MOST_PARAMETERS],
    ) {
        let amplitude = law.stochastic_amplitude;
        let scale = curve.sense * curve.span;
        let mut by_angle = [0.0; TERMS];
        for k in 0..=slip.order {
            if wanted[0] || wanted[1] {
                let share = curve.sense * amplitude * random.value[k];
                self.by_parameter[0][k] -= share;
                self.by_parameter[1][k] += share;
            }
            self.by_parameter[3][k] = scale * random.value[k];
            by_angle[k] = scale * amplitude * random.by_angle[k];
            // The waves go by angle/correlation angle.
            let turned = convolution(&slip.angle[..=k], &by_angle[..=k]);
            self.by_parameter[4][k] = -turned / law.correlation_angle;
        }
        self.by_parameter[5] = [0.0; TERMS];
        self.by_angle = Some(by_angle);
    }

    fn fill_gaussians(
        &mut self,
        law: &TwoGaussian<f64>,
        slip: &KnownSlip<'_>,
        wanted: &[bool; MOST_PARAMETERS],
    ) {
        let mut by_motion = [[0.0; TERMS]; 2];
        let work = slip.jet.work();
        two_gaussian::slopes(
            law,
            slip.speed,
            work,
            slip.order,
            &mut by_motion,
            &mut self.by_parameter,
            wanted,
        );
        self.by_speed = Some(by_motion[0]);
        self.by_rate = Some(by_motion[1]);
    }
}

/// An exponential curve that is added to a level (`sense` = 1) or taken from it (−1).
struct Curve {
    span: f64,
    inverse_omega_s: f64,
    sense: f64,
}

/// exp(−speed/ω_s).
fn unit_exponential(speed: &Series<f64>, inverse_omega_s: f64, order: usize) -> Series<f64> {
    let (mut weighted, mut unit) = ([0.0; TERMS], [0.0; TERMS]);
    unit[0] = libm::exp(-speed[0] * inverse_omega_s);
    for k in 1..=order {
        weighted[k] = -(k as f64 * speed[k] * inverse_omega_s);
        unit[k] = exponential(k, &weighted, &unit);
    }
    unit
}
