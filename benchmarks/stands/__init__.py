"""Stands that shift, blocks that are seated badly, axes that drift: how often each is told as what it is."""
