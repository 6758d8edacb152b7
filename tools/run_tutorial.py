#!/usr/bin/python3
"""Runs every `sh` block of docs/tutorial.md, in order, in an empty folder; fails where a command fails.

Usage: tools/run_tutorial.py COXA_BINARY FOLDER (which is emptied)
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def main():
    binary, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    blocks = re.findall(r"^```sh\n(.*?)^```", (ROOT / "docs/tutorial.md").read_text(), re.S | re.M)
    environment = dict(os.environ, COXA=str(ROOT), PATH=f"{binary.parent}:{os.environ['PATH']}")
    for number, block in enumerate(blocks, 1):
        print(f"tutorial: block {number} of {len(blocks)}", flush=True)
        run = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=folder, env=environment,
                             capture_output=True, text=True)
        if run.returncode != 0:
            print(f"{block}\n{run.stdout}{run.stderr}\ndocs/tutorial.md: block {number} ends with {run.returncode}")
            return 1
    return 0 if blocks else "docs/tutorial.md: no block to run"


if __name__ == "__main__":
    sys.exit(main())
