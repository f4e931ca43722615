"""Comparing fits: by what they leave, over what independent samples allow."""

from __future__ import annotations

import math

from .bench import Trial

EACH = 6.0  # of each effect: twice the logarithm of twenty that might have been taken


def delta_bic(before: Trial, after: Trial) -> float:
    """Return the drop of the Bayesian information criterion from one fit to another.

    The noise of each signal is unknown; samples count as often as the residuals of the better fit
    are independent.

    Parameters
    ----------
    before, after : Trial
        Of the same recordings.

    Returns
    -------
    float

    References
    ----------
    Kass, Raftery, Bayes factors, Journal of the American Statistical Association 90 (1995) 773-795.
    """
    gain, count = log_ratio(before, after)
    gain += before.strain - after.strain
    return gain - (after.terms - before.terms) * math.log(max(count, 2.0))


def preference(before: Trial, after: Trial) -> float:
    """Return by how much a fit is preferred to another: the criterion, less the odds of its effects.

    One effect out of many is easily found that fits a little better; two out of many still more
    easily.

    References
    ----------
    Chen, Chen, Extended Bayesian information criteria for model selection with large model spaces,
    Biometrika 95 (2008) 759-771.
    """
    return delta_bic(before, after) - EACH * (len(after.added) - len(before.added))


def log_ratio(before: Trial, after: Trial) -> tuple[float, float]:
    """Return twice the logarithm of the likelihood ratio, and the effective number of samples."""
    gain, count = 0.0, 0.0
    for name, squares in after.squares.items():
        other = before.squares.get(name, squares)
        better = after if squares <= other else before
        number = better.effective.get(name, 1.0)
        gain += number * math.log(max(other, 1e-300) / max(squares, 1e-300))
        count += number
    return gain, count
