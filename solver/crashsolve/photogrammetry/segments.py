"""The chain in every frame, each searched from the one before; a frame that does not fit is
refused.
"""

from dataclasses import replace

import numpy as np

from crashsolve.foundation.errors import DeckError, DeckErrors
from crashsolve.foundation.orientation import matrix
from crashsolve.photogrammetry.chain_fit import Chain, Fit, FitError, fit
from crashsolve.photogrammetry.points import IMPROBABLE, Frame, Measured
from crashsolve.photogrammetry.request import Requested, World


def fitted(requested: Requested, chain: Chain, measurements: Measured) -> list[Fit]:
    """One fit for each frame. Raises DeckErrors."""
    path = requested.card.frames
    fits: list[Fit] = []
    for frame in measurements.frames:
        for point in frame.points:
            if point.name not in chain.landmarks:
                message = f"point '{point.name}' has no landmark in {requested.card.landmarks}"
                raise DeckErrors([DeckError(path, point.rows[0].line, None, "", message)])
        line = frame.points[0].rows[0].line
        before = fits[-1].q if fits else None
        try:
            own = fit(
                chain, in_world(frame, requested.card.world), requested.card.landmark_error, before
            )
            _check(own, frame)
        except FitError as error:
            where = f"frame at {frame.time:.6g} s"
            raise DeckErrors(
                [DeckError(path, line, None, where, str(error), error.advice)]
            ) from None
        fits.append(own)
    return fits


def in_world(frame: Frame, world: World) -> Frame:
    """A frame in the axes of the deck."""
    R = matrix(world.rotation.quaternion())
    points = tuple(replace(p, x=R @ p.x + np.asarray(world.position)) for p in frame.points)
    R_all = np.kron(np.eye(len(points)), R)
    return replace(frame, points=points, covariance=R_all @ frame.covariance @ R_all.T)


def _check(own: Fit, frame: Frame) -> None:
    """Refuse points that the chain cannot meet within the errors stated. Raises FitError."""
    from scipy.stats import chi2

    if own.freedom == 0 or chi2.sf(own.chi_squared, own.freedom) >= IMPROBABLE:
        return
    worst = int(np.argmax(own.distances))
    rms = float(np.sqrt(np.mean(own.distances**2)))
    raise FitError(
        f"the points do not fit the segments within their errors: {rms * 1e3:.3g} mm rms, most "
        f"'{frame.points[worst].name}', {own.distances[worst] * 1e3:.3g} mm; chi-squared is "
        f"{own.chi_squared:.4g} of {own.freedom}",
        "look for points taken for others and for wrong units; a person of other size than the "
        "segments needs a larger landmark_error",
    )
