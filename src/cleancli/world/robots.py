"""Every number of the robots, each with its source or the word "chosen". Metres, seconds, kilograms, newtons,
radians; docs/world.md says what each robot is."""

from __future__ import annotations

# Gantry, chosen: quicker than the tool speeds of the actions, so that those decide.
JOINT_SPEED = (0.6, 0.6, 0.4, 3.0)  # x, y, z in m/s, yaw in rad/s
JOINT_ACCELERATION = (2.0, 2.0, 1.5, 10.0)
JOINT_FORCE = (200.0, 200.0, 200.0, 20.0)
CARRIAGE_MASS = (2.0, 2.0, 1.0, 0.4)
CARRIAGE_INERTIA = 0.01
REACH_MARGIN = 0.45  # how far the gantry goes beyond the table's edges
REACH_HEIGHT = (-0.02, 0.40)
TRACKING_LIMIT = 0.04  # farther than this from the commanded position, something blocks the tool
REST_CLEARANCE = 0.10  # between the camera's view and the resting tool
