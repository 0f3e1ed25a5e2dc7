"""Under which address a client's attempts are counted."""

from ipaddress import IPv6Address, IPv6Network, ip_address

SITE = 64
"""Bits of an IPv6 address that a provider gives to one customer, who chooses the others freely."""


def counted_address(client: str) -> str:
    """The client's address; of IPv6 the network of its site, of IPv4 in IPv6 the IPv4 address."""
    try:
        found = ip_address(client)
    except ValueError:
        return client
    if not isinstance(found, IPv6Address):
        return client
    return str(found.ipv4_mapped or IPv6Network((found, SITE), strict=False))
