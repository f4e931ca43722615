"""The sliding brake by hand: Eq. 1 of Procedia Engineering 72 (2014) 471-476, linearised."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq


def sliding_matrix(c, zeta=0.05, k_f=350e3, k_w=90e3, f_f=300.0, f_w=200.0, r=0.08, zeta_w=None):
    """State matrix about sliding with friction slope c, in the order w_r, V_c, theta, x."""
    zeta_w = zeta if zeta_w is None else zeta_w
    m_f, m_w = k_f / (2 * math.pi * f_f) ** 2, k_w / (2 * math.pi * f_w) ** 2
    b_f, b_w = 2 * zeta * math.sqrt(k_f * m_f), 2 * zeta_w * math.sqrt(k_w * m_w)
    j, k_t, b_t = m_w * r**2, k_w * r**2, b_w * r**2
    return np.array(
        [
            [-(b_t + c * r**2) / j, c * r / j, k_t / j, 0],
            [c * r / m_f, -(b_f + c) / m_f, 0, -k_f / m_f],
            [-1, 0, 0, 0],
            [0, 1, 0, 0],
        ]
    )


def critical_slope(**values):
    """Slope of friction at which sliding loses its stability, nearest to zero."""
    return brentq(
        lambda c: np.linalg.eigvals(sliding_matrix(c, **values)).real.max(), -60, 0, xtol=1e-13
    )


def slope(speed, v_s, drop=225.0):
    """Slope of friction that falls by ``drop`` newtons."""
    return -drop / v_s * math.exp(-speed / v_s)


def critical_speed(v_s, drop=225.0, **values):
    """Speed below which sliding is unstable."""
    return v_s * math.log(-drop / (v_s * critical_slope(**values)))
