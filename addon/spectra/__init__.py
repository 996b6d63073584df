"""Light and matter on one wavelength grid: reflectances, sensitivities, sunlight, bases."""
