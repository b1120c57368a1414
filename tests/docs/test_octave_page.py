"""The example of the page about MATLAB and Octave runs as it stands."""

import subprocess
from pathlib import Path

from derive.api.build import build
from derive.api.robots import load
from derive.verification.octave_model import OPTIONS, find_octave
from tests.docs.console import blocks
from tests.places import ROOT
from tests.targets.generated_models import needs_octave


@needs_octave
def test_the_example_runs(tmp_path: Path) -> None:
    script = []
    for block in blocks(ROOT / "docs" / "octave.md"):
        if block.file:
            (tmp_path / block.file).write_text(block.body, encoding="utf-8")
        script += [block.body] if block.language == "matlab" else []
    build(load(str(tmp_path / "arm.yaml")), tmp_path / "generated", targets=["octave"], effort="quick")
    (tmp_path / "arm_example.m").write_text("".join(script), encoding="utf-8")
    command = [*(find_octave() or ()), *OPTIONS, "arm_example.m"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    assert script
