"""The paper on multi-position alignment: its two figures and its end values, and what comes after them."""
