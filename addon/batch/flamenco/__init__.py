"""Flamenco 3: the job type for its Manager, and submitting a plan to it. See README.md here."""
