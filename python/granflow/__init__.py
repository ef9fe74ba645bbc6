"""Where a granular mass comes to rest: avalanches, slides and sandpiles.

::

    import granflow

    ds = granflow.run("avalanche.toml")          # an xarray.Dataset
    ds.granflow.plot()

    case = granflow.Case("avalanche.toml").set("material.friction.coulomb.mu", 0.3)
    sim = granflow.Simulation(case)
    sim.until(10.0)
    sim["thickness"]                             # the engine's own memory, read-only

``docs/python.md`` of the repository is the guide, ``docs/case-file.md`` says every key of a case.
"""

from . import exact
from ._calibrate import Calibration, calibrate
from ._case import Case
from ._ensemble import Ensemble
from ._errors import CaseError, ComputationError, GranflowWarning, MissingFileError, StaleViewError
from ._memory import Raster
from ._native import __version__
from ._plot import Results
from ._run import run
from ._sensitivity import sensitivity
from ._simulation import Checkpoint, Simulation, StateView

__all__ = [
    "Calibration",
    "Case",
    "CaseError",
    "Checkpoint",
    "ComputationError",
    "Ensemble",
    "GranflowWarning",
    "MissingFileError",
    "Raster",
    "Results",
    "Simulation",
    "StaleViewError",
    "StateView",
    "__version__",
    "calibrate",
    "exact",
    "run",
    "sensitivity",
]
