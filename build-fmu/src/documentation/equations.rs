//! The equations of the rigs, the friction laws and the effects, as the documentation shows them.

/// A named group of equations in the notation of the module `mathml`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Equations {
    /// Heading.
    pub title: &'static str,
    /// Where they come from.
    pub source: &'static str,
    /// The equations, one to a line.
    pub equations: &'static [&'static str],
}

/// Equations of motion of the rig with one disc (`full` = false) or two.
pub fn rig(full: bool) -> Equations {
    if full {
        return Equations {
            title: "Full rig: discs D1 and D2, shafts, gearbox, DC motor",
            source: "dissertation, Eq. 4-4, misprints put right (see below)",
            equations: &[
                "J_1 θ_1'' = − c_1 ( θ_1' − θ_2' ) − k_1 ( θ_1 − θ_2 ) − T_f1",
                "J_2 θ_2'' = − c_1 ( θ_2' − θ_1' ) − k_1 ( θ_2 − θ_1 ) − c_2 ( θ_2' − θ_3' ) − k_2 ( θ_2 − θ_3 ) − T_f",
                "η^2 J_m θ_3'' = η ( K_T i − C_m η θ_3' − T_fm ) + c_2 ( θ_2' − θ_3' ) + k_2 ( θ_2 − θ_3 )",
                "L i' = u − R i − K_E η θ_3'",
            ],
        };
    }
    Equations {
        title: "Reduced rig: disc D2, shaft, gearbox, DC motor",
        source: "dissertation, Eq. 4-5, misprints put right (see below)",
        equations: &[
            "J_2 θ_2'' = − c_2 ( θ_2' − θ_3' ) − k_2 ( θ_2 − θ_3 ) − T_f",
            "η^2 J_m θ_3'' = η ( K_T i − C_m η θ_3' − T_fm ) + c_2 ( θ_2' − θ_3' ) + k_2 ( θ_2 − θ_3 )",
            "L i' = u − R i − K_E η θ_3'",
        ],
    }
}

/// Equations of a friction law by its name in `model.toml`; `None` for a name that is no law.
pub fn law(name: &str) -> Option<Equations> {
    const STICK: &str = "stuck: θ_2' = 0 , | T_f | ≤ r N_2 μ_s";
    let (title, source, equations): (_, _, &'static [&'static str]) = match name {
        "coulomb" => (
            "Coulomb friction",
            "dissertation, Eq. 2-1",
            &[
                "T_f = r N_2 μ_c sign ( θ_2' )",
                "stuck: θ_2' = 0 , | T_f | ≤ r N_2 μ_c",
            ],
        ),
        "coulomb_stiction" => (
            "Coulomb friction with stiction",
            "dissertation, Eq. 2-2",
            &["T_f = r N_2 μ_c sign ( θ_2' )", STICK],
        ),
        "stribeck" => (
            "Stribeck friction",
            "dissertation, Eq. 2-3",
            &[
                "T_f = r N_2 ( μ_c + ( μ_s − μ_c ) exp ( − | θ_2' | / ω_s ) ) sign ( θ_2' )",
                STICK,
            ],
        ),
        "karnopp" => (
            "Karnopp's law",
            "dissertation, Eq. 2-4; Karnopp 1985",
            &[
                "T_f = r N_2 ( μ_c + ( μ_s − μ_c ) exp ( − | θ_2' | / ω_s ) ) sign ( θ_2' ) , | θ_2' | > ω_tol",
                "stuck: | θ_2' | ≤ ω_tol , | T_f | ≤ r N_2 μ_s",
            ],
        ),
        "switch" => (
            "Switch model",
            "Leine, van Campen, de Kraker, van den Steen 1998",
            &[
                "T_f = r N_2 ( μ_c + ( μ_s − μ_c ) exp ( − | θ_2' | / ω_s ) ) sign ( θ_2' ) , | θ_2' | > ω_tol",
                "stuck: | θ_2' | ≤ ω_tol , | T_f | ≤ r N_2 μ_s , θ_2' {decays at the given rate}",
            ],
        ),
        "wojewoda" => (
            "Hysteretic friction of Wojewoda et al.",
            "dissertation, Eqs 2-5 to 2-8",
            &[
                "T_f = r N_2 ( μ_c ± ( μ_s − μ_c ) ( exp ( − | θ_2' | / ω_s ) + f_r ) ) sign ( θ_2' )",
                "+ {while speeding up,} − {while slowing down;} f_r {a seeded random function of the angle}",
                STICK,
            ],
        ),
        "two_gaussian_torque" => (
            "Friction torque as two Gaussians of the phase-plane angle",
            "dissertation, Eq. 6-1, made odd in the velocity",
            &[
                "T_f = ( a_1 exp ( − ( ( α − b_1 ) / c_1 ) ^2 ) + a_2 exp ( − ( ( α − b_2 ) / c_2 ) ^2 ) ) sign ( θ_2' )",
                "α = atan2 ( θ_2'' / A , ( θ_2' − V_c ) / V_c )",
            ],
        ),
        "two_gaussian_mu" => (
            "Friction coefficient as two Gaussians of the phase-plane angle",
            "dissertation, Eq. 6-2, made odd in the velocity",
            &[
                "T_f = r N_2 ( a_1 exp ( − ( ( α − b_1 ) / c_1 ) ^2 ) + a_2 exp ( − ( ( α − b_2 ) / c_2 ) ^2 ) ) sign ( θ_2' )",
                "α = atan2 ( θ_2'' / A , ( θ_2' − V_c ) / V_c )",
            ],
        ),
        _ => return None,
    };
    Some(Equations {
        title,
        source,
        equations,
    })
}

/// Equations of an effect by the name of its section; `None` for a section that is no effect.
pub fn effect(section: &str) -> Option<Equations> {
    let (title, equations): (_, &'static [&'static str]) = match section {
        "bearing_friction" => ("Bearing friction of the disc", &["T = − T_b sign ( θ_2' )"]),
        "normal_force_wobble" => (
            "Normal force that varies with the disc's angle",
            &["N = N_2 ( 1 + a cos ( θ_2 − φ ) )"],
        ),
        "position_friction" => (
            "Friction that varies with the disc's angle",
            &["T = T_f ( 1 + a cos ( 2 θ_2 − φ ) )"],
        ),
        "unbalance" => ("Unbalance of the disc", &["T = − T_u cos ( θ_2 − φ )"]),
        "viscous_drag" => ("Viscous drag on the disc", &["T = − b θ_2'"]),
        "quadratic_drag" => ("Aerodynamic drag on the disc", &["T = − q θ_2' | θ_2' |"]),
        "shaft_hardening" => ("Hardening shaft", &["T = k_2 δ + k_3 δ^3 , δ = θ_2 − θ_3"]),
        "shaft_hysteresis" => (
            "Internal friction of the shaft (standard linear solid)",
            &["w' = k_h ( θ_2' − θ_3' ) − w//τ"],
        ),
        "backlash" => (
            "Play in the shaft's coupling",
            &["T = 0 , | θ_2 − θ_3 | ≤ g / 2"],
        ),
        "gear_ripple" => (
            "Torque ripple of motor or gears",
            &["T = T_r sin ( n θ_m + φ )"],
        ),
        "motor_viscous" => ("Extra viscous friction in the motor", &["T = − b_m θ_m'"]),
        "supply_sag" => ("Sagging supply", &["u_m = s u"]),
        "resistance_drift" => (
            "Armature that warms up",
            &["R ( t ) = R ( 1 + ρ t / 60 s )"],
        ),
        "load_cell_bias" => ("Load cell with an offset", &["N = N_2 − b"]),
        "friction_wear" => ("Contact that wears", &["T = T_f ( 1 + w t / 60 s )"]),
        "load_exponent" => (
            "Friction not proportional to the normal force",
            &["N = 50 N ( N_2 / 50 N ) ^p"],
        ),
        "presliding" => (
            "Sticking pin that gives way like a bristle",
            &[
                "stuck: T_f = σ_0 z + σ_1 z' , z' = θ_2' , | T_f | ≤ r N_2 μ_s",
                "sticks from sliding: z = T_f / σ_0",
            ],
        ),
        "stochastic_friction" => (
            "Friction that fluctuates in time",
            &["T = T_f ( 1 + s ξ ( t ) )"],
        ),
        "bearing_friction1" => ("Bearing friction of disc D1", &["T = − T_b sign ( θ_1' )"]),
        "unbalance1" => ("Unbalance of disc D1", &["T = − T_u cos ( θ_1 − φ )"]),
        "viscous_drag1" => ("Viscous drag on disc D1", &["T = − b θ_1'"]),
        "quadratic_drag1" => ("Aerodynamic drag on disc D1", &["T = − q θ_1' | θ_1' |"]),
        "normal_force_wobble1" => (
            "Normal force that varies with the angle of disc D1",
            &["N = N_1 ( 1 + a cos ( θ_1 − φ ) )"],
        ),
        "shaft_hardening1" => (
            "Hardening shaft between the discs",
            &["T = k_1 δ + k_3 δ^3 , δ = θ_1 − θ_2"],
        ),
        "sensor_delay" => ("Disc sensors that lag", &["θ_read ( t ) = θ_2 ( t − τ )"]),
        _ => return None,
    };
    Some(Equations {
        title,
        source: "catalogue of effects of the project",
        equations,
    })
}

/// What the dissertation prints and what holds, where the two differ for these equations.
pub const MISPRINTS: [(&str, &str, &str); 6] = [
    ("Eq. 4-5", "c1, k1, θ1 and +T_f2", "c2, k2, θ3 and −T_f2"),
    (
        "Eq. 4-4",
        "J1 θ̇1; a bracket missing; T_fm without sign",
        "J1 θ̈1; T_fm sign(ω3) with stiction",
    ),
    (
        "Table 4.5",
        "ξ = 0.02323, 0.0986",
        "these are logarithmic decrements (the first 0.2323); ξ = 0.0370, 0.0157; unit of d is N m s/rad",
    ),
    (
        "Tables 4.2, 4.4",
        "static k1 = 2.336 N m/rad",
        "the measured 10.04 rad/s wants 2.905 N m/rad",
    ),
    (
        "Table 4.6",
        "K_T = 0.126, K_E = 0.0602",
        "must be equal in SI; catalogue values, not identified",
    ),
    (
        "Eqs 6-1, 6-2",
        "no sign of the velocity; stick branch a ω",
        "odd in ω2; sticking is exact",
    ),
];
