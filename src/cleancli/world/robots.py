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

# Barrett WAM: Denavit-Hartenberg rows and joint limits as in Barrett's user manual (D1001). The speeds and
# accelerations of joints are chosen: those of a careful set-up, far below what the arm can do.
WAM_OFFSETS = (0.0, 0.0, 0.045, -0.045, 0.0, 0.0, 0.0)
WAM_LENGTHS = (0.0, 0.0, 0.55, 0.0, 0.30, 0.0, 0.06)
WAM_LOW = (-2.6, -2.0, -2.8, -0.9, -4.76, -1.6, -3.0)
WAM_HIGH = (2.6, 2.0, 2.8, 3.1, 1.24, 1.6, 3.0)
WAM_SPEED = (1.2, 1.2, 1.8, 1.8, 3.0, 2.5, 3.0)
WAM_ACCELERATION = (4.0, 4.0, 6.0, 6.0, 10.0, 10.0, 10.0)
# Chosen, with measured reach (docs/world.md): the shoulder stands so far back from the container, beside the
# middle of the surface, and above the surface.
WAM_BACK, WAM_BESIDE, WAM_ABOVE = 0.05, 0.53, 0.30
WAM_GAP = 0.20  # chosen: at least so far beside the table's edge
WAM_TOOL = 0.10  # chosen: from the last flange to the rag's lower middle
WAM_POSTURE = (0.0, 0.6, 0.0, 1.6, -1.76, 0.9, 0.0)  # chosen: elbow up, all joints far from their limits
# Chosen: folded beside the table. Of the postures that hide nothing of it, searched at random, the one with
# the shortest ways to the surface.
WAM_REST = (0.62, 0.68, -0.31, 2.95, -2.65, 0.30, -0.17)
# Hulls of links (chosen, roughly those of the arm) as frame, both ends and radius: base, upper arm, forearm,
# hand.
WAM_HULLS = (
    (0, (0.0, 0.0, -0.346), (0.0, 0.0, -0.05), 0.10),
    (3, (-0.045, 0.50, 0.0), (-0.01, 0.02, 0.0), 0.07),
    (4, (0.045, 0.0, 0.0), (0.0, 0.0, 0.28), 0.055),
    (7, (0.0, 0.0, -0.05), (0.0, 0.0, 0.0), 0.045),
)
WAM_APART = ((0, 2), (0, 3), (1, 3))
WAM_MASSES = (10.0, 3.8, 6.0, 1.7, 2.4, 0.4, 0.2)  # chosen, of the order of the arm's 27 kg
WAM_TORQUE = (200.0, 200.0, 150.0, 150.0, 60.0, 60.0, 30.0)  # chosen: enough to follow any path it is given
WAM_COLOUR = (190, 192, 198)  # chosen

# Of all arms, chosen.
LINK_INERTIA = 0.02
HELD_MASS = 0.3
