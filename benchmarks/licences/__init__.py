"""Dependencies of the service, with their licences."""
