"""From LaTeX to PDF with latexmk, in a folder of its own that nobody else sees.

The same text gives the same bytes: no time of day, no path and no configuration of the user's enters the PDF. TeX may
run no program and write nowhere else. What went wrong and how many pages there are is read in the log.
"""

import os
import re
import shutil
import signal
import subprocess
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from derive.errors import LatexError, Location
from derive.interrupts import TemporaryFolder

PROGRAMS = ("latexmk", "pdflatex")
PACKAGES = "texlive-latex-recommended latexmk"  # Debian packages that bring the programs
TIME_LIMIT = 120.0  # seconds after which LaTeX is stopped; the longest handout takes a few
_OPTIONS = ("-interaction=nonstopmode", "-halt-on-error", "-file-line-error", "-no-shell-escape")
_SECTION = re.compile(r"\\section\*\{(.*)\}")
_SHOWN = 160  # characters of a line of LaTeX in a message
# No time of day in the PDF, no line of the log cut, no file read or written outside.
_ENVIRONMENT = {
    "SOURCE_DATE_EPOCH": "0",
    "FORCE_SOURCE_DATE": "1",
    "TZ": "UTC",
    "LC_ALL": "C",
    "max_print_line": "10000",
    "error_line": "254",
    "half_error_line": "238",
    "openin_any": "p",
    "openout_any": "p",
}
_FAULT = re.compile(r"^(?:! (?!\s*==>)(?P<plain>.+)|(?P<file>[^\s:][^:\n]*):(?P<line>\d+): (?P<message>.+))$", re.M)
_PLACE = re.compile(r"^l\.(\d+) ", re.M)
_PAGES = re.compile(r"Output written on [^(]*\((\d+) page")


@dataclass(frozen=True, slots=True)
class LatexRun:
    """A run of pdflatex, the last one where there were several."""

    text: str  # the whole log
    pdf: bytes = b""  # the file; empty where none was asked for

    @property
    def faults(self) -> list[tuple[str, int]]:
        """What LaTeX says of each error, and the line of the input, from 1; 0 where LaTeX names none."""
        found = []
        for match in _FAULT.finditer(self.text):
            if match["message"]:
                found.append((match["message"].strip(), int(match["line"])))
                continue
            following = _FAULT.search(self.text, match.end())  # the plain form has its line further down
            place = _PLACE.search(self.text, match.end(), following.start() if following else len(self.text))
            found.append((match["plain"].strip(), int(place[1]) if place else 0))
        return found

    @property
    def pages(self) -> int:
        """Pages of the document; 0 if none was written."""
        return int(match.group(1)) if (match := _PAGES.search(self.text.replace("\n", ""))) else 0


def compile_latex(text: str, name: str = "handout", *, time_limit: float = TIME_LIMIT) -> LatexRun:
    """Compiles a document as often as its references need."""
    if missing := [program for program in PROGRAMS if shutil.which(program) is None]:
        remedy = f"on Debian and Ubuntu: apt install {PACKAGES}; or write the .tex and compile it elsewhere"
        raise LatexError(f"no PDF without LaTeX: {' and '.join(missing)} not found", remedy=remedy)
    with TemporaryFolder() as folder:
        source, log_file = folder.path / f"{name}.tex", folder.path / f"{name}.log"
        source.write_bytes(text.encode())
        status = _run([PROGRAMS[0], "-norc", "-pdf", *_OPTIONS, source.name], folder.path, time_limit)
        written = log_file.read_text(encoding="latin-1") if log_file.is_file() else ""
        if status is None:
            folder.keep()
            raise LatexError(f"LaTeX was stopped after {time_limit:g} s", remedy=f"see what it was doing in {log_file}")
        if status or LatexRun(written).faults:
            folder.keep()
            raise _refusal(text, LatexRun(written).faults, source)
        return LatexRun(written, source.with_suffix(".pdf").read_bytes())


def _run(command: list[str], folder: Path, time_limit: float) -> int | None:
    """The exit status, None after the time limit; neither latexmk nor the TeX that it started is left behind."""
    with open(folder / "output.txt", "wb") as output:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env={**os.environ, **_ENVIRONMENT},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        try:
            return process.wait(time_limit)
        except subprocess.TimeoutExpired:
            return None
        finally:
            if process.poll() is None:
                with suppress(OSError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def _refusal(text: str, faults: list[tuple[str, int]], kept: Path) -> LatexError:
    """What LaTeX said first, the line at which it says so or gave up, and what is written there under which heading."""
    if not faults:
        return LatexError("latexmk failed without a word of LaTeX", remedy=f"see {kept.with_name('output.txt')}")
    message = faults[0][0].removeprefix("LaTeX Error: ").rstrip(".")
    number = next((line for _, line in faults if line), 0)
    remedy = f"it is kept as {kept}"
    if "not found" in message and ".sty'" in message:
        remedy = f"on Debian and Ubuntu: apt install {PACKAGES} texlive-fonts-recommended; {remedy}"
    place = Location(kept.name, number) if number else None
    lines, written = text.splitlines(), ""
    if 0 < number <= len(lines):
        line = lines[number - 1].strip()
        shown = line if len(line) <= _SHOWN else f"{line[:_SHOWN]} ..."
        titles = (_SECTION.fullmatch(x) for x in reversed(lines[:number]))
        title = next((match[1] for match in titles if match), "")
        written = f"line {number} is '{shown}'" + (f", under '{title}'" if title else "")
    return LatexError(f"LaTeX: {message}", allowed=written, remedy=remedy, location=place)
