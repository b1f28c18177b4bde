"""Writes a motion as BVH: somebody marches on a circle, turns, swings the arms and bends the trunk, never twice the same."""

import math
import sys

RATE = 30.0
# Name, parent, offset in centimetres.
JOINTS = [
    ("Hips", None, (0, 0, 0)),
    ("Spine", "Hips", (0, 12, 0)),
    ("Chest", "Spine", (0, 22, 0)),
    ("Neck", "Chest", (0, 22, 0)),
    ("Head", "Neck", (0, 8, 0)),
]
for side, sign in (("Left", 1), ("Right", -1)):
    JOINTS += [
        (f"{side}Shoulder", "Chest", (4 * sign, 17, 0)),
        (f"{side}Arm", f"{side}Shoulder", (14 * sign, 0, 0)),
        (f"{side}ForeArm", f"{side}Arm", (28 * sign, 0, 0)),
        (f"{side}Hand", f"{side}ForeArm", (25 * sign, 0, 0)),
        (f"{side}UpLeg", "Hips", (9 * sign, -4, 0)),
        (f"{side}Leg", f"{side}UpLeg", (0, -42, 0)),
        (f"{side}Foot", f"{side}Leg", (0, -41, 0)),
        (f"{side}ToeBase", f"{side}Foot", (0, -5, 14)),
    ]
ENDS = {"Head": (0, 16, 0), "LeftHand": (17, 0, 0), "RightHand": (-17, 0, 0), "LeftToeBase": (0, 0, 6), "RightToeBase": (0, 0, 6)}


def below(name):
    """The joint and those below it, in the order of the file."""
    yield name
    for child, parent, _ in JOINTS:
        if parent == name:
            yield from below(child)


def angles(seconds):
    """Degrees about z, x, y by joint."""
    step, slow = 2 * math.pi * 0.9 * seconds, 2 * math.pi * 0.13 * seconds
    turns = {"Spine": (4 * math.sin(slow), 8 + 6 * math.sin(1.7 * slow), 6 * math.sin(0.6 * slow))}
    for side, sign, phase in (("Left", 1, 0.0), ("Right", -1, math.pi)):
        lift = max(0.0, math.sin(step + phase))
        swing = math.sin(step + phase + math.pi)
        raised = 35 + 30 * math.sin(0.8 * slow + phase)
        turns[f"{side}UpLeg"] = (2.0 * sign, -45 * lift, 0)
        turns[f"{side}Leg"] = (0, 60 * lift, 0)
        turns[f"{side}Arm"] = (-sign * (75 - raised), 0, sign * (10 + 25 * swing))
        turns[f"{side}ForeArm"] = (0, 0, -sign * (35 + 25 * math.sin(1.3 * slow + phase)))
    return turns


def frame(index):
    """The numbers of a frame: place, then turns."""
    seconds = index / RATE
    way = 2 * math.pi * seconds / 24
    place = (60 * math.cos(way), 92 + 1.5 * math.cos(4 * math.pi * 0.9 * seconds), 60 * math.sin(way))
    turns = angles(seconds)
    turns["Hips"] = (0, 0, -math.degrees(way) + 15 * math.sin(0.3 * seconds))
    numbers = [*place, *(angle for name in below("Hips") for angle in turns.get(name, (0, 0, 0)))]
    return " ".join(f"{number:.4f}" for number in numbers)


def hierarchy(name, depth=0):
    """The lines of a joint and those below it."""
    _, parent, offset = next(joint for joint in JOINTS if joint[0] == name)
    indent = "  " * depth
    channels = "6 Xposition Yposition Zposition" if parent is None else "3"
    yield f"{indent}{'ROOT' if parent is None else 'JOINT'} {name}"
    yield f"{indent}{{"
    yield f"{indent}  OFFSET {' '.join(map(str, offset))}"
    yield f"{indent}  CHANNELS {channels} Zrotation Xrotation Yrotation"
    for child, above, _ in JOINTS:
        if above == name:
            yield from hierarchy(child, depth + 1)
    if name in ENDS:
        yield f"{indent}  End Site\n{indent}  {{\n{indent}    OFFSET {' '.join(map(str, ENDS[name]))}\n{indent}  }}"
    yield f"{indent}}}"


if __name__ == "__main__":
    path, frames = sys.argv[1], int(sys.argv[2])
    with open(path, "w", encoding="utf-8") as file:
        lines = ["HIERARCHY", *hierarchy("Hips"), "MOTION", f"Frames: {frames}", f"Frame Time: {1 / RATE:.7f}"]
        file.write("\n".join([*lines, *map(frame, range(frames))]) + "\n")
