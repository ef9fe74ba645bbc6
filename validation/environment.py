"""A virtual environment for a script: made once, with pinned packages, and entered. Standard library only."""

import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
MARK = "granflow-packages.txt"
AVAFRAME = ["avaframe==2.1", "numpy==1.26.4", "rasterio==1.4.4", "fiona==1.10.1", "matplotlib==3.11.2", "netCDF4==1.7.5.1.post1"]


class Refusal(Exception):
    """What is wrong, and a cure; printed without a traceback."""

    def __init__(self, finding, cure):
        super().__init__(f"error: {finding}\n  cure: {cure}")


def guarded(main):
    """Runs `main` and exits: status 2 with the finding and its cure after a refusal, 130 after Ctrl-C."""
    try:
        sys.exit(main())
    except Refusal as refusal:
        print(refusal, file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("interrupted; what is written so far stays", file=sys.stderr)
        sys.exit(130)


def python_of(folder):
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def pip(folder, packages):
    """Installs into the environment; a refusal says what pip said last and what may help."""
    done = subprocess.run([python_of(folder), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages],
                          capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return
    said = (done.stderr.strip() or done.stdout.strip()).splitlines()
    last = next((line for line in reversed(said) if line.startswith("ERROR")), said[-1] if said else "nothing")
    if "No module named pip" in last:
        cure = f"remove {folder}, install pip's wheels for this Python (Debian: apt install python3-venv), start again"
    elif any(word in done.stderr for word in ("Connection", "resolve", "Retrying", "timed out", "Network")):
        cure = f"connect to a network; or bring wheels: {python_of(folder)} -m pip install --no-index --find-links WHEELS {' '.join(packages)}"
    else:
        cure = f"look whether there is a network; the packages were tried with Python 3.11, this is {sys.version.split()[0]}: with that, give a new folder, --venv FOLDER"
    raise Refusal(f"pip could not install {' '.join(packages)} into {folder}: {last}", cure)


def make(folder, packages):
    """The environment with these packages, made where it is missing, kept where it is there."""
    wanted = "\n".join(packages) + "\n"
    mark = folder / MARK
    if folder.exists() and any(folder.iterdir()):
        if not (folder / "pyvenv.cfg").is_file() or not python_of(folder).exists():
            raise Refusal(f"{folder} is there and is no virtual environment", "give another folder: --venv FOLDER")
        if mark.is_file() and mark.read_text(encoding="utf-8") == wanted:
            return
        print(f"installing {' '.join(packages)} into {folder}", file=sys.stderr)
    else:
        print(f"making {folder} with {' '.join(packages)}; a minute", file=sys.stderr)
        done = subprocess.run([sys.executable, "-m", "venv", folder], capture_output=True, text=True, check=False)
        if done.returncode:
            shutil.rmtree(folder, ignore_errors=True)
            raise Refusal(f"{sys.executable} makes no virtual environment: {(done.stdout or done.stderr).strip().splitlines()[0]}",
                          "install the module venv (Debian: apt install python3-venv), or use a Python from python.org")
    pip(folder, packages)
    mark.write_text(wanted, encoding="utf-8")


def enter(name, packages, folder=None):
    """Goes on in the environment `venv-NAME` beside this file, or in `folder`: returns in it, restarts the script outside it."""
    folder = pathlib.Path(folder).resolve() if folder else HERE / f"venv-{name}"
    make(folder, packages)
    if pathlib.Path(sys.prefix).resolve() == folder:
        return
    os.environ["MPLBACKEND"] = "Agg"
    sys.stdout.flush()
    command = [str(python_of(folder)), *sys.argv]
    if os.name == "nt":
        sys.exit(subprocess.run(command, check=False).returncode)
    os.execv(command[0], command)


def fresh_folder(path):
    """The folder for results, made; what lies there already is not touched, so it must be empty."""
    path = pathlib.Path(path).resolve()
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise Refusal(f"{path} is there and not empty", "give a new folder: --out FOLDER")
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise Refusal(f"{path} cannot be made: {error.strerror}", "give a folder that you may write: --out FOLDER") from error
    return path
