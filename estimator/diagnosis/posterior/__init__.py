"""One generative model of a session, one search, one posterior.

layout, priors → information → term and its kinds → search → noise → solve → write
"""
