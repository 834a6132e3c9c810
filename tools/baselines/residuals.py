"""Residual torques of a case, in weak form, and the columns that may explain them.

Both torque balances are integrated against a smooth bump phi (weak form): accelerations become
integrals of the measured angle against phi'', so no signal is differentiated twice.

    disc   J2 a2 + c2 (w2 - w3) + k2 (th2 - th3) + N2 r mu = what is missing
    motor  n^2 Jm a3 - n (K_T i - C_m n w3 - T_fm) - c2 (w2 - w3) - k2 (th2 - th3) = what is missing
    with   i = (u - K_E n w3 - L di/dt) / R, L di/dt from the same without L

The motor turns forward in all records, so T_fm is a constant. Windows that touch a stuck disc or a
voltage step are left out (sticking is a reaction); instead every breakaway gives one row,
shaft torque - mu_s N2 r. Rows are scaled to unit noise and the analyst's nominal parameters are
projected out under their stated uncertainty.
"""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.signal import savgol_filter

SAMPLE = 0.01
DISC_STEP = 2 * math.pi / 1000
MOTOR_STEP = 2 * math.pi / 8000
DISC_HALF_WIDTH = 10
MOTOR_HALF_WIDTH = 5
STUCK_SPEED = 0.25
BREAKAWAY_NOISE = 0.03

PRIOR = {"J2": 0.006, "k2": 0.02, "c2": 0.06, "R": 0.02, "KT": 0.02, "KE": 0.01, "Tfm": 0.04, "mu_c": 0.02, "mu_s": 0.02}

# Sizes of the practice records: a coefficient of 1 is an effect of that size.
SIZE = {
    "bearing_friction": 0.06, "normal_force_wobble": 0.25, "unbalance": 0.04, "shaft_hardening": 0.03,
    "gear_ripple": 0.06, "viscous_drag": 0.008, "quadratic_drag": 0.0012, "backlash": 0.25,
    "load_cell_bias": 4.0, "friction_wear": 0.3, "resistance_drift": 0.6, "supply_sag": 0.06,
    "load_exponent": 0.3, "motor_viscous": 0.0006, "sensor_delay": 0.03,
}
TWO_GAUSSIAN = dict(a1=0.27115, b1=-3.07246, c1=1.28946, a2=0.18567, b2=0.4796, c2=2.62303,
                    omega_centre=7.15956, acceleration_semi_axis=58.2873)


@dataclass
class Problem:
    """Whitened regression: `target` [rows] on `columns` [rows, terms] named by `names`."""

    target: np.ndarray
    columns: np.ndarray
    names: list[str]

    def without(self, effects):
        """The same regression with these effects out of the library."""
        kept = [k for k, name in enumerate(self.names) if name.split(":")[0] not in effects]
        return Problem(self.target, self.columns[:, kept], [self.names[k] for k in kept])


def two_gaussian(law, speed, acceleration):
    angle = np.arctan2(acceleration / law["acceleration_semi_axis"], speed / law["omega_centre"] - 1)
    return sum(law[f"a{k}"] * np.exp(-(((angle - law[f"b{k}"]) / law[f"c{k}"]) ** 2)) for k in (1, 2))


def sliding(contact, speed, acceleration):
    """Coefficient of friction of a law while the disc turns forward."""
    match contact["law"]:
        case "coulomb" | "coulomb_stiction":
            return np.full_like(speed, contact["mu_c"])
        case "stribeck":
            return contact["mu_c"] + (contact["mu_s"] - contact["mu_c"]) * np.exp(-speed / contact["omega_s"])
        case "two_gaussian_mu":
            return two_gaussian(contact, speed, acceleration)
        case other:
            raise ValueError(f"unknown friction law {other}")


def breakaway(contact):
    if contact["law"] == "two_gaussian_mu":
        return float(max(two_gaussian(contact, np.zeros(1), np.array([s * 1e-9]))[0] for s in (1, -1)))
    return contact.get("mu_s", contact["mu_c"])


def richer_laws(contact):
    """Laws of the catalogue that could replace the analyst's."""
    laws = {"acceleration_hysteresis": {"law": "two_gaussian_mu", **TWO_GAUSSIAN}}
    if contact["law"] == "two_gaussian_mu":
        return {}
    if contact["law"] in ("coulomb", "coulomb_stiction"):
        laws["stribeck"] = {"law": "stribeck", "mu_c": 0.12, "mu_s": 0.2, "omega_s": 1.2}
    if contact["law"] == "coulomb":
        laws["stiction"] = {"law": "coulomb_stiction", "mu_c": 0.13, "mu_s": 0.2}
    return laws


def bump(half_width):
    """Kernels k = 0 … 3 with `correlate(f, kernel)` = integral of phi f^(k), phi = (1 - x^2)^4.

    Each is the sampled (-1)^k phi^(k), mended so that it is exact for polynomials up to degree 4: angles
    grow to hundreds of radians and the smallest moment left over would swamp the acceleration.
    """
    x = np.arange(-half_width, half_width + 1) / half_width
    span = half_width * SAMPLE
    phi = np.polynomial.Polynomial([1, 0, -4, 0, 6, 0, -4, 0, 1])
    weight = phi(x) / phi(x).sum()
    powers = np.vander(x, 5, increasing=True)
    kernels = [weight]
    for order in (1, 2, 3):
        kernel = (-1) ** order * phi.deriv(order)(x) / phi(x).sum()
        wanted = [
            math.factorial(m) / math.factorial(m - order) * (weight @ x ** (m - order)) if m >= order else 0.0
            for m in range(5)
        ]
        shape = powers * (weight + 1e-3)[:, None]
        kernel = kernel + shape @ np.linalg.solve(powers.T @ shape, wanted - powers.T @ kernel)
        kernels.append(kernel / span**order)
    return kernels


def weak(signal, kernel):
    """The kernel's integral around every sample."""
    return np.correlate(signal, kernel, mode="same")


def time_since_breakaway(inertia, load_rate, speed, acceleration):
    """Seconds since breakaway of a disc seen at `speed` under a load that grows at `load_rate`.

    From J w = jump t + rate t^2/2 and J a = jump + rate t, whatever the drop of friction `jump` is.
    """
    torque = inertia * acceleration
    root = max(torque**2 - 2 * load_rate * inertia * speed, 0.0)
    return (torque - math.sqrt(root)) / load_rate


def one_run(path, model):
    """Blocks (equation, target, nuisance columns, library columns) of one record."""
    record = pd.read_csv(path)
    d, s, m, contact = model["disc"], model["shaft"], model["motor"], model["contact"]
    n, radius = model["gearbox"]["ratio"], contact["radius"]
    time, voltage, force = (record[c].to_numpy(float) for c in ("time", "u", "N2"))
    force = np.where(np.abs(force) < 1e-9, 0.0, savgol_filter(force, 51, 0))
    th2, th3 = record.theta.to_numpy(float) + DISC_STEP / 2, record.theta3.to_numpy(float) + MOTOR_STEP / 2
    w2 = 0.5 * (savgol_filter(th2, 9, 3, deriv=1, delta=SAMPLE) + savgol_filter(record.theta_dot, 9, 3))
    w3 = savgol_filter(th3, 5, 2, deriv=1, delta=SAMPLE)
    a2 = savgol_filter(th2, 15, 3, deriv=2, delta=SAMPLE)
    smooth2, smooth3 = savgol_filter(th2, 9, 3), savgol_filter(th3, 5, 2)
    twist = smooth2 - smooth3
    mu = sliding(contact, np.maximum(w2, 0), a2)
    press = force * radius
    stuck = (w2 < STUCK_SPEED) & (force > 0)
    step = np.abs(np.diff(voltage, prepend=voltage[0])) > 0.08
    step[0] = True
    force_step = np.abs(np.diff(record.N2, prepend=record.N2[0])) > 3

    def rows(half_width, forbidden, before, after):
        bad = np.convolve(forbidden, np.ones(2 * half_width + 1), mode="same") > 0.5
        late = np.convolve(step | force_step, np.ones(before + after + 1), mode="full")[: len(step)] > 0.5
        late = np.roll(late, -before)
        inside = np.zeros(len(time), bool)
        inside[half_width + 15 : -half_width - 15 : max(half_width // 2, 2)] = True
        return np.flatnonzero(inside & ~bad & ~late)

    blocks = []
    # Disc
    k0, k1, k2, k3 = bump(DISC_HALF_WIDTH)
    keep = rows(DISC_HALF_WIDTH, stuck, DISC_HALF_WIDTH + 5, DISC_HALF_WIDTH + 5)

    def disc(signal):
        return weak(signal, k0)[keep]

    inertia = d["inertia"] * weak(th2, k2)[keep]
    spring = s["stiffness"] * disc(th2 - th3)
    damper = s["damping"] * weak(th2 - th3, k1)[keep]
    nuisance = {"J2": inertia, "k2": spring, "c2": damper}
    if contact["law"] == "stribeck":
        share = np.exp(-np.maximum(w2, 0) / contact["omega_s"])
        nuisance["mu_c"] = disc(press * contact["mu_c"] * (1 - share))
        nuisance["mu_s"] = disc(press * contact["mu_s"] * share)
    else:
        nuisance["mu_c"] = disc(press * mu)
    library = {
        "bearing_friction": disc(-np.sign(w2)) * SIZE["bearing_friction"],
        "normal_force_wobble:cos": disc(-press * mu * np.cos(smooth2)) * SIZE["normal_force_wobble"],
        "normal_force_wobble:sin": disc(-press * mu * np.sin(smooth2)) * SIZE["normal_force_wobble"],
        "unbalance:cos": disc(-np.cos(smooth2)) * SIZE["unbalance"],
        "unbalance:sin": disc(-np.sin(smooth2)) * SIZE["unbalance"],
        "shaft_hardening": disc(-(twist**3)) * SIZE["shaft_hardening"],
        "viscous_drag": disc(-w2) * SIZE["viscous_drag"],
        "quadratic_drag": disc(-w2 * np.abs(w2)) * SIZE["quadratic_drag"],
        "backlash": disc(s["stiffness"] * np.clip(twist, -SIZE["backlash"] / 2, SIZE["backlash"] / 2)),
        "load_cell_bias": disc(radius * mu * (force > 0)) * SIZE["load_cell_bias"],
        "friction_wear": disc(-press * mu * time / 60) * SIZE["friction_wear"],
        "load_exponent": disc(press * mu * np.log(np.maximum(force, 1) / 50)) * SIZE["load_exponent"],
        "sensor_delay": -(d["inertia"] * weak(th2, k3)[keep] + s["damping"] * weak(th2, k2)[keep]
                          + s["stiffness"] * weak(th2, k1)[keep]) * SIZE["sensor_delay"],
    }
    for name, law in richer_laws(contact).items():
        library[name] = disc(press * (mu - sliding(law, np.maximum(w2, 0), a2)))
    blocks.append(("disc", inertia + damper + spring + disc(press * mu), nuisance, library))

    # Breakaway: the shaft's load when a slip began that the records show some time later.
    load = -s["stiffness"] * (th2 - th3) + s["damping"] * w3
    loads, levels = [], []
    for i in np.flatnonzero(stuck[:-1] & ~stuck[1:]):
        slips = 30 < i < len(time) - 10 and stuck[i - 15 : i + 1].all() and (w2[i + 1 : i + 8] > STUCK_SPEED).all()
        if slips:
            rate, seen = s["stiffness"] * w3[i], i + 2
            acceleration = (w2[seen + 2] - w2[seen - 2]) / (4 * SAMPLE)
            late = time_since_breakaway(d["inertia"], rate, w2[seen], acceleration) - 2 * SAMPLE
            loads.append(load[i] - rate * late)
            levels.append(breakaway(contact) * press[i])
    if loads:
        loads, levels = np.array(loads), np.array(levels)
        library = {
            name: (1 - breakaway(law) / breakaway(contact)) * levels for name, law in richer_laws(contact).items()
        }
        blocks.append(("breakaway", levels - loads, {"mu_s": levels, "k2": -loads}, library))

    # Motor
    k0, k1, k2, k3 = bump(MOTOR_HALF_WIDTH)
    keep = rows(MOTOR_HALF_WIDTH, w3 < 0.3, MOTOR_HALF_WIDTH + 1, MOTOR_HALF_WIDTH + 8)

    def motor(signal):
        return weak(signal, k0)[keep]

    lag = m["inductance"] / m["resistance"]
    quasi = voltage / m["resistance"]
    electric = motor(quasi) - lag * weak(quasi, k1)[keep]
    back = m["back_emf_constant"] * n / m["resistance"]
    induced = back * (weak(th3, k1) - lag * weak(th3, k2))[keep]
    drive = n * m["torque_constant"] * (electric - induced)
    inertia = n * n * m["inertia"] * weak(th3, k2)[keep]
    shaft = s["stiffness"] * motor(th2 - th3) + s["damping"] * weak(th2 - th3, k1)[keep]
    coulomb = np.full(len(keep), n * m["coulomb_torque"])
    speed = weak(th3, k1)[keep]
    viscous = n * n * m["viscous_damping"] * speed
    nuisance = {
        "k2": -s["stiffness"] * motor(th2 - th3), "c2": -s["damping"] * weak(th2 - th3, k1)[keep],
        "R": drive, "KT": -drive, "KE": n * m["torque_constant"] * induced, "Tfm": coulomb,
    }
    quasi_drift = drive * time[keep] / 60
    library = {
        "gear_ripple:sin": n * motor(np.sin(2 * n * th3)) * SIZE["gear_ripple"],
        "gear_ripple:cos": n * motor(np.cos(2 * n * th3)) * SIZE["gear_ripple"],
        "resistance_drift": -quasi_drift * SIZE["resistance_drift"],
        "supply_sag": -n * m["torque_constant"] * electric * SIZE["supply_sag"],
        "motor_viscous": -n * n * speed * SIZE["motor_viscous"],
        "shaft_hardening": motor(twist**3) * SIZE["shaft_hardening"],
        "backlash": -s["stiffness"] * motor(np.clip(twist, -SIZE["backlash"] / 2, SIZE["backlash"] / 2)),
        "sensor_delay": (s["stiffness"] * weak(th2, k1) + s["damping"] * weak(th2, k2))[keep] * SIZE["sensor_delay"],
    }
    blocks.append(("motor", inertia + viscous + coulomb - shaft - drive, nuisance, library))
    return blocks


def problem(case: Path) -> Problem:
    """The whitened, projected regression of a case; reads only its model and its `run-*.csv`."""
    model = tomllib.loads((case / "model.toml").read_text())
    blocks = [block for path in sorted(case.glob("run-*.csv")) for block in one_run(path, model)]
    names = sorted({name for block in blocks for name in block[3]})
    nominal = list(PRIOR)

    def stack(index, wanted):
        return np.vstack([np.column_stack([block[index].get(name, np.zeros(len(block[1]))) for name in wanted]) for block in blocks])

    target = np.concatenate([block[1] for block in blocks])
    belief, columns = stack(2, nominal), stack(3, names)
    equation = np.concatenate([np.full(len(block[1]), block[0]) for block in blocks])
    # A parameter under a prior is a column with one more row; without it the columns J2, k2 … would
    # add up to the whole balance and leave nothing.
    anchors = np.diag([1 / PRIOR[name] for name in nominal])
    # Noise per equation from what no column at all explains.
    scale = np.full(len(target), 0.01)
    for _ in range(3):
        everything = np.vstack(
            [np.hstack([belief, columns]) / scale[:, None], np.hstack([anchors, np.zeros((len(nominal), len(names)))])]
        )
        solution = np.linalg.lstsq(everything, np.append(target / scale, np.zeros(len(nominal))), rcond=1e-8)[0]
        left = target - np.hstack([belief, columns]) @ solution
        for name in np.unique(equation):
            part = equation == name
            scale[part] = 1.4826 * np.median(np.abs(left[part]))
    # The breakaway level is extrapolated over some 50 ms and no better known than this.
    scale[equation == "breakaway"] = np.maximum(scale[equation == "breakaway"], BREAKAWAY_NOISE)
    # Neighbouring windows overlap; half of them are worth one.
    scale *= math.sqrt(2)
    belief, columns, target = belief / scale[:, None], columns / scale[:, None], target / scale
    basis, _ = np.linalg.qr(np.vstack([belief, anchors]))
    used = np.abs(columns).sum(axis=0) > 0

    def project(matrix):
        padded = np.vstack([matrix, np.zeros((len(nominal), matrix.shape[1]))])
        return padded - basis @ (basis.T @ padded)

    return Problem(project(target[:, None])[:, 0], project(columns[:, used]), [n for n, u in zip(names, used) if u])
