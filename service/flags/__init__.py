"""Flags on matters that somebody must look after, and the messages about them."""
