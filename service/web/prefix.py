"""Where the API starts: the version of the contract is part of every address."""

API = "/api/v1"
