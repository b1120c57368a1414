"""What `derive` shows: every public name, in every order of imports, and no more."""

import inspect

import pytest

import derive
from tests.interpreters import printed_by
from tests.places import ROOT

FUNCTIONS = sorted(name for name in derive.__all__ if inspect.isfunction(getattr(derive, name)))


RUN, SOLVER = "from derive.cli.main import main; main", "derive.inverse.closed.solve"
UNNEEDED = {
    "import derive": "sympy numpy casadi flint pydantic yaml jinja2 derive.robot derive.model",
    "import derive.api.build": "sympy numpy casadi flint pydantic jinja2 derive.programs.build",
    "import derive, tempfile\nwith tempfile.TemporaryDirectory() as out: "
    "derive.build('scara-perugia', out, targets=['numpy'], only=True, effort='quick')": (
        "dask distributed zarr xarray pyarrow pandas"
    ),
    "import derive.programs.inverse": "sympy casadi pydantic",
    f"{RUN}(['show', 'puma560-usp', 'p', '--format', 'latex'])": f"numpy casadi pydantic jinja2 {SOLVER}",
    f"{RUN}(['move', 'scara-pick-and-place'])": f"casadi pydantic numpy.ma scipy {SOLVER} derive.model.kinematic_model",
}


@pytest.mark.parametrize(("statement", "heavy"), UNNEEDED.items())
def test_what_is_not_needed_is_not_imported(statement: str, heavy: str) -> None:
    code = f"{statement}; import sys; print([name for name in {heavy.split()} if name in sys.modules])"
    assert printed_by(code).splitlines()[-1] == "[]"


def test_dir_shows_the_public_names_before_anything_is_imported() -> None:
    assert printed_by("import derive; print(*dir(derive))").split() == sorted(derive.__all__)


def test_no_subpackage_takes_the_place_of_a_function() -> None:
    modules = ("cli.main", "publish.build", "notebook", "api.check", "api.plot", "api.handout")
    everything = "; ".join(f"import derive.{module}" for module in modules)
    functions = f"[getattr(derive, name) for name in {FUNCTIONS!r}]"
    same = f"print(all(map(inspect.isfunction, found)) and found == {functions})"
    assert printed_by(f"import derive, inspect; found = {functions}; {everything}; {same}") == "True"
    assert not [name for name in FUNCTIONS if (ROOT / "derive" / name).exists()]


@pytest.mark.parametrize("name", derive.__all__)
def test_every_public_name_is_documented(name: str) -> None:
    thing = getattr(derive, name)
    if name in FUNCTIONS:
        text = inspect.getdoc(thing) or ""
        assert "Returns:" in text
        assert all(f"    {argument}: " in text for argument in inspect.signature(thing).parameters)
    elif inspect.isclass(thing):
        assert inspect.getdoc(thing)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'bild'"):
        _ = derive.bild  # type: ignore[attr-defined]
