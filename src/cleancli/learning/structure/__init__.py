"""Whole rules from transitions alone (§7.1): contexts, references, outcomes and their probabilities."""
