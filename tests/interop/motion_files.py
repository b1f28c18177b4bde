"""Opens written motion files with other people's libraries and compares joints with the CSV, within 0.1 mm.

Usage: motion_files.py FOLDER, where FOLDER has motion.csv, .bvh, .trc, .c3d, .glb and .npz of one motion, in metres
and with y up. A library that is not there is said, and its part skipped.
"""

import csv
import importlib
import math
import pathlib
import sys

NEAR_M = 1e-4


def optional(module):
    try:
        return importlib.import_module(module)
    except ImportError:
        print(f"SKIPPED: python3 has no module {module}")
        return None


class Check:
    def __init__(self, name):
        self.name, self.worst, self.count = name, 0.0, 0

    def near(self, found, expected, what):
        apart = math.dist([float(x) for x in found], expected)
        assert apart < NEAR_M, f"{self.name}: {what} is {apart} m from where the CSV has it"
        self.worst, self.count = max(self.worst, apart), self.count + 1

    def done(self):
        assert self.count, f"{self.name}: nothing was compared"
        print(f"{self.name}: {self.count} joints, at most {self.worst * 1000:.5f} mm apart")


def read_csv(path):
    """Joints by frame and name."""
    frames = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            place = [float(row[axis]) for axis in "xyz"]
            frames.setdefault(int(row["frame"]), {})[row["joint"].replace(" ", "_")] = place
    return frames


def multiply(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turned(a, v):
    return [sum(a[i][k] * v[k] for k in range(3)) for i in range(3)]


def about(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {
        "X": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "Z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]


def read_bvh(path):
    """Places of joints and end sites, frame by frame."""
    hierarchy, motion = path.read_text().split("MOTION")
    words, joints, stack = iter(hierarchy.split()[1:]), [], []
    for word in words:
        if word in ("ROOT", "JOINT", "End"):
            name = next(words)
            name = joints[stack[-1]][0] + "_end" if word == "End" else name
            joints.append([name, stack[-1] if stack else None, None, []])
        elif word == "{":
            stack.append(len(joints) - 1)
        elif word == "}":
            stack.pop()
        elif word == "OFFSET":
            joints[stack[-1]][2] = [float(next(words)) for _ in range(3)]
        elif word == "CHANNELS":
            joints[stack[-1]][3] = [next(words) for _ in range(int(next(words)))]
    for line in motion.strip().splitlines()[2:]:
        numbers, world = iter(map(float, line.split())), []
        for name, parent, offset, channels in joints:
            place, turn = list(offset), [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
            for channel in channels:
                if channel.endswith("position"):
                    place["XYZ".index(channel[0])] = next(numbers)
                else:
                    turn = multiply(turn, about(channel[0], next(numbers)))
            if parent is not None:
                above, of_above = world[parent]
                place = [a + b for a, b in zip(above, turned(of_above, place))]
                turn = multiply(of_above, turn)
            world.append((place, turn))
        yield {joint[0]: place for joint, (place, _) in zip(joints, world)}


# Nodes of the skeleton that lie at joints of the CSV.
PLACES = {
    "spine": "root",
    "chest": "spine",
    "neck": "chest",
    "neck_end": "skull",
} | {
    f"{side}_{node}": f"{side}_{joint}"
    for side in ("right", "left")
    for node, joint in {
        "upper_arm": "clavicle",
        "forearm": "upper_arm",
        "forearm_end": "hand",
        "thigh": "hip",
        "calf": "lower_thigh",
        "foot": "lower_calf",
        "foot_end": "foot",
    }.items()
}


def check_bvh(path, truth):
    check = Check("bvh")
    first = min(truth)
    for index, places in enumerate(read_bvh(path)):
        if first + index in truth:
            for node, joint in PLACES.items():
                check.near(places[node], truth[first + index][joint], f"{node} in frame {first + index}")
    check.done()


def check_bvhio(path, truth):
    bvhio = optional("bvhio")
    if bvhio is None:
        return
    check = Check("bvh by bvhio")
    first, root = min(truth), bvhio.readAsHierarchy(str(path))
    for index in range(max(truth) - first + 1):
        if first + index not in truth:
            continue
        root.loadPose(index, recursive=True)
        for node, _, _ in root.layout():
            joint = PLACES.get(node.Name)
            if joint:
                place = node.PositionWorld
                check.near(place, truth[first + index][joint], f"{node.Name} in frame {first + index}")
    check.done()


def check_trc(path, truth):
    check = Check("trc")
    lines = [line.split("\t") for line in path.read_text().splitlines()]
    names = [name for name in lines[3][2:] if name]
    for row in lines[6:]:
        for index, name in enumerate(names):
            place = row[2 + 3 * index : 5 + 3 * index]
            if int(row[0]) in truth:
                check.near(place, truth[int(row[0])][name], f"{name} in frame {row[0]}")
            else:
                assert place == ["nan"] * 3, f"trc: frame {row[0]} is a gap"
    check.done()


def check_opensim(mot, trc, truth):
    """OpenSim itself is large, so that requirements.txt leaves it out: it is asked where it is installed."""
    opensim = optional("opensim")
    if opensim is None:
        return
    check = Check("mot and trc by OpenSim")
    table = opensim.TimeSeriesTable(str(mot))
    assert table.getTableMetaDataAsString("inDegrees") == "yes"
    columns = [table.getDependentColumn(f"spine_t{axis}") for axis in "xyz"]
    for row, frame in enumerate(sorted(truth)):
        check.near([column[row] for column in columns], truth[frame]["root"], f"root in row {row}")
    table = opensim.TimeSeriesTableVec3(str(trc))
    assert table.getTableMetaDataAsString("Units") == "m"
    names, first = list(table.getColumnLabels()), min(truth)
    for row in range(table.getNumRows()):
        if first + row in truth:
            places = table.getRowAtIndex(row)
            for index, name in enumerate(names):
                place = [places[index][axis] for axis in range(3)]
                check.near(place, truth[first + row][name], f"{name} in frame {first + row}")
    check.done()


def check_ezc3d(path, truth):
    ezc3d = optional("ezc3d")
    if ezc3d is None:
        return
    check = Check("c3d by ezc3d")
    file = ezc3d.c3d(str(path))
    names = file["parameters"]["POINT"]["LABELS"]["value"]
    assert file["parameters"]["POINT"]["UNITS"]["value"] == ["m"]
    first = file["header"]["points"]["first_frame"]
    points = file["data"]["points"]
    for frame in range(points.shape[2]):
        for index, name in enumerate(names):
            if first + frame in truth:
                check.near(points[:3, index, frame], truth[first + frame][name], f"{name} in frame {first + frame}")
            else:
                assert math.isnan(points[0, index, frame]), f"c3d: frame {first + frame} is a gap"
    check.done()


def check_c3d(path, truth):
    c3d = optional("c3d")
    if c3d is None:
        return
    check = Check("c3d by c3d")
    with open(path, "rb") as file:
        reader = c3d.Reader(file)
        names = [name.strip() for name in reader.point_labels]
        for number, points, _ in reader.read_frames():
            for name, point in zip(names, points):
                if number - 1 in truth:
                    check.near(point[:3], truth[number - 1][name], f"{name} in frame {number - 1}")
                else:
                    assert point[3] < 0, f"c3d: frame {number - 1} is a gap"
    check.done()


def check_npz(path, truth):
    numpy = optional("numpy")
    if numpy is None:
        return
    check = Check("npz")
    file = numpy.load(path, allow_pickle=False)
    names = [str(name).replace(" ", "_") for name in file["joint_names"]]
    assert len(file["rotation_names"]) == file["rotations"].shape[1]
    for frame, joints in zip(file["frames"], file["joints"]):
        for name, place in zip(names, joints):
            check.near(place, truth[int(frame)][name], f"{name} in frame {frame}")
    check.done()


def check_glb(path, truth, rate):
    pygltflib, numpy = optional("pygltflib"), optional("numpy")
    if pygltflib is None or numpy is None:
        return
    check = Check("glb")
    file = pygltflib.GLTF2().load(str(path))
    data = file.binary_blob()

    def read(index):
        accessor = file.accessors[index]
        view = file.bufferViews[accessor.bufferView]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor.type]
        assert accessor.componentType == pygltflib.FLOAT
        return numpy.frombuffer(data, "<f4", accessor.count * width, view.byteOffset).reshape(-1, width)

    keys, times = {}, None
    for channel in file.animations[0].channels:
        sampler = file.animations[0].samplers[channel.sampler]
        times = read(sampler.input)[:, 0]
        keys[channel.target.node, channel.target.path] = read(sampler.output)

    def matrix(q):
        x, y, z, w = (float(v) for v in q)
        return [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]

    for key, time in enumerate(times):
        frame = min(truth) + round(float(time) * rate)
        stack, places = [(file.scenes[0].nodes[0], [0, 0, 0], matrix([0, 0, 0, 1]))], {}
        while stack:
            index, above, of_above = stack.pop()
            node = file.nodes[index]
            moved = keys.get((index, "translation"))
            moved = node.translation if moved is None else [float(x) for x in moved[key]]
            place = [a + b for a, b in zip(above, turned(of_above, moved))]
            turn = keys.get((index, "rotation"))
            turn = of_above if turn is None else multiply(of_above, matrix(turn[key]))
            places[node.name] = place
            stack += [(child, place, turn) for child in node.children or []]
        for node, joint in PLACES.items():
            check.near(places[node], truth[frame][joint], f"{node} in frame {frame}")
    check.done()


def main():
    folder = pathlib.Path(sys.argv[1])
    truth = read_csv(folder / "motion.csv")
    check_bvh(folder / "motion.bvh", truth)
    check_bvhio(folder / "motion.bvh", truth)
    check_trc(folder / "motion.trc", truth)
    check_opensim(folder / "motion.mot", folder / "motion.trc", truth)
    check_ezc3d(folder / "motion.c3d", truth)
    check_c3d(folder / "motion.c3d", truth)
    check_npz(folder / "motion.npz", truth)
    check_glb(folder / "motion.glb", truth, 60)


if __name__ == "__main__":
    main()
