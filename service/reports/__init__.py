"""What is handed to people and their programs: certificates, corrections, fleet reports; PDF, XLSX and XML."""
