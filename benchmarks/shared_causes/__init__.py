"""Every target of causes that sensors share, with what is measured: lines of several commands on one page."""
