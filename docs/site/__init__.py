"""The site of the documentation: the pages of docs/ as they are, and a reference made from the code. `make docs`."""
