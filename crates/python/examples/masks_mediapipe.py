"""Masks and keypoints of videos by MediaPipe, written as a take: needs pip install backlit[masks].

python masks_mediapipe.py calibration.toml "videos/{}.mp4" take    # {} is a camera's name; pictures too: "{}/%06d.jpg"
"""

import sys
from typing import Any

import cv2
import mediapipe
import numpy as np

import backlit as bl

COCO = [0, 2, 5, 7, 8, 11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28]  # MediaPipe's landmarks in COCO's order

calibration, pattern, folder = sys.argv[1:]
cams, masks, keypoints, fps = bl.CameraGroup.load(calibration), list[Any](), list[Any](), 30.0
for name in cams.names:
    video = cv2.VideoCapture(pattern.format(name))
    fps, seen, found = video.get(cv2.CAP_PROP_FPS) or fps, [], []
    with mediapipe.solutions.pose.Pose(enable_segmentation=True) as pose:
        while (picture := video.read()[1]) is not None:
            result, (height, width) = pose.process(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB)), picture.shape[:2]
            marks = result.pose_landmarks.landmark if result.pose_landmarks else []
            seen.append(result.segmentation_mask > 0.5 if marks else np.zeros((height, width), bool))
            found.append([[width * m.x - 0.5, height * m.y - 0.5, m.visibility] for m in (marks[i] for i in COCO)] if marks else 17 * [3 * [np.nan]])
    masks, keypoints = [*masks, np.array(seen)], [*keypoints, np.array(found)]
cams, T = cams.resized([m.shape[:0:-1] for m in masks]), min(map(len, masks))
bl.Take.from_arrays(cams, [m[:T] for m in masks], keypoints=[k[:T] for k in keypoints], fps=fps, sizes="fit").save(folder)
