"""Imports a glTF file into Blender and holds the joints of its clips against tables of krok-export.

Usage: blender -b --factory-startup --python blender_clips.py --
           FILE.glb TOLERANCE NAME=POSITIONS.csv...
TOLERANCE is in millimetres. POSITIONS.csv has world positions in long form; all frames are compared.
Prints "OK" and the largest distance in millimetres, or what differs.
"""

import csv
import sys

import bpy
import numpy

# Blender 3.4 as Debian packages it uses a name that its numpy no longer has.
if not hasattr(numpy, "bool"):
    numpy.bool = bool


def positions(path):
    moments = {}
    with open(path, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            moments.setdefault(float(row["time"]), {})[row["joint"]] = [
                float(row[axis]) for axis in "xyz"]
    return moments


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=arguments[0])
    scene = bpy.context.scene
    armature = next(each for each in bpy.data.objects if each.type == "ARMATURE")
    tracks = {track.name for track in armature.animation_data.nla_tracks}
    worst = 0.0
    for argument in arguments[2:]:
        name, path = argument.split("=", 1)
        if name not in tracks:
            sys.exit(f"there is no NLA track {name} among {sorted(tracks)}")
        for track in armature.animation_data.nla_tracks:
            track.mute = True
        armature.animation_data.action = next(
            action for action in bpy.data.actions if action.name.startswith(name + "_"))
        moments = positions(path)
        compared = 0
        for time in sorted(moments):
            frame = time * scene.render.fps
            scene.frame_set(int(frame), subframe=frame - int(frame))
            for joint, (x, y, z) in moments[time].items():
                # Blender's axes: +Z up, the character faces -Y.
                at = armature.matrix_world @ armature.pose.bones[joint].head
                worst = max(worst, abs(at.x - x), abs(at.y + z), abs(at.z - y))
                compared += 1
        if not compared:
            sys.exit("nothing was compared")
    if 1000 * worst > float(arguments[1]):
        sys.exit(f"joints are up to {1000 * worst:.3f} mm away")
    print(f"OK {1000 * worst:.4f} mm")


main()
