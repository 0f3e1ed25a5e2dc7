"""Backup and restore: one file that holds the database's rows and the uploaded files, for either engine."""

from service.storage.backup.restore import Restored, restore, verified
from service.storage.backup.write import write_backup

__all__ = ["Restored", "restore", "verified", "write_backup"]
