#!/usr/bin/env python3
"""Loads the exported mechanism of a run with the programs of others: MuJoCo, URDF readers, trimesh, OpenCASCADE and OpenSCAD. Python 3.11 or
newer; needs the network.

    cargo build --release
    python3 scripts/mechanism_peer.py                     # results/z-grasp
    python3 scripts/mechanism_peer.py runs/another-hand

MuJoCo, yourdfpy, urdf_parser_py, trimesh and OpenCASCADE (the kernel of FreeCAD) are installed into a virtual environment in a temporary folder. OpenSCAD is used
where it is installed (`apt install openscad`). Any warning is an error.
"""
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "hwasp"
PINNED = ["mujoco==3.17.0", "yourdfpy==0.0.60", "urdf_parser_py==0.0.4", "trimesh==5.2.0", "cadquery-ocp==8.0.1.1.0"]

# Runs inside the environment, with the folder of the export and the run's design.toml.
INSIDE = """
import itertools, json, re, sys, tomllib, warnings
from pathlib import Path
import mujoco, numpy, trimesh, yourdfpy
from urdf_parser_py import urdf as urdf_parser, xml_reflection

folder, design_file = Path(sys.argv[1]), Path(sys.argv[2])
warnings.simplefilter("error")
# What yourdfpy is told by trimesh is not about our files.
warnings.simplefilter("ignore", DeprecationWarning)


def refuse(message):
    raise AssertionError(message)


mujoco.set_mju_user_warning(refuse)
xml_reflection.core.on_error = refuse

KINDS = ["thumb_proximal", "thumb_distal", "finger_proximal", "finger_distal"]
JOINTS = [f"{digit}_{link}" for digit in ("thumb", "finger1", "finger2") for link in ("proximal", "distal")]
KIND = dict(zip(JOINTS, (0, 1, 2, 3, 2, 3)))
design = tomllib.loads(design_file.read_text())
radius, stiffness, preload = (
    [design[f"{kind}_{what}"]["as_built"][0] for kind in KINDS] for what in ("radius", "stiffness", "preload")
)
# What is printed is made for parts that are bought: the numbers at the head of hand.scad, in mm.
head = (folder / "hand.scad").read_text().split("$fn")[0]
scad = {name: json.loads(value) for name, value in re.findall(r"^(\\w+) = ([^;]+);", head, re.MULTILINE)}
near = numpy.abs(numpy.array(scad["radius"]) - 1e3 * numpy.array(radius)).max()
assert near < 0.2, f"the pulleys that are printed are {near} mm off those of the design"
random = numpy.random.default_rng(7)


def close(what, ours, theirs, tolerance):
    off = float(numpy.abs(numpy.asarray(ours) - numpy.asarray(theirs)).max())
    assert off <= tolerance, f"{what}: {ours} is not {theirs}"
    return off


# The model, as the engine's own tools read it.
model = mujoco.MjModel.from_xml_path(str(folder / "hand.xml"))
data = mujoco.MjData(model)
assert (model.nq, model.nv, model.nu, model.ntendon) == (16, 15, 6, 3), (model.nq, model.nv, model.nu, model.ntendon)
for joint in JOINTS:
    address, dof = int(model.joint(joint).qposadr[0]), int(model.joint(joint).dofadr[0])
    close(f"stiffness of {joint}", model.jnt_stiffness[model.joint(joint).id], stiffness[KIND[joint]], 1e-12)
    close(f"preload of {joint}", model.qpos_spring[address], -preload[KIND[joint]], 1e-12)
worst = 0.0
for _ in range(100):
    angles = random.uniform(0, 1.57, 6)
    for joint, angle in zip(JOINTS, angles):
        data.joint(joint).qpos[0] = angle
    mujoco.mj_forward(model, data)
    wound = [sum(radius[KIND[j]] * a for j, a in zip(JOINTS[d : d + 2], angles[d : d + 2])) for d in (0, 2, 4)]
    worst = max(worst, close("tendon lengths", data.ten_length, wound, 1e-12))
mujoco.mj_resetDataKeyframe(model, data, 0)
for step in range(3000):
    data.ctrl[3:] = min(model.numeric("travel").data[0], 1e-5 * step)
    mujoco.mj_step(model, data)
assert all(warning.number == 0 for warning in data.warning), "the engine warns of a state"
bodies = [model.body(name) for name in ["palm", *(f"{joint}_link" for joint in JOINTS)]]
mass = sum(float(body.mass[0]) for body in bodies)
print(f"MuJoCo {mujoco.__version__}: hand.xml has nq {model.nq}, {model.ntendon} tendons, a hand of {1e3 * mass:.1f} g;")
print(f"  tendon lengths at 100 poses are those of the design to {worst:.0e} m; 3 s of winding without a warning")

# Links and joints.
strict = urdf_parser.URDF.from_xml_string((folder / "hand.urdf").read_bytes())
strict.check_valid()
robot = yourdfpy.URDF.load(str(folder / "hand.urdf"), build_collision_scene_graph=True)
assert robot.validate() and not robot.errors, robot.errors
assert set(robot.actuated_joint_names) == set(JOINTS)
compiled = mujoco.MjModel.from_xml_path(str(folder / "hand.urdf"))
assert compiled.nq == 6, compiled.nq
total = 0.0
for body in bodies:
    inertial = robot.link_map[body.name].inertial
    moments = numpy.diag(inertial.inertia)
    assert (inertial.inertia == numpy.diag(moments)).all() and moments.min() > 0 and 2 * moments.max() <= moments.sum()
    total += inertial.mass
    # MuJoCo sorts principal moments.
    close(f"moments of {body.name}", sorted(moments), sorted(body.inertia), 1e-18)
    close(f"mass of {body.name}", inertial.mass, body.mass[0], 0)
    close(f"centre of {body.name}", inertial.origin[:3, 3], body.ipos, 1e-15)
close("mass", total, mass, 1e-12)
worst = 0.0
for _ in range(100):
    angles = random.uniform(0, 1.57, 6)
    for joint, angle in zip(JOINTS, angles):
        data.joint(joint).qpos[0] = angle
    mujoco.mj_kinematics(model, data)
    robot.update_cfg(dict(zip(JOINTS, angles)))
    for body in bodies:
        place = robot.get_transform(body.name, "base")
        worst = max(worst, close(body.name, place[:3, 3], data.body(body.id).xpos - data.body("palm").xpos, 1e-12))
        worst = max(worst, close(body.name, place[:3, :3].ravel(), data.body(body.id).xmat, 1e-12))
print(f"yourdfpy {yourdfpy.__version__}, urdf_parser_py and MuJoCo take hand.urdf; its frames at 100 poses, masses and inertias")
print(f"  are those of hand.xml (frames to {worst:.0e})")

# Parts to print.
parts = {}
for file in sorted(folder.glob("*.stl")):
    mesh = trimesh.load_mesh(file)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.is_volume and mesh.body_count == 1, file.name
    assert mesh.nondegenerate_faces().all() and (mesh.edges_sorted.shape[0] == 2 * len(mesh.edges_unique)), file.name
    parts[file.stem] = mesh
    low, high = mesh.bounds
    size = " x ".join(f"{s:.1f}" for s in high - low)
    print(f"  {file.name:<27} {size:>20} mm {1e-3 * mesh.volume:>8.2f} cm3 {len(mesh.faces):>6} triangles {file.stat().st_size / 1e3:>6.1f} kB")
used = {visual.geometry.mesh.filename for link in robot.robot.links for visual in link.visuals}
assert used == {f"{name}.stl" for name in parts} and len(parts) == 15, sorted(parts)
worst = 0.0
for kind, name in enumerate(KINDS):
    link = parts[f"{name}_link"]
    # Half of the width: groove, flange, prong, springs, cheek, and what moves beside each other.
    line, free, room = scad["line"], scad["print_clearance"], -(-scad["springs"] // 2) * scad["spring_room"]
    half = line + free + scad["flange"] + free + scad["plate"] + room + free + free + scad["cheek"]
    # To the stop in the fork, beyond the largest pulley; to the tip.
    end = (50 + 12 + line / 2 + free + scad["wall"] + 1.5 * free, 40 + 12)[kind % 2]
    close(f"{name}_link", link.bounds, [[-half, -12, -12], [half, 12, end]], 0.01)
    # Half of the line below its centre; corners in a groove, which holes of the flange touch, on the other side.
    corners = parts[f"{name}_pulley"].vertices
    corners = corners[numpy.isclose(corners[:, 0], line + free)]
    away = numpy.hypot(corners[:, 1], corners[:, 2])
    bottom = away[away > scad["radius"][kind] - line].min()
    worst = max(worst, close(f"groove of {name}", bottom + line / 2, scad["radius"][kind], 0.005))
print(f"trimesh {trimesh.__version__}: all fifteen watertight; the line runs at the radii of the parts to {1e3 * worst:.1f} um")

# Parts that are joined, and the pulleys in them, at 25 poses.
placed = [(link.name, v.geometry.mesh.filename[:-4]) for link in robot.robot.links for v in link.visuals]
neighbours = {frozenset((joint.parent, joint.child)) for joint in robot.robot.joints}
pairs = [
    pair for pair in itertools.combinations(placed, 2)
    if pair[0][0] == pair[1][0] or frozenset((pair[0][0], pair[1][0])) in neighbours
]


# The volume that two parts have in common, mm3.
def shared(one, other):
    both = []
    for link, part in (one, other):
        place = robot.get_transform(link, "base").copy()
        place[:3, 3] *= 1e3
        both.append(parts[part].copy().apply_transform(place))
    corners = trimesh.boolean.intersection(both, engine="manifold").triangles
    return abs(float(numpy.einsum("ij,ij->", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])))) / 6


largest = 0.0
for proximal, distal in itertools.product(numpy.linspace(0, 1.57, 5), repeat=2):
    robot.update_cfg({joint: proximal if joint.endswith("proximal") else distal for joint in JOINTS})
    for pair in pairs:
        volume = shared(*pair)
        assert volume < 1e-3, f"{pair} share {volume} mm3 at {proximal}, {distal} rad"
        largest = max(largest, volume)
# A little before the open hand every link is inside of its stop.
robot.update_cfg({joint: numpy.float64(-0.002) for joint in JOINTS})
for joint in robot.robot.joints:
    if joint.name in JOINTS:
        one, other = ((link, "palm" if link == "palm" else link.replace("1", "").replace("2", "")) for link in (joint.parent, joint.child))
        assert 0.1 < shared(one, other) < 2, f"{joint.name} has no stop: {shared(one, other)} mm3"
print(f"  {len(pairs)} pairs of joined parts at 25 poses: the most that two share is {largest:.0e} mm3; every stop holds at 0 rad")
"""

# Compares a part of OpenSCAD's with ours.
SCAD = """
import sys, numpy, trimesh
ours, theirs = (trimesh.load_mesh(path) for path in sys.argv[1:])
assert theirs.is_watertight, sys.argv[2]
assert abs(theirs.volume / ours.volume - 1) < 1e-5, f"{sys.argv[1]}: {ours.volume} mm3, OpenSCAD {theirs.volume} mm3"
assert numpy.abs(ours.bounds - theirs.bounds).max() < 1e-3, f"{sys.argv[1]}: {ours.bounds}, OpenSCAD {theirs.bounds}"
print(abs(theirs.volume / ours.volume - 1))
"""


# Reads the STEP files with the kernel of FreeCAD: each one valid solid of the volume of its STL.
STEP = """
import sys, trimesh
from pathlib import Path
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer

largest, files = 0.0, sorted(Path(sys.argv[1]).glob("*.step"))
assert len(files) == 16, files
for file in files:
    reader = STEPControl_Reader()
    assert reader.ReadFile(str(file)) == IFSelect_RetDone, file
    reader.TransferRoots()
    shape = reader.OneShape()
    assert BRepCheck_Analyzer(shape).IsValid(), file
    solids, found = 0, TopExp_Explorer(shape, TopAbs_SOLID)
    while found.More():
        solids += 1
        found.Next()
    assert solids == 1, f"{file}: {solids} solids"
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    stl = file.with_suffix(".stl")
    stl = stl if stl.is_file() else stl.parent / "package" / stl.name
    off = abs(properties.Mass() / trimesh.load_mesh(stl).volume - 1)
    assert off < 1e-6, f"{file}: {off}"
    largest = max(largest, off)
print(f"OpenCASCADE: {len(files)} STEP files, each one valid solid with the volume of its STL to {largest:.0e}")
"""


def openscad(python, folder):
    """Every part by OpenSCAD; the largest relative difference of volumes."""
    largest = 0.0
    for ours in sorted(folder.glob("*.stl")):
        theirs = folder / f"openscad-{ours.name}"
        command = ["openscad", "-o", theirs, "-D", f'part="{ours.stem}"', folder / "hand.scad"]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stderr
        if "WARNING" in said or "ERROR" in said:
            sys.exit(said)
        off = subprocess.run([python, "-c", SCAD, ours, theirs], check=True, capture_output=True, text=True).stdout
        largest = max(largest, float(off))
    return largest


def main():
    run = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "results" / "z-grasp"
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", f"{folder}/venv"], check=True)
        python = f"{folder}/venv/bin/python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PINNED], check=True)
        out = Path(folder) / "export"
        command = [PROGRAM, "export", run, "--mjcf", "--urdf", "--stl", "--scad", "--step", "--package", "--out", out]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        if subprocess.run([python, "-c", INSIDE, out, run / "design.toml"]).returncode:
            sys.exit(f"the mechanism of {run} is not sound")
        subprocess.run([python, "-c", STEP, out], check=True)
        if shutil.which("openscad"):
            print(f"OpenSCAD makes the same parts of hand.scad: volumes to {openscad(python, out):.0e}")
        else:
            print("SKIPPED OpenSCAD: it is not installed")


if __name__ == "__main__":
    main()
