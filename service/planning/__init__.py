"""Plans for people: asked in people's units, answered in words. The command and the page share it."""
