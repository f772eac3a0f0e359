"""Teach a robot to clean: probabilistic rules in, motion out, better rules back."""

__version__ = "0.1.0"
