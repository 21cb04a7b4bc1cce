#!/usr/bin/env python3
"""Runs exported controllers in onnxruntime and holds them against this program. Python 3.10 or newer; needs the network.

    cargo build --release
    python3 scripts/onnx_peer.py                # the runs under results/, and short trainings of the other problems
    python3 scripts/onnx_peer.py runs/mine      # runs of one's own

`hwasp export --samples` writes 10,000 random observations with its own answers. Every ONNX file has to pass the checker of
`onnx`; its answers in onnxruntime, and those of numpy on controller.json and controller.safetensors, may differ by a
millionth of the motors' range (of the largest effort). Packages go into a virtual environment in a temporary folder.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "hwasp"
PINNED = ["onnxruntime==1.32.0", "onnx==1.23.2", "numpy==2.4.6", "safetensors==0.8.0"]
SAMPLES = 10_000
TOLERANCE = 1e-6
TRAINED = ["mass-spring hwasp", "mass-spring minimal", "bar-length hwasp", "pendulum hwasp", "reach hwasp"]

# Runs inside the environment: [file, bytes, tensor, largest difference, unit, the same as a share] for an export.
INSIDE = """
import json, os, sys
import numpy, onnx, onnxruntime
from safetensors.numpy import load_file
folder = sys.argv[1] + "/"
samples, contract = load_file(folder + "samples.safetensors"), json.load(open(folder + "contract.json"))
rows = []

def compare(file, tensor, given):
    quantities, wanted = contract[tensor], samples[tensor]
    assert given.shape == wanted.shape and numpy.isfinite(given).all()
    apart = numpy.abs(given - wanted).max(0)
    sizes = [q["limits"][1] - q["limits"][0] for q in quantities] if tensor == "command" else numpy.abs(wanted).max(0)
    worst = int(numpy.argmax(apart / sizes))
    share = float(apart[worst] / sizes[worst])
    rows.append([file, os.path.getsize(folder + file), tensor, float(apart[worst]), quantities[worst]["unit"], share])

for name in ["controller", "policy"]:
    file, model = name + ".onnx", contract["models"][name]
    onnx.checker.check_model(onnx.load(folder + file), full_check=True)
    session = onnxruntime.InferenceSession(folder + file, providers=["CPUExecutionProvider"])
    assert json.loads(session.get_modelmeta().custom_metadata_map["contract"]) == contract
    for told, found in zip(model["inputs"] + model["outputs"], session.get_inputs() + session.get_outputs()):
        kind = {"float32": "tensor(float)", "float64": "tensor(double)"}[told["type"]]
        assert (told["name"], kind, told["shape"]) == (found.name, found.type, found.shape), (told, found)
    inputs = {told["name"]: samples[told["name"]].astype(told["type"]) for told in model["inputs"]}
    for told, given in zip(model["outputs"], session.run(None, inputs)):
        compare(file, told["name"], given.astype("float64"))

# The numbers by hand, in double precision.
def network(x, layers):
    for weight, bias, activation in layers:
        x = x @ numpy.asarray(weight, "float64") + numpy.asarray(bias, "float64")
        x = {"tanh": numpy.tanh, "relu": lambda x: numpy.maximum(x, 0), "identity": lambda x: x}[activation](x)
    return x

observation = samples["observation"].astype("float64")
told = json.load(open(folder + "controller.json"))
column = lambda tensor, key: numpy.array([q[key] for q in told[tensor]])
x = (observation - column("observation", "center")) / column("observation", "scale")
if "clip" in told["observation"][0]:
    x = numpy.clip(x, -column("observation", "clip"), column("observation", "clip"))
x = network(x, [(l["weight"], l["bias"], l["activation"]) for l in told["layers"]])
limits = column("command", "limits").T
compare("controller.json", "command", numpy.clip(x * column("command", "scale") + column("command", "offset"), *limits))

t = {name: tensor.astype("float64") for name, tensor in load_file(folder + "controller.safetensors").items()}
count = len(contract["network"]["sizes"]) - 1
kinds = [contract["network"]["hidden_activation"]] * (count - 1) + [contract["network"]["output_activation"]]
layers = [(t[f"controller.{l}.weight"], t[f"controller.{l}.bias"], kind) for l, kind in enumerate(kinds)]
x = (observation - t["observation.center"]) / t["observation.scale"]
if "observation.lowest" in t:
    x = numpy.clip(x, t["observation.lowest"], t["observation.highest"])
x = network(x, layers)
x = numpy.clip(x * t["command.scale"] + t["command.offset"], t["command.lowest"], t["command.highest"])
compare("controller.safetensors", "command", x)
print(json.dumps(rows))
"""


def trained(folder):
    """Short trainings of the problems that have no run under results/."""
    for run in TRAINED:
        experiment, method = run.split()
        out = folder / f"{experiment}-{method}"
        command = [PROGRAM, "train", experiment, "--method", method, "--env-steps", "400000", "--quiet", "--out", out]
        subprocess.run(command, check=True)
        yield out


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
        python = folder / "venv" / "bin" / "python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PINNED], check=True)
        runs = [Path(run) for run in sys.argv[1:]]
        runs = runs or [*sorted(run for run in (ROOT / "results").iterdir() if run.is_dir()), *trained(folder)]
        print("| run | file | kB | answer | largest difference | as a share |\n|---|---|---|---|---|---|")
        far = []
        for number, run in enumerate(runs):
            out = folder / f"export-{number}"
            export = [PROGRAM, "export", run, "--out", out, "--samples", str(SAMPLES)]
            subprocess.run(export, check=True, stdout=subprocess.DEVNULL)
            printed = subprocess.run([python, "-c", INSIDE, out], check=True, stdout=subprocess.PIPE, text=True).stdout
            for file, size, tensor, apart, unit, share in json.loads(printed):
                cells = [run.name, f"`{file}`", f"{size / 1e3:.1f}", tensor, f"{apart:.1e} {unit}".strip(), f"{share:.1e}"]
                print("| " + " | ".join(cells) + " |", flush=True)
                if not share <= TOLERANCE:
                    far.append(f"{run.name}: {file}")
    if far:
        sys.exit(f"more than {TOLERANCE} apart: {', '.join(far)}")


if __name__ == "__main__":
    main()
