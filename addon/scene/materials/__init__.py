"""Materials that are made spectral, and given back."""
