"""Units' lives from an independent generator: no law, prior or code is shared with the estimator or other generators.

`draw_life` draws what truly happens to a unit. `epochs` gives it as histories of parameters, `entries` as the session
files and services in the order in which a crew enters them. Everything follows from the `rng` that is passed in.
"""
