"""Crashes at every step of an adaptation of every shape: what comes back is the old structure or the new one."""
