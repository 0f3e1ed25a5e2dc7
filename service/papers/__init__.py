"""Documents for people and programs: certificates, corrections, labels, exports."""
