"""What every subject uses: measures, moments, names, charts' look, lists."""
