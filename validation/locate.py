"""Where the program granflow is."""

import os
import shutil

from environment import HERE, Refusal


def program(path=None):
    """The program granflow: the one given, the one built in this clone, or the one on the path."""
    built = HERE.parent / "target" / "release" / ("granflow.exe" if os.name == "nt" else "granflow")
    found = shutil.which(path) if path else (str(built) if built.is_file() else shutil.which("granflow"))
    if not found:
        where = f"{path} is no program" if path else f"there is no program granflow, neither at {built} nor on the path"
        raise Refusal(where, "cargo build --release -p granflow-cli; or --granflow PROGRAM")
    return os.path.abspath(found)
