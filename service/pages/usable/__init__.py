"""May a unit be used?"""
