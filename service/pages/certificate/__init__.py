"""Certificates, corrections and labels: the page, and the same over HTTP."""
