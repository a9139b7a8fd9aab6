"""Finite-element simulation of soft pneumatic actuators.

Silicone fingers that bend when air is let into their chambers: large rotations, hyperelastic silicones, air pressure that follows the walls,
contact between chambers, with themselves and with rigid obstacles.

    >>> import pneuflex
    >>> case = pneuflex.Case.actuator(chambers=6, gap=1.5, pressures=[10, 20, 30])
    >>> result = case.solve()
    >>> result.end_face_angle_deg  # one value per pressure

* :class:`Case` is an actuator that its lengths describe, :class:`Model` any other body: from a model file, an input deck of Abaqus or
  CalculiX, a mesh of Gmsh, or numpy arrays. Both have ``set``, ``check`` and ``solve``.
* :class:`Result` has arrays over the reached states; ``result[k]`` is a :class:`State` with its fields.
* :func:`sweep` solves many designs, on all cores or a cluster.
* :func:`fit` and :func:`materials` find constants of silicones.

Units are mm, N, MPa and mJ; air pressures are in kPa, angles in degrees. Nothing beyond numpy is required; pandas, PyVista, meshio,
matplotlib, SciPy and pyarrow are imported by what needs them.
"""

from ._errors import Interrupted, InputError, NotConverged, Problem
from ._materials import Fit, Silicone, fit, materials
from ._native import VERSION as __version__
from ._result import Result, State
from ._study import Case, Check, Model, Study
from ._sweep import Grid, LatinHypercube, Sobol, Sweep, sweep

__all__ = [
    "Case",
    "Check",
    "Fit",
    "Grid",
    "InputError",
    "Interrupted",
    "LatinHypercube",
    "Model",
    "NotConverged",
    "Problem",
    "Result",
    "Silicone",
    "Sobol",
    "State",
    "Study",
    "Sweep",
    "__version__",
    "fit",
    "materials",
    "sweep",
]
