"""The bicycle brake on plain NumPy and scipy, event by event: no bond graph is used here."""

import numpy
from scipy.integrate import solve_ivp

NOMINAL = {"mu_s": 0.5, "mu_k": 0.4, "v_s": 0.05, "V0": 0.9, "F_k": 900.0, "tau": 0.02}


def brake(**given):
    """Numbers of the brake, seen at the rotor's rim."""
    p = {**NOMINAL, "k_f": 350e3, "k_w": 90e3, "f_f": 300.0, "f_w": 200.0, "zeta": 0.05, **given}
    for part in "fw":
        turn = 2 * numpy.pi * p[f"f_{part}"]
        p[f"m_{part}"] = p[f"k_{part}"] / turn**2
        p[f"b_{part}"] = 2 * p["zeta"] * p[f"k_{part}"] / turn
    return {**p, "N0": p["F_k"] / p["mu_k"]}


def own(p):
    """Rolling freely: rim speed of the rotor, wind-up, caliper's speed and place, pad force."""
    return numpy.array([p["V0"], 0.0, 0.0, 0.0, 0.0])


def sliding(p):
    """Steady sliding, whose friction hardly depends on the slip there."""
    force = (p["mu_k"] + (p["mu_s"] - p["mu_k"]) * numpy.exp(-p["V0"] / p["v_s"])) * p["N0"]
    return numpy.array([p["V0"], force / p["k_w"], 0.0, force / p["k_f"], p["N0"]])


def seized(p):
    """Steady sliding after a blow that seizes the pads: momentum is shared."""
    state = sliding(p)
    shared = p["m_w"] * p["V0"] / (p["m_w"] + p["m_f"])
    state[[0, 2]] = shared
    return state


def stopped(p):
    """Steady sliding with all momentum gone."""
    state = sliding(p)
    state[[0, 2]] = 0.0
    return state


def sticks(p, state, until, rtol=1e-9):
    """Times at which the pads begin to stick."""
    t, found = 0.0, []
    held = state[0] == state[2]
    side = 1.0 if state[0] >= state[2] else -1.0
    options = {"method": "DOP853", "rtol": rtol, "atol": 1e-13, "max_step": 1e-3}
    while t < until:
        if held:

            def margin(t, y):
                return p["mu_s"] * y[4] - abs(_held(p, y)[1])

            if margin(t, state) <= 0:
                held, side = False, numpy.sign(_held(p, state)[1])
                continue
            margin.terminal, margin.direction = True, -1
            run = solve_ivp(
                lambda t, y: _held(p, y)[0], (t, until), state, events=margin, **options
            )
            t, state = float(run.t[-1]), run.y[:, -1].copy()
            held, side = False, numpy.sign(_held(p, state)[1])
            state[[0, 2]] = (p["m_w"] * state[0] + p["m_f"] * state[2]) / (p["m_w"] + p["m_f"])
            continue

        def slip(t, y):
            return y[0] - y[2]

        def rates(t, y, side=side):
            # steps that overshoot the event are thrown away, but must be finite
            speed = max(side * (y[0] - y[2]), -p["v_s"])
            mu = p["mu_k"] + (p["mu_s"] - p["mu_k"]) * numpy.exp(-speed / p["v_s"])
            return _free(p, y, side * mu * y[4])

        slip.terminal, slip.direction = True, -side
        if state[0] == state[2]:  # off the event that has just been
            run = solve_ivp(rates, (t, t + 1e-7), state, **options)
            t, state = float(run.t[-1]), run.y[:, -1].copy()
        run = solve_ivp(rates, (t, until), state, events=slip, **options)
        t, state = float(run.t[-1]), run.y[:, -1].copy()
        if run.status == 1:
            found.append(t)
            held = True
            state[[0, 2]] = (p["m_w"] * state[0] + p["m_f"] * state[2]) / (p["m_w"] + p["m_f"])
    return numpy.array(found)


def frequency(p, state, until=0.5):
    """Frequency of the cycle that a run ends in, Hz; None where it slides on."""
    found = sticks(p, state, until)
    if len(found) < 5 or found[-1] < 0.9 * until:
        return None
    return 1 / float(numpy.diff(found[-4:]).mean())


def _free(p, y, force):
    w, wound, v, x, n = y
    return [
        (p["k_w"] * wound + p["b_w"] * (p["V0"] - w) - force) / p["m_w"],
        p["V0"] - w,
        (force - p["k_f"] * x - p["b_f"] * v) / p["m_f"],
        v,
        (p["N0"] - n) / p["tau"],
    ]


def _held(p, y):
    """Rates while stuck, and the force that keeps it so."""
    w, wound, v, x, n = y
    speed = (p["m_w"] * w + p["m_f"] * v) / (p["m_w"] + p["m_f"])
    on_wheel = p["k_w"] * wound + p["b_w"] * (p["V0"] - speed)
    on_frame = p["k_f"] * x + p["b_f"] * speed
    rate = (on_wheel - on_frame) / (p["m_w"] + p["m_f"])
    force = p["m_f"] * rate + on_frame
    return [rate, p["V0"] - speed, rate, speed, (p["N0"] - n) / p["tau"]], force
