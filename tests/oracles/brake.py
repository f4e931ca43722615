"""The bicycle brake of Procedia Engineering 72 (2014) 471-476, solved without any bond graph.

Equation 1 of the paper with set-valued friction at zero slip, as an automaton of three modes
(``stick``, ``slip+``, ``slip-``) integrated by scipy's DOP853 between located events. States are
``omega_r`` (rotor, rad/s), ``V_c`` (caliper, m/s), ``theta_w`` (wind-up of the wheel, rad) and
``x_c`` (deflection of the frame, m); the pad force ``N(t) = N0 (1 - exp(-t/tau))`` is analytic.

Three readings of the paper matter: ``k_t`` is the wheel's stiffness times the *rotor's* radius
squared, ``N`` is the force of both pads together, and the quoted coefficient 0.4 is the kinetic
one. Velocities are relative to the bicycle.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

Mode = Literal["stick", "slip+", "slip-"]
Array = NDArray[np.float64]

STATES = ("omega_r", "V_c", "theta_w", "x_c")
ENERGIES = ("road", "bt", "bf", "friction")
NOISE = 1e-13
"""Guards below this share of their scale are taken for zero where a mode starts."""

SIGN: dict[Mode, float] = {"slip+": 1.0, "slip-": -1.0}


@dataclass(frozen=True)
class Brake:
    """Parameters under the paper's names, in SI units; defaults are the paper's values.

    Attributes
    ----------
    k_f, k_w : stiffness of frame and wheel, both at the caliper, N/m
    f_f, f_w : natural frequency of frame and wheel, Hz
    r_r, r_t : radius of rotor and tyre, m
    zeta_f, zeta_w : damping ratio of frame and wheel
    V0 : speed of the rotor at the caliper, m/s
    mu_s, mu_k : static and kinetic coefficient of friction
    v_s : slip speed over which the static excess decays, m/s
    F_k : kinetic friction force when the pads are fully applied, N
    tau : time constant of the pad force, s
    """

    k_f: float = 350e3
    k_w: float = 90e3
    f_f: float = 300.0
    f_w: float = 200.0
    r_r: float = 0.08
    r_t: float = 0.33
    zeta_f: float = 0.05
    zeta_w: float = 0.05
    V0: float = 0.9
    mu_s: float = 0.5
    mu_k: float = 0.4
    v_s: float = 0.05
    F_k: float = 900.0
    tau: float = 0.03

    @cached_property
    def m_f(self) -> float:
        """Effective mass of the frame, kg."""
        return self.k_f / (2 * math.pi * self.f_f) ** 2

    @cached_property
    def J_r(self) -> float:
        """Inertia of hub and rotor, kg m^2."""
        return self.k_w / (2 * math.pi * self.f_w) ** 2 * self.r_r**2

    @cached_property
    def k_t(self) -> float:
        """Torsional stiffness of the wheel, N m/rad."""
        return self.k_w * self.r_r**2

    @cached_property
    def b_f(self) -> float:
        """Damping of the frame, N s/m."""
        return 2 * self.zeta_f * math.sqrt(self.k_f * self.m_f)

    @cached_property
    def b_t(self) -> float:
        """Torsional damping of the wheel, N m s/rad."""
        return 2 * self.zeta_w * math.sqrt(self.k_t * self.J_r)

    @cached_property
    def omega_t(self) -> float:
        """Imposed speed of the tyre, rad/s."""
        return self.V0 / self.r_r

    @cached_property
    def N0(self) -> float:
        """Final pad force, N."""
        return self.F_k / self.mu_k

    @cached_property
    def compliance(self) -> float:
        """Slip acceleration per newton of friction, 1/kg."""
        return self.r_r**2 / self.J_r + 1 / self.m_f

    @cached_property
    def start(self) -> tuple[float, float, float, float]:
        """State before the brake is applied: the wheel turns, nothing is deflected."""
        return (self.omega_t, 0.0, 0.0, 0.0)

    def pad_force(self, t: float) -> float:
        """Normal force of both pads at time `t`, N."""
        return -self.N0 * math.expm1(-t / self.tau)

    def pad_force_rate(self, t: float) -> float:
        """Time derivative of the pad force, N/s."""
        return self.N0 / self.tau * math.exp(-t / self.tau)

    def friction_coefficient(self, slip: float) -> float:
        """Coefficient of friction at a slip speed of either sign."""
        return self.mu_k + (self.mu_s - self.mu_k) * math.exp(-abs(slip) / self.v_s)

    def slip(self, y: Sequence[float] | Array) -> float:
        """Slip speed of the rotor against the pads, m/s."""
        return float(self.r_r * y[0] - y[1])

    def stored(self, y: Sequence[float] | Array) -> float:
        """Energy held in both inertias and both springs, J."""
        w, v, th, x = (float(a) for a in y[:4])
        return 0.5 * (self.J_r * w * w + self.m_f * v * v + self.k_t * th * th + self.k_f * x * x)

    @cached_property
    def holding_row(self) -> tuple[Array, float]:
        """Row and constant of the holding force: ``lambda = row @ y[:4] + constant``, N."""
        a, b = self.r_r / self.J_r, 1 / self.m_f
        row = np.array([-a * self.b_t, b * self.b_f, a * self.k_t, b * self.k_f])
        return row / self.compliance, a * self.b_t * self.omega_t / self.compliance

    def holding_force(self, y: Sequence[float] | Array) -> float:
        """Friction force that would keep rotor and pads at equal acceleration, N."""
        row, constant = self.holding_row
        return float(row[0] * y[0] + row[1] * y[1] + row[2] * y[2] + row[3] * y[3] + constant)


class Event(NamedTuple):
    """A change of mode: time in s, mode left, mode entered."""

    t: float
    left: Mode
    entered: Mode


@dataclass(frozen=True)
class Run:
    """What one solution of the brake yields.

    Attributes
    ----------
    brake : parameters of the run
    t, states : requested times, s, shape (n,), and states, shape (n, 4), ordered as `STATES`
    events : changes of mode in order of time
    first_mode : mode at the start
    final : state at the end
    energies : J over the whole run: ``road`` (supplied), ``bt``, ``bf``, ``friction``
        (dissipated), ``stored`` (change) and ``residual``
    margin : least dimensionless distance to another order of events (see `solve`)
    least_slip : least |slip| at a turning point that did not reach zero, m/s; inf if there is none
    """

    brake: Brake
    t: Array
    states: Array
    events: tuple[Event, ...]
    first_mode: Mode
    final: Array
    energies: Mapping[str, float]
    margin: float
    least_slip: float

    @property
    def stick_times(self) -> list[float]:
        """Times at which rotor and pads stick, s."""
        return [e.t for e in self.events if e.entered == "stick"]

    @property
    def slip_times(self) -> list[float]:
        """Times at which a stuck brake lets go, s."""
        return [e.t for e in self.events if e.left == "stick"]

    @property
    def crossing_times(self) -> list[float]:
        """Times at which slip reverses without sticking, s."""
        return [e.t for e in self.events if "stick" not in (e.left, e.entered)]

    def cycle_frequency(self, cycles: int = 4) -> float:
        """Mean frequency over the last `cycles` intervals between sticks, Hz; nan without any."""
        last = self.stick_times[-cycles - 1 :]
        if len(last) < 2:
            return math.nan
        return (len(last) - 1) / (last[-1] - last[0])


class _Guard(NamedTuple):
    """A quantity positive within a mode, its rate, and the scale that makes it dimensionless."""

    value: Callable[[float, Array], float]
    rate: Callable[[float, Array, Array], float]
    scale: Callable[[float], float]


def _right_side(p: Brake, mode: Mode) -> Callable[[float, Array], list[float]]:
    """Rates of the four states and of the four energies of `ENERGIES` in one mode."""
    r, j, m, k_t, k_f, b_t, b_f = p.r_r, p.J_r, p.m_f, p.k_t, p.k_f, p.b_t, p.b_f
    w_t, mu_k, excess, v_s = p.omega_t, p.mu_k, p.mu_s - p.mu_k, p.v_s
    (l0, l1, l2, l3), l4 = p.holding_row[0].tolist(), p.holding_row[1]
    s = SIGN.get(mode, 0.0)

    def rates(t: float, y: Array) -> list[float]:
        w, v, th, x = y[:4].tolist()
        slip = r * w - v
        if s:
            # smooth beyond zero slip, so that the step that passes the event stays accurate;
            # clamped, so that a rejected trial step cannot overflow
            mu = mu_k + excess * math.exp(min(-s * slip / v_s, 3.0))
            force = s * p.pad_force(t) * mu
        else:
            force = l0 * w + l1 * v + l2 * th + l3 * x + l4
        wind = w_t - w
        torque = k_t * th + b_t * wind
        return [
            (torque - r * force) / j,
            (force - k_f * x - b_f * v) / m,
            wind,
            v,
            w_t * torque,
            b_t * wind * wind,
            b_f * v * v,
            force * slip,
        ]

    return rates


def _guards(p: Brake, mode: Mode) -> tuple[_Guard, ...]:
    """Guards that end a mode: zero slip, or a holding force at either static limit."""
    if mode != "stick":
        s = SIGN[mode]
        return (
            _Guard(
                lambda t, y: s * (p.r_r * y[0] - y[1]),
                lambda t, y, f: s * (p.r_r * f[0] - f[1]),
                lambda t: p.V0,
            ),
        )
    row = p.holding_row[0]

    def limit(s: float) -> _Guard:
        return _Guard(
            lambda t, y: p.mu_s * p.pad_force(t) - s * p.holding_force(y),
            lambda t, y, f: p.mu_s * p.pad_force_rate(t) - s * float(row @ f[:4]),
            lambda t: p.mu_s * p.pad_force(t),
        )

    return limit(1.0), limit(-1.0)


def _mode_at(p: Brake, t: float, y: Array) -> Mode:
    """Mode in which the brake moves on from a state whose slip is zero."""
    force = p.holding_force(y)
    if abs(force) <= p.mu_s * p.pad_force(t):
        return "stick"
    return "slip+" if force > 0 else "slip-"


def _first_mode(p: Brake, y: Array) -> Mode:
    slip = p.slip(y)
    if slip == 0:
        return _mode_at(p, 0.0, y)
    return "slip+" if slip > 0 else "slip-"


@dataclass
class _Solution:
    """The run under way; the only mutable thing here."""

    brake: Brake
    t_end: float
    grid: Array
    rtol: float
    max_step: float
    t: float
    y: Array
    mode: Mode
    rows: list[Array] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    margin: float = math.inf
    least_slip: float = math.inf

    def advance(self) -> bool:
        """Integrate to the end of the mode; False once the end of the run is reached."""
        p = self.brake
        rates, guards = _right_side(p, self.mode), _guards(p, self.mode)
        scales = _scales(p, self.t_end)
        solver = DOP853(
            rates, self.t, self.y, self.t_end, self.max_step, self.rtol, 0.1 * self.rtol * scales
        )
        armed = [bool(g.value(self.t, self.y) > NOISE * g.scale(self.t)) for g in guards]
        if self.mode in SIGN and self.events and self.events[-1].left == "stick":
            armed = [False]
        before, f0 = solver.t, np.array(solver.f)
        while solver.status == "running":
            solver.step()
            if solver.status == "failed":
                raise RuntimeError(f"brake oracle failed at t = {solver.t!r} s in {self.mode}")
            step = _Step(before, solver.t, f0, np.array(solver.f), solver, rates)
            event = self._first_event(step, guards, armed)
            self._record(step, solver.t if event is None else event)
            if event is not None:
                self._switch(event, step.state(event))
                return True
            before, f0 = solver.t, step.f1
        self.t, self.y = solver.t, np.array(solver.y)
        return False

    def _first_event(
        self, step: _Step, guards: tuple[_Guard, ...], armed: list[bool]
    ) -> float | None:
        found = []
        for i, guard in enumerate(guards):
            bracket = self._bracket(step, guard, armed[i])
            if bracket is not None:
                found.append(step.root(guard.value, *bracket))
            armed[i] = armed[i] or guard.value(step.t1, step.y1) > NOISE * guard.scale(step.t1)
        return min(found, default=None)

    def _bracket(self, step: _Step, guard: _Guard, armed: bool) -> tuple[float, float] | None:
        """Times around the first zero of a guard within a step, if there is one."""
        a, b = step.t0, step.t1
        if not armed:
            # the guard starts at zero, often with zero rate, so its sign there is noise
            noise = NOISE * guard.scale(b)
            if guard.value(b, step.y1) >= -noise:
                return None
            ahead = [t for t in np.linspace(a, b, 33)[1:] if guard.value(t, step.state(t)) > noise]
            if not ahead:
                raise RuntimeError(f"mode {self.mode} entered at t = {a!r} s turns against itself")
            return ahead[0], b
        if guard.value(b, step.y1) <= 0:
            return a, b
        if not guard.rate(a, step.y0, step.f0) < 0 < guard.rate(b, step.y1, step.f1):
            return None
        low = step.root(lambda t, y: guard.rate(t, y, np.array(step.rates(t, y))), a, b)
        value = guard.value(low, step.state(low))
        if value < 0:
            return a, low
        self.margin = min(self.margin, float(value / guard.scale(low)))
        if self.mode in SIGN:
            self.least_slip = min(self.least_slip, float(value))
        return None

    def _record(self, step: _Step, until: float) -> None:
        while len(self.rows) < len(self.grid) and self.grid[len(self.rows)] <= until:
            self.rows.append(step.state(self.grid[len(self.rows)])[:4])

    def _switch(self, t: float, y: Array) -> None:
        p = self.brake
        y = np.array(y)
        if self.mode == "stick":
            entered: Mode = "slip+" if p.holding_force(y) > 0 else "slip-"
        else:
            entered = _mode_at(p, t, y)
            limit = p.mu_s * p.pad_force(t)
            if limit > 0:
                self.margin = min(self.margin, abs(1 - abs(p.holding_force(y)) / limit))
        # remove what the root finder left of the slip, keeping the momentum
        impulse = p.slip(y) / p.compliance
        y[0] -= p.r_r * impulse / p.J_r
        y[1] += impulse / p.m_f
        self.events.append(Event(t, self.mode, entered))
        self.t, self.y, self.mode = t, y, entered


class _Step:
    """One accepted step, its dense output made only when something asks for it."""

    def __init__(
        self,
        t0: float,
        t1: float,
        f0: Array,
        f1: Array,
        solver: DOP853,
        rates: Callable[[float, Array], list[float]],
    ) -> None:
        self.t0, self.t1, self.f0, self.f1, self.rates = t0, t1, f0, f1, rates
        self.y0, self.y1 = np.array(solver.y_old), np.array(solver.y)
        self._solver = solver

    @cached_property
    def _dense(self) -> Callable[[float], Array]:
        return self._solver.dense_output()

    def state(self, t: float) -> Array:
        if t == self.t1:
            return self.y1
        return self.y0 if t == self.t0 else self._dense(t)

    def root(self, value: Callable[[float, Array], float], a: float, b: float) -> float:
        return float(brentq(lambda t: value(t, self.state(t)), a, b, xtol=1e-16, rtol=1e-14))


def starting_state(p: Brake, initial: Mapping[str, float]) -> list[float]:
    """`Brake.start` with some states, by name, put elsewhere.

    Raises
    ------
    KeyError
        if a name is not one of `STATES`
    """
    if unknown := set(initial) - set(STATES):
        raise KeyError(f"no such state: {', '.join(sorted(unknown))}")
    return [initial.get(name, value) for name, value in zip(STATES, p.start, strict=True)]


def _scales(p: Brake, t_end: float) -> Array:
    """Magnitude of each state and each energy, for the absolute tolerance."""
    work = p.F_k * p.V0 * t_end
    states = [p.omega_t, p.V0, p.r_r * p.F_k / p.k_t, p.F_k / p.k_f]
    return np.array([*states, work, 1e-2 * work, 1e-2 * work, work])


def solve(
    brake: Brake,
    t_end: float,
    *,
    t_eval: ArrayLike = (),
    initial: Mapping[str, float] | None = None,
    rtol: float = 1e-12,
) -> Run:
    """Solve the brake with every stick, slip and crossing located.

    Parameters
    ----------
    brake : parameters
    t_end : length of the run, s
    t_eval : increasing times at which states are wanted, s, shape (n,)
    initial : states that start elsewhere than `Brake.start`, by name
    rtol : relative tolerance of DOP853; the absolute one is a tenth of it on each state's scale

    Returns
    -------
    run : states, events, energies

    Notes
    -----
    A step is at most a twentieth of the shortest natural period, hence a guard turns at most once
    within it; a turning point that dips below zero counts as two events, so none is jumped over.

    ``margin`` is the least of: |slip|/V0 at turning points of slip that did not reach zero,
    1 - |lambda|/(mu_s N) at turning points of the holding force that did not let go, and
    |1 - |lambda|/(mu_s N)| where it was decided between sticking and crossing. A small one means
    that an error of that size may change the number of events.
    """
    y = np.zeros(8)
    y[:4] = starting_state(brake, initial or {})
    run = _Solution(
        brake=brake,
        t_end=t_end,
        grid=np.asarray(t_eval, dtype=float),
        rtol=rtol,
        max_step=1 / (20 * max(brake.f_f, brake.f_w)),
        t=0.0,
        y=y,
        mode=_first_mode(brake, y),
    )
    first, stored = run.mode, brake.stored(y)
    while run.advance():
        pass
    energies = dict(zip(ENERGIES, run.y[4:].tolist(), strict=True))
    energies["stored"] = brake.stored(run.y) - stored
    energies["residual"] = (
        energies["road"] - energies["stored"] - sum(energies[k] for k in ENERGIES[1:])
    )
    return Run(
        brake=brake,
        t=run.grid[: len(run.rows)],
        states=np.array(run.rows).reshape(-1, 4),
        events=tuple(run.events),
        first_mode=first,
        final=run.y[:4].copy(),
        energies=energies,
        margin=run.margin,
        least_slip=run.least_slip,
    )


def sliding_equilibrium(p: Brake) -> Array:
    """State of steady sliding under full pad force, shape (4,), ordered as `STATES`."""
    force = p.N0 * p.friction_coefficient(p.V0)
    return np.array([p.omega_t, 0.0, p.r_r * force / p.k_t, force / p.k_f])


def friction_slope(p: Brake) -> float:
    """Slope of friction over slip at steady sliding, N s/m; negative means negative damping."""
    return -p.N0 * (p.mu_s - p.mu_k) / p.v_s * math.exp(-p.V0 / p.v_s)


def sliding_matrix(p: Brake, slope: float | None = None) -> Array:
    """Linearised sliding at full pad force, shape (4, 4), ordered as `STATES`."""
    c = friction_slope(p) if slope is None else slope
    r, j, m = p.r_r, p.J_r, p.m_f
    return np.array(
        [
            [-(p.b_t + c * r * r) / j, c * r / j, p.k_t / j, 0],
            [c * r / m, -(p.b_f + c) / m, 0, -p.k_f / m],
            [-1, 0, 0, 0],
            [0, 1, 0, 0],
        ]
    )


def frame_matrix(p: Brake, slope: float | None = None) -> Array:
    """The older model, whose wheel is rigid: shape (2, 2), ordered ``V_c``, ``x_c``."""
    c = friction_slope(p) if slope is None else slope
    return np.array([[-(p.b_f + c) / p.m_f, -p.k_f / p.m_f], [1, 0]])


def stuck_modes(p: Brake) -> NDArray[np.complex128]:
    """Eigenvalues with rotor and pads stuck, complex, 1/s, ordered as `modes` orders them."""
    mass = p.m_f + p.J_r / p.r_r**2
    damping, stiffness = p.b_f + p.b_t / p.r_r**2, p.k_f + p.k_w
    return modes(np.array([[-damping / mass, -stiffness / mass], [1, 0]]))


def modes(matrix: Array) -> NDArray[np.complex128]:
    """Eigenvalues with positive imaginary part, slowest first, 1/s."""
    values = np.linalg.eigvals(matrix)
    values = values[values.imag > 0]
    return np.asarray(values[np.argsort(values.imag)], dtype=complex)


class Hopf(NamedTuple):
    """Where steady sliding loses stability: slope in N s/m, frequency in Hz, slip in m/s."""

    slope: float
    frequency: float
    slip: float


def hopf(p: Brake) -> Hopf:
    """Friction slope, frequency and slip speed at which sliding becomes unstable.

    ``slip`` is nan where the friction curve is nowhere steep enough.
    """

    def growth(c: float) -> float:
        return float(np.linalg.eigvals(sliding_matrix(p, c)).real.max())

    # the trace is positive beyond this slope, so sliding is surely unstable there
    steep = -(p.b_t / p.J_r + p.b_f / p.m_f) / p.compliance
    grid = np.linspace(0, steep, 401)
    last = next(i for i, c in enumerate(grid) if growth(c) > 0 or i == 400)
    slope = float(brentq(growth, grid[last - 1], grid[last] * (1 + 1e-9), xtol=1e-14, rtol=1e-15))
    values = np.linalg.eigvals(sliding_matrix(p, slope))
    frequency = float(abs(values[values.real.argmax()].imag) / (2 * math.pi))
    steepness = p.N0 * (p.mu_s - p.mu_k) / (p.v_s * abs(slope))
    return Hopf(slope, frequency, p.v_s * math.log(steepness) if steepness > 1 else math.nan)


def acceptance() -> dict[str, Any]:
    """Stored figures of the paper's four behaviours; the file's ``source`` says whence."""
    path = Path(__file__).with_name("brake_acceptance.json")
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return data


def figure(name: str) -> Brake:
    """Parameters of one of the paper's behaviours: ``fig6``, ``fig7``, ``fig8``, ``fig9``."""
    return replace(Brake(), **acceptance()["sets"][name]["params"])


def parameters(p: Brake) -> dict[str, float]:
    """Parameters as a dictionary by name."""
    return asdict(p)
