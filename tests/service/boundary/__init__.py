"""What every request passes before a route sees it, over real HTTP."""
