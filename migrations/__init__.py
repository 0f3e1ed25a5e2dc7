"""Alembic migrations of the service's database; `service.storage.schema` runs them."""
