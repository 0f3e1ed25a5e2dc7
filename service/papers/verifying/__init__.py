"""A certificate checked by a stranger: with its session's file, without the service that issued it."""
