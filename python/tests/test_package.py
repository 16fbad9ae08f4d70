"""The package itself: types, stubs, documentation, notebooks."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

import nima
from conftest import motion

FOLDER = Path(__file__).resolve().parents[1]
# A page that watches a run.
PLACE = "127.0.0.1:18944"
NOTEBOOKS = sorted((FOLDER / "notebooks").glob("*.ipynb"))


def check(*arguments: str, folder: Path) -> None:
    done = subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True, check=False, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr


def test_mypy_accepts_the_package_and_who_uses_it(tmp_path):
    check("mypy", "--strict", "-p", "nima", folder=tmp_path)
    user = tmp_path / "user.py"
    user.write_text(
        "import numpy as np\nimport nima\n"
        "result = nima.identify(np.zeros(9), np.zeros(9), 1000.0, 0.05, mode='dfr')\n"
        "error: float = result.errors['rendered']['mae']\n"
        "environment = nima.Environment('peg_transfer')\n"
        "observation, info = environment.reset(seed=1)\n"
        "observation, reward, terminated, truncated, info = environment.step(observation['handle_m'])\n"
    )
    check("mypy", "--strict", str(user), folder=tmp_path)
    user.write_text("import nima\nnima.identify([1.0], [1.0], mode=3)\n")
    wrong = subprocess.run([sys.executable, "-m", "mypy", "--strict", str(user)], capture_output=True, text=True, cwd=tmp_path)
    assert wrong.returncode == 1 and 'incompatible type "int"' in wrong.stdout, wrong.stdout


def test_the_stub_has_everything_that_is_compiled_and_nothing_else(tmp_path):
    check("mypy.stubtest", "nima._nima", "--ignore-missing-stub", "--ignore-disjoint-bases", folder=tmp_path)
    stub = (FOLDER / "nima" / "_nima.pyi").read_text()
    for name, member in vars(sys.modules["nima._nima"]).items():
        if not name.startswith("_"):
            assert re.search(rf"(def|class) {name}\b", stub), name
            for method in vars(member) if inspect.isclass(member) else ():
                assert method.startswith("_") or method in stub, f"{name}.{method}"


def test_everything_public_is_documented():
    for name in nima.__all__:
        thing = getattr(nima, name)
        if isinstance(thing, tuple):
            continue
        assert inspect.getdoc(thing), name
        for method, member in vars(thing).items() if inspect.isclass(thing) else ():
            public = not method.startswith("_") and (inspect.isfunction(member) or isinstance(member, property))
            assert not public or inspect.getdoc(member), f"{name}.{method}"


@pytest.mark.parametrize("page", [FOLDER / "README.md", FOLDER.parent / "docs" / "python.md"], ids=lambda page: page.name)
def test_the_examples_of_the_pages_run(page, tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)
    times_s, positions_m, forces_n = motion(1500)
    columns = np.column_stack([times_s, positions_m, forces_n])
    np.savetxt("recording.csv", columns, delimiter=",", comments="", header="t_s,x_m,y_m,z_m,fx_n,fy_n,fz_n", fmt="%.17g")
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(), re.S)
    assert blocks
    names: dict[str, object] = {"positions_m": positions_m, "forces_n": forces_n}
    for block in blocks:
        if PLACE in block:
            block = block.replace(PLACE, request.getfixturevalue("running")[1])
        exec(compile(block, page.name, "exec"), names)
    assert isinstance(names["result"], nima.Identification)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_notebooks_run(path):
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": path.parent}}).execute()
    assert not any(cell.get("outputs") for cell in nbformat.read(path, as_version=4).cells), "kept without outputs"
    assert len(NOTEBOOKS) == 3
