"""Studies of what careful people find in sessions, by generators that share no code with the estimator."""
