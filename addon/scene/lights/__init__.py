"""Lamps: the sun's, the sky's dome of soft suns, the user's, and whom they light."""
