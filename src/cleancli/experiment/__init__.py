"""Carries out the episodes of studies, here or on a cluster, and keeps a row of each."""
