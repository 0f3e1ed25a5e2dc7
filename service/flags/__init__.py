"""Flags: what somebody must look after; and the messages that tell of them."""
