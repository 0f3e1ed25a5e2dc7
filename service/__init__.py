"""The service around the estimator: uploads, storage, decisions, pages and commands.

Sessions are many small matrices. Spread over several threads they cost more than they give, and two services on one
machine starve each other, so the numerical library is held to one thread. It reads the variable when numpy is first
imported, which no module of the service does before this one has run; an operator's own setting wins.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
