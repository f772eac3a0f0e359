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

# From where people see each robot, chosen: the angle from the container's side to the onlooker, radians. The
# arm is then behind the surface.
GANTRY_ASPECT = -0.9
WAM_ASPECT = -0.9
REEM_ASPECT = 2.5

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

# REEM, two arms on a torso. Lengths and joint speeds as in its published description (PAL Robotics,
# reem_description: 14.2 and 8.8 cm of upper arm, 8.8 and 15 cm of forearm, 2 cm aside at the elbow, 4.6 cm of
# hand). Where its joint limits depend on how axes are counted they are chosen, and so is the rest.
REEM_OFFSETS = (0.0, 0.0, 0.02, -0.02, 0.0, 0.0, 0.0)
REEM_LENGTHS = (0.0, 0.0, 0.23, 0.0, 0.238, 0.0, 0.046)
REEM_LOW = (-2.6, -2.2, -2.36, -0.1, -2.09, -1.57, -2.09)
REEM_HIGH = (2.6, 2.2, 2.75, 2.44, 2.09, 1.57, 2.09)
REEM_SPEED = (2.7, 3.66, 4.58, 4.58, 1.95, 1.76, 1.76)
REEM_ACCELERATION = (6.0, 6.0, 8.0, 8.0, 8.0, 8.0, 8.0)
REEM_SHOULDERS = 0.20  # each beside the middle
# Chosen among a few by how much of the surface can be picked up from there (docs/world.md): the shoulders are
# above the table's edge, and so high above the surface.
REEM_ABOVE = 0.40
REEM_TOOL = 0.08
REEM_POSTURE = (0.0, 0.8, 0.0, 1.6, 0.0, 0.6, 0.0)
REEM_REST = (-1.2, 0.6, 0.0, 1.9, 0.0, 0.6, 0.0)
REEM_LEFT_REST = (1.2, 0.6, 0.0, 1.9, 0.0, 0.6, 0.0)
REEM_HULLS = (
    (0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.05), 0.06),
    (3, (-0.02, 0.20, 0.0), (-0.01, 0.02, 0.0), 0.05),
    (4, (0.02, 0.0, 0.0), (0.0, 0.0, 0.21), 0.045),
    (7, (0.0, 0.0, -0.036), (0.0, 0.0, 0.0), 0.04),
)
REEM_APART = ((0, 2), (0, 3), (1, 3))
REEM_MASSES = (1.5, 1.6, 1.6, 1.2, 1.2, 0.4, 0.1)
REEM_TORQUE = (45.0, 45.0, 30.0, 30.0, 20.0, 20.0, 20.0)
REEM_COLOUR = (214, 214, 210)

# The dustpan, whose length and slope `motion/pick_up.py` has. Chosen.
PAN_LIP = 4e-4
PAN_WIDTH = 0.16
PAN_WALL, PAN_WALL_HEIGHT = 4e-3, 0.025
PAN_FRICTION = 0.3
PAN_MASS = 0.05  # of each of its four parts
PAN_GAP = 2e-4  # below it while it stands on the surface
PAN_HELD = 0.20  # rad: the lip is raised so far while the rag leaves: what lies on the slope creeps down
PAN_LEAN = 0.35  # rad: the lip is raised so far while it is carried,
PAN_LEANS = (0.15, 0.60, 0.30)  # at least, at most, and to either side
PAN_HOLD = 0.6  # seconds that it stays tipped
PAN_COLOUR = (70, 140, 90)
