"""Brings the code for arms without formulas into templates of generated modules: ``python -m tests.targets.embedded``.

Generated modules import NumPy alone, so the code that solves general arms stands in them. It is that of
`derive.inverse`, less annotations, long docstrings and what a generated module does not need; names at the top
of a module get an underscore. With ``--check`` nothing is written, and the exit status is 1 where something would be.
"""

import ast
import copy
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from tests.docs.console import ROOT

SOURCES = {
    "rigid_motion": "derive.inverse.general.rigid_motion",
    "closure": "derive.inverse.general.closure",
    "numeric_chain": "derive.inverse.numeric.chain",
    "numeric": "derive.inverse.numeric.newton",
    "elimination": "derive.inverse.general.elimination",
    "candidates": "derive.inverse.general.candidates",
    "general": "derive.inverse.general.search",
}
"""Modules by the name of their template, in an order in which each needs only those before it."""

TEMPLATES = ROOT / "templates" / "numpy" / "inverse"

ROOTS = {
    "numeric": ("solve", "Status"),
    "numeric_chain": ("NumericChain", "POSE"),
    "elimination": ("Elimination", "Reduction"),
    "closure": ("Closure",),
    "general": ("GeneralSolution",),
}
"""What the templates use of them."""

LEFT_OUT = {"NumericChain.of"}
"""Methods that need more than NumPy."""

RENAMED = {("elimination", "POLICY"): "_ELIMINATION_POLICY"}
"""Names that two modules have."""

Key = tuple[str, str]
"""Module and name at its top."""


class Module:
    def __init__(self, name: str) -> None:
        self.name = name
        templates_of = {module: template for template, module in SOURCES.items()}
        tree = ast.parse((ROOT / SOURCES[name].replace(".", "/")).with_suffix(".py").read_text(encoding="utf-8"))
        self.imported: dict[str, Key] = {}
        self.defined: dict[str, ast.stmt] = {}
        for statement in tree.body:
            if isinstance(statement, ast.ImportFrom) and statement.module in templates_of:
                source = templates_of[statement.module]
                self.imported |= {alias.name: (source, alias.name) for alias in statement.names}
            elif isinstance(statement, ast.FunctionDef | ast.ClassDef):
                self.defined[statement.name] = statement
            elif isinstance(statement, ast.Assign | ast.AnnAssign):
                targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
                self.defined |= {
                    target.id: statement
                    for target in targets
                    for target in ast.walk(target)
                    if isinstance(target, ast.Name) and isinstance(target.ctx, ast.Store)
                }
        # Assignments into what has been defined.
        assignments = [s for s in tree.body if isinstance(s, ast.Assign)]
        self.filled = [s for s in assignments if not all(isinstance(target, ast.Name) for target in s.targets)]

    def key(self, name: str) -> Key | None:
        """What a name at the top of the module stands for, if it is embedded."""
        if name in self.defined:
            return self.name, name
        return self.imported.get(name)


module = cache(Module)


def local_names(function: ast.AST) -> set[str]:
    found = {node.id for node in ast.walk(function) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    return found | {node.arg for node in ast.walk(function) if isinstance(node, ast.arg)}


class Plain(ast.NodeTransformer):
    """Code without annotations and long docstrings, its names at the top those of the generated module."""

    def __init__(self, source: Module) -> None:
        self.source = source
        self.bound: list[set[str]] = []
        self.classes = 0
        self.needs: set[Key] = set()

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        self.bound.append(local_names(node) if not self.bound else local_names(node) | self.bound[-1])
        node.returns = None
        node.args = self.visit(node.args)
        node.decorator_list = [self.visit(each) for each in node.decorator_list]
        node.body = [new for each in node.body if (new := self.visit(each)) is not None]
        self.bound.pop()
        _shorten(node)
        if not self.bound and not self.classes:
            node.name = embedded_name((self.source.name, node.name))
        return node

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        self.classes += 1
        node.bases = [self.visit(each) for each in node.bases]
        node.decorator_list = [self.visit(each) for each in node.decorator_list]
        node.body = [new for each in node.body if (new := self.visit(each)) is not None]
        self.classes -= 1
        _shorten(node)
        node.name = embedded_name((self.source.name, node.name))
        return node

    def visit_arg(self, node: ast.arg) -> ast.AST:
        node.annotation = None
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST | None:
        value = self.visit(node.value) if node.value is not None else None
        if self.classes and not self.bound:
            kept = ast.AnnAssign(node.target, ast.Name("object", ast.Load()), value, node.simple)
            return ast.copy_location(kept, node)
        return None if value is None else ast.copy_location(ast.Assign([self.visit(node.target)], value), node)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if not any(node.id in names for names in self.bound):
            key = self.source.key(node.id)
            if key is not None and not (self.classes and not self.bound and isinstance(node.ctx, ast.Store)):
                self.needs.add(key)
                node.id = embedded_name(key)
        return node


def _shorten(node: ast.FunctionDef | ast.ClassDef) -> None:
    """The first line of a docstring alone; strings behind constants vanish."""
    documentation = ast.get_docstring(node)
    body = [s for s in node.body if not (isinstance(s, ast.Expr) and isinstance(s.value, ast.Constant))]
    first = [ast.Expr(ast.Constant(documentation.split("\n")[0]))] if documentation else []
    node.body = [*first, *body] or [ast.Pass()]


def embedded_name(key: Key) -> str:
    """What a name is called in a generated module."""
    return RENAMED.get(key) or (key[1] if key[1].startswith("_") else f"_{key[1]}")


def embedded() -> dict[str, str]:
    """The text of every template, by module."""
    plain: dict[Key, ast.stmt] = {}
    open_ = [(name, root) for name, roots in ROOTS.items() for root in roots]
    while open_:
        key = open_.pop()
        if key in plain:
            continue
        source = module(key[0])
        transformer = Plain(source)
        plain[key] = transformer.visit(copy.deepcopy(source.defined[key[1]]))
        for statement in source.filled:
            if key[1] in {n.id for n in ast.walk(statement) if isinstance(n, ast.Name)}:
                transformer.visit(copy.deepcopy(statement))
        open_ += transformer.needs
    _drop_unused_methods(list(plain.values()))
    return {name: _text(name, plain) for name in SOURCES}


def _drop_unused_methods(statements: list[ast.stmt]) -> None:
    """Methods whose name occurs nowhere, and those that are left out."""
    dropped = True
    while dropped:
        used = {n.attr for s in statements for n in ast.walk(s) if isinstance(n, ast.Attribute)}
        dropped = False
        for owner in (statement for statement in statements if isinstance(statement, ast.ClassDef)):
            for method in [s for s in owner.body if isinstance(s, ast.FunctionDef)]:
                is_used = method.name in used or method.name.startswith("__")
                if f"{owner.name.lstrip('_')}.{method.name}" in LEFT_OUT or not is_used:
                    owner.body.remove(method)
                    dropped = True


def _text(name: str, plain: dict[Key, ast.stmt]) -> str:
    source = module(name)
    blocks, done = [], set()
    for top, statement in source.defined.items():
        if (name, top) in plain and id(statement) not in done:
            done.add(id(statement))
            blocks.append(ast.unparse(ast.fix_missing_locations(plain[name, top])))
            for extra in source.filled:
                if top in {n.id for n in ast.walk(extra) if isinstance(n, ast.Name)}:
                    own = Plain(source).visit(copy.deepcopy(extra))
                    blocks.append(ast.unparse(ast.fix_missing_locations(own)))
                    done.add(id(extra))
    return formatted("\n\n".join(blocks) + "\n")


def formatted(text: str) -> str:
    command = [sys.executable, "-m", "ruff", "format", "--line-length", "120", "--stdin-filename", "x.py", "-"]
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True, cwd=ROOT).stdout


def templates() -> Iterator[tuple[Path, str]]:
    """Path and text of every template."""
    for name, text in embedded().items():
        assert not re.search(r"{{|{%|{#", text), f"{name}: braces that Jinja would read"
        yield TEMPLATES / f"{name}.py.jinja", text


def is_fresh(path: Path, text: str) -> bool:
    """Whether a template holds the code of its source, however it is formatted."""
    return path.is_file() and ast.dump(ast.parse(path.read_text(encoding="utf-8"))) == ast.dump(ast.parse(text))


def main(arguments: list[str] | None = None) -> int:
    """Write the templates, or say which are stale."""
    stale = [(path, text) for path, text in templates() if not is_fresh(path, text)]
    check = "--check" in (sys.argv[1:] if arguments is None else arguments)
    for path, text in stale:
        print(f"{'stale' if check else 'written'}: {path.relative_to(ROOT)}")
        if not check:
            path.write_text(text, encoding="utf-8")
    return int(check and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
