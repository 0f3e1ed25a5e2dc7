"""The search for causes: forward selection, backward elimination, refinement of shapes."""
