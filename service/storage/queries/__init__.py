"""Every query of the service, one subject a file."""
