"""Plans that come with derive, under ``derive/plans/built_in``, new ones to start from, and such of Python data."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import names, number
from derive.robot.load import named_bytes, names_in
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.robot.units import in_symbol_units

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_BUILT_IN = "plans/built_in"

STRIDE = {True: math.pi / 4, False: 0.2}  # of a joint in a new plan: a revolute one [rad], a prismatic one [m]
_NEW = """\
# Motion plan. What it asks of the joints:  derive move {name}.yaml       All outputs:  derive move --help
robot: {robot}
profile: quintic               # cubic, quintic, septic, trapezoidal, harmonic, spline
sample: 0.01                   # time between two rows of a table [s]
{values}
# Joint values in the units of the robot file, cells as there{pose}.
points:
  home: [{home}]
  A: [{away}]

# time [s]; further keys: profile, via: pass (do not stop there){more[0]}
path:
  - home
  - {{to: A, time: 2}}
  - {{to: home, time: 2}}

# derive move {name}.yaml --simulate
control: {{law: computed-torque, kp: 100, kd: 20}}   # none, pd, pd-gravity, computed-torque
friction: smooth               # none, smooth (tanh){more[1]}
"""


def plan_names() -> tuple[str, ...]:
    """Names of the built-in plans, sorted."""
    return names_in(_BUILT_IN)


def plan_bytes(path_or_name: str | Path) -> bytes:
    """Contents of a plan, or of a built-in one."""
    return named_bytes(path_or_name, _BUILT_IN, "plan", "derive list --plans")


def new_plan_text(name: str, robot: Robot, source: str) -> str:
    """A commented plan that moves every joint of a robot there and back."""
    numbers = parameter_values(robot)
    missing = [symbol for symbol in free_symbols(robot) if symbol not in numbers]
    typed = {symbol: in_symbol_units(robot, symbol, number("9.81" if symbol == "g" else 1)) for symbol in missing}
    chosen = ", ".join(f"{symbol}: {evaluate(value, {}):.6g}" for symbol, value in typed.items())
    units = "units of the robot file" if robot.units.parameters else "SI units"
    values = f"values: {{{chosen}}}   # {units}\n" if missing else ""
    known = {**dict.fromkeys(missing, 1.0), **{symbol: float(value) for symbol, value in numbers.items()}}
    named = [end.name for end in robot.ends if end.name]
    of_end = f", end: {named[0]}" if len(named) > 1 else ""
    pose = "" if robot.root or robot.coupled else f"; or a pose: {{pose: {{p: [x, y, z], rpy: [0, 0, 0]}}{of_end}}}"
    ends = []  # where each joint stands and where it goes, within its limits, in the units of the robot file
    for joint in robot.variables:
        angle = math.radians(1) if robot.units.degrees else 1.0
        unit = angle if joint.is_revolute else 0.001 if robot.units.millimetres else 1.0
        start, end, bounds = 0.0, STRIDE[joint.is_revolute], joint.limits or ()
        if bounds and all(symbol in known for cell in bounds for symbol in names(cell)):
            low, high = (evaluate(cell, known) for cell in bounds)
            start = 0.0 if low <= 0 < high else (low + high) / 2
            end = min(start + end, (start + high) / 2)
        ends.append((start / unit, end / unit))
    home, away = (", ".join(f"{value:.6g}" for value in column) for column in zip(*ends, strict=True))
    more = ("", "") if robot.coupled else (", line: yes, through: POINT, payload: 0.5 (kg)", ", exact (stick and slip)")
    return _NEW.format(name=name, robot=source, values=values, pose=pose, home=home, away=away, more=more)


def plan_text(keys: Mapping[str, Any]) -> str:
    """The file of a plan of numbers, texts of cells, lists, arrays and mappings; None and False count as left out."""
    return json.dumps(_plain(keys), indent=1, ensure_ascii=False)


def _plain(value: object) -> object:
    if isinstance(value, Mapping):
        plain = {str(key): _plain(entry) for key, entry in value.items()}
        return {key: entry for key, entry in plain.items() if entry is not None}
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, bool):
        return "yes" if value else None
    return value if value is None or isinstance(value, int | float | str) else str(value)


def waypoints(points: ArrayLike, times: ArrayLike | None) -> dict[str, Any]:
    """The points, (points, n), and the path of a plan; times of the segments or one for all [s], None by limits."""
    import numpy as np  # names of plans are completed without it

    if (rows := np.asarray(points)).ndim != 2 or len(rows) < 2:
        raise ValueError(f"points: two rows at least, not an array of shape {rows.shape}")
    count = len(rows) - 1
    if times is not None and np.size(times) not in (1, count):
        raise ValueError(f"times: one, or {count} for {len(rows)} points, not {np.size(times)}")
    each = [None] * count if times is None else np.resize(times, count).tolist()
    steps = [{"to": f"p{k}", "time": time} for k, time in enumerate(each, 1)]
    return {"points": {f"p{k}": row for k, row in enumerate(rows)}, "path": ["p0", *steps]}
