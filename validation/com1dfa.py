"""Runs AvaFrame's com1DFA once: FOLDER with AvaFrame's layout, INI with the settings that differ from its defaults, JSON to write.

Called by runs.py as `python -I com1dfa.py`: in isolated mode, since the script avaframe.py beside this file would hide the package.
"""

import json
import logging
import pathlib
import sys
from importlib.metadata import version

from avaframe.com1DFA import com1DFA
from avaframe.in3Utils import cfgUtils


def main():
    folder, settings, answer = map(pathlib.Path, sys.argv[1:])
    logging.basicConfig(filename=folder / "com1dfa.log", level=logging.INFO)
    general = cfgUtils.getGeneralConfig()
    general["MAIN"].update(avalancheDir=str(folder), nCPU="1")
    general["FLAGS"].update(createReport="False", ReportDir="False", savePlot="False", showPlot="False")
    _, _, _, table = com1DFA.com1DFAMain(general, cfgInfo=settings)
    if not hasattr(table, "iloc") or len(table) != 1:
        sys.exit(f"com1DFA computed {len(table)} runs, one was asked for; see {folder / 'com1dfa.log'}")
    row = table.iloc[0]
    wanted = {"name": str(row["simName"]), "steps": int(row["nIter"]), "particles": int(row["nPart"]), "loop_seconds": float(row["timeLoop"])}
    answer.write_text(json.dumps({**wanted, "version": version("avaframe")}), encoding="utf-8")


main()
