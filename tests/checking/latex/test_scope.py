"""What a text says as a whole: names that it defines, in any order, and how it writes the frames of transforms."""

from derive.checking.latex.left import Scripts
from derive.checking.latex.scope import Scope
from derive.errors import Location
from derive.model.model import Model
from derive.robot.robot import Robot

PLANAR = Model(Robot.load("planar-2r-perugia"))
ROTATION = r"\begin{bmatrix} c_2 & -s_2 \\ s_2 & c_2 \end{bmatrix}"


def scope(text: str) -> Scope:
    return Scope(PLANAR, text, Location("page"), document=True)


def test_definitions_may_stand_behind_their_use_and_those_without_use_are_told() -> None:
    found = scope(r"$$x = k c_1 + h$$ $$h = k_2 c_{12}$$ $$k_2 = a_2$$ $$k = a_1$$ $$z_9 = a_1$$")
    assert sorted(found.definitions) == ["h", "k", "k2", "z9"]
    assert [name for name, _ in found.unused()] == ["z9"]


def test_the_reading_is_what_most_matrices_need() -> None:
    assert scope(f"$$R^1_2 = {ROTATION}$$").meanings.reading == frozenset()
    turned = scope(f"$$R_1^2 = {ROTATION}$$")
    assert turned.meanings.reading == {Scripts.RIGHT}
    assert turned.readings == ["transforms are read as T^i_j = pose of frame i in frame j (1 of 1 matrix)"]
