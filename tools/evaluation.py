"""What the programs share that evaluate segmentation: their arguments, the evaluator of ../shared/eval, noisy landmarks."""
import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent


def parser(doc, work="/tmp/coxa_evaluation", coxa=True):
    """With --coxa (where it is run), --shared and --work."""
    arguments = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    if coxa:
        arguments.add_argument("--coxa", default=ROOT / "build/release/coxa")
    arguments.add_argument("--shared", type=pathlib.Path, default=ROOT.parent / "shared")
    arguments.add_argument("--work", type=pathlib.Path, default=pathlib.Path(work))
    return arguments


def begin(arguments):
    """The options, their work directory made, and the evaluator, ../shared/eval/surface_distance.py."""
    options = arguments.parse_args()
    sys.path.insert(0, str(options.shared / "eval"))
    import surface_distance as evaluator
    options.work.mkdir(parents=True, exist_ok=True)
    return options, evaluator


def run(command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        print(f"{' '.join(map(str, command))}\n  ended with {done.returncode}: {done.stderr.strip()[-400:]}", file=sys.stderr)
    return done


def distances(result, truth, image, evaluator):
    """assd, hd95, bias and the others of surface_distance.py, mm, where the image shows them."""
    return json.loads(run(["/usr/bin/python3", evaluator.__file__, result, truth, "--image", image, "--json"]).stdout)


def distance_text(d):
    return f"{d['assd']:.3f} / {d['hd95']:.2f} / {d['bias']:+.2f}"


def noisy(marks, name, error, seed):
    """Landmarks with normal noise, its size's standard deviation `error` mm, the same for a name and a seed."""
    rng = np.random.default_rng([seed, *name.encode()])
    return {mark: p + rng.normal(0, error / np.sqrt(3), 3) for mark, p in marks.items()}


def write_landmarks(path, marks, side):
    rows = [f"{mark}_{side}," + ",".join(f"{x:.3f}" for x in p) for mark, p in marks.items()]
    path.write_text("name,x,y,z\n" + "\n".join(rows) + "\n")
