"""What is done in another process is what would have been done here."""

import os
import pickle
from fractions import Fraction

import pytest

from derive.programs.build import build_program
from derive.publish.render import in_another_process, in_two_processes
from derive.robot.robot import Robot


def test_the_result_comes_back_however_often_it_is_asked_for_and_an_error_too() -> None:
    with in_another_process(sorted, [3, 1, 2], reverse=True) as result:
        assert result() == [3, 2, 1]
        assert result() is result()
    with in_another_process(divmod, 1, 0) as result, pytest.raises(ZeroDivisionError):
        result()
    with in_another_process(os.getpid):
        pass


def test_work_whose_process_dies_is_done_here() -> None:
    here = os.getpid()

    def fragile() -> int:
        if os.getpid() != here:
            os.kill(os.getpid(), 9)
        return 5

    with in_another_process(fragile) as result:
        assert result() == 5


@pytest.mark.parametrize("sizes", [[1, 1, 1], [90_000, 10, 20_000]], ids=["short", "long"])
def test_results_are_in_the_order_of_the_pieces(sizes: list[int]) -> None:
    assert in_two_processes(abs, [-1, -2, -3], sizes) == [1, 2, 3]


def test_programs_reach_another_process_whole() -> None:
    """One that does not is made twice, in silence: pi in its inverse kinematics did not."""
    program = build_program(Robot.load("puma560-corke"), names=(), inverse=True)
    assert any(not isinstance(node.value, Fraction | None) for node in program.inverse.function.tape.nodes)
    assert pickle.loads(pickle.dumps(program)) == program


def test_programs_do_not_depend_on_how_the_search_is_spread() -> None:
    robot = Robot.load("scara-perugia")
    assert build_program(robot, spread=in_two_processes) == build_program(robot)
