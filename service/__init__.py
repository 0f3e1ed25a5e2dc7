"""The service: upload → validate → calibrate → history → decisions → pages and reports.

Imports run one way:
app, cli → api | pages | reports → flows → ingest | storage → records, units, errors, settings → estimator.
"""
