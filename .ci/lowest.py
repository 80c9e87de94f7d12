"""Print the lowest version that pyproject.toml allows of every package it names, as constraints."""

import tomllib
from pathlib import Path

project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
named = sum(project["optional-dependencies"].values(), start=project["dependencies"])
for requirement in sorted(set(named)):
    if not requirement.startswith(f"{project['name']}["):  # an extra that contains another
        print(requirement.replace(">=", "==", 1))
