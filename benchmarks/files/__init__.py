"""Files made to do harm, and the heaviest that are allowed: what they cost the service."""
