"""What is seen of faults that are put in: generators of their own, that import nothing from ``estimator`` to draw."""
