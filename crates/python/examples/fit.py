"""A person followed through the masks of four cameras: joints, how far they may be believed, files for other programs."""

import numpy as np

import backlit as bl

# Yours: cams = bl.CameraGroup.load("calibration.toml"), and masks from any segmentation, bool or uint8.
take = bl.Take.load()
cams = take.ideal_cameras
masks = np.stack([np.stack(take.masks(frame)) for frame in range(10)], axis=1)  # (cameras, frames, height, width)

track = bl.fit(cams, masks, body=take.body, fps=take.fps)

print(*track.notes, sep="\n")
wrist = track.joint_names.index("left forearm")
for frame, joints, sigma, verdict in zip(track.frames, track.joints, track.sigma, track.verdict):
    x, y, z = joints[wrist]
    print(f"frame {frame}: left wrist at ({x:.3f}, {y:.3f}, {z:.3f}) m, ± {1000 * sigma[wrist]:.0f} mm, {verdict}")
print("IoU by camera:", dict(zip(track.camera_names, track.iou.mean(axis=0).round(3).tolist())))
print("left knee flexion, degrees:", track.angles["left knee flexion"].round(1))

track.to_trc("motion.trc")
track.to_bvh("motion.bvh")
