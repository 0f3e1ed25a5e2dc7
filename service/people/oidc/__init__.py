"""Signing in at an OpenID provider: the protocol, and the way there and back. Optional; this folder can be deleted."""
