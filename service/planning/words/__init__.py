"""Sentences on plans and measurements to come."""
