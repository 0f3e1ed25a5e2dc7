"""Who somebody is, and what a route needs: passwords, secrets, the table of rules."""
