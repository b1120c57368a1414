"""Printed Denavit-Hartenberg tables become robots with the same transforms, whatever their columns are called."""

from pathlib import Path

import numpy as np
import pytest

from derive import Model, Robot
from derive.checking.documents import document_of
from derive.checking.table import robot_of_table
from derive.cli.main import main
from derive.errors import CheckError

ANT = "standard: theta1,d1,0,pi/2 theta2,0,a2,0 theta3,0,a3,0"
SCARA = "standard: theta1,d1,l1,0 theta2,0,l2,pi theta3,0,0,0 0,d4,0,0"
CRAIG = "modified: theta1,0,0,0 theta2,0,L1,pi/2 theta3,0,L2,0"
TABLES = {
    r"""| $i$ | $\theta_i$ | $d_i$ | $a_i$ | $\alpha_i$ |
|---|---|---|---|---|
| 1 | $\theta_1$ | $d_1$ | 0 | $90^\circ$ |
| 2 | $\theta_2$ | 0 | $a_2$ | $0^\circ$ |
| 3 | $\theta_3$ | 0 | $a_3$ | $0^\circ$ |
""": ANT,
    """Link | \N{GREEK SMALL LETTER ALPHA} | a | d | \N{GREEK SMALL LETTER THETA}
---|---|---|---|---
1 | π/2 | 0 | d₁ | θ₁
2 | 0 | a₂ | 0 | θ₂
3 | 0 | a₃ | 0 | θ₃
""": ANT,
    r"""\begin{tabular}{|c|c|c|c|c|} \hline
Joint & $a_i$ & $\alpha_i$ (deg) & $d_i$ & $\theta_i$ \\ \hline
1 & 0 & 90 & $d_1$ & $\theta_1^*$ \\ \hline
2 & $a_2$ & 0 & 0 & $\theta_2^*$ \\ \hline
3 & $a_3$ & 0 & 0 & $\theta_3^*$ \\ \hline
\end{tabular}
""": ANT,
    r"""$$\begin{array}{c|cccc} i & a_i & \alpha_i & d_i & \theta_i \\ \hline
1 & 0 & \frac{\pi}{2} & d_1 & \theta_1 \\
2 & a_2 & 0 & 0 & \theta_2 \\
3 & a_3 & 0 & 0 & \theta_3 \end{array}$$
""": ANT,
    r"""| Eslabón ($i$) | $\theta_i$ (Rotación en $Z$) | $d_i$ (Distancia en $Z$) | $a_i$ | $\alpha_i$ (Torsión) |
| :---: | :---: | :---: | :---: | :---: |
| **1** | $\theta_1^*$ | $d_1$ | $l_1$ | $0^\circ$ |
| **2** | $\theta_2^*$ | $0$ | $l_2$ | $180^\circ$ |
| **3** | $\theta_3^*$ | $0$ | $0$ | $0^\circ$ |
| **4** | $0^\circ$ | $d_4^*$ | $0$ | $0^\circ$ |
""": SCARA,
    r"""| $i$ | $\alpha_{i-1}$ | $a_{i-1}$ | $d_i$ | $\theta_i$ |
|-----|-----|-----|-----|-----|
| 1 | 0 | 0 | 0 | $\theta_1$ |
| 2 | $90°$ | $L_1$ | 0 | $\theta_2$ |
| 3 | 0 | $L_2$ | 0 | $\theta_3$ |
""": CRAIG,
    """| Joint | alpha(i-1) [deg] | a(i-1) | d(i) | theta(i) |
| --- | --- | --- | --- | --- |
| 1 | 0 | 0 | 0 | theta1 |
| 2 | 90 | L1 | 0 | theta2 |
| 3 | 0 | L2 | 0 | theta3 |
""": CRAIG,
    """| link | twist | link length | offset | theta |
|---|---|---|---|---|
| 1 | -90 | 0 | 0 | q1 |
| 2 | 90 | 0 | d2 | q2 - 90 |
| 3 | 0 | 0 | q3 | 0 |
""": "standard: q1,0,0,-pi/2 q2-pi/2,d2,0,pi/2 0,q3,0,0",
    """| i | theta | d | a | alpha |
|---|---|---|---|---|
| 1 | theta1 | 0 | a1 | 5 |
| 2 | theta2 + 0 | 0 | a2 | 90 |
""": "standard: theta1,0,a1,pi/36 theta2,0,a2,pi/2",
    """| i | theta | d (mm) | a (mm) | alpha |
|---|---|---|---|---|
| 1 | theta1 | 330 | 75 | -pi/2 |
| 2 | theta2 | 0 | 300 | 0 |
""": "standard: theta1,0.33,0.075,-pi/2 theta2,0,0.3,0",
}


def text_of(rows: str) -> Robot:
    convention, *joints = rows.split()
    lines = [f"name: arm\nconvention: {convention.removesuffix(':')}\njoints:"]
    for row in joints:
        theta, d, a, alpha = row.split(",")
        q = theta.split("-")[0] if theta[0] in "tq" else d
        kind = "revolute" if theta[0] in "tq" else "prismatic"
        lines.append(f"  - {{type: {kind}, q: {q}, theta: {theta}, d: {d}, a: {a}, alpha: {alpha}}}")
    return Robot.from_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("table", TABLES, ids=range(len(TABLES)))
def test_a_printed_table_is_the_robot_that_it_describes(table: str) -> None:
    kind = ".tex" if "\\begin" in table else ".md"
    text, where = robot_of_table(document_of(f"Prose before.\n\n{table}\nand after\n", "page", kind), "arm")
    read, meant = Robot.from_text(text), text_of(TABLES[table])
    assert read.convention == meant.convention
    assert [joint.variable for joint in read.joints] == [joint.variable for joint in meant.joints]
    assert Model(read).quantity("T") == Model(meant).quantity("T")
    assert where.line == 3 if kind == ".md" else where.line in (3, 4)


def test_a_last_row_without_a_variable_is_the_tool() -> None:
    rows = "| i | theta | d | a | alpha |\n|---|---|---|---|---|\n| 1 | theta1 | 0 | a1 | 0 |\n"
    text, _ = robot_of_table(document_of(f"{rows}| 2 | pi/2 | d2 | a2 | -pi/2 |\n", "page", ".md"), "arm")
    meant = Robot.from_text(
        "name: arm\nconvention: standard\njoints:\n  - {type: revolute, q: theta1, a: a1}\n"
        "tool:\n  - [0, 0, -1, 0]\n  - [1, 0, 0, a2]\n  - [0, -1, 0, d2]\n  - [0, 0, 0, 1]\n"
    )
    assert np.array_equal(Model(Robot.from_text(text)).quantity("T"), Model(meant).quantity("T"))


HEAD = "| i | theta | d | a | alpha |\n|---|---|---|---|---|\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no table here\n", "no Denavit-Hartenberg table"),
        (f"{HEAD}| 1 | q1 | 0 | a1 | 0 |\n\nprose\n\n{HEAD}| 1 | q1 | 0 | a2 | 0 |\n", "2 Denavit-Hartenberg tables"),
        (f"{HEAD}| 1 | 0 | 0 | a1 | 0 |\n| 2 | q2 | 0 | a2 | 0 |\n", "row 1 has no variable"),
        (f"{HEAD}| 1 | q1 | ? | a1 | 0 |\n", "cell '?' of column d"),
        (f"{HEAD}| 1 | q1 | d(1 | a1 | 0 |\n", "a table that is no robot"),
    ],
)
def test_what_is_no_table_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(CheckError, match=message.replace("?", r"\?")) as caught:
        robot_of_table(document_of(text, "page.md", ".md"), "arm")
    assert str(caught.value).startswith("page.md")


def test_the_command_writes_the_file_and_lines_choose_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("notes.md").write_text(f"{HEAD}| 1 | q1 | 0 | a1 | 0 |\n\nprose\n\n{HEAD}| 1 | q1 | 0 | a2 | 0 |\n")
    assert main(["new", "arm", "--from-table", "notes.md"]) == 2
    assert not Path("arm.yaml").exists()
    assert main(["new", "arm", "--from-table", "notes.md", "--lines", "6-9"]) == 0
    assert Robot.load("arm.yaml").joints[0].variable == "q1"
    assert "a2" in Path("arm.yaml").read_text()
    assert main(["new", "two", "--from-table", "notes.md", "--joints", "2"]) == 2
    capsys.readouterr()


def test_a_document_with_its_table_is_checked_without_a_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    rows = "| 1 | theta1 | 0 | a1 | 0 |\n| 2 | theta2 | 0 | a2 | 0 |\n"
    Path("notes.md").write_text(
        f"# Arm\n{HEAD}{rows}\n$$x = a_1 c_1 + a_2 c_{{12}}$$\n$$y = a_1 s_1 - a_2 s_{{12}}$$\n"
    )
    assert main(["check", "--latex", "notes.md"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("notes.md: the robot is that of the table at notes.md:2:1\n")
    assert "p[1]: same form" in said
    assert "p[2] is wrong" in said
    assert main(["check", "--latex", "x = a_1 c_1"]) == 2
    assert main(["check"]) == 2
    assert "name a corpus file" in capsys.readouterr().err
