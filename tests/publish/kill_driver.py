"""Run as a program: kills publishing processes at chosen moments and reports in what state the folder was each time.

``steps``: a child dies at the k-th operation on files, for every k until one lives to the end; ``moments``: a child
that publishes for ever is killed from outside after some milliseconds; ``builds``: a child builds a robot and is killed
on the way. Prints a JSON list of states: ``old``, ``new``, ``backup`` (between two renames, healed by the next build)
or what is wrong.
"""

import json
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from derive.publish import atomic_folder

VERSIONS = {
    name: {
        "MANIFEST.json": json.dumps(
            {"generator": "derive", "robot": "arm", "files": dict.fromkeys(("one.py", "two.py", name), "")}
        ).encode(),
        "one.py": name.encode() * 50_000,
        "two.py": name.encode() * 10,
        name: b"only here",
    }
    for name in ("old", "new")
}


def put(name: str, target: Path) -> None:
    atomic_folder.publish(VERSIONS[name], target, "arm", lambda folder: None)


def state(target: Path) -> str:
    if not target.exists():
        return "backup" if target.with_name(f".derive-{target.name}.old").exists() else "nothing"
    found = {path.name: path.read_bytes() for path in target.iterdir()}
    names = [name for name, files in VERSIONS.items() if files == found]
    return names[0] if names else f"mixed: {sorted(found)}"


def child(work: Callable[[], None]) -> int:
    process = os.fork()
    if process == 0:
        try:
            work()
        finally:
            os._exit(0)
    return process


def steps(target: Path) -> list[str]:
    """One state for every operation on files at which a process can die."""
    states = []
    for step in range(1, 1000):
        put("old", target)

        def work(step: int = step) -> None:
            die_at(step)
            put("new", target)

        _, status = os.waitpid(child(work), 0)
        states.append(state(target))
        atomic_folder.heal(target.parent)
        healed = state(target)
        states.append(healed if healed in VERSIONS else f"not healed: {healed}")
        if os.WEXITSTATUS(status) == 0:
            break
    return states


def die_at(step: int) -> None:
    """Ends this process, without any clean-up, before its ``step``-th operation on files."""
    count = 0

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        nonlocal count
        if event == "open" or event.startswith(("os.", "shutil.", "fcntl.", "ctypes.call")):
            count += 1
            if count == step:
                os._exit(9)

    sys.addaudithook(hook)


def moments(target: Path) -> list[str]:
    """The state after each of 60 kills from outside, each somewhere in the first publications of a child."""
    states = []
    put("old", target)
    for kill in range(60):
        reader, writer = os.pipe()
        process = child(lambda writer=writer: forever(target, writer))
        os.read(reader, 1)  # however busy the machine is, the child is at work now
        time.sleep(0.001 * kill)
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)
        os.close(reader)
        os.close(writer)
        states.append(state(target))
    put("new", target)
    states.append(f"left over: {sorted(os.listdir(target.parent))}" if len(os.listdir(target.parent)) > 1 else "new")
    return states


def forever(target: Path, writer: int) -> None:
    put("new", target)
    os.write(writer, b"x")
    while True:
        put("old", target)
        put("new", target)


def builds(target: Path, kills: int) -> list[str]:
    """The state after each of some kills of a whole build that would change a folder, evenly over its time."""
    from derive.publish.build import build_robot
    from derive.robot.robot import Robot

    def robot(title: str) -> Robot:
        head = f"name: arm\ntitle: {title}\nconvention: standard\n"
        return Robot.from_text(head + "joints: [{type: revolute, a: a1}]\n")

    def contents() -> dict[str, bytes]:
        return {path.name: path.read_bytes() for path in target.iterdir()}

    build_robot(robot("new"), target.parent)
    new, started = contents(), time.perf_counter()
    build_robot(robot("old"), target.parent)
    old, seconds = contents(), time.perf_counter() - started
    states = []
    for kill in range(kills):
        build_robot(robot("old"), target.parent, verified=False)
        process = child(lambda: build_robot(robot("new"), target.parent) and None)
        time.sleep(seconds * 1.2 * kill / kills)
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)
        found = contents()
        states.append("old" if found == old else "new" if found == new else f"mixed: {sorted(found)}")
    return states


def main() -> None:
    """Mode, folder, whether folders may be exchanged in one step, and how many builds are killed."""
    mode, target, swap = sys.argv[1], Path(sys.argv[2]), sys.argv[3] == "swap"
    target.parent.mkdir()
    assert target.parent.parent in Path(tempfile.gettempdir()).parents, "what is killed leaves temporary files anywhere"
    kills = int(sys.argv[4]) if len(sys.argv) > 4 else 0
    if not swap:
        atomic_folder.exchange = lambda one, other: False  # type: ignore[assignment]
    print(json.dumps(builds(target, kills) if kills else {"steps": steps, "moments": moments}[mode](target)))


if __name__ == "__main__":
    main()
