"""Pictures for people who look rather than read: numbers in, pixels out, with numpy alone."""
