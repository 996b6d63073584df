"""A sky that moves through the day: keyframes and drivers that a file plays without the add-on."""
