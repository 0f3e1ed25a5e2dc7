"""Steps that raise flags, and say of open ones that nothing speaks for them any more."""
