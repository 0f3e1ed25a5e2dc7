"""Steps that raise and settle flags, one reason a file."""
