"""The names of the parameters in which torques are linear."""

import random

import pytest

from derive.robot.inertial_parameters import LINK_PARTS, Parameter, has_regressor, standard_parameters
from derive.robot.robot import Robot
from tests.random_robots import random_robot


@pytest.mark.parametrize("seed", range(14))
def test_ten_for_each_link_and_what_its_joint_has(seed: int) -> None:
    drawn = random_robot(random.Random(seed), 1 + seed % 7)
    robot = Robot.from_text(drawn.text)
    found = standard_parameters(robot)
    assert len(set(found)) == len(found)
    assert [p for p in found if p.of_link] == [Parameter(i, part) for i in range(1, robot.n + 1) for part in LINK_PARTS]
    for i, link in enumerate(drawn.links, start=1):
        own = {p.part for p in found if p.joint == i and not p.of_link}
        wanted = dict.fromkeys(("mm", "Im"), link.rotor_inertia)
        wanted |= {"Ia": link.armature, "b": link.viscous, "f": link.coulomb}
        assert own == {part for part, value in wanted.items() if value}


def test_a_parameter_is_named_after_its_joint_and_without_links_there_are_none() -> None:
    assert Parameter(3, "Ixy").name == "Ixy3"
    assert has_regressor(Robot.load("scara-perugia"))
    assert not has_regressor(Robot.load("thumb"))
