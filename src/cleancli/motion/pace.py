"""Speeds and heights of the tool between strokes, the same for every robot."""

FAST_SPEED = 0.20  # m/s, chosen; so is the next
STRAIGHT_SPEED = 0.12
VERTICAL_SPEED = 0.10  # coming down and lifting; chosen
TRANSIT_SPEED = 0.25  # above the surface, between actions; the measured room for planning assumes it
LIFT = 0.05  # "a few centimeters away from the surface" (§3.2)
