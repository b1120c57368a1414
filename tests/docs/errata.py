"""Writes docs/errata.md from the lecture corpus: ``python -m tests.docs.errata``."""

from derive.api.check import printout_of
from derive.checking.files import check_path
from derive.checking.report import Printout, errata_report
from tests.docs.motion_errata import section
from tests.lectures.results import CORPUS
from tests.places import ROOT

PAGE = ROOT / "docs" / "errata.md"
TITLES = {
    "000": "Document 000: lecture notes on robot kinematics and mechatronics (C. Laschi)",
    "001": "Document 001: lecture slides 'Cinematica degli scheletri' (N. A. Borghese)",
    "002": "Document 002: lecture slides 'Cinemática Direta' (USP)",
    "003": "Document 003: lecture slides on direct kinematics (A. De Luca)",
    "004": "Document 004: report on the SCARA manipulator (University of Perugia)",
}
HEAD = (
    "This page lists the errors that `derive check` finds in five lecture documents; the command itself wrote it "
    "(`make errata`). Formulas are in the shorthand of the notes: `c12` is the cosine of the sum of the first two "
    "joint angles, `**` a power. In the Newton-Euler equations `w`, `wd`, `v`, `vd` are velocities and accelerations, "
    "`@` is a matrix product. The last section is about motions; its items are commands and numbers."
)


def printouts() -> list[Printout]:
    checked = (check_path(str(path)) for path in sorted(CORPUS.glob("*.yaml")))
    return [printout_of(report, robot) for report, robot in checked]


def page() -> str:
    found = printouts()
    documents = {finding.remark.document.title for p in found for finding in p.report.findings}
    documents |= {p.report.document.title for p in found}
    report = errata_report(found, {name: TITLES[name[:3]] for name in documents if name}, HEAD)
    return "\n".join([report, *section()]).rstrip() + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
