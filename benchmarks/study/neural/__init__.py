"""A network that learns from simulated sessions what a posterior over the causes would say."""
