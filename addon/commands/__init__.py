"""The commands: each gathers its arguments, calls other rooms and prints what came back."""
