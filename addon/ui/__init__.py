"""What a person sees and presses in Blender: it draws and delegates, and knows no physics."""
