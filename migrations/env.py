"""Run by Alembic for every command; the caller's connection and transaction are used, so that a failure undoes all."""

from alembic import context

from service.papers.tables import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    render_as_batch=True,
    transactional_ddl=True,
)
context.run_migrations()
