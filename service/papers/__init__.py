"""What is handed to people and programs: certificates, corrections, labels, exports."""
