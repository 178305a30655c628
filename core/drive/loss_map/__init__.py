"""Drives whose losses are given as a map over torque and speed."""
