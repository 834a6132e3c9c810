"""Makes references.toml: trajectories of the rigs by an independent method.

An explicit Runge-Kutta method of order 8 (DOP853 of SciPy) at its tightest tolerance integrates each
mode; every switch is found by bisection over repeated integrations of the step in which it lies. The
equations are written down here anew from DESIGN.md, section 1, and share nothing with the product.

    python reference.py            # needs Python 3.11, numpy, scipy; writes references.toml beside it
"""

import math
import pathlib
import sys
import tomllib

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

HERE = pathlib.Path(__file__).parent
TH, OM, TH3, OM3, I, TH1, OM1, W, Z, Z1 = range(10)
RTOL, ATOL, LONGEST = 1e-13, 1e-13, 4e-3
# Bristles may give way for less than a millisecond, and guards are looked at between steps.
LONGEST_ON_BRISTLES = 2e-4

REDUCED = """
[disc]
inertia = 0.0149
[shaft]
stiffness = 0.3482
damping = 0.0022
[gearbox]
ratio = 8.0
[motor]
inertia = 5.18e-5
resistance = 0.33
inductance = 8.437e-4
torque_constant = 0.126
back_emf_constant = 0.0602
coulomb_torque = 0.1196
viscous_damping = 1.784e-4
[contact]
radius = 0.075
"""
OUTER = """
[disc1]
inertia = 0.0288
[shaft1]
stiffness = 2.905
damping = 0.0214
[contact1]
radius = 0.089
"""
STRIBECK = 'law = "stribeck"\nmu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\n'
LAWS = {
    "coulomb": 'law = "coulomb"\nmu_c = 0.15\n',
    "coulomb-stiction": 'law = "coulomb_stiction"\nmu_c = 0.12\nmu_s = 0.2\n',
    "stribeck": STRIBECK,
    "karnopp": 'law = "karnopp"\nmu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nomega_tolerance = 0.01\n',
    "switch": 'law = "switch"\nmu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nomega_tolerance = 0.01\n'
    "decay_rate = 50.0\n",
    "wojewoda": 'law = "wojewoda"\nmu_c = 0.12\nmu_s = 0.2\nomega_s = 1.2\nstochastic_amplitude = 0.0\n'
    "correlation_angle = 0.3\nseed = 3\n",
    "wojewoda-random": 'law = "wojewoda"\nmu_c = 0.15\nmu_s = 0.2\nomega_s = 1.2\n'
    "stochastic_amplitude = 0.05\ncorrelation_angle = 0.3\nseed = 5\n",
    "two-gaussian-mu": 'law = "two_gaussian_mu"\na1 = 0.27115\nb1 = -3.07246\nc1 = 1.28946\na2 = 0.18567\n'
    "b2 = 0.47960\nc2 = 2.62303\nomega_centre = 7.15956\nacceleration_semi_axis = 58.2873\n",
    "two-gaussian-folds": 'law = "two_gaussian_mu"\na1 = 0.4886\nb1 = -1.9351\nc1 = 0.5563\na2 = 0.1052\n'
    "b2 = 2.3490\nc2 = 2.5181\nomega_centre = 6.9024\nacceleration_semi_axis = 37.769\n",
    "two-gaussian-torque": 'law = "two_gaussian_torque"\na1 = 0.6\nb1 = -2.6\nc1 = 1.2\na2 = 0.6\n'
    "b2 = 0.47960\nc2 = 2.62303\nomega_centre = 7.15956\nacceleration_semi_axis = 58.2873\n",
}
EFFECTS = {
    "bearing_friction": "torque = 0.05",
    "normal_force_wobble": "amplitude = 0.2\nphase = 0.7",
    "position_friction": "amplitude = 0.15\nphase = 0.4",
    "unbalance": "torque = 0.1\nphase = 0.3",
    "viscous_drag": "coefficient = 0.01",
    "quadratic_drag": "coefficient = 0.002",
    "shaft_hardening": "cubic_stiffness = 0.02",
    "shaft_hysteresis": "stiffness = 0.1\nrelaxation_time = 0.15",
    "backlash": "gap = 0.2",
    "gear_ripple": "torque = 0.02\norder = 2.0\nphase = 0.4",
    "motor_viscous": "coefficient = 2e-4",
    "supply_sag": "factor = 0.95",
    "resistance_drift": "rate_per_minute = 0.5",
    "load_cell_bias": "bias = 5.0",
    "friction_wear": "rate_per_minute = 0.8",
    "load_exponent": "exponent = 0.8",
    "presliding": "stiffness = 20.0\ndamping = 0.05",
    "stochastic_friction": "standard_deviation = 0.04\ncorrelation_time = 0.1\nseed = 5",
}


def random_function(seed, length):
    """Harmonics (wave number, phase) of the seeded random function, and their amplitude."""
    state, count, mask = seed, 12, (1 << 64) - 1

    def uniform():
        nonlocal state
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        return ((z ^ (z >> 31)) >> 11) / 2.0**53

    harmonics = []
    for m in range(count):
        quantile = (m + uniform()) / count
        wave = math.tan(0.97 * math.pi / 2 * quantile) / length
        harmonics.append((wave, 2 * math.pi * uniform()))
    return lambda x: math.sqrt(2 / count) * sum(math.cos(w * x + p) for w, p in harmonics)


class Pin:
    """One pin contact: its law and the torque it gives."""

    def __init__(self, section, inertia):
        self.p, self.law, self.inertia = section, section["law"], inertia
        self.has_band = self.law in ("karnopp", "switch")
        self.band = section.get("omega_tolerance", 0.0)
        self.decay = section.get("decay_rate", 0.0)
        self.gaussian = self.law.startswith("two_gaussian")
        self.branched = self.gaussian or self.law == "wojewoda"
        self.random = None
        if section.get("stochastic_amplitude", 0.0) > 0.0:
            self.random = random_function(int(section["seed"]), section["correlation_angle"])
        self.guess = 0.0

    def breakaway(self):
        if self.gaussian:
            return max(self.mu_angle(math.pi), self.mu_angle(-math.pi))
        return self.p.get("mu_s", self.p["mu_c"])

    def mu_angle(self, alpha):
        p = self.p
        return p["a1"] * math.exp(-(((alpha - p["b1"]) / p["c1"]) ** 2)) + p["a2"] * math.exp(
            -(((alpha - p["b2"]) / p["c2"]) ** 2)
        )

    def mu(self, v, a):
        p = self.p
        x = (v - p["omega_centre"]) / p["omega_centre"]
        return self.mu_angle(math.atan2(a / p["acceleration_semi_axis"], x))

    def mu_slopes(self, v, a):
        """Derivatives of mu with respect to v and a."""
        p = self.p
        x, y = (v - p["omega_centre"]) / p["omega_centre"], a / p["acceleration_semi_axis"]
        alpha, r2 = math.atan2(y, x), x * x + y * y
        slope = 0.0
        for n in "12":
            z = (alpha - p["b" + n]) / p["c" + n]
            slope += p["a" + n] * math.exp(-z * z) * (-2 * z / p["c" + n])
        return slope * (-y / r2) / p["omega_centre"], slope * (x / r2) / p["acceleration_semi_axis"]

    def level(self, v, theta, up):
        p = self.p
        if self.law in ("coulomb", "coulomb_stiction"):
            return p["mu_c"]
        g = math.exp(-v / p["omega_s"])
        if self.law == "wojewoda":
            extra = p["stochastic_amplitude"] * self.random(theta) if self.random else 0.0
            excess = (p["mu_s"] - p["mu_c"]) * (g + extra)
            return p["mu_c"] + excess if up else p["mu_c"] - excess
        return p["mu_c"] + (p["mu_s"] - p["mu_c"]) * g

    def branches(self, theta, v):
        """Levels at zero acceleration, speeding up and slowing down."""
        if self.gaussian:
            return self.mu(v, 0.0), self.mu(v, -0.0)
        return self.level(v, theta, True), self.level(v, theta, False)

    def solve(self, v, load, rest, guess):
        """Root a of J a + load mu(v, a) + rest = 0 next to `guess`, on its side of the jump."""
        a = guess
        for _ in range(60):
            f = self.inertia * a + load * self.mu(v, a) + rest
            slope = self.inertia + load * self.mu_slopes(v, a)[1]
            step = -f / slope
            nxt = a + step
            if v < self.p["omega_centre"] and math.copysign(1, nxt) != math.copysign(1, guess):
                nxt = math.copysign(0.5 * abs(a), guess)
            if abs(nxt - a) <= 1e-15 * (1e-2 + abs(nxt)):
                return nxt
            a = nxt
        return a


class Rig:
    """Modes, right-hand side and guards of a rig."""

    def __init__(self, case):
        self.m = m = tomllib.loads(case["model"])
        self.case = case
        self.full = "disc1" in m
        self.pins = {"disc": Pin(m["contact"], m["disc"]["inertia"])}
        if self.full:
            self.pins["disc1"] = Pin(m["contact1"], m["disc1"]["inertia"])
        self.noise = None
        if "stochastic_friction" in m:
            s = m["stochastic_friction"]
            self.noise = random_function(int(s["seed"]), s["correlation_time"])

    def longest_step(self, mode):
        on_bristles = any(self.has_bristles(name) and mode[name][0] != "slip" for name in self.pins)
        return LONGEST_ON_BRISTLES if on_bristles else LONGEST

    def force(self, t):
        n = np.polynomial.polynomial.polyval(t, self.case["normal_force"])
        return n - self.m["load_cell_bias"]["bias"] if "load_cell_bias" in self.m else n

    def load(self, name, t, y):
        m, pin = self.m, self.pins[name]
        if name == "disc1":
            n = np.polynomial.polynomial.polyval(t, self.case["normal_force_1"])
            return 1.0 if pin.law == "two_gaussian_torque" else max(n, 0.0) * m["contact1"]["radius"]
        if pin.law == "two_gaussian_torque":
            load = 1.0
        else:
            n = max(self.force(t), 0.0)
            if "load_exponent" in m:
                n = 50 * (n / 50) ** m["load_exponent"]["exponent"]
            load = n * m["contact"]["radius"]
            if "normal_force_wobble" in m:
                w = m["normal_force_wobble"]
                load *= 1 + w["amplitude"] * math.cos(y[TH] - w["phase"])
        if "position_friction" in m:
            w = m["position_friction"]
            load *= 1 + w["amplitude"] * math.cos(2 * y[TH] - w["phase"])
        if "friction_wear" in m:
            load *= max(1 + m["friction_wear"]["rate_per_minute"] * t / 60, 0.0)
        if self.noise:
            load *= 1 + m["stochastic_friction"]["standard_deviation"] * self.noise(t)
        return load

    def bearing(self, name):
        return self.m["bearing_friction"]["torque"] if name == "disc" and "bearing_friction" in self.m else 0.0

    def limit(self, name, t, y):
        if name == "motor":
            return self.m["gearbox"]["ratio"] * self.m["motor"]["coulomb_torque"]
        return self.load(name, t, y) * self.pins[name].breakaway() + self.bearing(name)

    def shaft(self, y, coupling):
        m = self.m
        twist, rate = y[TH] - y[TH3], y[OM] - y[OM3]
        if coupling == "free":
            return 0.0
        if "backlash" in m:
            twist -= math.copysign(0.5 * m["backlash"]["gap"], 1 if coupling == "ahead" else -1)
        torque = m["shaft"]["stiffness"] * twist + m["shaft"]["damping"] * rate
        if "shaft_hardening" in m:
            torque += m["shaft_hardening"]["cubic_stiffness"] * twist**3
        if "shaft_hysteresis" in m:
            torque += y[W]
        return torque

    def pull(self, name, t, y, mode):
        """Everything that turns a body forward except its dry friction [N m]."""
        m, eta = self.m, self.m["gearbox"]["ratio"]
        shaft = self.shaft(y, mode["coupling"])
        if name == "motor":
            viscous = m["motor"]["viscous_damping"]
            if "motor_viscous" in m:
                viscous += m["motor_viscous"]["coefficient"]
            torque = eta * (m["motor"]["torque_constant"] * y[I] - viscous * eta * y[OM3]) + shaft
            if "gear_ripple" in m:
                g = m["gear_ripple"]
                torque += eta * g["torque"] * math.sin(g["order"] * eta * y[TH3] + g["phase"])
            return torque
        outer = 0.0
        if self.full:
            outer = m["shaft1"]["stiffness"] * (y[TH1] - y[TH]) + m["shaft1"]["damping"] * (y[OM1] - y[OM])
        if name == "disc1":
            return -outer
        torque = outer - shaft
        if "unbalance" in m:
            torque -= m["unbalance"]["torque"] * math.cos(y[TH] - m["unbalance"]["phase"])
        if "viscous_drag" in m:
            torque -= m["viscous_drag"]["coefficient"] * y[OM]
        if "quadratic_drag" in m and mode["disc"][0] != "stuck":
            torque -= m["quadratic_drag"]["coefficient"] * y[OM] * abs(y[OM])
        return torque

    def has_bristles(self, name):
        return "presliding" in self.m and name in self.pins

    def bristles(self, name, y):
        """Torque of the bristles of a pin that sticks."""
        p, (z, v) = self.m["presliding"], ((y[Z], y[OM]) if name == "disc" else (y[Z1], y[OM1]))
        return p["stiffness"] * z + p["damping"] * v

    def yielding(self, name, t, y, sign):
        """Deflection at which bristles that give way carry the breakaway torque."""
        p, v = self.m["presliding"], y[OM] if name == "disc" else y[OM1]
        return (sign * self.limit(name, t, y) - p["damping"] * v) / p["stiffness"]

    def end_slip(self, name, t, y, mode):
        """Slip velocity of the ends of bristles that give way: the disc's minus the bristles' own."""
        sign, p = mode[name][1], self.m["presliding"]
        v, force, radius = (y[OM], "normal_force", "contact") if name == "disc" else (y[OM1], "normal_force_1", "contact1")
        rate = np.polynomial.polynomial.polyval(t, np.polynomial.polynomial.polyder(self.case[force]))
        falling = self.m[radius]["radius"] * rate * self.pins[name].breakaway()
        own = (sign * falling - p["damping"] * self.acceleration(name, t, y, mode)) / p["stiffness"]
        return sign * (v - own)

    def acceleration(self, name, t, y, mode):
        kind, sign, regime = mode[name]
        pull = self.pull(name, t, y, mode)
        if name == "motor":
            if kind == "stuck":
                return 0.0
            inertia = self.m["gearbox"]["ratio"] ** 2 * self.m["motor"]["inertia"]
            return (pull - sign * self.limit("motor", t, y)) / inertia
        pin = self.pins[name]
        omega = y[OM] if name == "disc" else y[OM1]
        if kind == "stuck" and self.has_bristles(name):
            return (pull - self.bristles(name, y)) / pin.inertia
        if kind == "stuck":
            return -pin.decay * omega
        if kind == "breaking":
            return (pull - sign * self.limit(name, t, y)) / pin.inertia
        if regime == "hold":
            return 0.0
        load, bearing = self.load(name, t, y), self.bearing(name)
        if pin.gaussian:
            a = pin.solve(sign * omega, load, bearing - sign * pull, mode["guess"][name])
            return sign * a
        torque = load * pin.level(sign * omega, y[TH] if name == "disc" else y[TH1], regime == "up")
        return (pull - sign * (torque + bearing)) / pin.inertia

    def rhs(self, t, y, mode):
        m = self.m
        d = np.zeros(len(y))
        d[TH], d[TH3] = y[OM], y[OM3]
        d[OM], d[OM3] = self.acceleration("disc", t, y, mode), self.acceleration("motor", t, y, mode)
        u = np.polynomial.polynomial.polyval(t, self.case["voltage"])
        if "supply_sag" in m:
            u *= m["supply_sag"]["factor"]
        r = m["motor"]["resistance"]
        if "resistance_drift" in m:
            r *= 1 + m["resistance_drift"]["rate_per_minute"] * t / 60
        emf = m["motor"]["back_emf_constant"] * m["gearbox"]["ratio"] * y[OM3]
        d[I] = (u - r * y[I] - emf) / m["motor"]["inductance"]
        if self.full:
            d[TH1], d[OM1] = y[OM1], self.acceleration("disc1", t, y, mode)
        if "shaft_hysteresis" in m:
            h = m["shaft_hysteresis"]
            d[W] = h["stiffness"] * (y[OM] - y[OM3]) - y[W] / h["relaxation_time"]
        for name, place, speed in (("disc", Z, OM), ("disc1", Z1, OM1)):
            if self.has_bristles(name) and mode[name][0] == "stuck":
                d[place] = y[speed]
        return d

    def guards(self, mode):
        """(kind, function of t, y that is positive while the mode holds)."""
        out = []
        for name, place in (("disc", OM), ("disc1", OM1), ("motor", OM3)):
            if name == "disc1" and not self.full:
                continue
            kind, sign, regime = mode[name]
            pin = self.pins.get(name)
            band = pin.band if pin else 0.0
            if self.has_bristles(name) and kind == "stuck":
                for s in (1, -1):
                    out.append((("break", name, s), lambda t, y, n=name, s=s: self.limit(n, t, y) - s * self.bristles(n, y)))
            elif self.has_bristles(name) and kind == "breaking":
                out.append((("leave", name, sign), lambda t, y, p=place, s=sign: -s * y[p]))
                out.append((("calm", name, sign), lambda t, y, n=name: self.end_slip(n, t, y, mode)))
            elif kind == "stuck":
                for s in (1, -1):
                    out.append((("break", name, s), lambda t, y, n=name, s=s: self.limit(n, t, y) - s * self.pull(n, t, y, mode)))
            elif kind == "breaking":
                out.append((("leave", name, sign), lambda t, y, p=place, s=sign, b=band: b - s * y[p]))
                out.append((("calm", name, sign), lambda t, y, n=name, s=sign: s * self.pull(n, t, y, mode) - self.limit(n, t, y)))
            else:
                out.append((("rest", name, sign), lambda t, y, p=place, s=sign, b=band: s * y[p] - b))
                if pin and pin.branched and regime in ("up", "down"):
                    side = 1 if regime == "up" else -1
                    out.append((("turn", name, side), lambda t, y, n=name, s=side: s * self.drive(n, t, y, mode, s)))
                if regime == "hold":
                    for s in (1, -1):
                        out.append((("release", name, s), lambda t, y, n=name, s=s: -s * self.excess(n, t, y, mode, s)))
        if "backlash" in self.m:
            half = 0.5 * self.m["backlash"]["gap"]
            side = {"ahead": 1, "behind": -1, "free": 0}[mode["coupling"]]
            if side:
                out.append((("play", "free", 0), lambda t, y, s=side: s * (y[TH] - y[TH3]) - half))
            else:
                for s, n in ((1, "ahead"), (-1, "behind")):
                    out.append((("play", n, 0), lambda t, y, s=s: half - s * (y[TH] - y[TH3])))
        if mode["lifted"] is not None:
            s = -1 if mode["lifted"] else 1
            out.append((("lift", "", 0), lambda t, y, s=s: s * self.force(t)))
        return out

    def drive(self, name, t, y, mode, side):
        """What has the sign of the slip acceleration on the branch `side`, also where the branch ends."""
        pin, sign = self.pins[name], mode[name][1]
        if pin.gaussian and sign * (y[OM] if name == "disc" else y[OM1]) > pin.p["omega_centre"]:
            return sign * self.acceleration(name, t, y, mode)
        return self.excess(name, t, y, mode, side)

    def excess(self, name, t, y, mode, side):
        """Pull beyond the friction of the branch `side` for a contact that slides steadily."""
        _, sign, _ = mode[name]
        omega, theta = (y[OM], y[TH]) if name == "disc" else (y[OM1], y[TH1])
        levels = self.pins[name].branches(theta, sign * omega)
        level = levels[0] if side > 0 else levels[1]
        return sign * self.pull(name, t, y, mode) - self.load(name, t, y) * level - self.bearing(name)

    def branch(self, name, sign, t, y, mode, earlier):
        """Regime of a branched law at zero acceleration."""
        pin = self.pins[name]
        omega = y[OM] if name == "disc" else y[OM1]
        if pin.gaussian and sign * omega > pin.p["omega_centre"]:
            regime = "down" if earlier == 1 else "up"
        else:
            mode[name] = ("slip", sign, "hold")
            up = self.excess(name, t, y, mode, 1) > 0
            down = self.excess(name, t, y, mode, -1) < 0
            if earlier == 1:
                regime = "down" if down else "hold"
            elif earlier == -1:
                regime = "up" if up else "hold"
            else:
                regime = "up" if up else "down" if down else "hold"
        mode[name] = ("slip", sign, regime)
        mode["guess"][name] = -0.0 if regime == "down" else 0.0

    def at_rest(self, name, t, y, mode):
        if self.has_bristles(name):
            mode[name] = ("stuck", 0, "")
            return
        pull = self.pull(name, t, y, dict(mode, **{name: ("stuck", 0, "")}))
        if abs(pull) <= self.limit(name, t, y):
            mode[name] = ("stuck", 0, "")
        else:
            self.break_away(name, 1 if pull > 0 else -1, mode)

    def break_away(self, name, sign, mode):
        pin = self.pins.get(name)
        if pin and pin.has_band:
            mode[name] = ("breaking", sign, "")
        else:
            mode[name] = ("slip", sign, "up")
            mode["guess"][name] = 0.0

    def initial(self, t, y):
        mode = {"coupling": "ahead", "guess": {"disc": 0.0, "disc1": 0.0}, "lifted": None}
        if "backlash" in self.m:
            half, twist = 0.5 * self.m["backlash"]["gap"], y[TH] - y[TH3]
            mode["coupling"] = "ahead" if twist > half else "behind" if twist < -half else "free"
        if any(self.case["normal_force"][1:]):
            mode["lifted"] = bool(self.force(t + 1e-9) < 0)
        for name in ("disc", "disc1", "motor"):
            mode[name] = ("stuck", 0, "")
        for name, place in (("motor", OM3), ("disc", OM), ("disc1", OM1)):
            if name == "disc1" and not self.full:
                continue
            pin = self.pins.get(name)
            band = pin.band if pin else 0.0
            if abs(y[place]) > band:
                sign = 1 if y[place] > 0 else -1
                mode[name] = ("slip", sign, "up")
                if pin and pin.branched:
                    self.branch(name, sign, t, y, mode, 0)
            else:
                self.at_rest(name, t, y, mode)
        return mode

    def switch(self, guard, t, y, mode):
        kind, name, sign = guard
        if self.has_bristles(name):
            self.switch_bristles(guard, t, y, mode)
        elif kind == "rest":
            place = {"disc": OM, "disc1": OM1, "motor": OM3}[name]
            pin = self.pins.get(name)
            y[place] = sign * (pin.band if pin else 0.0)
            self.at_rest(name, t, y, mode)
        elif kind == "break":
            self.break_away(name, sign, mode)
        elif kind == "leave":
            mode[name] = ("slip", sign, "up")
        elif kind == "calm":
            mode[name] = ("stuck", 0, "")
        elif kind == "turn":
            self.branch(name, mode[name][1], t, y, mode, sign)
        elif kind == "release":
            mode[name] = ("slip", mode[name][1], "up" if sign > 0 else "down")
            mode["guess"][name] = 0.0 if sign > 0 else -0.0
        elif kind == "play":
            mode["coupling"] = name
        elif kind == "lift":
            mode["lifted"] = not mode["lifted"]

    def switch_bristles(self, guard, t, y, mode):
        kind, name, sign = guard
        speed, place = (OM, Z) if name == "disc" else (OM1, Z1)
        if kind == "rest":
            # The torque at the end of the slide is what the motion there says.
            y[speed] = 0.0
            a = self.acceleration(name, t, y, mode)
            y[place] = (self.pull(name, t, y, mode) - self.pins[name].inertia * a) / self.m["presliding"]["stiffness"]
            mode[name] = ("stuck", 0, "")
        elif kind == "break" and sign * y[speed] > 0:
            y[place] = 0.0
            mode[name] = ("slip", sign, "up")
            if self.pins[name].branched:
                self.branch(name, sign, t, y, mode, 0)
        elif kind == "break":
            mode[name] = ("breaking", sign, "")
            y[place] = self.yielding(name, t, y, sign)
        elif kind == "leave":
            y[place] = 0.0
            mode[name] = ("slip", sign, "up")
            mode["guess"][name] = 0.0
        elif kind == "calm":
            y[place] = self.yielding(name, t, y, sign)
            mode[name] = ("stuck", 0, "")
        elif kind == "turn":
            self.branch(name, mode[name][1], t, y, mode, sign)
        elif kind == "release":
            mode[name] = ("slip", mode[name][1], "up" if sign > 0 else "down")
            mode["guess"][name] = 0.0 if sign > 0 else -0.0

    def margin(self, t, y, mode):
        """Smallest 1 + (dT/da)/J of the disc's loop."""
        kind, sign, regime = mode["disc"]
        pin = self.pins["disc"]
        if not pin.gaussian or kind != "slip" or regime == "hold":
            return 1.0
        a = sign * self.acceleration("disc", t, y, mode)
        return 1 + self.load("disc", t, y) * pin.mu_slopes(sign * y[OM], a)[1] / pin.inertia


def integrate(rig, t, y, end, mode):
    """State at `end` by DOP853 in one mode."""
    if end <= t:
        return y.copy()
    solver = DOP853(lambda t, y: rig.rhs(t, y, mode), t, y, end, rtol=RTOL, atol=ATOL, max_step=rig.longest_step(mode))
    while solver.status == "running":
        solver.step()
    assert solver.status == "finished"
    return solver.y.copy()


def through_fold(rig, t, y, mode):
    """Runs up to the fold with s as the variable, dt/ds = 1 + T_a/J, which is regular there, and puts
    the loop on the root to which the acceleration then runs, if a fold is what comes. Reduced rig, held inputs, no effects."""
    _, sign, _ = mode["disc"]
    pin, load = rig.pins["disc"], rig.load("disc", t, y)
    k, c = rig.m["shaft"]["stiffness"], rig.m["shaft"]["damping"]
    a0 = sign * rig.acceleration("disc", t, y, mode)

    def stiffness(z):
        return pin.inertia + load * pin.mu_slopes(sign * z[OM], z[9])[1]

    def f(s, z):
        frozen = dict(mode, guess={"disc": z[9], "disc1": 0.0})
        d = np.zeros(10)
        y = z[:8]
        # The right-hand side with the acceleration taken from z instead of from the loop.
        a3, i_rate = rig.acceleration("motor", t, y, frozen), rig.rhs(t, y, dict(mode, disc=("stuck", 0, "")))[I]
        d[TH], d[OM], d[TH3], d[OM3], d[I] = y[OM], sign * z[9], y[OM3], a3, i_rate
        g = stiffness(z)
        d *= g
        d[8] = g
        e_rate = sign * (c * (sign * z[9] - a3) + k * (y[OM] - y[OM3]))
        d[9] = -(load * pin.mu_slopes(sign * y[OM], z[9])[0] * z[9] + e_rate)
        return d

    z = np.concatenate([y, [t, a0]])
    s, h = 0.0, 1e-2
    solver = DOP853(f, 0.0, z, 1e9, rtol=RTOL, atol=ATOL, max_step=0.5)
    while True:
        s_old, z_old = solver.t, solver.y.copy()
        solver.step()
        if stiffness(solver.y) > 0.05 * pin.inertia:
            mode["guess"]["disc"] = solver.y[9]
            return solver.y[8], solver.y[:8].copy(), False
        if stiffness(solver.y) <= 0:
            break

    def at(s_end):
        z = z_old.copy()
        if s_end > s_old:
            part = DOP853(f, s_old, z, s_end, rtol=RTOL, atol=ATOL)
            while part.status == "running":
                part.step()
            z = part.y.copy()
        return z

    s_fold = brentq(lambda s: stiffness(at(s)), s_old, solver.t, xtol=1e-15, rtol=1e-15)
    z = at(s_fold)
    y, t, a = z[:8].copy(), z[8], z[9]
    rest = -sign * rig.pull("disc", t, y, mode)

    def big_f(x):
        return pin.inertia * x + load * pin.mu(sign * y[OM], x) + rest

    # F has an extremum of value zero at a; run against its sign to the next zero crossing.
    way = 1 if big_f(a + 0.05) < 0 and big_f(a - 0.05) < 0 else -1
    x = a + 0.05 * way
    while big_f(x) * way < 0:
        previous, x = x, x + 0.05 * way
        if previous * x < 0:
            assert sign * y[OM] > pin.p["omega_centre"], "jump across zero acceleration not expected"
    root = brentq(big_f, min(previous, x), max(previous, x), xtol=1e-14)
    mode["guess"]["disc"] = root
    mode["disc"] = ("slip", sign, "up" if root >= 0 else "down")
    return t, y, True


def run(case):
    rig = Rig(case)
    t, y = 0.0, np.array(case["initial"], dtype=float)
    mode = rig.initial(t, y)
    states, switches, folds = [], [], 0
    for end in case["times"]:
        while t < end:
            solver = DOP853(lambda t, y: rig.rhs(t, y, mode), t, y, end, rtol=RTOL, atol=ATOL, max_step=rig.longest_step(mode))
            guards = rig.guards(mode)
            lost = None
            while solver.status == "running":
                t_old, y_old = solver.t, solver.y.copy()
                solver.step()
                assert solver.status != "failed", (t_old, mode)
                negative = [(g, kind) for kind, g in guards if g(solver.t, solver.y) < 0]
                if negative:
                    candidates = []
                    for g, kind in negative:
                        if g(t_old, y_old) <= 0:
                            candidates.append((t_old, kind))
                        else:
                            root = brentq(lambda x: g(x, integrate(rig, t_old, y_old, x, mode)), t_old, solver.t, xtol=1e-15, rtol=1e-15)
                            candidates.append((root, kind))
                    lost = min(candidates, key=lambda c: c[0])
                    break
                for name in rig.pins:
                    kind, sign, regime = mode[name]
                    if rig.pins[name].gaussian and kind == "slip" and regime != "hold":
                        mode["guess"][name] = sign * rig.acceleration(name, solver.t, solver.y, mode)
                if rig.margin(solver.t, solver.y, mode) < 0.03:
                    t, y, jumped = through_fold(rig, solver.t, solver.y.copy(), mode)
                    assert t < end
                    folds += jumped
                    lost = "fold"
                    break
            if lost == "fold":
                continue
            if lost is None:
                t, y = solver.t, solver.y.copy()
                break
            where, kind = lost
            y = integrate(rig, t_old, y_old, where, mode)
            t = where
            switches.append((t, kind[0], kind[1]))
            rig.switch(kind, t, y, mode)
        states.append(y.copy())
    return states, switches, folds


def cases():
    u55 = 0.33 * (1.784e-4 * 8 * 5.76 + 0.1196) / 0.126 + 0.0602 * 8 * 5.76
    still = [0.0] * 8

    def case(name, model, **other):
        base = {"voltage": [u55], "normal_force": [50.0], "normal_force_1": [0.0], "initial": still, "times": [1.0, 2.0, 3.0]}
        return dict(base, name=name, model=model, **other)

    def two(name, law, model=None, **other):
        return case(name, model or REDUCED + LAWS[law], **other)

    turning = [0.4, 3.0, -0.9, 5.0, 0.7, 0.0, 0.0, 0.0]
    for law in LAWS:
        yield two(law, law)
        if law not in ("two-gaussian-folds", "wojewoda-random"):  # both are told by one run
            yield two(law + " turning", law, initial=turning, normal_force=[20.0], times=[0.7, 2.2])
    yield two("two-gaussian-mu 10 N", "two-gaussian-mu", normal_force=[10.0])
    yield two("two-gaussian-mu fast", "two-gaussian-mu", normal_force=[10.0], initial=[0, 9.0, 0.5, 4.0, 0.5, 0, 0, 0])
    for effect, values in EFFECTS.items():
        # 50 N is the force at which a load exponent changes nothing.
        initial = [0.0] * 10 if effect == "presliding" else still
        yield case("effect " + effect, f"{REDUCED}{STRIBECK}[{effect}]\n{values}\n", normal_force=[35.0], initial=initial)
    both = f"{REDUCED}{STRIBECK}{OUTER}{STRIBECK}"
    yield case("full rig", both, normal_force_1=[20.0], normal_force=[30.0])
    yield case("full rig, both stick", both, normal_force_1=[40.0], normal_force=[20.0], voltage=[2.0])
    yield case("full rig, mixed laws", f"{REDUCED}{LAWS['two-gaussian-mu']}{OUTER}{LAWS['wojewoda']}", normal_force_1=[10.0], normal_force=[20.0])
    yield case("pin lifts and touches", REDUCED + STRIBECK, normal_force=[20.0, -30.0, 10.0], times=[1.0, 2.0, 3.0])
    yield case("voltage reverses", REDUCED + STRIBECK, voltage=[3.0, -2.0], normal_force=[10.0], times=[1.0, 2.0, 3.0])
    undamped = "[presliding]\nstiffness = 12.0\ndamping = 0.0\n"
    damped = "[presliding]\nstiffness = 20.0\ndamping = 0.3\n"
    moving = turning + [0.0, 0.0]
    for law in ("coulomb", "coulomb-stiction", "wojewoda", "two-gaussian-mu"):
        yield two(f"presliding {law}", law, model=REDUCED + LAWS[law] + undamped, initial=moving, normal_force=[20.0])
    yield case("presliding, full rig", both + damped, normal_force_1=[20.0], normal_force=[30.0], initial=[0.0] * 10)
    bearing = "[bearing_friction]\ntorque = 0.05\n[normal_force_wobble]\namplitude = 0.2\nphase = 0.7\n"
    yield case("presliding with bearing friction and wobble", REDUCED + STRIBECK + bearing + damped, initial=[0.0] * 10, voltage=[1.5])
    # The disc springs back while the breakaway torque falls below that of the bristles.
    sprung = [0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.02, 0.0]
    for name, bristles in (("undamped", undamped), ("damped", undamped.replace("damping = 0.0", "damping = 0.01"))):
        force = [25.0, -60.0, 48.0]
        yield case(f"presliding under a falling force, {name}", REDUCED + STRIBECK + bristles, initial=sprung, voltage=[0.0], normal_force=force, times=[0.05, 0.4, 1.0])
    yield case("presliding, pin lifts and touches", REDUCED + STRIBECK + damped, initial=sprung, voltage=[0.0], normal_force=[20.0, -100.0, 100.0], times=[0.2, 0.5, 1.5])
    yield case("motor sticks", REDUCED + STRIBECK, voltage=[0.25, 0.4, -0.45], normal_force=[2.0], times=[1.0, 2.0, 3.0], initial=[0.5, 0, 0, 0, 0, 0, 0, 0])


def numbers(values):
    return "[" + ", ".join(repr(float(v)) for v in values) + "]"


def main():
    only = sys.argv[1:]
    blocks = ["# Made by reference.py; see there for the method.\n"]
    for case in cases():
        if only and case["name"] not in only:
            continue
        states, switches, folds = run(case)
        print(f"{case['name']:40} {len(switches):4} switches {folds} folds  theta {states[-1][TH]:.10f}", flush=True)
        if only:
            print("\n".join(f"  {t:.12f} {k} {n}" for t, k, n in switches))
        lines = ["\n[[case]]", f'name = "{case["name"]}"', f"model = '''{case['model']}'''"]
        for key in ("voltage", "normal_force", "normal_force_1", "initial", "times"):
            lines.append(f"{key} = {numbers(case[key])}")
        lines.append("states = [\n" + "".join(f"    {numbers(s)},\n" for s in states) + "]")
        wanted = [s for s in switches if s[1] in ("rest", "break")]
        lines.append(f"switch_times = {numbers(t for t, _, _ in wanted)}")
        lines.append(f"folds = {folds}")
        blocks.append("\n".join(lines) + "\n")
    if not only:
        (HERE / "references.toml").write_text("".join(blocks))


if __name__ == "__main__":
    main()
