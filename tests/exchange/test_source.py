"""What a URDF or a xacro file is made of, and expressions in xacro."""

from pathlib import Path

import pytest
import xacro

from derive.errors import RobotFileError
from derive.exchange.reading.source import MARK, ChainSource, forbidden, guarded, open_urdf, opened, relative
from tests.exchange.urdfs import J, urdf

XACRO = """\
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="length" default="0.5"/>
  <xacro:macro name="bar" params="name parent far">
    <link name="${name}"/>
    <joint name="to_${name}" type="revolute">
      <parent link="${parent}"/><child link="${name}"/>
      <origin xyz="${far} 0 0"/><axis xyz="0 0 1"/><limit lower="${-pi}" upper="${pi}" effort="1" velocity="1"/>
    </joint>
  </xacro:macro>
  <link name="l0"/>
  <xacro:bar name="l1" parent="l0" far="0"/>
  <xacro:bar name="l2" parent="l1" far="$(arg length)"/>
</robot>
"""


def test_names_with_quotes_line_breaks_and_braces_come_back() -> None:
    source = ChainSource('a "b".urdf', "base\n# x", "tip: {1}", "0" * 64, ("..",), (("a", "b"),))
    assert "\n" not in source.line
    text = f"# {source.line}\n# pose error over all limits <= 1.2e-16 m and 3e-16 rad, proven\nname: arm\n"
    told = ChainSource.of(text)
    assert told[0] == source
    assert (told[1].position, told[1].rotation) == (1.2e-16, 3e-16)


@pytest.mark.parametrize("head", ["", "# derive import: {}", "# derive import: [1", f"# {MARK}3", "name: arm"])
def test_a_head_that_says_nothing_is_none(head: str) -> None:
    text = f"{head}\n# pose error over all limits <= 1 m and 1 rad, proven\n"
    assert ChainSource.of(text) is None


def test_xacro_is_expanded_with_its_arguments_and_no_others(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(XACRO)
    assert float(open_urdf(path)[0].joints[1].origin.xyz[0]) == 0.5
    assert float(open_urdf(path, arguments={"length": "0.25"})[0].joints[1].origin.xyz[0]) == 0.25
    path.write_text(XACRO)
    with pytest.raises(RobotFileError, match="no argument 'lenght'; its arguments: 'length'"):
        open_urdf(path, arguments={"lenght": "0.25"})


def test_xacro_is_known_by_what_it_uses_whatever_the_file_is_called(tmp_path: Path) -> None:
    """From standard input, which has no folder, it is refused; what stands in comments is no use of it."""
    path = tmp_path / "arm.urdf"
    path.write_text(XACRO)
    assert float(open_urdf(path)[0].joints[1].origin.xyz[0]) == 0.5
    with pytest.raises(RobotFileError, match=r"arm\.urdf:2:1: an element 'xacro:arg'"):
        opened(XACRO.encode(), "arm.urdf")
    text = urdf([J()], top="<!-- <xacro:bar/> ${pi} <!-- -->").replace("<robot ", '<robot xmlns:xacro="http://xacro" ')
    path.write_text(text)
    assert open_urdf(path)[0] == opened(text.encode(), str(path))[0]


def test_arguments_need_xacro_and_packages_a_folder(tmp_path: Path) -> None:
    plain, path = tmp_path / "plain.urdf", tmp_path / "arm.xacro"
    plain.write_text(urdf([J()]))
    path.write_text(XACRO)
    with pytest.raises(RobotFileError, match="arguments of xacro, 'length', for a file without xacro"):
        open_urdf(plain, arguments={"length": "1"})
    with pytest.raises(RobotFileError, match=r"no folder '.*nowhere'"):
        open_urdf(path, [f"bars={tmp_path / 'nowhere'}"])
    # folders of packages are named in the robot file where xacro has looked in them
    assert [bool(open_urdf(file, [str(tmp_path)])[1].packages) for file in (plain, path)] == [False, True]


def test_what_xacro_does_not_find_is_one_message(tmp_path: Path) -> None:
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO.replace("$(arg length)", "$(find nowhere)"))
    with pytest.raises(RobotFileError, match="nowhere") as refused:
        open_urdf(path)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("folder", "included", "packages"),
    [
        ("src/bars", "$(find bars)/arm.xacro", ["{}/src"]),
        ("src/other", "$(find bars)/arm.xacro", ["bars={}/src/other"]),
        (".", "arm.xacro", []),
    ],
)
def test_includes_are_found_in_packages_by_folder_or_name_and_beside_the_file(
    folder: str, included: str, packages: list[str], tmp_path: Path
) -> None:
    (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    (tmp_path / folder / "arm.xacro").write_text(XACRO)
    path, include = tmp_path / "cell.xacro", f'<xacro:include filename="{included}"/>'
    path.write_text(f'<robot name="cell" xmlns:xacro="http://www.ros.org/wiki/xacro">{include}</robot>')
    assert len(open_urdf(path, [package.format(tmp_path) for package in packages])[0].joints) == 2


def test_a_digest_is_that_of_the_file_which_is_named_from_the_folder_of_the_other(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(urdf([J()]))
    before = open_urdf(path)[1].sha256
    path.write_text(urdf([J("0 0 1")]))
    assert open_urdf(path)[1].sha256 != before
    assert relative(tmp_path / "urdf" / "arm.urdf", tmp_path / "robots") == "../urdf/arm.urdf"


RUN = "('touch owned')"

FRAMES = (
    "[a for a in [[]] for g in [(g.gi_frame.f_back.f_back.f_back.f_globals for g in a)] for _ in [a.append(g)] "
    f"for r in g for _ in [r['os'].system{RUN}]]"
)

CLASSES = "[c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close']"
LAMBDA = f"(lambda: {CLASSES}[0].__init__.__globals__['system']{RUN})()"

GLOBALS = "python.vars(python.type(xacro.arg))['_' + '_globals_' + '_']"
TYPES = f"python.vars(python.type({GLOBALS}))['_' + '_get_' + '_']({GLOBALS}, xacro.arg)['os'].system{RUN}"

HOSTILE = [f"${{{FRAMES}}}", f"${{{LAMBDA}}}", f"${{{TYPES}}}", "$(eval ${frames})"]


def file_with(value: str) -> str:
    return f'''<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="type" value="revolute"/>
  <xacro:property name="size" value="${{dict(length=0.25, f_max=3, _n=2)}}"/>
  <xacro:property name="frames" value="{FRAMES}"/>
  <link name="l0"/><link name="l1"/><joint name="j" type="${{type}}"><parent link="l0"/><child link="l1"/>
  <origin xyz="{value} 0 0"/><axis xyz="0 0 1"/></joint></robot>'''


@pytest.mark.parametrize("value", HOSTILE)
def test_no_file_runs_a_command(value: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(file_with(value))
    with pytest.raises(RobotFileError, match=r"is not (evaluated|defined)") as refused:
        open_urdf(path)
    assert "\n" not in str(refused.value)
    assert "--packages" not in refused.value.remedy or "is not defined" in refused.value.found
    assert [entry.name for entry in tmp_path.iterdir()] == ["arm.urdf"]


def test_what_one_expansion_writes_for_the_next_is_looked_at(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(file_with("$" + HOSTILE[1]))
    with pytest.raises(RobotFileError, match="uses __"):
        open_urdf(path)
    assert not (tmp_path / "owned").exists()


@pytest.mark.parametrize(
    "value",
    [
        "${size['length']}",
        "${python.sum([0.2, 0.05])}",
        "${'%.2f' % (1 / 4)}",
        "$(eval 1/4.0)",
        "${(lambda x: x / size['_n'])(0.5)}",
        "${[k / 4 for k in python.range(2)][1]}",
    ],
)
def test_sums_of_lengths_are_evaluated(value: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(file_with(value))
    assert float(open_urdf(path)[0].joints[0].origin.xyz[0]) == 0.25


def test_other_users_of_xacro_find_it_as_it_was() -> None:
    before, offered = xacro.safe_eval, dict(xacro._global_symbols["python"])
    with guarded():
        assert xacro.safe_eval is not before
    assert xacro.safe_eval is before
    assert dict(xacro._global_symbols["python"]) == offered
    assert forbidden("limits.f_max + type") is None
