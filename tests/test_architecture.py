"""The house stays the house: sizes, names, docstrings, who may speak of what (docs/decisions, README)."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src" / "planner_reactor"
SOURCES = sorted(PACKAGE.rglob("*.py"))
LONGEST_FILE, LONGEST_FUNCTION, NINTH_DECILE = 400, 60, 25

GENERAL_ROOMS = ("rs", "analysis", "runtime", "reactor", "logic", "planner", "link")
KITTING = re.compile(
    r"kitting|workcell|\b(tray|trays|kit|kits|belt|gripper|conveyor|motor|cap|arm|camera|part_kind)s?\b"
)
ORDINARY = {"runtime": {"arm"}, "analysis": {"motor"}, "planner": {"motor"}}
"""Words of the trade that only look like kitting: to arm a queue; sensory and motor processes (X §3.3)."""
EMPTY_NAMES = re.compile(r"(manager|handler|helper|utils|common)", re.IGNORECASE)


def functions(tree: ast.Module) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
    return [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]


def length(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines without the docstring."""
    lines = (node.end_lineno or node.lineno) - node.lineno + 1
    first = node.body[0]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
        lines -= (first.end_lineno or first.lineno) - first.lineno + 1
    return lines


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_file_is_short_says_what_it_is_and_names_things(path: Path) -> None:
    text = path.read_text()
    tree = ast.parse(text)
    assert text.count("\n") <= LONGEST_FILE
    assert ast.get_docstring(tree)
    assert not EMPTY_NAMES.search(path.stem)
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            assert not EMPTY_NAMES.search(node.name)
    too_long = [f.name for f in functions(tree) if length(f) > LONGEST_FUNCTION]
    assert not too_long


def test_functions_are_short() -> None:
    lengths = sorted(length(f) for path in SOURCES for f in functions(ast.parse(path.read_text())))
    assert lengths[len(lengths) * 9 // 10] <= NINTH_DECILE


@pytest.mark.parametrize("room", GENERAL_ROOMS)
def test_no_room_but_the_workcell_speaks_of_kitting(room: str) -> None:
    found = {}
    for path in (PACKAGE / room).rglob("*.py"):
        words = {m.group(0) for m in KITTING.finditer(path.read_text().lower())} - ORDINARY.get(room, set())
        if words:
            found[str(path.relative_to(PACKAGE))] = words
    assert not found


def test_the_direction_of_imports_is_kept() -> None:
    linter = Path(sys.executable).parent / "lint-imports"
    done = subprocess.run([linter, "--no-logo"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_nothing_evaluates_text_or_unpickles() -> None:
    banned = re.compile(r"(?<![\w.])(eval|exec|__import__)\(|\bpickle\b|\bmarshal\b")
    found = {str(p.relative_to(PACKAGE)): banned.findall(p.read_text()) for p in SOURCES}
    assert not {path: words for path, words in found.items() if words}


def test_no_file_names_a_registry_host_or_a_path_of_some_machine() -> None:
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False).stdout.split()
    hosts = re.compile(r"pypi\.org|pythonhosted|registry\.npmjs|files\.python|/work/|\.\./shared")
    texts = [p for p in tracked if p.endswith((".py", ".md", ".toml", ".txt", ".itl", ".rsl", "Makefile", "run"))]
    found = [p for p in texts if p != "tests/test_architecture.py" and hosts.search((ROOT / p).read_text())]
    assert not found
