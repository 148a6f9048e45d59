"""Engines that make the runs of a campaign: what they need of a system, and which of them a system gets."""
