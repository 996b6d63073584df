"""From reflectance to matrix, and how far the colour is off."""
