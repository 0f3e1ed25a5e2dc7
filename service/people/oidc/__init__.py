"""Signing in at an OpenID provider: the protocol and its routes. Optional; this folder can be deleted."""
