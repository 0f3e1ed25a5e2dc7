"""Electronic seals: PAdES on PDF, XAdES on XML, with the laboratory's key."""
