"""Print pip constraints that pin every dependency of a project to its lower bound."""

import sys
import tomllib
from pathlib import Path

from pip._vendor.packaging.requirements import Requirement


def lowest(requirement: Requirement) -> str:
    """``numpy>=1.26`` as ``numpy==1.26``; ValueError for a requirement without exactly one lower bound."""
    [bound] = [each.version for each in requirement.specifier if each.operator == ">="]
    return f"{requirement.name}=={bound}"


project = tomllib.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))["project"]
extras = project["optional-dependencies"]
print("\n".join(lowest(Requirement(each)) for each in (*project["dependencies"], *extras["jit"], *extras["fe"])))
