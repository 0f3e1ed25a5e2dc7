"""Whether everybody may do everything: on this machine alone, until the first account is made."""

from service.people.provider import Provider
from service.people.store import Accounts
from service.settings import Settings
from service.storage import Storage


class Gate:
    """Whether everybody may do everything: on this machine alone, until the first account is made."""

    def __init__(self, settings: Settings, provider: Provider | None = None) -> None:
        self._settings, self._has_accounts = settings, False
        self.provider = provider
        """Where else people sign in."""

    @property
    def may_be_open(self) -> bool:
        """Whether there are times at which nobody needs to sign in."""
        return self._settings.sign_in == "off" or (self._settings.sign_in == "auto" and self._settings.is_local)

    def is_open(self, storage: Storage) -> bool:
        """Asks the database until there is an account; accounts are never deleted."""
        if not self.may_be_open or self._settings.sign_in == "off":
            return self.may_be_open
        if not self._has_accounts:
            with storage.database.reading() as store:
                self._has_accounts = Accounts(store).any()
        return not self._has_accounts
