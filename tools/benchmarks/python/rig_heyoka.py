"""The rig under heyoka's adaptive Taylor integrators: a peer for the benchmark, started by `benchmarks bench`.

Reads one JSON object from standard input: `parameters` (short names as in rig_cvode.c), `end`,
`output_step`, `repeat`, `set_ups` (names of SET_UPS) and `tolerances`. Writes one CSV line per run:
set-up, tolerance, processor time of the run [s], that of its Python loop [s], that of compiling [s],
theta2 at the end, mode changes, steps.

Every combination of the contacts' modes is an integrator of its own, compiled once with all numbers in
it. Terminal events end a mode: a torque at its static limit, a velocity at zero, an angle at its cut.
Outputs come from propagate_grid.

The two-Gaussian law makes an algebraic loop of the disc's acceleration. While the disc slips, the
acceleration is a state too; its equation is the loop's derivative over time.

Set-ups tried and left out: outputs by propagate_until with continuous output, which compiles a function
at every call (thirty times slower), and by propagate_grid up to the end of the run, which makes room for
all outputs at every call (four times slower).
"""

import json
import math
import sys
import time

import heyoka as hy
import numpy as np

SET_UPS = {
    "non-compact": {},
    "compact": {"compact_mode": True},
    "non-compact, fast math": {"fast_math": True},
    "non-compact, fast math, SLP": {"fast_math": True, "slp_vectorize": True},
}

TH2, W2, TH3, W3, CUR, TH1, W1 = range(7)
CONTACTS = (2, 3, 1)  # disc D2, motor bearing, disc D1: order within a mode, each -1, 0 (stuck) or 1
VELOCITY = {1: W1, 2: W2, 3: W3}
# What happens at the cut of the two-Gaussian law's angle: the side on which the motion goes on.
CUTS = {"accelerates": math.pi, "decelerates": -math.pi}
FALLING = hy.event_direction.negative
TIME_LIMIT = hy.taylor_outcome.time_limit
CHUNK = 150  # outputs that a call makes room for: 1.5 s, about as long as a mode lasts
# Velocity [rad/s] of a contact that breaks away: its acceleration is zero but for rounding, which may be negative, and
# a velocity of exactly zero would then end the slip before it began.
NUDGE = 1e-20


class Rig:
    """Equations, switches and torques of the rig with these parameters."""

    def __init__(self, parameters):
        self.p = parameters
        self.full = "J1" in parameters
        self.gaussian = "A" in parameters
        self.size = 7 if self.full else 5
        p = parameters
        load = p["radius"] * p["N2"]
        static = max(self.coefficient(-math.pi), self.coefficient(math.pi)) if self.gaussian else p["mu_s"]
        self.load, self.breakaway2, self.breakaway3 = load, load * static, p["eta"] * p["Tfm"]
        self.breakaway1 = p["radius"] * p["N1"] * p["mu_s"] if self.full else 0.0

    def coefficient(self, alpha, exp=math.exp):
        """Two-Gaussian coefficient of friction at the angle `alpha`, a number or an expression."""
        p = self.p
        x1, x2 = (alpha - p["b1"]) / p["c1g"], (alpha - p["b2"]) / p["c2g"]
        return p["a1"] * exp(-x1 * x1) + p["a2"] * exp(-x2 * x2)

    def stribeck(self, speed):
        p = self.p
        return p["mu_c"] + (p["mu_s"] - p["mu_c"]) * hy.exp(speed * (-1.0 / p["omega_s"]))

    def drive1(self, y):
        p = self.p
        return p["c1"] * (y[W2] - y[W1]) + p["k1"] * (y[TH2] - y[TH1])

    def drive2(self, y):
        p = self.p
        shaft = p["c2"] * (y[W3] - y[W2]) + p["k2"] * (y[TH3] - y[TH2])
        return shaft - self.drive1(y) if self.full else shaft

    def drive3(self, y):
        p = self.p
        motor = p["eta"] * (p["KT"] * y[CUR] - p["Cm"] * p["eta"] * y[W3])
        return motor + p["c2"] * (y[W2] - y[W3]) + p["k2"] * (y[TH2] - y[TH3])

    def loop_acceleration(self, y, side, sign):
        """Acceleration in the slip direction with the angle near `side`, of a disc that is at rest or at the cut."""
        p, load = self.p, self.load
        drive, x = sign * self.drive2(y), (sign * y[W2] - p["Vc"]) / p["V"]
        a = (drive - load * self.coefficient(side)) / p["J2"]
        for _ in range(50):
            alpha = math.atan2(a / p["A"], x)
            x1, x2 = (alpha - p["b1"]) / p["c1g"], (alpha - p["b2"]) / p["c2g"]
            slope = -2.0 * (x1 / p["c1g"] * p["a1"] * math.exp(-x1 * x1) + x2 / p["c2g"] * p["a2"] * math.exp(-x2 * x2))
            per_a = load * slope * x / ((x * x + (a / p["A"]) ** 2) * p["A"])
            step = (drive - p["J2"] * a - load * self.coefficient(alpha)) / (p["J2"] + per_a)
            a += step
            if abs(step) <= 1e-14 * (abs(a) + 1.0):
                break
        return a

    def integrator(self, mode, options):
        """The integrator of one mode, with what each of its events switches: (contact, what)."""
        slip2, slip3, slip1 = mode
        p = self.p
        y = list(hy.make_vars("th2", "w2", "th3", "w3", "cur", "th1", "w1")[: self.size])
        zero = hy.expression(0.0)
        d = [zero] * self.size
        events, meanings = [], []

        def ends(expression, contact, what):
            events.append(hy.t_event(expression, direction=FALLING))
            meanings.append((contact, what))

        def rests(drive, breakaway, contact):
            ends(breakaway - drive, contact, 1)
            ends(breakaway + drive, contact, -1)

        d[CUR] = (p["u"] - p["R"] * y[CUR] - p["KE"] * p["eta"] * y[W3]) / p["L"]
        if slip3:
            d[TH3] = y[W3]
            d[W3] = (self.drive3(y) - p["eta"] * p["Tfm"] * slip3) / (p["eta"] ** 2 * p["Jm"])
            ends(slip3 * y[W3], 3, 0)
        else:
            rests(self.drive3(y), self.breakaway3, 3)
        if slip2:
            ends(slip2 * y[W2], 2, 0)
            d[TH2] = y[W2]
            if self.gaussian:
                a = hy.make_vars("a")
                x, w = hy.make_vars("angle_a", "angle_w")
                alpha = hy.atan2(x / p["A"], (w - p["Vc"]) / p["V"])
                torque = self.load * self.coefficient(alpha, hy.exp)
                at = {"angle_a": slip2 * a, "angle_w": slip2 * y[W2]}
                torque_a, torque_w = (hy.subs(hy.diff(torque, v), at) for v in (x, w))
                alpha = hy.subs(alpha, at)
                d[W2] = a
                drive_rate = p["c2"] * (d[W3] - a) + p["k2"] * (d[TH3] - y[W2])
                y.append(a)
                d.append((drive_rate - torque_w * a) / (p["J2"] + torque_a))
                ends(math.pi + alpha, 2, "accelerates")
                ends(math.pi - alpha, 2, "decelerates")
            else:
                d[W2] = (self.drive2(y) - slip2 * self.load * self.stribeck(slip2 * y[W2])) / p["J2"]
        else:
            rests(self.drive2(y), self.breakaway2, 2)
        if self.full:
            if slip1:
                load = p["radius"] * p["N1"]
                d[TH1] = y[W1]
                d[W1] = (self.drive1(y) - slip1 * load * self.stribeck(slip1 * y[W1])) / p["J1"]
                ends(slip1 * y[W1], 1, 0)
            else:
                rests(self.drive1(y), self.breakaway1, 1)
        made = hy.taylor_adaptive(list(zip(y, d)), [0.0] * len(y), t_events=events, **options)
        return made, meanings

    def switch(self, mode, y, meaning):
        """Mode and state after an event; an arrested velocity becomes zero."""
        contact, what = meaning
        modes, n = list(mode), self.size
        if what == 0:
            y[VELOCITY[contact]] = 0.0
            drive, breakaway = self.limits(contact)
            what = arrest(drive(y), breakaway)
        elif what in (-1, 1):
            y[VELOCITY[contact]] = what * NUDGE
        if what not in CUTS:
            modes[CONTACTS.index(contact)] = what
        slip = modes[0]
        if self.gaussian and slip == 0:
            y = y[:n]
        elif self.gaussian and contact == 2:
            side = CUTS.get(what, math.pi)
            y = np.append(y[:n], slip * self.loop_acceleration(y, side, slip))
        return tuple(modes), y

    def limits(self, contact):
        """Torque on a contact without its friction, as a function of the state, and its static limit."""
        return {
            1: (self.drive1, self.breakaway1),
            2: (self.drive2, self.breakaway2),
            3: (self.drive3, self.breakaway3),
        }[contact]


def arrest(drive, breakaway):
    """Mode after a velocity reached zero: stuck, or slipping the way the torque pushes."""
    return 0 if abs(drive) <= breakaway else (1 if drive > 0 else -1)


class Machine:
    """The integrators of all modes that a run meets, made when they are first met."""

    def __init__(self, rig, options, end, output_step):
        self.rig, self.options = rig, options
        self.grid = np.linspace(0.0, end, round(end / output_step) + 1)
        self.made = {}
        self.compiling = 0.0

    def of(self, mode):
        if mode not in self.made:
            start = time.process_time()
            made, meanings = self.rig.integrator(mode, self.options)
            self.compiling += time.process_time() - start
            self.made[mode] = made, made.state, meanings
        return self.made[mode]

    def run(self, ends=None):
        """One run, as a list of calls: what each was given and what it came to. `ends` takes the states at the events."""
        scratch, last = self.grid.copy(), len(self.grid) - 1
        mode, y, t, reached = (0, 0, 0), np.zeros(self.rig.size), 0.0, 0
        calls = []
        while True:
            integrator, state, meanings = self.made.get(mode) or self.of(mode)
            state[: len(y)] = y
            integrator.time = t
            integrator.reset_cooldowns()
            scratch[reached] = t
            outcome = TIME_LIMIT
            while outcome == TIME_LIMIT and reached < last:
                begin = reached
                outcome, _, _, steps, _, values = integrator.propagate_grid(scratch[begin : begin + CHUNK])
                reached += len(values) - 1
                calls.append((mode, y, t, begin, outcome, steps, values))
            if outcome == TIME_LIMIT:
                return calls
            t, y = integrator.time, state.copy()
            if ends is not None:
                ends.append(y.copy())
            mode, y = self.rig.switch(mode, y, meanings[-1 - int(outcome)])

    def play(self, calls, ends):
        """What `run` does around the integration: its calls again, each with a grid of one point, its switches too."""
        scratch, played, before, ends = self.grid.copy(), [], None, iter(ends)
        for mode, y, t, begin, outcome, steps, values in calls:
            integrator, state, meanings = self.made.get(mode) or self.of(mode)
            if y is not before:
                before = y
                state[: len(y)] = y
                integrator.time = t
                integrator.reset_cooldowns()
                scratch[begin] = t
            integrator.time = scratch[begin]
            integrator.propagate_grid(scratch[begin : begin + 1])
            played.append((mode, y, t, begin, outcome, steps, values))
            if outcome != TIME_LIMIT:
                t, y = integrator.time, next(ends).copy()
                self.rig.switch(mode, y, meanings[-1 - int(outcome)])
        return played


def best(repeat, function, *arguments):
    """Smallest processor time of several calls [s]."""
    least = math.inf
    for _ in range(repeat):
        start = time.process_time()
        function(*arguments)
        least = min(least, time.process_time() - start)
    return least


def main():
    job = json.load(sys.stdin)
    rig = Rig(job["parameters"])
    print(f"# heyoka {hy.__version__}, numpy {np.__version__}")
    for set_up in job["set_ups"]:
        for tolerance in job["tolerances"]:
            options = {**SET_UPS[set_up], "tol": tolerance}
            machine = Machine(rig, options, job["end"], job["output_step"])
            ends = []
            calls = machine.run(ends)  # compiles
            loop = best(job["repeat"], machine.play, calls, ends)
            seconds = best(job["repeat"], machine.run)
            theta = float(calls[-1][-1][-1][TH2])
            switches = sum(outcome != TIME_LIMIT for *_, outcome, _, _ in calls)
            steps = sum(call[5] for call in calls)
            row = (set_up, repr(tolerance), repr(seconds), repr(loop), repr(machine.compiling), repr(theta), switches, steps)
            print(*row, sep=";", flush=True)


main()
