//! Silhouette-based markerless motion capture: the tracking core of Backlit.
