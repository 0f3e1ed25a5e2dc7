"""Tools for every subject: measures, moments, names, charts' look, lists."""
