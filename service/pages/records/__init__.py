"""Records taken back, accepted, superseded, from the page and over HTTP."""
