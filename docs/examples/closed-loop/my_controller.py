"""A controller that a user writes, as an FMI 2 FMU: `pythonfmu build -f my_controller.py`.

Soft torque in its simplest form: the voltage follows the wanted speed and yields to the current's deviation from its
slow mean. Inputs and output bear the names of the rig's variables.
"""

import math

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class MyController(Fmi2Slave):
    author = "a user"
    description = "Soft torque in Python"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.omega_ref = 0.0  # rad/s
        self.i = 0.0  # A
        self.u = 0.0  # V
        self.impedance = 0.072  # N m s/rad, sqrt(J k) of disc and shaft
        self.current = 0.0  # filtered over 0.05 s, A
        self.mean = 0.0  # filtered over 1 s, A
        for name in ("omega_ref", "i"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.register_variable(Real("u", causality=Fmi2Causality.output))
        self.register_variable(
            Real("impedance", causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
        )

    def do_step(self, current_time, step_size):
        self.current += (1 - math.exp(-step_size / 0.05)) * (self.i - self.current)
        self.mean += (1 - math.exp(-step_size / 1.0)) * (self.i - self.mean)
        back_emf, torque_per_ampere, resistance = 0.0602 * 8, 0.126 * 8, 0.33
        yielding = torque_per_ampere * (self.current - self.mean) / self.impedance  # rad/s
        self.u = back_emf * (self.omega_ref - yielding) + resistance * self.mean
        return True
