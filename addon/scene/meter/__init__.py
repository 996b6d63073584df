"""Light as a meter reads it: lux, luminance, color temperature, what it does to people."""
