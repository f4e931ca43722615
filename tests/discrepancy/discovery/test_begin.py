"""Where recordings begin: angles that nothing depends on, and effects that are periodic in them."""

import numpy
import sympy

from bondgraph import I, Integrator, One, R, Se, assemble, simulate
from bondgraph.discrepancy import Measurement, discover, graft
from bondgraph.discrepancy.discovery.begin import anchored
from bondgraph.discrepancy.discovery.prepare import prepared
from bondgraph.simulation import CompiledModel

T = numpy.linspace(0, 12, 901)
TORQUE = 2 + numpy.sin(0.9 * T)


def _wheel(begins=0.7):
    friction, torque = sympy.Symbol("friction", positive=True), sympy.Symbol("torque")
    wheel = One("wheel")
    angle = Integrator("angle", wheel.f, initial=begins)
    return assemble(
        "wheel",
        Se("drive", torque) >> wheel >> (I("disc", 1.0), R("bearing", friction)),
        angle,
        parameters={friction: 0.4},
        inputs=[torque],
        outputs={"speed": wheel.f},
    )


def _recorded(graph, seed, begin=None):
    start = {} if begin is None else {"angle.y": begin, "run_out.q": begin}
    run = simulate(graph, T[-1], {}, start, {"torque": (T, TORQUE)}, t_eval=T)
    noise = 0.002 * numpy.random.default_rng(seed).normal(size=len(T))
    return Measurement(T, {"torque": TORQUE, "speed": run["speed"] + noise}, name=f"run {seed}")


def test_an_angle_that_nothing_feels_begins_where_the_model_says():
    graph = _wheel()
    row, _ = prepared(_recorded(graph, 0), graph)
    assert "angle.y" in row.item.free
    held = anchored(row, CompiledModel(graph), {"friction": 0.4})
    assert held.item.free == tuple(name for name in row.item.free if name != "angle.y")
    assert held.item.initial["angle.y"] == 0.7 == held.plain.initial["angle.y"]


def test_run_out_has_the_phase_of_the_models_angle_and_is_found_in_another():
    sizes = {"sine": 0.5, "cosine": -0.3, "order": 2.0}
    rough = graft(_wheel(), "run_out", "wheel", parameters=sizes).graph
    found = discover(_wheel(), _recorded(rough, 1), _recorded(rough, 2, begin=2.3))
    assert [effect.name for effect in found.effects] == ["run_out"]
    for key, true in sizes.items():
        assert abs(found.effects[0].parameters[key].value - true) < 0.02 * max(abs(true), 0.3)
    gap = found.gap["validation"]["speed"]
    assert gap.after < 1.1 * gap.noise_floor < 0.1 * gap.before
