"""What the sides of an equation say, and quantities that pages print beside those of the registry."""

import numpy as np
import pytest
import sympy

from derive.checking.latex.quantities import OWN, own_quantity, slope
from derive.checking.latex.scope import Scope
from derive.checking.latex.sides import SideReading
from derive.errors import Location
from derive.model.model import Model
from derive.robot.robot import Robot

ARM = Model(Robot.load("anthropomorphic-arm"))
Q = {"q1": 0.3, "q2": -0.7, "q3": 1.1}
RATES = {"qd1": 0.4, "qd2": 0.9, "qd3": -0.6}


def numbers(value: sympy.Matrix, q: dict[str, float]) -> np.ndarray:
    free = {name: 0.2 + 0.1 * k for k, name in enumerate(sorted(map(str, value.free_symbols)))}
    return np.array(value.subs(free | RATES | q), dtype=float)


@pytest.mark.parametrize(
    ("text", "frames"), [(r"T_1^0 T_2^1", (0, 2)), (r"T_2^1 T_3^0", None), (r"A_1^{-1} T_3^0", (1, 3))]
)
def test_a_product_of_transforms_names_what_it_leads_to(text: str, frames: tuple[int, int] | None) -> None:
    scope = Scope(ARM, f"$$ {text} = 1 $$", Location("page"), document=True)
    side = SideReading(scope, "").side(scope.equations[0][0], True)
    assert (side.frames, len(side.factors)) == (frames, 2)


def test_velocities_are_what_differences_of_positions_give() -> None:
    step = 1e-6
    later = {name: value + step * RATES[name.replace("q", "qd")] for name, value in Q.items()}
    values = [numbers(ARM.quantity("p"), q) for q in (Q, later)]
    assert np.allclose((values[1] - values[0]) / step, numbers(slope(ARM.robot, ARM.quantity("p"), "t"), Q), atol=1e-5)
    assert np.allclose(numbers(own_quantity(ARM, "twist"), Q)[:3], numbers(slope(ARM.robot, ARM.quantity("p"), "t"), Q))
    # the angular velocity by dR/dt R^T
    turn = ARM.quantity("T")[:3, :3]
    spin = numbers(slope(ARM.robot, turn, "t"), Q) @ numbers(turn, Q).T
    assert np.allclose(numbers(own_quantity(ARM, "omega[3,0]"), Q).ravel(), [spin[2, 1], spin[0, 2], spin[1, 0]])
    assert {"twist", "omega"} <= {*OWN}
