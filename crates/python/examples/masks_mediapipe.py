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
cams = bl.CameraGroup.load(calibration)
masks, keypoints, fps = list[Any](), list[Any](), 30.0
for name, size in zip(cams.names, cams.size):
    video = cv2.VideoCapture(pattern.format(name))
    fps, seen, found = video.get(cv2.CAP_PROP_FPS) or fps, [], []
    with mediapipe.solutions.pose.Pose(enable_segmentation=True) as pose:
        while (picture := video.read()[1]) is not None:
            result = pose.process(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
            marks = result.pose_landmarks.landmark if result.pose_landmarks else []
            seen.append(result.segmentation_mask > 0.5 if marks else np.zeros(picture.shape[:2], bool))
            found.append([[*(size * (marks[i].x, marks[i].y) - 0.5), marks[i].visibility] if marks else [np.nan] * 3 for i in COCO])
    masks, keypoints = [*masks, np.array(seen)], [*keypoints, np.array(found)]
frames = min(map(len, masks))
bl.Take.from_arrays(cams, [m[:frames] for m in masks], keypoints=[k[:frames] for k in keypoints], fps=fps, sizes="fit").save(folder)
