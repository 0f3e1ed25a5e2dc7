"""Sessions with a hidden effect, and how well the diagnosis finds it.

The physics here is written a second time, plainly, from the equations of the sensor model and of the catalogue of
causes. Nothing under ``estimator`` is imported but the function that is examined.
"""
