"""The pages in a real Chromium, over real HTTP."""
