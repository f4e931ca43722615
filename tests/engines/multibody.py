"""The pendulums as bodies and joints for MuJoCo, and their motion.

MuJoCo measures the second rod's angle from the first rod; `UNFOLD` turns joint rates into the rates
of the angles from hanging that the bond graph has.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .pendulums import CART, DOUBLE

SCENE = """
<mujoco>
  <option timestep="{step}" integrator="RK4" gravity="0 0 -9.81"/>
  <worldbody>{bodies}</worldbody>
</mujoco>
"""
ROD = """
<body pos="0 0 {height}">
  <joint type="hinge" axis="0 -1 0"/>
  <inertial pos="0 0 {end}" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>
  {hung}
</body>
"""
CARRIAGE = """
<body>
  <joint type="slide" axis="1 0 0" stiffness="{k}"/>
  <inertial pos="0 0 0" mass="{M}" diaginertia="1 1 1"/>
  {hung}
</body>
"""
UNFOLD = {"double": np.array([[1.0, 0.0], [1.0, 1.0]]), "cart": np.eye(2)}


def rod(height: float, length: float, mass: float, inertia: float, hung: str = "") -> str:
    """A rod with a bob at its end, hinged at a height above the body that carries it."""
    return ROD.format(height=height, end=-length, mass=mass, inertia=inertia, hung=hung)


def scene(name: str, step: float) -> Any:
    """MuJoCo's model of ``double`` or ``cart``, stepped by its Runge-Kutta method."""
    import mujoco

    if name == "double":
        v = {symbol.name: value for symbol, value in DOUBLE.items()}
        lower = rod(-v["l1"], v["l2"], v["m2"], v["J2"])
        bodies = rod(0, v["l1"], v["m1"], v["J1"], lower)
    else:
        v = {symbol.name: value for symbol, value in CART.items()}
        bodies = CARRIAGE.format(k=v["k"], M=v["M"], hung=rod(0, v["l1"], v["m1"], v["J1"]))
    return mujoco.MjModel.from_xml_string(SCENE.format(step=step, bodies=bodies))


def run(name: str, start: list[float], until: float, step: float = 1e-3) -> np.ndarray:
    """Coordinates and rates, as the bond graph has them, at every step; (4, nt)."""
    import mujoco

    model, unfold = scene(name, step), UNFOLD[name]
    data = mujoco.MjData(model)
    data.qpos, data.qvel = np.linalg.solve(unfold, np.reshape(start, (2, 2)).T).T
    rows = [start]
    for _ in range(round(until / step)):
        mujoco.mj_step(model, data)
        rows.append([*(unfold @ data.qpos), *(unfold @ data.qvel)])
    return np.array(rows).T


def mass_matrix(name: str, at: np.ndarray) -> np.ndarray:
    """Mass matrix at coordinates, for the rates that the bond graph has."""
    import mujoco

    model, unfold = scene(name, 1e-3), UNFOLD[name]
    data = mujoco.MjData(model)
    data.qpos = np.linalg.solve(unfold, at)
    mujoco.mj_forward(model, data)
    columns = np.zeros((2, 2))
    for column, unit in zip(columns, np.eye(2), strict=True):
        # not mj_fullM: its arguments changed with MuJoCo 4
        mujoco.mj_mulM(model, data, column, unit)
    fold = np.linalg.inv(unfold)
    return fold.T @ columns.T @ fold
