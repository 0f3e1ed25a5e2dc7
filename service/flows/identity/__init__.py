"""What changes who may sign in: accounts, passwords, links, tokens; one verb a file."""
