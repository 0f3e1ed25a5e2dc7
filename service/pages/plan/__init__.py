"""The pages of a plan, and of what is asked before a measurement and while it is made."""
